// The game is exactly symmetric: rotated by half a turn about z, with exchanged teams, a match
// continues exactly rotated.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>

#include "../src/random.h"
#include "../src/table_world.h"
#include "bodies.h"
#include "foosball/computer_player.h"
#include "foosball/match.h"

namespace foosball {
namespace {

vp::Vec3 turned(const vp::Vec3& v) {
  return {-v.x, -v.y, v.z};
}

bool same(const vp::Vec3& a, const vp::Vec3& b) {
  return a.x == b.x && a.y == b.y && a.z == b.z;
}

RodTarget turned(const RodTarget& t) {
  return {-t.slide, -t.angle, -t.slide_rate, -t.angle_rate, t.live};
}

constexpr int across(int rod) {
  return kRods - 1 - rod;
}

// Rods that move, pinch and kick at random, unlike a player's.
class Hands {
 public:
  explicit Hands(std::uint64_t seed) : random_(seed) {}
  const RodTargets& next(const TableSpec& table) {
    for (int rod = 0; rod < kRods; ++rod) {
      RodTarget& target = targets_[rod];
      if (random_.unit() < 0.01) {
        const double limit = 1.1 * table.rods[rod].slide_limit;
        target.slide = random_.between(-limit, limit);
        target.live = random_.unit() < 0.9;
      }
      if (random_.unit() < 0.01) target.angle = random_.between(-1.3, 1.3);
      if (random_.unit() < 0.001) target.angle_rate = random_.between(-100.0, 100.0);
      if (random_.unit() < 0.02) target.angle_rate = 0.0;
      target.angle += target.angle_rate * kTick;
    }
    return targets_;
  }

