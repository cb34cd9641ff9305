// The real programs: recordings, replays, errors, and the state after kill -9.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "lockstep.h"
#include "os/file_descriptor.h"
#include "server/match_record.h"
#include "server_program.h"

namespace server {
namespace {

TEST(ServerProgram, ReplaysWhatItRecorded) {
  const std::string path = temp_path("match.sfr");
  Process recorded(serve({"--port", "0", "--seconds", "1.5", "--seed", "9", "--team0", "computer",
                          "--team1", "computer", "--layout", "paper", "--record", path}));
  ASSERT_EQ(recorded.wait(), 0) << recorded.output();
  Process headless({REPLAY_BINARY, path, "--restore-at", "700"});
  EXPECT_EQ(headless.wait(), 0) << headless.output();
  EXPECT_NE(headless.output().find("ticks    1500\n"), std::string::npos) << headless.output();
  EXPECT_NE(headless.output().find("the replay is the match that was played"), std::string::npos);
  Process shown(serve({"--port", "0", "--replay", path, "--fast"}));
  EXPECT_EQ(shown.wait(), 0) << shown.output();
  EXPECT_NE(shown.output().find("the replay is the match that was played"), std::string::npos);
  Process stopped({REPLAY_BINARY, path, "--until", "100"});
  EXPECT_EQ(stopped.wait(), 0);
  Process beyond({REPLAY_BINARY, path, "--restore-at", "100000"});
  EXPECT_EQ(beyond.wait(), 2);
  std::remove(path.c_str());
}

TEST(ServerProgram, FailsWhenItsRecordingEndedEarly) {
  Process full(serve({"--port", "0", "--seconds", "0.1", "--record", "/dev/full"}));
  EXPECT_EQ(full.wait(), 1);
  EXPECT_NE(full.output().find("recording to /dev/full ended early"), std::string::npos)
      << full.output();
}

// The pipe has a reader that reads nothing.
TEST(ServerProgram, EndsOnSigtermThoughNobodyReadsItsRecording) {
  const std::string path = temp_path("pipe");
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  const os::FileDescriptor reader(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  ASSERT_GE(::fcntl(reader.get(), F_SETPIPE_SZ, 4096), 4096);
  RunningServer server({"--team0", "computer", "--team1", "computer", "--record", path});
  ProbeClient watcher(server.port());  // the control port answers meanwhile
  ASSERT_TRUE(watcher.join());
  while (const auto snapshot = watcher.snapshot()) {
    if (snapshot->tick > 1'000) break;  // of both computers' rods: more than the pipe holds
  }
  server->kill(SIGTERM);
  EXPECT_EQ(server->wait(), 1);
  EXPECT_NE(server->output().find("ended early"), std::string::npos) << server->output();
  std::remove(path.c_str());
}

TEST(ServerProgram, SaysThatAnotherServerWritesTheRecording) {
  const std::string path = temp_path("both.sfr");
  RunningServer server({"--record", path});
  Process second(serve({"--port", "0", "--record", path, "--overwrite"}));
  EXPECT_EQ(second.wait(), 2);
  EXPECT_NE(second.output().find("another server is writing it"), std::string::npos)
      << second.output();
  server->kill(SIGTERM);
  EXPECT_EQ(server->wait(), 0);
  std::remove(path.c_str());
}

TEST(ServerProgram, KeepsTheFileThatIsThereUnlessToldToOverwriteARecording) {
  const std::string path = temp_path("match.sfr");
  const std::vector<std::string> record = {"--quiet", "--port",   "0", "--seconds",
                                           "0.05",    "--record", path};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), record.begin(), record.end());
    return serve(more);
  };
  std::ofstream{path};  // an empty file holds nothing
  Process first(with({}));
  EXPECT_EQ(first.wait(), 0) << first.output();
  const std::string kept = text_of(path);
  ASSERT_FALSE(kept.empty());

