// The folder of recordings: the summary of each file, and which files are deleted.
#include "server/recordings.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "lockstep.h"
#include "os/file_descriptor.h"
#include "wire/read_file.h"

namespace server {
namespace {

namespace fs = std::filesystem;

class Recordings : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  void write(const std::string& name, std::span<const std::byte> bytes) const {
    std::ofstream(path(name), std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  }
  void touch(const std::string& name, std::size_t size = 0) const {
    write(name, std::vector<std::byte>(size));
  }
  // The files in the folder, without its path.
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& file : fs::directory_iterator(folder_))
      all.push_back(file.path().filename().string());
    std::ranges::sort(all);
    return all;
  }
  // Two computers play until a goal, or for this many ticks.
  void record(const std::string& name, int ticks) const {
    Lockstep table([&](ServerOptions& o) {
      o.computer = {true, true};
      o.match.seed = 42;
      o.record = path(name);
    });
    for (int i = 0; i < ticks; ++i) table.tick();
    table->finish(wire::Sentence::untranslated("done"));
  }

  const fs::path folder_ = temp_path("recordings");
};

TEST_F(Recordings, AreSummarisedByTheirFirstAndLastBytes) {
  record("2026-11-23_070542.sfr", 25'300);
  const RecordingSummary whole = summarise_recording(path("2026-11-23_070542.sfr"));
  EXPECT_EQ(whole.state, RecordingSummary::State::whole) << whole.problem;
  EXPECT_EQ(whole.ticks, 25'300u);
  EXPECT_EQ(whole.layout, 1);
  EXPECT_EQ(whole.characters[0].empty(), false);
  EXPECT_TRUE(whole.standing.computer[0] && whole.standing.computer[1]);
  std::tm began{};
  ::localtime_r(&whole.began, &began);
  EXPECT_EQ(began.tm_hour, 7);
  EXPECT_EQ(began.tm_mday, 23);

  // Truncated anywhere: the standing is at most one second old.
  const auto bytes = wire::read_file(whole.path, 1 << 30);
  ASSERT_TRUE(bytes);
  for (const std::size_t share : {30u, 50u, 77u, 99u}) {
    write("cut.sfr", std::span(*bytes).first(bytes->size() * share / 100));
    const RecordingSummary cut = summarise_recording(path("cut.sfr"));
    EXPECT_EQ(cut.state, RecordingSummary::State::cut_short);
    EXPECT_GT(cut.ticks, 1'000u) << share;
    EXPECT_EQ(cut.characters, whole.characters);
  }
}

TEST_F(Recordings, WhatIsNoRecordingHasASentenceThatNamesIt) {
  ASSERT_EQ(::mkfifo(path("pipe.sfr").c_str(), 0666), 0);
  fs::create_directory(path("folder.sfr"));
  touch("empty.sfr");
  touch("zeros.sfr", 100'000);
  fs::create_symlink("/no/such", path("dangling.sfr"));
  fs::create_symlink("/dev/zero", path("device.sfr"));
  touch("other.txt");
  const auto list = list_recordings(folder_.string());
  ASSERT_TRUE(list) << list.error();
  ASSERT_EQ(list->size(), 6u);
  for (const RecordingSummary& one : *list) {
    EXPECT_EQ(one.state, RecordingSummary::State::bad) << one.path;
    EXPECT_EQ(one.problem.find(one.path), 0u) << one.problem;
    EXPECT_EQ(one.problem.back(), '.') << one.problem;
  }
  EXPECT_TRUE(list_recordings(path("none"))->empty());
  EXPECT_FALSE(list_recordings(path("other.txt")));
}

TEST_F(Recordings, OfAnotherFormatSayWhichReleaseIsNeeded) {
  record("a.sfr", 10);
  auto bytes = *wire::read_file(path("a.sfr"), 1 << 30);
  // Another layout hash with a correct checksum.
  const std::size_t size = static_cast<std::size_t>(bytes[0]) | static_cast<std::size_t>(bytes[1])
                                                                    << 8;
  bytes[8 + 7] ^= std::byte{1};
  const auto crc_of = [](std::span<const std::byte> all) {
    std::uint32_t crc = ~0u;
    for (const std::byte b : all) {
      crc ^= static_cast<std::uint32_t>(b);
      for (int i = 0; i < 8; ++i) crc = crc >> 1 ^ (crc & 1 ? 0xEDB88320u : 0u);
    }
    return ~crc;
  };
  const std::uint32_t crc = crc_of(std::span(bytes).subspan(8, size));
  for (std::size_t i = 0; i < 4; ++i) bytes[4 + i] = static_cast<std::byte>(crc >> 8 * i);
  write("a.sfr", bytes);
  const RecordingSummary one = summarise_recording(path("a.sfr"));
  EXPECT_NE(one.problem.find("another release"), std::string::npos) << one.problem;
}

TEST_F(Recordings, TheOldestAreDroppedAndNoneThatAPersonKeeps) {
  for (const char* name :
       {"2026-01-01_000000.sfr", "2026-01-02_000000.sfr", "2026-01-03_000000.sfr",
        "2026-01-03_000000-2.sfr", "2026-01-04_000000.sfr", "2026-01-05_000000.sfr",
        "my best match.sfr", "2026-01-01_000000 kept.sfr", "2025-01-01_000000.txt"})
    touch(name, 1000);
  ASSERT_TRUE(keep_recording(path("2026-01-02_000000.sfr"), true));
  // A running server writes the third.
  const os::FileDescriptor writing(::open(path("2026-01-03_000000.sfr").c_str(), O_WRONLY));
  ASSERT_EQ(::flock(writing.get(), LOCK_EX), 0);
  const auto next = new_recording(folder_.string(), {.count = 3, .bytes_of_one = 0}, 1'700'000'000);
  ASSERT_TRUE(next) << next.error();
  EXPECT_EQ(names(), (std::vector<std::string>{
                         "2025-01-01_000000.txt", "2026-01-01_000000 kept.sfr",
                         "2026-01-02_000000.sfr", "2026-01-02_000000.sfr.keep",
                         "2026-01-03_000000.sfr", "2026-01-05_000000.sfr", "my best match.sfr"}));
  // ... by their size, too; and no longer protected.
  ASSERT_TRUE(keep_recording(path("2026-01-02_000000.sfr"), false));
  ASSERT_TRUE(new_recording(folder_.string(), {.bytes = 3000, .bytes_of_one = 1000}, 1));
  EXPECT_FALSE(fs::exists(path("2026-01-02_000000.sfr")));
  EXPECT_TRUE(fs::exists(path("2026-01-05_000000.sfr")));
}

TEST_F(Recordings, TwoOfOneSecondHaveTwoNames) {
  const auto first = new_recording(folder_.string(), {}, 1'700'000'000);
  ASSERT_TRUE(first);
  std::ofstream{*first};
  const auto second = new_recording(folder_.string(), {}, 1'700'000'000);
  ASSERT_TRUE(second);
  EXPECT_NE(*first, *second);
  EXPECT_EQ(fs::path(*first).stem().string() + "-2.sfr", fs::path(*second).filename());
}

TEST_F(Recordings, AFolderThatCannotBeMadeIsASentence) {
  const auto none = new_recording("/proc/no/such", {}, 1);
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().find("/proc/no/such"), std::string::npos);
}

// An automatic recording never disturbs play.
TEST_F(Recordings, ByDefaultNothingFailsAndWhatNobodyPlayedIsRemoved) {
  const auto run = [&](const std::string& file, std::uint64_t limit, bool computers, int ticks) {
    Lockstep table([&](ServerOptions& o) {
      o.computer = {computers, computers};
      o.record = file;
      o.record_by_default_bytes = limit;
    });
    for (int i = 0; i < ticks; ++i) table.tick();
    table->finish(wire::Sentence::untranslated("done"));
    return table->journal_problem();
  };
  EXPECT_EQ(run("/no/such/folder/a.sfr", 1 << 20, false, 100), "");
  EXPECT_EQ(run(path("idle.sfr"), 1 << 20, false, 2'000), "");
  EXPECT_FALSE(fs::exists(path("idle.sfr"))) << "nobody has played";
  EXPECT_EQ(run(path("played.sfr"), 1 << 20, true, 12'000), "");
  EXPECT_TRUE(fs::exists(path("played.sfr")));
  const std::string full = run(path("full.sfr"), 30'000, true, 12'000);
  EXPECT_NE(full.find("play goes on"), std::string::npos) << full;
  EXPECT_LE(fs::file_size(path("full.sfr")), 30'000u);
  EXPECT_GT(summarise_recording(path("full.sfr")).ticks, 1'000u);
}

}  // namespace
}  // namespace server
