#include "foosball/reach.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "../src/table_world.h"
#include "bodies.h"

namespace foosball {
namespace {

const TeamBodies kAverage = built_in(1, 1);

TEST(Reach, NoBallIsWithinReachOfTwoRods) {
  for (int layout = 0; layout < kLayouts; ++layout) {
    const TableSpec& table = table_spec(static_cast<Layout>(layout));
    for (int i = -200; i <= 200; ++i) {
      for (int k = -16; k <= 16; ++k) {
        const double x = 0.003 * i, y = 0.02 * k;
        for (const CharacterBody& body : bodies_of_all_kinds()) {
          const auto rods = rods_in_reach(table, {body, body}, {x, y, 0.0173});
          ASSERT_LE(std::popcount(rods), 1) << x << " " << y;
        }
      }
    }
  }
}

// A renderer uses this to know whose time of possession runs: a snapshot contains only the team.
TEST(Reach, TheRodThatReachesTheBallIsTheNearestOneWithinHalfTheWayToTheNext) {
  for (int layout = 0; layout < kLayouts; ++layout) {
    const TableSpec& table = table_spec(static_cast<Layout>(layout));
    const double half_way = 0.5 * (table.rods[1].x - table.rods[0].x);
    for (int i = -200; i <= 200; ++i) {
      const double x = 0.003 * i;
      for (const CharacterBody& body : bodies_of_all_kinds()) {
        const auto rods = rods_in_reach(table, {body, body}, {x, 0.0, 0.0173});
        if (rods == 0) continue;
        const double off = std::fabs(table.rods[std::countr_zero(rods)].x - x);
        for (const RodSpec& other : table.rods) ASSERT_LE(off, std::fabs(other.x - x) + 1e-12);
        ASSERT_LE(off, half_way) << x;
      }
    }
  }
}

TEST(Reach, TheStripMidwayBetweenTwoRodsIsOutOfReach) {
  const TableSpec& table = table_spec(Layout::tournament);
  EXPECT_EQ(rods_in_reach(table, kAverage, {0.0, 0.0, 0.0173}), 0);
  EXPECT_EQ(rods_in_reach(table, kAverage, {0.075, 0.0, 0.0173}), 1 << 4);
}

TEST(Reach, TheLoneGoalieDoesNotReachTheCorners) {
  const TableSpec& table = table_spec(Layout::tournament);
  EXPECT_EQ(rods_in_reach(table, kAverage, {-0.525, 0.26, 0.0173}), 1);
  EXPECT_EQ(rods_in_reach(table, kAverage, {-0.525, 0.31, 0.0173}), 0);
}

// The formula against simulated men: a foot swung past a fixed ball touches it where the formula
// says within reach, to 2 mm.
TEST(Reach, IsWhereASwungFootMeetsTheBall) {
  const TableSpec& table = table_spec(Layout::tournament);
  constexpr int kRod = 2;
  for (const CharacterBody& body : bodies_of_all_kinds()) {
    double reach = 0.0;
    while (can_reach(table, kRod, body, {table.rods[kRod].x - reach, 0.0, table.ball_radius})) {
      reach += 1e-4;
    }
    for (const double d : {reach - 0.002, reach + 0.002}) {
      TableWorld world(Layout::tournament, {body, body});
      bool met = false;
      for (int tick = 0; tick < 1000; ++tick) {
        world.set_ball({table.rods[kRod].x - d, 0.0, table.ball_radius}, {});
        world.drive(kRod, {.angle = -1.0 + 0.0025 * tick, .live = true});  // feet move towards -x
        world.step();
        for (const vp::ContactEvent& event : world.contacts()) {
          met = met || ball_contact(event).other.what == Tag::What::man;
        }
      }
      EXPECT_EQ(met, d < reach) << body.foot_reach << " at " << d;
    }
  }
}

}  // namespace
}  // namespace foosball
