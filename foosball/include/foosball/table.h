// The table in true dimensions: one description from which the physics, the rules and the renderer
// all take their figures.
//
// Frame: origin at the centre of the field's surface; x from goal to goal (team 0 defends -x and
// attacks +x), y along the rods, z up. A rod's slide is along +y. Its angle is a right-handed turn
// about +y; at 0 the men hang straight down; a positive angle swings the feet towards -x.
// Source: shared notes on real tables (Leonhart 1200 x 680 mm, Tornado ball), paper section 5.1.
#pragma once

#include <array>
#include <cstdint>

#include "foosball/character.h"
#include "vphysics/lie.h"

namespace foosball {

inline constexpr int kRods = 8;
inline constexpr int kTeams = 2;
inline constexpr int kMaxMenOnRod = 5;
inline constexpr double kTick = 0.001;  // [s]; every process counts in these

enum class Layout : std::uint8_t {
  paper,       // 4 men in each of the 8 rows, each hinged at his shoulder
  tournament,  // 1-2-5-3, fixed to rods
};
inline constexpr int kLayouts = 2;

// Paper, section 5.1: its men hang from hinges of their own, and there is no pipe that joins them.
constexpr bool hinged_men(Layout layout) {
  return layout == Layout::paper;
}

// Of the men of team 0 and 1.
using TeamBodies = std::array<CharacterBody, kTeams>;

// The way a team attacks along x, and the way its players push a rod along y: the players of team 0
// stand on the -y side with their own goal to the left, those of team 1 opposite.
constexpr double attack_sign(int team) {
  return team == 0 ? 1.0 : -1.0;
}
constexpr double push_sign(int team) {
  return team == 0 ? 1.0 : -1.0;
}

// What a rod is for, from a team's own goal outwards.
enum class Line : std::uint8_t { goalie, defence, midfield, attack };

struct RodSpec {
  int team;
  Line line;
  double x;            // of the axis [m]
  int men;             // <= kMaxMenOnRod
  double spacing;      // between neighbours [m]
  double slide_limit;  // |slide| <= this [m]
};

struct TableSpec {
  Layout layout;
  double length;                    // along x, between the goal lines [m]
  double width;                     // along y, between the side walls [m]
  double wall_height;               // [m]
  double rod_height;                // axis above the field [m]
  double goal_width;                // [m]
  double goal_height;               // [m]
  double goal_depth;                // [m]
  double corner_rise;               // height of the raised corners [m]
  double corner_size;               // their legs along x and y [m]
  double ball_radius;               // [m]
  double ball_mass;                 // [kg]
  double rod_mass;                  // without men [kg]
  double rod_radius;                // [m]
  std::array<RodSpec, kRods> rods;  // from -x to +x
};
const TableSpec& table_spec(Layout layout);

// How far fore and aft of its rod's axis a man can touch a ball that lies on the field: the most
// over all angles, from the axis to the ball's centre [m]. What lies further from every rod is out
// of everybody's reach.
double field_reach(const TableSpec& table, const CharacterBody& body);

// y of a man on its rod at slide 0 [m]; 0 <= man < rod.men.
inline double man_offset(const RodSpec& rod, int man) {
  return (man - 0.5 * (rod.men - 1)) * rod.spacing;
}

// The man whose place at slide 0 is nearest to y [m].
int man_nearest(const RodSpec& rod, double y);

// The rods of a team, from its goal outwards: index into TableSpec::rods by Line.
std::array<int, 4> rods_of_team(const TableSpec& table, int team);

}  // namespace foosball
