// Recording and replay: equal bits, truncated files, differences, and files that cannot be written.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/syscall.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <fstream>

#include "journal_file.h"
#include "lockstep.h"
#include "os/file_descriptor.h"
#include "results/store.h"
#include "server/match_record.h"
#include "wire/read_file.h"

namespace {

std::atomic<int> fdatasyncs{0};
std::atomic<bool> disk_fails{false}, disk_hangs{false};

}  // namespace

// Replaces the C library's function in this program: counts calls, and fails or blocks on demand.
extern "C" int fdatasync(int fd) {
  ++fdatasyncs;
  fdatasyncs.notify_all();
  disk_hangs.wait(true);
  if (!disk_fails) return static_cast<int>(::syscall(SYS_fdatasync, fd));
  errno = EIO;
  return -1;
}

namespace server {
namespace {

using namespace std::chrono_literals;

struct Recorded {
  std::string path;
  std::uint64_t hash = 0, ticks = 0;
  std::array<int, 2> score{};
};

// Two computers, and one person's requests and rods.
Recorded record(int ticks) {
  Recorded out{temp_path("match.sfr")};
  Lockstep table([&](ServerOptions& o) {
    o.computer = {true, true};
    o.match.seed = 42;
    o.match.rules.goals_to_win = 2;
    o.record = out.path;
  });
  ProbeClient player(table.port());
  const auto welcome = player.join(0);
  EXPECT_TRUE(welcome);
  wire::InputDatagram input;
  input.session = welcome->session;
  input.token = welcome->token;
  for (int i = 0; i < ticks; ++i) {
    input.sequence = static_cast<std::uint32_t>(i + 1);
    const auto swing = static_cast<float>(std::sin(0.02 * i));
    for (auto& rod : input.rods) rod = {true, 0.05f * swing, 0.8 * swing, 0.0f, 0.0f};
    if (i % 7 == 0) player.send_input(input);
    if (i % 500 == 250) {
      const auto asked = [&] {
        const ControlCounters c = table->counters().control;
        return c.requests + c.requests_dropped;  // in case ticks run too fast
      };
      const std::uint64_t before = asked();
      player.send(
          wire::MatchRequest{static_cast<std::uint8_t>(foosball::Command::Kind::push), 0, 0});
      EXPECT_TRUE(table.wait_until([&] { return asked() > before; }));
    }
    table.tick();
  }
  table->finish(wire::Sentence::untranslated("done"));
  out.hash = table->match().state_hash();
  out.ticks = table->counters().ticks;
  out.score = table->match().view().score;
  return out;
}

std::vector<std::byte> contents(const std::string& path) {
  return wire::read_file(path, wire::kMaxJournalFile).value();
}

struct Replayed {
  std::uint64_t hash = 0, ticks = 0;
  Playback::Verdict verdict{};
  std::string sentence;
};

Replayed replay(std::vector<std::byte> bytes, std::uint64_t restore_at = 0) {
  auto playback = Playback::from_bytes(std::move(bytes), "match.sfr").value();
  auto match = foosball::Match::create(playback->match()).value();
  while (const wire::JournalTick* tick = playback->next(match)) {
    step_recorded(match, *tick);
    if (playback->ticks() != restore_at) continue;
    std::vector<std::byte> saved;
    match.snapshot(saved);
    match = foosball::Match::create(playback->match()).value();
    EXPECT_TRUE(match.restore(saved));
  }
  return {match.state_hash(), playback->ticks(), playback->verdict(), playback->verdict_sentence()};
}

TEST(Recording, ReplaysToTheSameHash) {
  const Recorded live = record(11'000);  // includes a keyframe
  const Replayed again = replay(contents(live.path));
  EXPECT_EQ(again.verdict, Playback::Verdict::same) << again.sentence;
  EXPECT_EQ(again.hash, live.hash);
  EXPECT_EQ(again.ticks, live.ticks);
  std::remove(live.path.c_str());
}

TEST(Recording, ReplaysToTheSameHashAfterSaveAndRestoreInTheMiddle) {
  const Recorded live = record(3'000);
  for (const std::uint64_t at : {1u, 777u, 2999u}) {
    const Replayed again = replay(contents(live.path), at);
    EXPECT_EQ(again.verdict, Playback::Verdict::same) << again.sentence;
    EXPECT_EQ(again.hash, live.hash);
  }
  std::remove(live.path.c_str());
}

TEST(Recording, ServesAReplayAsIfLive) {
  const Recorded live = record(2'000);
  Lockstep table([&](ServerOptions& o) { o.replay = Playback::open(live.path).value(); });
  ProbeClient watcher(table.port()), player(table.port());
  ASSERT_TRUE(watcher.join());
  player.send(player.hello(0));
  EXPECT_EQ(player.receive_a<wire::Refusal>().value_or(wire::Refusal{}).code,
            wire::Refusal::Code::team_taken);
  table.tick();
  const auto first = watcher.snapshot();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->tick, 1u);
  EXPECT_EQ(first->rods[0].source, 4);
  while (!table->replay_over()) table.tick();
  EXPECT_EQ(table->match().state_hash(), live.hash);
  EXPECT_EQ(table->match().view().score, live.score);
  EXPECT_EQ(table->replay()->verdict(), Playback::Verdict::same);
  std::remove(live.path.c_str());
}

// Truncated anywhere, the rest replays and is reported as truncated.
TEST(Recording, ReplaysWhatATruncatedFileStillHolds) {
  const Recorded live = record(1'500);
  const std::vector<std::byte> whole = contents(live.path);
  std::uint64_t last_ticks = 0;
  for (const std::size_t percent : {30u, 60u, 90u}) {
    const std::size_t size = whole.size() * percent / 100;
    const Replayed part = replay({whole.begin(), whole.begin() + static_cast<long>(size)});
    EXPECT_EQ(part.verdict, Playback::Verdict::cut_short);
    EXPECT_NE(part.sentence.find("stops early"), std::string::npos);
    EXPECT_GT(part.ticks, last_ticks);
    last_ticks = part.ticks;
  }
  EXPECT_LT(last_ticks, live.ticks);
  std::remove(live.path.c_str());
}

// Equal inputs with different hashes: the effect of a build that is not deterministic.
TEST(Recording, SaysWhereAReplayDiffers) {
  const Recorded live = record(2'500);
  const std::vector<std::byte> whole = contents(live.path);
  wire::JournalReader reader(whole);
  wire::JournalEncoder encoder;
  std::vector<std::byte> changed;
  while (auto entry = reader.next()) {
    auto* hash = std::get_if<wire::JournalHash>(&*entry);
    if (hash != nullptr && hash->tick == 2'000) hash->state_hash ^= 1;
    ASSERT_TRUE(encoder.add(*entry, changed));
  }
  const Replayed again = replay(changed);
  EXPECT_EQ(again.verdict, Playback::Verdict::differs);
  EXPECT_NE(again.sentence.find("tick 2000"), std::string::npos);
  std::remove(live.path.c_str());
}

TEST(Recording, RefusesAFileThatIsNoRecording) {
  for (const std::size_t size : {0u, 1u, 100u}) {
    const auto opened = Playback::from_bytes(std::vector<std::byte>(size, std::byte{7}), "x.sfr");
    ASSERT_FALSE(opened);
    EXPECT_NE(opened.error().find("x.sfr is not a recorded match"), std::string::npos);
  }
  EXPECT_FALSE(Playback::open("/nowhere/at/all"));
}

// Bit by bit, by the definition of IEEE 802.3.
std::uint32_t crc32(std::span<const std::byte> bytes) {
  std::uint32_t crc = ~0u;
  for (const std::byte b : bytes) {
    crc ^= std::to_integer<std::uint32_t>(b);
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ ((crc & 1u) != 0 ? 0xEDB88320u : 0u);
  }
  return ~crc;
}

// Another layout hash or version, with a correct checksum.
TEST(Recording, OfAnotherReleaseSaysWhichFormatItNeeds) {
  const Recorded live = record(10);
  const std::vector<std::byte> whole = contents(live.path);
  ASSERT_FALSE(wire::other_journal_format(whole));
  for (const std::size_t at : {13u, 15u}) {  // of the version, of the layout hash
    std::vector<std::byte> other = whole;
    other[at] ^= std::byte{0x55};
    EXPECT_FALSE(wire::other_journal_format(other)) << "damaged, not of another release";
    const std::size_t size =
        std::to_integer<std::size_t>(other[0]) | std::to_integer<std::size_t>(other[1]) << 8;
    const std::uint32_t crc = crc32(std::span(other).subspan(8, size));
    for (std::size_t i = 0; i < 4; ++i) other[4 + i] = static_cast<std::byte>(crc >> 8 * i);
    const auto format = wire::other_journal_format(other);
    ASSERT_TRUE(format);
    const auto opened = Playback::from_bytes(other, "old.sfr");
    ASSERT_FALSE(opened);
    for (const auto& f : {*format, wire::journal_format()}) {
      EXPECT_NE(opened.error().find(wire::to_text(f)), std::string::npos) << opened.error();
    }
    // It still counts as a recording: --overwrite may replace it, and nothing else does.
    std::ofstream(live.path, std::ios::binary)
        .write(reinterpret_cast<const char*>(other.data()),
               static_cast<std::streamsize>(other.size()));
    EXPECT_NE(JournalFile::create({.path = live.path}).error().find("--overwrite"),
              std::string::npos);
  }
  std::remove(live.path.c_str());
}

std::vector<std::byte> journal(const std::vector<wire::JournalEntry>& entries) {
  wire::JournalEncoder encoder;
  std::vector<std::byte> out;
  for (const auto& entry : entries) EXPECT_TRUE(encoder.add(entry, out));
  return out;
}

TEST(Recording, RefusesOneWithoutATickAndNamesIt) {
  const wire::JournalHeader header = to_header({});
  for (const auto& bytes : {journal({header}), journal({header, wire::JournalEnd{0, 1}})}) {
    const auto opened = Playback::from_bytes(bytes, "x.sfr");
    ASSERT_FALSE(opened);
    EXPECT_EQ(opened.error().rfind("x.sfr contains ", 0), 0u) << opened.error();
    EXPECT_NE(opened.error().find("no tick"), std::string::npos) << opened.error();
  }
}

TEST(Recording, RefusesRulesThatCannotBePlayedAndNamesTheFile) {
  wire::JournalHeader header = to_header({});
  header.goals_to_win = 0;
  const auto opened = Playback::from_bytes(journal({header, wire::JournalTick{}}), "x.sfr");
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().rfind("x.sfr cannot be replayed: ", 0), 0u) << opened.error();
}

TEST(Recording, LeftBeforeItsEndIsSaidToBeTheSameSoFar) {
  const Recorded live = record(1'500);
  auto playback = Playback::open(live.path).value();
  auto match = foosball::Match::create(playback->match()).value();
  while (playback->ticks() < 1'200) step_recorded(match, *playback->next(match));
  EXPECT_EQ(playback->verdict(), Playback::Verdict::so_far);
  EXPECT_EQ(playback->hashes_checked(), 1u);
  EXPECT_NE(playback->verdict_sentence().find("stopped before"), std::string::npos);
  std::remove(live.path.c_str());
}

TEST(Recording, BeginsItsReplayWhenTheAwaitedClientHasJoined) {
  const Recorded live = record(20);
  Lockstep table([&](ServerOptions& o) {
    o.replay = Playback::open(live.path).value();
    o.await_client = true;
  });
  table.tick(100);
  EXPECT_EQ(table->ticks(), 0u);
  EXPECT_FALSE(table->replay_over());
  ProbeClient watcher(table.port());
  ASSERT_TRUE(watcher.join());
  while (!table->replay_over()) table.tick();
  EXPECT_EQ(table->ticks(), live.ticks);
  EXPECT_EQ(table->match().state_hash(), live.hash);
  std::remove(live.path.c_str());
}

TEST(Recording, GoesOnPlayingWhenTheDiskIsFull) {
  Lockstep table([](ServerOptions& o) {
    o.computer = {true, true};
    o.record = "/dev/full";
  });
  ProbeClient watcher(table.port());
  ASSERT_TRUE(watcher.join());
  ASSERT_TRUE(table.tick_until([&] { return !table->journal_problem().empty(); }));
  table.tick();
  const auto notice = watcher.receive_a<wire::Notice>();
  ASSERT_TRUE(notice);
  EXPECT_NE(notice->text.find("ended early: No space left"), std::string::npos);
  const std::uint64_t before = table->counters().ticks;
  table.tick(100);
  EXPECT_EQ(table->counters().ticks, before + 100);
  EXPECT_GE(table->counters().journal_dropped, 100u);
}

TEST(Recording, SaysThatAFileCannotBeMade) {
  Lockstep table([](ServerOptions& o) { o.record = "/nowhere/match.sfr"; });
  ASSERT_FALSE(table.started());
  EXPECT_EQ(table.error().kind, StartError::Kind::bad_option);
  EXPECT_NE(table.error().sentence.find("/nowhere/match.sfr"), std::string::npos);
}

// Two computers play until one has won; the file has the match as the server observed it.
TEST(Results, OfAMatchThatWasWonAreInTheFile) {
  const std::string path = temp_path("results.sqlite");
  std::array<int, 2> score{};
  double seconds = 0.0;
  {
    Lockstep table([&](ServerOptions& o) {
      o.computer = {true, true};
      o.match.seed = 7;
      o.match.rules.goals_to_win = 1;
      o.results = path;
      o.date = [] { return std::string("2026-11-22T20:00:00Z"); };
    });
    ASSERT_TRUE(
        table.tick_until([&] { return table->match().view().screen == foosball::Screen::end; }));
    score = table->match().view().score;
    seconds = table->match().view().play_seconds;
    table->finish(wire::Sentence::untranslated("done"));
    EXPECT_EQ(table->results_problem(), "");
    EXPECT_EQ(table->counters().results_kept, 1u);
  }
  const auto store = results::Store::open(path, results::Access::read_only);
  ASSERT_TRUE(store) << store.error();
  const auto matches = store->matches({}).value();
  ASSERT_EQ(matches.size(), 1u);
  EXPECT_EQ(matches[0].finished_at, "2026-11-22T20:00:00Z");
  EXPECT_EQ(matches[0].layout, "tournament");
  EXPECT_EQ(matches[0].seed, 7u);
  EXPECT_DOUBLE_EQ(matches[0].play_seconds, seconds);
  for (std::size_t t = 0; t < 2; ++t) {
    EXPECT_EQ(matches[0].teams[t].goals, static_cast<std::uint32_t>(score[t]));
    EXPECT_EQ(matches[0].teams[t].players[0], (results::Player{"computer 2", "computer"}));
    ASSERT_TRUE(matches[0].teams[t].statistics);
  }
  const auto& statistics = *matches[0].teams[0].statistics;
  EXPECT_GT(statistics.touches + matches[0].teams[1].statistics->touches, 0u);
  EXPECT_LE(statistics.possession_seconds, seconds);
  for (const char* more : {"", "-wal", "-shm"}) std::remove((path + more).c_str());
}

TEST(Results, ThatCannotBeKeptAreToldAndStopNothing) {
  Lockstep table([&](ServerOptions& o) {
    o.results = "/nowhere/results.sqlite";
    o.date = [] { return std::string("2026-11-22T20:00:00Z"); };
  });
  ProbeClient watcher(table.port());
  ASSERT_TRUE(watcher.join());
  ASSERT_TRUE(table.tick_until([&] { return !table->results_problem().empty(); }));
  table.tick(3);
  const auto notice = watcher.receive_a<wire::Notice>();
  ASSERT_TRUE(notice);
  EXPECT_NE(notice->text.find("/nowhere/results.sqlite"), std::string::npos);
  const std::uint64_t before = table->counters().ticks;
  table.tick(100);
  EXPECT_EQ(table->counters().ticks, before + 100);
}

TEST(JournalFile, WaitsForTheDiskAtItsEndAndSaysWhenThatFails) {
  const std::string path = temp_path("synced.sfr");
  for (const bool fails : {false, true}) {
    auto file = JournalFile::create({.path = path, .overwrite = true}).value();
    file->add(wire::JournalHeader{});
    fdatasyncs = 0;
    disk_fails = fails;
    file->close();
    disk_fails = false;
    EXPECT_EQ(fdatasyncs, 1);
    EXPECT_EQ(file->problem().text().find("ended early: Input/output error") != std::string::npos,
              fails)
        << file->problem().text();
  }
  std::remove(path.c_str());
}

TEST(JournalFile, HasTheDiskTakeItAgainAndAgainWhileItIsWritten) {
  const std::string path = temp_path("often.sfr");
  auto file = JournalFile::create({.path = path, .sync_period = 1ms}).value();
  file->add(wire::JournalHeader{});
  fdatasyncs = 0;
  std::uint64_t tick = 0;
  for (int round = 0; round < 5; ++round) {
    const int before = fdatasyncs;
    for (int i = 0; i < wire::kJournalBatch; ++i) file->add(wire::JournalTick{tick++, {}, {}});
    fdatasyncs.wait(before);  // ctest limits the wait
  }
  EXPECT_GE(fdatasyncs, 5) << "and it is not closed yet";
  file->close();
  EXPECT_EQ(file->problem().text(), "");
  std::remove(path.c_str());
}

TEST(JournalFile, LeavesTheDiskAloneBetweenTwoPeriods) {
  const std::string path = temp_path("seldom.sfr");
  auto file = JournalFile::create({.path = path, .sync_period = 1h}).value();
  fdatasyncs = 0;
  file->add(wire::JournalHeader{});
  for (std::uint64_t tick = 0; tick < 1000; ++tick) file->add(wire::JournalTick{tick, {}, {}});
  file->close();
  EXPECT_EQ(fdatasyncs, 1) << "at its end alone";
  std::remove(path.c_str());
}

TEST(JournalFile, IsWrittenByOneServerOnly) {
  const std::string path = temp_path("twice.sfr");
  auto first = JournalFile::create({.path = path}).value();
  for (const bool overwrite : {false, true}) {
    const auto second = JournalFile::create({.path = path, .overwrite = overwrite});
    ASSERT_FALSE(second);
    EXPECT_NE(second.error().find("another server is writing it"), std::string::npos);
  }
  first->add(wire::JournalHeader{});
  first->close();
  EXPECT_EQ(first->problem().text(), "");
  EXPECT_FALSE(contents(path).empty());
  first.reset();
  EXPECT_TRUE(JournalFile::create({.path = path, .overwrite = true})) << "the lock goes with it";
  std::remove(path.c_str());
}

TEST(JournalFile, IsReadableForWhomTheUmaskSays) {
  const std::string path = temp_path("mode.sfr");
  const mode_t before = ::umask(0);
  for (const mode_t mask : {0022u, 0077u, 0002u}) {
    ::umask(mask);
    auto file = JournalFile::create({.path = path}).value();
    struct stat about {};
    EXPECT_EQ(::stat(path.c_str(), &about), 0);
    EXPECT_EQ(about.st_mode & 0777u, 0666u & ~mask);
    file.reset();
    std::remove(path.c_str());
  }
  ::umask(before);
}

TEST(JournalFile, RefusesAPipeThatNobodyReads) {
  const std::string path = temp_path("pipe");
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  const auto file = JournalFile::create({.path = path});
  ASSERT_FALSE(file);
  EXPECT_NE(file.error().find("nobody reads this pipe"), std::string::npos) << file.error();
  std::remove(path.c_str());
}

// The pipe's reader reads nothing: after 64 KiB it is full. The end has a time limit.
TEST(JournalFile, EndsInTimeThoughItsPipeIsFull) {
  ::signal(SIGPIPE, SIG_IGN);  // like the server: its thread may write after the reader has gone
  const std::string path = temp_path("full_pipe");
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  const os::FileDescriptor reader(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  auto file = JournalFile::create({.path = path, .close_patience = 50ms}).value();
  file->add(wire::JournalHeader{});
  file->add(wire::JournalKeyframe{0, std::vector<std::byte>(300'000)});
  const auto before = std::chrono::steady_clock::now();
  file->close();
  EXPECT_LT(std::chrono::steady_clock::now() - before, 5s);
  EXPECT_NE(file->problem().text().find("did not take the rest in time"), std::string::npos);
  std::remove(path.c_str());
}

// A system call that does not return, as for a network file system without its network.
TEST(JournalFile, EndsInTimeThoughTheDiskHangs) {
  const std::string path = temp_path("hangs.sfr");
  auto file = JournalFile::create({.path = path, .close_patience = 20ms}).value();
  file->add(wire::JournalHeader{});
  disk_hangs = true;
  const auto before = std::chrono::steady_clock::now();
  file->close();
  EXPECT_LT(std::chrono::steady_clock::now() - before, 5s);
  EXPECT_NE(file->problem().text().find("did not take the rest in time"), std::string::npos);
  file.reset();
  disk_hangs = false;
  disk_hangs.notify_all();
  std::remove(path.c_str());
}

// A ring too small for a keyframe: the journal ends there, and is readable up to there.
TEST(JournalFile, EndsReadableWhenItsRingOverflows) {
  const std::string path = temp_path("small.sfr");
  auto file = JournalFile::create({.path = path, .ring_bytes = 4096}).value();
  file->add(wire::JournalHeader{});
  for (std::uint64_t tick = 0; tick < 64; ++tick) file->add(wire::JournalTick{tick, {}, {}});
  EXPECT_FALSE(file->failed());
  file->add(wire::JournalKeyframe{64, std::vector<std::byte>(100'000)});
  EXPECT_TRUE(file->failed());
  EXPECT_NE(file->problem().text().find("disk is too slow"), std::string::npos);
  file->add(wire::JournalTick{64, {}, {}});
  EXPECT_EQ(file->entries_dropped(), 2u);
  file->close();

  const std::vector<std::byte> bytes = contents(path);
  wire::JournalReader reader(bytes);
  int ticks = 0;
  while (const auto entry = reader.next())
    ticks += std::holds_alternative<wire::JournalTick>(*entry);
  EXPECT_EQ(ticks, 64);
  EXPECT_EQ(reader.problem(), "");
  std::remove(path.c_str());
}

}  // namespace
}  // namespace server
