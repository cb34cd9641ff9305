// Recording and replay: the same bits, what is cut short, what differs, what cannot be written.
#include <gtest/gtest.h>
#include <sys/syscall.h>

#include <atomic>
#include <cstdio>
#include <fstream>

#include "journal_file.h"
#include "lockstep.h"
#include "wire/read_file.h"

namespace {

std::atomic<int> fdatasyncs{0};
std::atomic<bool> disk_fails{false};

}  // namespace

// In place of the C library's, in this program: counted, and failing on demand.
extern "C" int fdatasync(int fd) {
  ++fdatasyncs;
  if (!disk_fails) return static_cast<int>(::syscall(SYS_fdatasync, fd));
  errno = EIO;
  return -1;
}

namespace server {
namespace {

struct Recorded {
  std::string path;
  std::uint64_t hash = 0, ticks = 0;
  std::array<int, 2> score{};
};

// Two computers and one person's wishes and rods.
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
      const auto c = table->counters().control;
      player.say(wire::Wish{static_cast<std::uint8_t>(foosball::Command::Kind::push), 0, 0});
      EXPECT_TRUE(table.tick_until([&] { return table->counters().control.wishes > c.wishes; }));
    }
    table.tick();
  }
  table->finish("done");
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
  const Recorded live = record(11'000);  // a keyframe among them
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
  player.say(player.hello(0));
  EXPECT_EQ(player.hear_a<wire::Refusal>().value_or(wire::Refusal{}).code,
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

// However it is cut, what is before the cut replays and is said to be cut.
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

// The same inputs, but other hashes: what a build that is not deterministic would see.
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
    EXPECT_NE(opened.error().find("x.sfr is no recorded match"), std::string::npos);
  }
  EXPECT_FALSE(Playback::open("/nowhere/at/all"));
}

std::vector<std::byte> journal(const std::vector<wire::JournalEntry>& entries) {
  wire::JournalEncoder encoder;
  std::vector<std::byte> out;
  for (const auto& entry : entries) EXPECT_TRUE(encoder.add(entry, out));
  return out;
}

TEST(Recording, RefusesOneWithoutATickAndNamesIt) {
  const wire::JournalHeader header;
  for (const auto& bytes : {journal({header}), journal({header, wire::JournalEnd{0, 1}})}) {
    const auto opened = Playback::from_bytes(bytes, "x.sfr");
    ASSERT_FALSE(opened);
    EXPECT_EQ(opened.error().rfind("x.sfr holds ", 0), 0u) << opened.error();
    EXPECT_NE(opened.error().find("no tick"), std::string::npos) << opened.error();
  }
}

TEST(Recording, RefusesRulesThatCannotBePlayedAndNamesTheFile) {
  wire::JournalHeader header;
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
  EXPECT_NE(playback->verdict_sentence().find("left before"), std::string::npos);
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
  const auto notice = watcher.hear_a<wire::Notice>();
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
    EXPECT_EQ(file->problem().find("ended early: Input/output error") != std::string::npos, fails)
        << file->problem();
  }
  std::remove(path.c_str());
}

// A ring too small for a keyframe: the journal ends there, readable to there.
TEST(JournalFile, EndsReadableWhenItsRingOverflows) {
  const std::string path = temp_path("small.sfr");
  auto file = JournalFile::create({.path = path, .ring_bytes = 4096}).value();
  file->add(wire::JournalHeader{});
  for (std::uint64_t tick = 0; tick < 64; ++tick) file->add(wire::JournalTick{tick, {}, {}});
  EXPECT_FALSE(file->failed());
  file->add(wire::JournalKeyframe{64, std::vector<std::byte>(100'000)});
  EXPECT_TRUE(file->failed());
  EXPECT_NE(file->problem().find("disk is too slow"), std::string::npos);
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
