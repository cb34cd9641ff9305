// The server's part in the match's modes: the players, and the hand that ends a demonstration
// match.
#include <gtest/gtest.h>

#include "lockstep.h"
#include "wire/enums.h"

namespace server {
namespace {

wire::InputDatagram hand(const wire::Welcome& welcome, std::uint32_t sequence, float slide) {
  wire::InputDatagram input;
  input.session = welcome.session;
  input.token = welcome.token;
  input.sequence = sequence;
  for (auto& rod : input.rods) rod = {true, slide, 0.0, 0.0f, 0.0f};
  return input;
}

TEST(Attract, ComputersPlayWhileNobodyDoesUntilAHandMovesARod) {
  Lockstep table([](ServerOptions& o) { o.match.rules.attract_seconds = 1.0; });
  ProbeClient player(table.port());
  const auto welcome = player.join(0);
  ASSERT_TRUE(welcome);
  ASSERT_TRUE(table.tick_until([&] { return table->clients() == 1; }));
  std::uint32_t sequence = 0;
  player.send_input(hand(*welcome, ++sequence, 0.01f));
  // The client's rods move to its hand's position, and stay there.
  for (int i = 0; i < 6000 && !table->match().view().attract; ++i) table.tick();
  ASSERT_TRUE(table->match().view().attract);
  double moved = 0.0;
  for (int i = 0; i < 4000; ++i) {
    table.tick();
    for (const auto& rod : table->match().view().rods)
      moved = std::max(moved, std::fabs(rod.slide));
  }
  EXPECT_TRUE(table->match().view().attract);
  EXPECT_GT(moved, 0.02) << "both teams are played, also the one that a client has";
  player.send_input(hand(*welcome, ++sequence, 0.06f));
  EXPECT_TRUE(table.tick_until([&] { return !table->match().view().attract; }, 5000));
  EXPECT_EQ(table->match().view().screen, foosball::Screen::logo);
}

TEST(Seats, TheMatchKnowsWhichTeamAComputerPlays) {
  Lockstep table([](ServerOptions& o) { o.computer = {false, true}; });
  table.tick(3);
  EXPECT_EQ(table->match().view().computer, (std::array<bool, 2>{false, true}));
  ProbeClient player(table.port());
  ASSERT_TRUE(player.join(1));
  EXPECT_TRUE(table.tick_until([&] { return !table->match().view().computer[1]; }));
}

TEST(Absence, AMatchAgainstTheComputerReturnsToTheLogo) {
  Lockstep table([](ServerOptions& o) {
    o.computer = {false, true};
    o.match.rules.idle_seconds = 2.0;
  });
  ProbeClient player(table.port());
  ASSERT_TRUE(player.join(0));
  for (const auto& request : {wire::MatchRequest{0, 0, 0}, wire::MatchRequest{0, 0, 0}}) {
    const auto before = table->counters().control.requests;
    player.send(request);
    ASSERT_TRUE(table.wait_until([&] { return table->counters().control.requests > before; }));
    table.tick(10);
  }
  ASSERT_EQ(table->match().view().screen, foosball::Screen::selection);
  table.tick(2100);
  EXPECT_EQ(table->match().view().screen, foosball::Screen::logo);
}

}  // namespace
}  // namespace server
