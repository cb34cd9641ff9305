// Once warm, a tick does not allocate: an allocation may wait for a lock or for the kernel.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "counting_new.h"
#include "journal_file.h"
#include "lockstep.h"
#include "phone_probe.h"
#include "seats.h"
#include "wire/enums.h"

namespace server {
namespace {

class WarmTick : public testing::Test {
 protected:
  void TearDown() override { ::unlink(path.c_str()); }

  // Number of allocations in this many ticks.
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

// Covers the second of the journal's keyframes, eleven of its hashes, and all events of the match.
TEST_F(WarmTick, TakesNoMemoryWithTwoComputersARecordingAndAListener) {
  ProbeClient watcher(table.port());
  ASSERT_TRUE(watcher.join());
  // From the logo to the character selection, and on to play.
  int asked = 0;
  for (const auto screen : {foosball::Screen::selection, foosball::Screen::play}) {
    ASSERT_TRUE(table.tick_until([&] {
      if (table->match().view().screen == screen) return true;
      if (asked++ % 200 != 0) return false;  // no faster than a person
      for (std::uint8_t team = 0; team < foosball::kTeams; ++team) {
        watcher.send(
            wire::MatchRequest{static_cast<std::uint8_t>(foosball::Command::Kind::push), team, 0});
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
  EXPECT_GT(os::testing::allocations(), 0);  // the counter works
}

TEST_F(WarmTick, TakesNoMemoryWhenAClientTakesATeamAndGivesItBack) {
  table.tick(100);
  for (int round = 0; round < 3; ++round) {
    ProbeClient player(table.port());
    ASSERT_TRUE(player.join(0));  // welcomed: the next tick knows it
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

TEST_F(WarmTick, TakesNoMemoryWhileAHostLooksAtTheDevices) {
  table.tick(100);
  ProbeClient host(table.port());
  ASSERT_TRUE(host.join());
  long during = 0;
  for (int asked = 0; asked < 3; ++asked) {
    ASSERT_TRUE(host.send(wire::DeviceQuery{}));
    bool reported = false;
    ASSERT_TRUE(table.tick_until([&] {
      during += taken(1);
      reported = host.receive_a<wire::Devices>(1).has_value();
      return reported;
    }));
  }
  EXPECT_EQ(during, 0);
}

// A phone that swings its rods, and receives three pulses.
TEST(WarmPhones, TakeNoMemoryInATickWithInputsOrPulses) {
  Lockstep table([](ServerOptions& o) {
    o.phones.open = true;
    o.computer[1] = true;
    o.match.rules.goals_to_win = 99;
    o.match.rules.max_goals = 99;
  });
  PhoneProbe phone(table->phones());
  ASSERT_TRUE(phone.join());
  ASSERT_TRUE(phone.claim(0, wire::RodPair::attack));
  ProbeClient host(table.port());
  ASSERT_TRUE(host.join());
  for (const auto screen : {foosball::Screen::selection, foosball::Screen::play}) {
    for (std::uint8_t team = 0; team < foosball::kTeams; ++team)
      host.send(wire::MatchRequest{number(wire::RequestKind::push), team, 0});
    ASSERT_TRUE(table.tick_until([&] { return table->match().view().screen == screen; }));
  }
  wire::PhoneInput input;
  const auto swing = [&] {
    ++input.sequence;
    const double t = 1e-6 * static_cast<double>(table.now_us());
    for (wire::PhoneRod& rod : input.rods)
      rod = {true, static_cast<float>(0.08 * std::sin(3.0 * t)), 1.2 * std::sin(25.0 * t), 0, 0};
    ASSERT_TRUE(phone.send(input));
  };
  for (int i = 0; i < 6'000; ++i) swing(), table.tick();  // once warm
  long taken = 0;
  const std::uint64_t before = table->counters().haptic_pulses;
  const std::uint64_t inputs = table->counters().phones.inputs;
  const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (table->counters().haptic_pulses < before + 3 ||
         table->counters().phones.inputs < inputs + 200) {
    ASSERT_LT(std::chrono::steady_clock::now(), patience);
    swing();
    const long now = os::testing::allocations();
    table.tick();
    taken += os::testing::allocations() - now;
  }
  EXPECT_EQ(taken, 0);
}

// The best players simulate worlds of their own (foosball/src/computer_forecast.h).
class BestPlayersTick : public testing::Test {
 protected:
  BestPlayersTick()
      : table([](ServerOptions& o) {
          o.computer = {true, true};
          o.computer_fills = true;
          o.computer_player = *foosball::parse_player("5");
          o.limits.seat_kept_us = 30'000'000;
          o.match.rules.goals_to_win = 99;
          o.match.rules.max_goals = 99;
        }),
        host(table.port()) {}
  void SetUp() override {
    ASSERT_TRUE(host.join());
    for (const auto screen : {foosball::Screen::selection, foosball::Screen::play}) {
      for (std::uint8_t team = 0; team < foosball::kTeams; ++team) {
        host.send(wire::MatchRequest{number(wire::RequestKind::push), team, 0});
      }
      ASSERT_TRUE(table.tick_until([&] { return table->match().view().screen == screen; }));
    }
    table.tick(6'000);  // once warm
  }
  long taken() {
    const long before = os::testing::allocations();
    table.tick();
    return os::testing::allocations() - before;
  }
  struct Taken {
    int ticks = 0;  // that allocated
    long sum = 0, max = 0;
  };
  Taken taken_in(int ticks) {
    Taken all;
    for (int i = 0; i < ticks; ++i) {
      const long now = taken();
      all.ticks += now > 0 ? 1 : 0;
      all.sum += now;
      all.max = std::max(all.max, now);
    }
    return all;
  }

  Lockstep table;
  ProbeClient host;
};

TEST_F(BestPlayersTick, TakesNoMemoryWhileTheComputerStandsInForAPlayer) {
  const RodSet all0 = rods_of_team(foosball::MatchDesc{}.layout, 0);
  ProbeClient ann(table.port()), bob(table.port());
  ASSERT_TRUE(ann.join(0, RodSet(all0 & -all0)));
  const auto seat = bob.join(1);
  ASSERT_TRUE(seat);
  wire::InputDatagram input{.session = seat->session, .token = seat->token};
  for (wire::InputRod& rod : input.rods) rod = {true, 0.0f, 0.0, 0.0f, 0.0f};
  const auto play = [&](int seconds) {  // Bob's hand sends all the time
    Taken all;
    for (int i = 0; i < seconds; ++i) {
      ++input.sequence;
      bob.send_input(input);
      const Taken now = taken_in(1'000);
      all.ticks += now.ticks;
      all.sum += now.sum;
    }
    return all;
  };
  EXPECT_EQ(play(2).sum, 0) << "the computer fills her team";
  ann.leave();
  ASSERT_TRUE(table.wait_until([&] { return table->counters().control.lost == 1; }));
  const Taken stood_in = play(5);
  EXPECT_NE(table.log().find("the computer plays rods"), std::string::npos);
  EXPECT_LE(stood_in.ticks, 1) << "that tells all who plays";
  EXPECT_LT(stood_in.sum, 40);
}

// The only change during play that allocates. docs/decisions/0050 gives its duration.
TEST_F(BestPlayersTick, TakesMemoryForNewWorldsWhenTheTuningChangesAPartATick) {
  EXPECT_EQ(taken_in(1'000).sum, 0);
  const double gravity = table->match().view().tuning.gravity + 0.5;
  host.send(wire::MatchRequest{number(wire::RequestKind::tune), 0,
                               static_cast<std::uint8_t>(foosball::tuning_index("gravity")),
                               gravity});
  long at_once = 0;
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  while (table->match().view().tuning.gravity != gravity) {
    ASSERT_LT(std::chrono::steady_clock::now(), until);
    at_once = taken();
  }
  const Taken making = taken_in(25);
  std::printf("the match's world: %ld allocations; the players', %ld in %d ticks, %ld at most\n",
              at_once, making.sum, making.ticks, making.max);
  EXPECT_LT(at_once, 1'500);
  EXPECT_LT(making.max, 400);
  taken_in(500);  // the match's new world reaches its sizes
  EXPECT_EQ(taken_in(2'000).sum, 0);
}

// A match with more contacts has a larger keyframe than all before it.
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
