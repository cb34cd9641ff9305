// Men of the paper's layout. Each has a hinge at his shoulder and follows the hand with a bounded
// torque. A blocked man does not block the others, penetrates nothing, and returns to the hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "../src/table_world.h"
#include "bodies.h"
#include "foosball/computer_player.h"
#include "foosball/match.h"
#include "shots.h"

namespace foosball {
namespace {

constexpr int kGoalie = 0;       // row of team 0, in front of the end wall at -x
constexpr int kHeldMan = 0;      // beside the goal
constexpr double kDeep = 0.002;  // maximum penetration of the ball [m]

const TableSpec& table() {
  return table_spec(Layout::paper);
}

// Penetration of the ball into the nearest man, the field or a wall.
double deepest(const TableWorld& world, int character) {
  const vp::Vec3 ball = world.ball().pose.position();
  const double r = table().ball_radius;
  double depth = std::max({r - ball.z, std::fabs(ball.y) + r - 0.5 * table().width,
                           std::fabs(ball.y) > 0.5 * table().goal_width
                               ? std::fabs(ball.x) + r - 0.5 * table().length
                               : -1.0});
  for (int rod = 0; rod < kRods; ++rod) {
    for (int man = 0; man < table().rods[rod].men; ++man) {
      const RodState state = with_man(world.rod(rod), world.men()[rod][man]);
      const vp::Vec3 p = vp::inverse_times(man_pose(table(), rod, man, state), ball);
      for (const ManBox& box : boxes_of(built_in(character))) {
        depth = std::max(depth, r - ShotGallery::distance(p - box.centre, box.half_extents));
      }
    }
  }
  return depth;
}

struct Seen {
  double deepest = 0.0;       // [m]
  double fastest_man = 0.0;   // [rad/s]
  double fastest_ball = 0.0;  // [m/s]
  double apart = 0.0;         // largest angle between a man and his hand [rad]
  double others = 0.0;        // the same for the men who are not blocked [rad]
};

// One tick, and the properties that must hold in each.
void step(TableWorld& world, int character, int rod, Seen& seen) {
  ASSERT_TRUE(world.step()) << "a number left its range";
  seen.deepest = std::max(seen.deepest, deepest(world, character));
  seen.fastest_ball = std::max(seen.fastest_ball, vp::norm(world.ball().velocity));
  ASSERT_FALSE(std::isnan(seen.fastest_ball));
  for (int man = 0; man < table().rods[rod].men; ++man) {
    const ManState& m = world.men()[rod][man];
    const double apart = std::fabs(m.angle - world.rod(rod).angle);
    seen.fastest_man = std::max(seen.fastest_man, std::fabs(m.angle_rate));
    seen.apart = std::max(seen.apart, apart);
    const double beside = world.ball().pose.position().y - man_offset(table().rods[rod], kHeldMan);
    if (man != kHeldMan && std::fabs(beside) < 0.06) seen.others = std::max(seen.others, apart);
  }
}

class HingedMen : public testing::TestWithParam<int> {
 protected:
  int character = GetParam();
  TableWorld world{Layout::paper, built_in(character, character)};
  HandLimits limits = hand_limits(built_in(character));