 private:
  Random random_;
  RodTargets targets_{};
};

class Symmetry : public testing::TestWithParam<Layout> {};
INSTANTIATE_TEST_SUITE_P(Layouts, Symmetry, testing::Values(Layout::paper, Layout::tournament));

// Two minutes in each layout. Every three seconds the ball gets a random position. Rods that move
// at random kick it, and often pinch it between two rows.
TEST_P(Symmetry, AWorldOfTheOtherTeamFirstMovesTurnedToTheBit) {
  TableWorld world(GetParam(), built_in(0, 2), 0), other(GetParam(), built_in(2, 0), 1);
  Hands hands(7);
  Random places(8);
  long hits = 0, two_at_once = 0, left_behind = 0;
  for (int tick = 0; tick < 120'000; ++tick) {
    if (tick % 3000 == 0) {
      const vp::Vec3 place{places.between(-0.55, 0.55), places.between(-0.3, 0.3), 0.05};
      const vp::Vec3 velocity{places.between(-9.0, 9.0), places.between(-9.0, 9.0), 0.0};
      world.set_ball(place, velocity);
      other.set_ball(turned(place), turned(velocity));
    }
    const RodTargets& targets = hands.next(world.table());
    for (int rod = 0; rod < kRods; ++rod) {
      world.drive(rod, targets[rod]);
      other.drive(across(rod), turned(targets[rod]));
    }
    ASSERT_TRUE(world.step());
    ASSERT_TRUE(other.step());
    hits += static_cast<long>(world.contacts().size());
    two_at_once += world.contacts().size() > 2 ? 1 : 0;
    const BallState a = world.ball(), b = other.ball();
    ASSERT_TRUE(same(a.pose.position(), turned(b.pose.position()))) << "tick " << tick;
    ASSERT_TRUE(same(a.velocity, turned(b.velocity))) << "tick " << tick;
    ASSERT_TRUE(same(a.spin, turned(b.spin))) << "tick " << tick;
    for (int rod = 0; rod < kRods; ++rod) {
      const RodState p = world.rod(rod), q = other.rod(across(rod));
      ASSERT_TRUE(p.slide == -q.slide && p.angle == -q.angle && p.slide_rate == -q.slide_rate &&
                  p.angle_rate == -q.angle_rate)
          << "tick " << tick << " rod " << rod;
      const int men = world.table().rods[rod].men;
      for (int man = 0; man < men; ++man) {
        const ManState& m = world.men()[rod][man];
        const ManState& n = other.men()[across(rod)][men - 1 - man];
        ASSERT_TRUE(m.angle == -n.angle && m.angle_rate == -n.angle_rate)
            << "tick " << tick << " rod " << rod << " man " << man;
        left_behind += std::fabs(m.angle - p.angle) > 0.1 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(hits, 1'500);
  EXPECT_GT(two_at_once, 20);
  EXPECT_EQ(left_behind > 100, hinged_men(GetParam())) << left_behind;
}

// Between two rows the order of the solver matters: with both worlds built from team 0, 4 of these
// 400 pinches end with different bits.
TEST(SymmetryOfPinches, ABallSqueezedBetweenTheMidfieldsMovesTurnedToTheBit) {
  long hits = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    Random random(seed);
    TableWorld world(Layout::tournament, built_in(0, 2), 0),
        other(Layout::tournament, built_in(2, 0), 1);
    const vp::Vec3 place{random.between(-0.01, 0.01), random.between(-0.01, 0.01),
                         random.between(0.018, 0.1)};
    const vp::Vec3 velocity{random.between(-3.0, 3.0), random.between(-1.0, 1.0), 0.0};
    world.set_ball(place, velocity);
    other.set_ball(turned(place), turned(velocity));
    const double near = random.between(0.6, 1.6), far = random.between(0.6, 1.6);
    for (int tick = 0; tick < 400; ++tick) {
      const double closer = tick > 100 ? 1.0 + 0.1 * ((tick % 53) / 53.0) : 1.0;
      const double slide = tick > 100 ? 0.004 * (tick % 37) / 37.0 : 0.0;
      for (int rod = 0; rod < kRods; ++rod) {
        RodTarget target{0.0, 0.0, 0.0, 0.0, true};
        if (rod == 3) target = {slide, -near * closer, 0.0, 0.0, true};
        if (rod == 4) target.angle = far * closer;
        world.drive(rod, target);
        other.drive(across(rod), turned(target));
      }
      ASSERT_TRUE(world.step());
      ASSERT_TRUE(other.step());
      hits += static_cast<long>(world.contacts().size());
      ASSERT_TRUE(same(world.ball().velocity, turned(other.ball().velocity)))
          << "seed " << seed << " tick " << tick;
    }
  }
  EXPECT_GT(hits, 2'000);
}

// A single match without end: the next would draw lots again.
constexpr Rules kLong{.goals_to_win = 90, .max_goals = 99};

// Two computer players at a table. The players' seeds belong to the home team.
struct Game {
  Game(Layout layout, std::uint64_t lot, int home_team, std::uint64_t players, const char* player)
      : match(*Match::create({.layout = layout, .seed = lot, .rules = kLong})),
        home({.team = home_team, .seed = players, .player = *parse_player(player)}),
        away({.team = 1 - home_team, .seed = players + 1, .player = *parse_player(player)}) {}
  void step() {
    home.play(match.view(), input.rods);
    away.play(match.view(), input.rods);
    match.step(input);
  }
  Match match;
  ComputerPlayer home, away;
  TickInput input;
};

// The team that serves first with this seed.
int first_server(std::uint64_t seed) {
  Match match = *Match::create({.seed = seed, .rules = {}});
  const Command pushes[] = {
      {Command::Kind::push, 0}, {Command::Kind::push, 0}, {Command::Kind::push, 1}};
  match.step({.rods = {}, .commands = pushes});
  for (int tick = 0; tick < 5000; ++tick) {
    match.step({});
    for (const Event& event : match.events()) {
      if (event.kind == EventKind::serve) return event.team;
    }
  }
  ADD_FAILURE() << "no serve";
  return 0;
}

// Complete matches: screens, serves, goals and everything that the computer players see and do.
TEST_P(Symmetry, TheMirroredMatchIsTheSameMatch) {
  std::uint64_t lots[kTeams] = {1, 1};
  for (int team = 0; team < kTeams; ++team) {
    while (first_server(lots[team]) != team) ++lots[team];
  }
  int goals = 0;
  for (std::uint64_t players = 1; players <= 3; ++players) {
    const char* player = players == 1 ? "3" : players == 2 ? "5" : "classic:0.9";
    Game one(GetParam(), lots[0], 0, 7 * players, player);
    Game other(GetParam(), lots[1], 1, 7 * players, player);
    for (int tick = 0; tick < 60'000; ++tick) {
      one.step();
      other.step();
      const MatchView &a = one.match.view(), &b = other.match.view();
      ASSERT_EQ(a.screen, b.screen) << "tick " << tick;
      ASSERT_EQ(a.score[0], b.score[1]) << "tick " << tick;
      ASSERT_EQ(a.score[1], b.score[0]) << "tick " << tick;
      ASSERT_EQ(a.ball_in_play, b.ball_in_play) << "tick " << tick;
      ASSERT_TRUE(same(a.ball_position, turned(b.ball_position))) << "tick " << tick;
      ASSERT_TRUE(same(a.ball_velocity, turned(b.ball_velocity))) << "tick " << tick;
      for (int rod = 0; rod < kRods; ++rod) {
        const RodState &p = a.rods[rod], &q = b.rods[across(rod)];
        ASSERT_TRUE(p.slide == -q.slide && p.angle == -q.angle) << "tick " << tick;
      }
      for (const Event& event : one.match.events()) goals += event.kind == EventKind::goal ? 1 : 0;
    }
  }
  EXPECT_GE(goals, 3);
}

}  // namespace
}  // namespace foosball
