// Once warm, a tick takes no memory: an allocation may wait for a lock or for the kernel.
#include <gtest/gtest.h>

#include "counting_new.h"
#include "journal_file.h"
#include "lockstep.h"

namespace server {
namespace {

class WarmTick : public testing::Test {
 protected:
  void TearDown() override { ::unlink(path.c_str()); }

  // What so many ticks take from the heap.
  long taken(int ticks) {
    const long before = os::testing::allocations();
    table.tick(ticks);
    return os::testing::allocations() - before;
  }
  std::string path = temp_path("journal");
  Lockstep table{[this](ServerOptions& o) {
    o.computer = {true, true};
    o.record = path;
  }};
};

// Through the second of the journal's keyframes, eleven of its hashes, and whatever the match
// brings.
TEST_F(WarmTick, TakesNoMemoryWithTwoComputersARecordingAndAListener) {
  ProbeClient watcher(table.port());
  ASSERT_TRUE(watcher.join());
  // From the logo to the characters, and on to play.
  int asked = 0;
  for (const auto screen : {foosball::Screen::selection, foosball::Screen::play}) {
    ASSERT_TRUE(table.tick_until([&] {
      if (table->match().view().screen == screen) return true;
      if (asked++ % 200 != 0) return false;  // no faster than a person
      for (std::uint8_t team = 0; team < foosball::kTeams; ++team) {
        watcher.say(wire::Wish{static_cast<std::uint8_t>(foosball::Command::Kind::push), team, 0});
      }
      return false;
    }));
  }
  table.tick(11'000);  // the first keyframe is at 10,000
  const std::uint64_t written = table->counters().journal_bytes;
  const std::uint64_t sent = table->counters().snapshots_sent;
  EXPECT_EQ(taken(11'000), 0);
  EXPECT_EQ(table->counters().snapshots_sent, sent + 11'000);
  EXPECT_TRUE(table.tick_until([&] { return table->counters().journal_bytes > written; }));
  EXPECT_EQ(table->journal_problem(), "");
  EXPECT_NE(table->match().view().screen, foosball::Screen::logo);
  EXPECT_GT(os::testing::allocations(), 0);  // the counter counts
}

TEST_F(WarmTick, TakesNoMemoryWhenAClientTakesATeamAndGivesItBack) {
  table.tick(100);
  for (int round = 0; round < 3; ++round) {
    ProbeClient player(table.port());
    ASSERT_TRUE(player.join(0));  // welcomed: the next tick has it
    EXPECT_EQ(taken(1), 0);
    EXPECT_EQ(table->clients(), 1);
    player.leave();
    long during = 0;
    EXPECT_TRUE(table.tick_until([&] {
      during += taken(1);
      return table->clients() == 0;
    }));
    EXPECT_EQ(during, 0);
  }
}

// A match with more contacts has a larger keyframe than any before it.
TEST(WarmJournal, TakesNoMemoryForTheLargestEntries) {
  const std::string path = temp_path("journal");
  auto file = JournalFile::create({.path = path});
  ASSERT_TRUE(file) << file.error();
  (*file)->add(wire::JournalHeader{});
  wire::JournalTick tick;
  tick.commands.resize(wire::kMaxJournalCommands);
  std::uint64_t ticks = 0;
  for (const std::size_t bytes : {std::size_t{1000}, std::size_t{5000}, wire::kMaxKeyframe / 4}) {
    const wire::JournalEntry keyframe =
        wire::JournalKeyframe{ticks + wire::kJournalBatch, std::vector<std::byte>(bytes)};
    long taken = 0;
    for (int i = 0; i < wire::kJournalBatch; ++i) {
      tick.tick = ticks++;
      for (wire::JournalRod& rod : tick.rods) rod.slide_100nm = i % 2 == 0 ? 1'000'000 : 0;
      const wire::JournalEntry entry = tick;
      const long before = os::testing::allocations();
      (*file)->add(entry);
      taken += os::testing::allocations() - before;
    }
    const long before = os::testing::allocations();
    (*file)->add(keyframe);
    taken += os::testing::allocations() - before;
    EXPECT_EQ(taken, 0) << bytes;
  }
  (*file)->close();
  EXPECT_EQ((*file)->entries_dropped(), 0u);
  EXPECT_EQ((*file)->problem().text(), "");
  ::unlink(path.c_str());
}

}  // namespace
}  // namespace server