  Process second(with({}));
  EXPECT_EQ(second.wait(), 2);
  EXPECT_NE(second.output().find("choose another name, remove it, or give --overwrite"),
            std::string::npos)
      << second.output();
  EXPECT_EQ(text_of(path), kept);

  Process overwriting(with({"--overwrite", "--seed", "99"}));
  EXPECT_EQ(overwriting.wait(), 0) << overwriting.output();
  EXPECT_NE(text_of(path), kept);
  Process exhibition(with({"--team0", "computer", "--team1", "computer"}));
  EXPECT_EQ(exhibition.wait(), 2) << exhibition.output();

  std::ofstream(path) << "a letter";
  Process other(with({"--overwrite"}));
  EXPECT_EQ(other.wait(), 2);
  EXPECT_NE(other.output().find("not a recording"), std::string::npos) << other.output();
  EXPECT_EQ(text_of(path), "a letter");
  std::remove(path.c_str());
}

// A replay whose recorded hash differs: both programs report it and exit with an error.
TEST(ServerProgram, SaysThatAReplayDiffers) {
  const std::string path = temp_path("match.sfr");
  std::vector<std::byte> bytes;
  wire::JournalEncoder encoder;
  encoder.add(server::to_header({}), bytes);
  for (std::uint64_t tick = 0; tick < 10; ++tick) {
    encoder.add(wire::JournalTick{tick, {}, {}}, bytes);
  }
  encoder.add(wire::JournalEnd{10, 1234}, bytes);
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<long>(bytes.size()));
  Process headless({REPLAY_BINARY, path});
  EXPECT_EQ(headless.wait(), 1);
  EXPECT_NE(headless.output().find("differs"), std::string::npos);
  const std::vector<std::string> options = {"--port", "0", "--replay", path};
  Process shown(serve(options));
  EXPECT_EQ(shown.wait(), 1);
  EXPECT_NE(shown.output().find("\nverdict    the replay differs"), std::string::npos)
      << shown.output();
  std::vector<std::string> quietly = options;
  quietly.push_back("--quiet");
  Process quiet(serve(quietly));
  EXPECT_EQ(quiet.wait(), 1);
  EXPECT_NE(quiet.output().find("the replay differs"), std::string::npos) << quiet.output();
  std::remove(path.c_str());
}

std::uint64_t ticks_in(const std::string& recording) {
  const std::string text = text_of(recording);
  wire::JournalReader reader(std::as_bytes(std::span(text)));
  std::uint64_t ticks = 0;
  while (const auto entry = reader.next())
    ticks += std::holds_alternative<wire::JournalTick>(*entry);
  return ticks;
}

TEST(ServerProgram, LeavesAReadableJournalWhenItIsKilled) {
  const std::string path = temp_path("match.sfr");
  RunningServer server({"--team0", "computer", "--team1", "computer", "--record", path});
  ProbeClient client(server.port());
  ASSERT_TRUE(client.join());
  // The writer thread may be scheduled late: the test relies on the file.
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (ticks_in(path) < 300 && std::chrono::steady_clock::now() < end) {
    ASSERT_TRUE(client.snapshot());
  }
  const std::uint64_t written = ticks_in(path);
  ASSERT_GE(written, 300u);
  server->kill(SIGKILL);
  EXPECT_EQ(server->wait(), -SIGKILL);
  EXPECT_TRUE(client.sees_close());

  Process headless({REPLAY_BINARY, path});
  EXPECT_EQ(headless.wait(), 4) << headless.output();
  EXPECT_NE(headless.output().find("stops early"), std::string::npos) << headless.output();
  const auto at = headless.output().find("ticks    ");
  ASSERT_NE(at, std::string::npos);
  EXPECT_GE(std::strtoull(headless.output().c_str() + at + 9, nullptr, 10), written);
  std::remove(path.c_str());
}

}  // namespace
}  // namespace server
