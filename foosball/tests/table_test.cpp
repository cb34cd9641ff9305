// The table's dimensions against those of real tables, and their consistency.
#include "foosball/table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "bodies.h"
#include "foosball/match.h"

namespace foosball {
namespace {

class TableTest : public testing::TestWithParam<Layout> {
 protected:
  const TableSpec& table = table_spec(GetParam());
};

INSTANTIATE_TEST_SUITE_P(Layouts, TableTest, testing::Values(Layout::paper, Layout::tournament),
                         [](const auto& layout) {
                           return std::string(layout.param == Layout::paper ? "paper"
                                                                            : "tournament");
                         });

TEST_P(TableTest, HasTheDimensionsOfARealTable) {
  EXPECT_DOUBLE_EQ(table.length, 1.200);
  EXPECT_DOUBLE_EQ(table.width, 0.680);
  EXPECT_DOUBLE_EQ(table.rod_height, 0.084);
  EXPECT_DOUBLE_EQ(table.ball_radius, 0.0173);
  EXPECT_DOUBLE_EQ(table.ball_mass, 0.0263);
  EXPECT_GE(table.goal_width, 0.200);
  EXPECT_LE(table.goal_width, 0.205);
  EXPECT_GE(table.corner_rise, 0.010);
  EXPECT_LE(table.corner_rise, 0.011);
  for (int i = 0; i < kRods; ++i) EXPECT_NEAR(table.rods[i].x, -0.525 + 0.150 * i, 1e-12);
}

TEST_P(TableTest, IsTheSameFromBothSides) {
  for (int i = 0; i < kRods; ++i) {
    const RodSpec& here = table.rods[i];
    const RodSpec& there = table.rods[kRods - 1 - i];
    EXPECT_NE(here.team, there.team);
    EXPECT_EQ(here.line, there.line);
    EXPECT_EQ(here.men, there.men);
    EXPECT_NEAR(here.x, -there.x, 1e-12);
    EXPECT_DOUBLE_EQ(here.slide_limit, there.slide_limit);
    for (int man = 0; man < here.men; ++man) {
      EXPECT_NEAR(man_offset(here, man), -man_offset(there, here.men - 1 - man), 1e-12);
    }
  }
}

TEST_P(TableTest, EachTeamHasEachLineInOrderFromItsOwnGoal) {
  for (int team = 0; team < kTeams; ++team) {
    const auto rods = rods_of_team(table, team);
    for (int line = 0; line < 4; ++line) {
      EXPECT_EQ(table.rods[rods[line]].team, team);
      EXPECT_EQ(static_cast<int>(table.rods[rods[line]].line), line);
      if (line == 0) continue;
      EXPECT_GT(attack_sign(team) * (table.rods[rods[line]].x - table.rods[rods[line - 1]].x), 0);
    }
  }
}

TEST_P(TableTest, NoManTouchesAWallAtTheEndsOfItsSlideWhateverItsCharacter) {
  for (const RodSpec& rod : table.rods) {
    for (const CharacterBody& body : bodies_of_all_kinds()) {
      for (const ManBox& box : boxes_of(body)) {
        const double outermost = man_offset(rod, rod.men - 1) + rod.slide_limit;
        EXPECT_LT(outermost + box.centre.y + box.half_extents.y, 0.5 * table.width - 0.001);
      }
    }
    EXPECT_GT(rod.slide_limit, 0.07);  // travel for a push, and for a test's 40 mm
  }
}

TEST_P(TableTest, NoTurningManTouchesFieldEndWallOrTheNextRodsMen) {
  for (const CharacterBody& body : bodies_of_all_kinds()) {
    double reach = 0.0;
    for (const ManBox& box : boxes_of(body)) {
      const double z = std::fabs(box.centre.z) + box.half_extents.z;
      reach = std::max(reach, std::hypot(z, box.half_extents.x));
    }
    EXPECT_LT(reach, table.rod_height - 0.009) << "at least 9 mm of air over the field";
    EXPECT_LT(reach, 0.5 * table.length - table.rods[kRods - 1].x);
    EXPECT_LT(2.0 * reach, 0.150);
  }
}

TEST_P(TableTest, FeetReachFourFifthsOfTheWayBetweenTwoRods) {
  for (const CharacterBody& body : bodies_of_all_kinds()) {
    EXPECT_GT(field_reach(table, body), 0.8 * 0.075);  // built-in characters: at least 61.4 mm
  }
}

TEST_P(TableTest, MenReachEveryLineAlongTheFieldBetweenTheRaisedCorners) {
  for (const RodSpec& rod : table.rods) {
    const double reach = rod.slide_limit + 0.010 + table.ball_radius;  // half the narrowest foot
    const double gap = rod.men > 1 ? rod.spacing - 2.0 * reach : 0.0;
    EXPECT_LE(gap, 0.0) << "between neighbours";
    // The raised corner covers the gap between the outermost man and the wall, if any.
    const double left = 0.5 * table.width - (man_offset(rod, rod.men - 1) + reach);
    const double from_end = 0.5 * table.length - std::fabs(rod.x);
    EXPECT_LE(left, std::max(0.0, table.corner_size - from_end));
  }
}

TEST_P(TableTest, TheBallFitsTheGoalAndPassesUnderNoMansFoot) {
  EXPECT_GT(table.goal_height, 2.0 * table.ball_radius);
  EXPECT_GT(table.goal_depth, 4.0 * table.ball_radius) << "wholly in, and room to come out again";
  for (const CharacterBody& body : bodies_of_all_kinds()) {
    const double gap = table.rod_height - body.foot_reach;
    EXPECT_LT(gap, table.ball_radius) << "the foot meets the ball below its centre";
    EXPECT_GT(table.rod_height - body.head_height, 2.0 * table.ball_radius)
        << "a man head down pins no ball";
  }
}

TEST(Table, LayoutsHaveTheMenOfThePaperAndOfATournament) {
  for (const RodSpec& rod : table_spec(Layout::paper).rods) EXPECT_EQ(rod.men, 4);
  constexpr int kMen[] = {1, 2, 5, 3};  // goalie, defence, midfield, attack
  for (const RodSpec& rod : table_spec(Layout::tournament).rods) {
    EXPECT_EQ(rod.men, kMen[static_cast<int>(rod.line)]);
  }
}

TEST(Character, TheTallReachesFurtherAndStrikesHarderTheFatBlocksMore) {
  const CharacterBody& tall = built_in(0);
  const CharacterBody& fat = built_in(2);
  EXPECT_GT(tall.foot_reach, fat.foot_reach);
  EXPECT_GT(tall.restitution, fat.restitution);
  EXPECT_LT(tall.foot_width, fat.foot_width);
  EXPECT_LT(tall.torso_width, fat.torso_width);
}

TEST(ManBoxes, StackWithoutGapFromSoleToCrown) {
  for (const CharacterBody& body : bodies_of_all_kinds()) {
    const auto boxes = boxes_of(body);
    ASSERT_EQ(boxes.size(), 4u);
    double z = -body.foot_reach;
    for (const ManBox& box : boxes) {
      EXPECT_NEAR(box.centre.z - box.half_extents.z, z, 1e-12);
      EXPECT_GT(box.half_extents.x, 0.0);
      EXPECT_GT(box.half_extents.y, 0.0);
      z = box.centre.z + box.half_extents.z;
    }
    EXPECT_NEAR(z, body.head_height, 1e-12);
  }
}

TEST(ManPose, SlidesAlongYAndSwingsTheFeetTowardsMinusXForAPositiveAngle) {
  const TableSpec& table = table_spec(Layout::tournament);
  const vp::SE3 hanging = man_pose(table, 3, 2, {0.040, 0.0, 0.0, 0.0});
  EXPECT_NEAR(hanging.position().y, 0.040, 1e-12);
  EXPECT_NEAR(hanging.position().z, table.rod_height, 1e-12);
  const vp::Vec3 foot{0.0, 0.0, -0.072};
  const vp::Vec3 swung = man_pose(table, 3, 2, {0.0, 0.5 * vp::kPi, 0.0, 0.0}) * foot;
  EXPECT_NEAR(swung.x, table.rods[3].x - 0.072, 1e-12);
  EXPECT_NEAR(swung.z, table.rod_height, 1e-12);
}

}  // namespace
}  // namespace foosball