  // Between the end wall and the foot of the man beside the goal, on the field.
  void put_ball_behind_the_goalie() {
    const RodSpec& spec = table().rods[kGoalie];
    world.set_ball({-0.5 * table().length + table().ball_radius + 0.0005,
                    man_offset(spec, kHeldMan), table().ball_radius},
                   {});
  }
};
INSTANTIATE_TEST_SUITE_P(Characters, HingedMen, testing::Range(0, built_in_count()));

// Feet towards the wall behind them, with the ball in the way of one.
TEST_P(HingedMen, OneWhoIsHeldByTheBallAtTheWallHoldsUpNobodyElse) {
  put_ball_behind_the_goalie();
  Seen seen;
  double held = 0.0;
  for (int tick = 0; tick < 1000; ++tick) {
    world.drive(kGoalie, {0.0, 1.0, 0.0, 0.0, true});
    step(world, character, kGoalie, seen);
    // Later the wide foot of a man rolls the ball out to the side.
    if (tick == 45) held = world.men()[kGoalie][kHeldMan].angle;
  }
  std::printf("%s: held at %.2f of 1.00 rad, the others within %.1g; ball in anything %.3f mm\n",
              built_in_characters()[static_cast<std::size_t>(character)].name.c_str(), held,
              seen.others, 1e3 * seen.deepest);
  EXPECT_LT(held, 0.9);
  EXPECT_GT(held, 0.2);
  EXPECT_LT(seen.others, 1e-9);
  EXPECT_NEAR(world.rod(kGoalie).angle, 1.0, 1e-4) << "nor the hand";
  EXPECT_LT(seen.deepest, kDeep);
}

// The hand spins on for three turns at rates up to the maximum. Then it stops, and the ball is
// removed.
TEST_P(HingedMen, OneWhoIsHeldWhileTheHandSpinsThreeTurnsSlipsAndComesBack) {
  for (const double rate : {20.0, 60.0, 120.0}) {
    for (const double way : {1.0, -1.0}) {
      world.set_rod(kGoalie, {});
      put_ball_behind_the_goalie();
      Seen seen;
      double angle = 0.0;
      const double turns = 6.0 * vp::kPi;
      while (angle < turns) {
        angle += rate * kTick;
        world.drive(kGoalie, {0.0, way * std::min(angle, turns), 0.0, way * rate, true});
        step(world, character, kGoalie, seen);
      }
      EXPECT_LT(seen.deepest, kDeep) << rate;
      EXPECT_LT(seen.others, 1e-9) << rate;
      EXPECT_LE(seen.apart, vp::kPi + 1e-9);
      EXPECT_LT(seen.fastest_man, 1.1 * limits.angle_rate) << rate;
      EXPECT_LT(seen.fastest_ball, 25.0) << rate;
      for (int tick = 0; tick < 150; ++tick) {
        world.park_ball();
        world.drive(kGoalie, {0.0, way * turns, 0.0, 0.0, true});
        ASSERT_TRUE(world.step());
      }
      for (int man = 0; man < table().rods[kGoalie].men; ++man) {
        EXPECT_NEAR(world.men()[kGoalie][man].angle, way * turns, 1e-3) << rate << " man " << man;
      }
    }
  }
}

// A man far from his hand, as after a release: the drive would need five times the available
// torque.
TEST_P(HingedMen, TheTorqueOfAManIsBounded) {
  const RodInertia inertia = rod_inertia(table(), table().rods[kGoalie], built_in(character));
  world.set_man(kGoalie, kHeldMan, {-2.5, 0.0});
  const double max = inertia.limits.torque / inertia.turn * kTick;  // per tick [rad/s]
  double greatest = 0.0;
  for (int tick = 0; tick < 100; ++tick) {
    const double before = world.men()[kGoalie][kHeldMan].angle_rate;
    world.drive(kGoalie, {0.0, 0.0, 0.0, 0.0, true});
    ASSERT_TRUE(world.step());
    const double after = world.men()[kGoalie][kHeldMan].angle_rate;
    greatest = std::max(greatest, std::fabs(after - before));
  }
  EXPECT_NEAR(greatest, max, 1e-6 * max);
  EXPECT_NEAR(world.men()[kGoalie][kHeldMan].angle, 0.0, 1e-3) << "and he has come back";
}

// The foot on top of a ball on the field, pressed down by the hand at up to the maximum rate.
TEST_P(HingedMen, AFootOnTheBallPressesItNeitherThroughTheFieldNorThroughItself) {
  const int rod = rods_of_team(table(), 0)[static_cast<int>(Line::midfield)];
  const RodSpec& spec = table().rods[rod];
  for (const double rate : {0.0, 120.0}) {
    world.set_rod(rod, {0.0, -1.0, 0.0, 0.0});
    world.set_ball({spec.x + 0.046, man_offset(spec, kHeldMan), table().ball_radius}, {});
    Seen seen;
    for (int tick = 0; tick < 500; ++tick) {
      world.drive(rod, {0.0, -1.0 + std::min(1.5, rate == 0.0 ? 1.5 : rate * tick * kTick), 0.0,
                        rate, true});
      step(world, character, rod, seen);
    }
    EXPECT_LT(seen.deepest, kDeep) << rate;
    EXPECT_LT(seen.fastest_ball, 25.0) << rate;
  }
}

// Both midfields squeeze one ball between their feet, and vibrate.
TEST_P(HingedMen, TwoOpponentsJammedThroughTheBallStayApartAndSane) {
  const int home = 3, away = 4;
  ASSERT_NE(table().rods[home].team, table().rods[away].team);
  const vp::Vec3 between{0.0, man_offset(table().rods[home], kHeldMan), 0.055};
  Seen seen;
  long squeezed = 0;
  for (int tick = 0; tick < 2000; ++tick) {
    if (tick % 250 == 0) {
      world.set_rod(home, {0.0, -0.6, 0.0, 0.0});
      world.set_rod(away, {0.0, 0.6, 0.0, 0.0});
      world.set_ball(between, {});
    }
    const double tremble = 0.2 * std::fabs(std::remainder(0.013 * tick, 1.0));
    world.drive(home, {0.0, -1.3 - tremble, 0.0, 0.0, true});
    world.drive(away, {0.0, 1.3 + tremble, 0.0, 0.0, true});
    step(world, character, home, seen);
    const bool held = world.men()[home][kHeldMan].angle - world.rod(home).angle > 0.05 &&
                      world.rod(away).angle - world.men()[away][kHeldMan].angle > 0.05;
    squeezed += held ? 1 : 0;
  }
  std::printf("%s: squeezed in %ld of 2000 ticks, ball in anything %.3f mm, at most %.1f m/s\n",
              built_in_characters()[static_cast<std::size_t>(character)].name.c_str(), squeezed,
              1e3 * seen.deepest, seen.fastest_ball);
  EXPECT_GT(squeezed, 20);
  EXPECT_LT(seen.deepest, kDeep);
  EXPECT_LT(seen.others, 1e-9);
  EXPECT_LT(seen.fastest_ball, 25.0);
}

// A row that spins at the maximum rate, with balls rolled and dropped into it.
TEST_P(HingedMen, ASpinningRowKeepsItsMenTogetherAndTheBallOutOfThem) {
  const int rod = 5;
  const RodSpec& spec = table().rods[rod];
  Random random(11);
  Seen seen;
  double angle = 0.0;
  for (int tick = 0; tick < 6000; ++tick) {
    if (tick % 200 == 0) {
      vp::Vec3 place;
      do {
        place = {spec.x + random.between(-0.1, 0.1), random.between(-0.25, 0.25),
                 random.between(0.02, 0.1)};
      } while (!world.free_for_ball(place));
      world.set_ball(place, {random.between(-4.0, 4.0), random.between(-1.0, 1.0), 0.0});
    }
    angle += 120.0 * kTick;
    world.drive(rod, {0.0, angle, 0.0, 120.0, true});
    step(world, character, rod, seen);
  }
  std::printf("%s: apart at most %.2f rad, men at most %.0f rad/s\n",
              built_in_characters()[static_cast<std::size_t>(character)].name.c_str(), seen.apart,
              seen.fastest_man);
  EXPECT_LT(seen.deepest, kDeep);
  EXPECT_GT(seen.apart, 0.01) << "nobody was ever hit";
  EXPECT_LT(seen.fastest_man, 1.1 * limits.angle_rate);
}

// A ball can block only one man of a row.
TEST(HingedMenOfARow, AreTooFarApartForOneBall) {
  for (const CharacterBody& c : bodies_of_all_kinds()) {
    const double widest = std::max(c.foot_width, c.torso_width);
    for (const RodSpec& rod : table().rods) {
      EXPECT_GT(rod.spacing - widest, 2.0 * table().ball_radius) << widest;
    }
  }
}

// With a blocked man and a pressed ball: the restored world continues bit for bit.
TEST(HingedMenSaved, GoOnFromWhereTheyWereHeld) {
  TableWorld world(Layout::paper, built_in(1, 1)), other(Layout::paper, built_in(1, 1));
  const RodSpec& spec = table().rods[kGoalie];
  world.set_ball({-0.5 * table().length + table().ball_radius + 0.0005, man_offset(spec, 0),
                  table().ball_radius},
                 {});
  const auto run = [](TableWorld& w, int from, int to) {
    for (int tick = from; tick < to; ++tick) {
      for (int rod = 0; rod < kRods; ++rod) w.drive(rod, {0.0, 0.02 * tick, 0.0, 20.0, true});
      ASSERT_TRUE(w.step());
    }
  };
  run(world, 0, 70);
  ASSERT_GT(std::fabs(world.men()[kGoalie][0].angle - world.rod(kGoalie).angle), 0.1);
  std::vector<std::byte> bytes;
  world.snapshot(bytes);
  run(world, 70, 700);
  ASSERT_TRUE(other.restore(bytes));
  run(other, 70, 700);
  EXPECT_EQ(world.state_hash(), other.state_hash());
}

// A change of the tuning rebuilds the world: no man jumps.
TEST(HingedMenInAMatch, KeepTheirOwnAnglesWhenTheMatchIsTuned) {
  Match match = *Match::create(
      {.layout = Layout::paper, .seed = 3, .rules = {.goals_to_win = 90, .max_goals = 99}});
  ComputerPlayer home({.team = 0, .seed = 5}), away({.team = 1, .seed = 6});
  TickInput input;
  int tuned = 0;
  double gravity = 14.0;
  for (int tick = 0; tick < 60'000 && tuned < 5; ++tick) {
    home.play(match.view(), input.rods);
    away.play(match.view(), input.rods);
    double apart = 0.0;
    for (int rod = 0; rod < kRods; ++rod) {
      for (int man = 0; man < table().rods[rod].men; ++man) {
        apart = std::max(
            apart, std::fabs(match.view().men[rod][man].angle - match.view().rods[rod].angle));
      }
    }
    const MatchView before = match.view();
    gravity = gravity == 14.0 ? 15.0 : 14.0;
    const Command tune{Command::Kind::tune, 0, static_cast<std::uint8_t>(tuning_index("gravity")),
                       gravity};
    const bool now = apart > 0.2;
    if (now) input.commands = {&tune, 1};
    match.step(input);
    input.commands = {};
    if (!now) continue;
    ++tuned;
    ASSERT_EQ(match.view().tuning.gravity, gravity);
    for (int rod = 0; rod < kRods; ++rod) {
      for (int man = 0; man < table().rods[rod].men; ++man) {
        EXPECT_NEAR(match.view().men[rod][man].angle, before.men[rod][man].angle,
                    kTick * 2.0 * 160.0);
      }
    }
  }
  EXPECT_EQ(tuned, 5);
}

}  // namespace
}  // namespace foosball
