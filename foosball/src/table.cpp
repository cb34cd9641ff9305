// The dimensions of the table and their sources.
#include "foosball/table.h"

#include <algorithm>
#include <cmath>

namespace foosball {
namespace {

// Rods 150 mm apart; 11 mm of clearance under the foot of the average man (notes on a German
// table).
constexpr double kRodPitch = 0.150;
constexpr double kRodHeight = 0.084;
constexpr double kLength = 1.200;
constexpr double kWidth = 0.680;

// Half the width of the widest man and 2 mm of clearance. The slide limits are those of the widest
// character, so that the choice of a character does not change a rod's travel or a cabinet's
// calibration.
constexpr double kWallClearance = 0.022 + 0.002;

// Without a stop, a single goalie would reach every corner. A ball beyond his reach lies on the
// raised corner and rolls back to him.
constexpr double kLoneGoalieLimit = 0.270;

constexpr RodSpec rod_spec(int index, int team, Line line, int men, double spacing) {
  const double outermost = 0.5 * (men - 1) * spacing;
  const double to_wall = 0.5 * kWidth - outermost - kWallClearance;
  const double limit = men == 1 ? kLoneGoalieLimit : to_wall;
  return {team, line, (index - 3.5) * kRodPitch, men, spacing, limit};
}

struct LinePlan {
  int men;
  double spacing;
};
using TeamPlan = std::array<LinePlan, 4>;  // by Line

// 1-2-5-3 with the spacings of real rods. Four men 155 mm apart can just reach every y between the
// walls.
constexpr TeamPlan kTournament{{{1, 0.0}, {2, 0.239}, {5, 0.120}, {3, 0.190}}};
constexpr TeamPlan kPaper{{{4, 0.155}, {4, 0.155}, {4, 0.155}, {4, 0.155}}};

// From -x to +x, as on every real table: the midfields face each other, and each attack faces a
// defence.
struct Post {
  int team;
  Line line;
};
constexpr std::array<Post, kRods> kPosts{{{0, Line::goalie},
                                          {0, Line::defence},
                                          {1, Line::attack},
                                          {0, Line::midfield},
                                          {1, Line::midfield},
                                          {0, Line::attack},
                                          {1, Line::defence},
                                          {1, Line::goalie}}};

constexpr TableSpec describe(Layout layout) {
  TableSpec table{};
  table.layout = layout;
  table.length = kLength;
  table.width = kWidth;
  table.wall_height = 0.150;  // rods pass through at 84 mm; hopping balls stay inside
  table.rod_height = kRodHeight;
  table.goal_width = 0.205;
  table.goal_height = 0.080;
  table.goal_depth = 0.120;
  table.corner_rise = 0.0105;
  table.corner_size = 0.140;
  table.ball_radius = 0.0173;  // Tornado ball: 34.6 mm, 26.3 g
  table.ball_mass = 0.0263;
  table.rod_mass = 1.10;
  table.rod_radius = 0.008;
  const TeamPlan& plan = layout == Layout::paper ? kPaper : kTournament;
  for (int i = 0; i < kRods; ++i) {
    const Post& post = kPosts[i];
    const LinePlan& line = plan[static_cast<int>(post.line)];
    table.rods[i] = rod_spec(i, post.team, post.line, line.men, line.spacing);
  }
  return table;
}

constexpr std::array<TableSpec, kLayouts> kTables{describe(Layout::paper),
                                                  describe(Layout::tournament)};

}  // namespace

// The lower front edge of the foot leads the swing. The reach is limited by the ball's surface at
// the height of this edge.
double field_reach(const TableSpec& table, const CharacterBody& c) {
  const double r = table.ball_radius, half_depth = 0.5 * c.foot_depth;
  double reach = 0.0;
  for (int i = 0; i <= 1000; ++i) {
    const double sine = 0.001 * i, cosine = std::sqrt(1.0 - sine * sine);
    const double edge = table.rod_height - c.foot_reach * cosine + half_depth * sine;  // height
    if (edge >= 2.0 * r) continue;
    const double above = std::max(0.0, edge - r);  // of the edge above the ball's centre
    reach = std::max(reach, c.foot_reach * sine + half_depth * cosine +
                                std::sqrt(std::max(0.0, r * r - above * above)));
  }
  return reach;
}

const TableSpec& table_spec(Layout layout) {
  return kTables.at(static_cast<int>(layout));
}

int man_nearest(const RodSpec& rod, double y) {
  if (rod.men == 1) return 0;
  const double man = y / rod.spacing + 0.5 * (rod.men - 1);
  return static_cast<int>(std::lround(std::clamp(man, 0.0, rod.men - 1.0)));
}

std::array<int, 4> rods_of_team(const TableSpec& table, int team) {
  std::array<int, 4> rods{};
  for (int i = 0; i < kRods; ++i) {
    if (table.rods[i].team == team) rods[static_cast<int>(table.rods[i].line)] = i;
  }
  return rods;
}

}  // namespace foosball
