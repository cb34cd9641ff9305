// The pure function of a rod's motion against the rod of the simulated table.
#include "foosball/rod_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "../src/random.h"
#include "../src/table_world.h"
#include "bodies.h"

namespace foosball {
namespace {

struct Difference {
  double slide = 0.0, angle = 0.0, man = 0.0;
};

// Drives every rod of a table and its prediction with the same hand. Returns the largest
// difference.
template <class Hand>
Difference compare(Layout layout, const CharacterBody& body, int ticks, Hand&& hand) {
  TableWorld world(layout, {body, body});
  const TableSpec& table = world.table();
  std::array<RodState, kRods> predicted{};
  Difference worst;
  for (int tick = 0; tick < ticks; ++tick) {
    for (int rod = 0; rod < kRods; ++rod) {
      const RodSpec& spec = table.rods[rod];
      const RodTarget target = hand(rod, tick, spec);
      world.drive(rod, target);
      predicted[rod] = step_rod(spec, rod_inertia(table, spec, body), predicted[rod], target);
    }
    world.park_ball();  // no contacts
    world.step();
    for (int rod = 0; rod < kRods; ++rod) {
      const RodState simulated = world.rod(rod);
      worst.slide = std::max(worst.slide, std::fabs(simulated.slide - predicted[rod].slide));
      worst.angle = std::max(worst.angle, std::fabs(simulated.angle - predicted[rod].angle));
      for (int man = 0; man < table.rods[rod].men; ++man) {
        const double angle = world.men()[rod][man].angle;
        worst.man = std::max(worst.man, std::fabs(angle - predicted[rod].angle));
      }
    }
  }
  std::printf("layout %d, men of %.3f kg: within %.2g m, %.2g rad, men %.2g rad\n",
              static_cast<int>(layout), body.mass, worst.slide, worst.angle, worst.man);
  return worst;
}

class RodMotionTest : public testing::TestWithParam<Layout> {};
INSTANTIATE_TEST_SUITE_P(Layouts, RodMotionTest,
                         testing::Values(Layout::paper, Layout::tournament));

TEST_P(RodMotionTest, EqualsTheSimulatedRodUnderSmoothAndJumpingHands) {
  for (const CharacterBody& body : bodies_of_all_kinds()) {
    Random random(7);
    std::array<RodTarget, kRods> targets{};
    const Difference worst =
        compare(GetParam(), body, 3000, [&](int rod, int tick, const RodSpec& spec) {
          RodTarget& t = targets[rod];
          if (tick % 400 == 50 * rod) {  // a jump: force and rates reach their limits
            t = {spec.slide_limit * random.between(-1.2, 1.2), random.between(0.0, 9.0), 0.0, 0.0,
                 true};
          } else if (tick % 400 > 200) {  // a stroke
            t.slide_rate = 1.5;
            t.angle_rate = -60.0;
            t.slide += t.slide_rate * kTick;
            t.angle += t.angle_rate * kTick;
          } else {
            t.slide_rate = t.angle_rate = 0.0;
          }
          return t;
        });
    EXPECT_LT(worst.slide, kRodSlideTolerance);
    EXPECT_LT(worst.angle, kRodAngleTolerance);
    EXPECT_LT(worst.man, kRodAngleTolerance) << "a free man moves as his hand does";
  }
}

// A critically damped spring and damper approaches its target from one side: no overshoot for men
// of any mass.
TEST_P(RodMotionTest, TheDrivesAreCriticallyDampedForEveryCharacter) {
  const TableSpec& table = table_spec(GetParam());
  for (const CharacterBody& body : bodies_of_all_kinds()) {
    for (const RodSpec& spec : table.rods) {
      const RodInertia inertia = rod_inertia(table, spec, body);
      const RodState rest{};
      const RodTarget target{0.001, 0.01, 0.0, 0.0, true};
      for (const auto& [drive, mass] :
           {std::pair{slide_drive(spec, inertia, rest, target), inertia.slide},
            std::pair{angle_drive(inertia, rest.angle, target), inertia.turn}}) {
        const double ratio = drive.damping / (2.0 * std::sqrt(drive.stiffness * mass));
        EXPECT_NEAR(ratio, 1.0, 1e-12) << body.mass;
      }
      RodState rod{};
      for (int tick = 0; tick < 100; ++tick) {
        rod = step_rod(spec, inertia, rod, target);
        ASSERT_LE(rod.slide, target.slide + 1e-9);
        ASSERT_LE(rod.angle, target.angle + 1e-9);
      }
      EXPECT_NEAR(rod.angle, target.angle, 1e-6);
    }
  }
}

TEST_P(RodMotionTest, ARodStopsAtItsStop) {
  const TableSpec& table = table_spec(GetParam());
  const RodSpec& spec = table.rods[3];
  RodState rod{};
  for (int tick = 0; tick < 500; ++tick)
    rod = step_rod(spec, rod_inertia(table, spec, built_in(1)), rod, {9.0, 0.0, 5.0, 0.0, true});
  EXPECT_NEAR(rod.slide, spec.slide_limit, 1e-9);
  EXPECT_NEAR(rod.slide_rate, 0.0, 1e-6);
}

}  // namespace
}  // namespace foosball
