// The table in its true dimensions: one description for the physics, the rules and the renderer.
//
// Frame: origin at the centre of the field's surface; x from goal to goal (team 0 defends -x and
// attacks +x), y along the rods, z up. A rod's slide is along +y. Its angle is right-handed about
// +y. At angle 0 the men hang straight down; a positive angle swings the feet towards -x. Source:
// shared notes on real tables (Leonhart 1200 x 680 mm, Tornado ball), paper section 5.1.
#pragma once

#include <array>
#include <cstdint>

#include "foosball/character.h"
#include "vphysics/lie.h"

namespace foosball {

inline constexpr int kRods = 8;
inline constexpr int kTeams = 2;
inline constexpr int kMaxMenOnRod = 5;
inline constexpr double kTick = 0.001;  // [s]; the time step of every process

enum class Layout : std::uint8_t {
  paper,       // 4 men in each of the 8 rows, each hinged at his shoulder
  tournament,  // 1-2-5-3, fixed to rods
};
inline constexpr int kLayouts = 2;

// Paper, section 5.1: each man hangs from his own hinge; no rod connects them.
constexpr bool hinged_men(Layout layout) {
  return layout == Layout::paper;
}

// Bodies of the men of teams 0 and 1.
using TeamBodies = std::array<CharacterBody, kTeams>;

// Sign of x of a team's attack, and sign of y of a push of a rod by its players. The players of
// team 0 stand on the -y side with their own goal to the left; those of team 1 stand opposite.
constexpr double attack_sign(int team) {
  return team == 0 ? 1.0 : -1.0;
}
constexpr double push_sign(int team) {
  return team == 0 ? 1.0 : -1.0;
}

// The role of a rod, in order from a team's own goal.
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

// Reach of a man on the field, fore and aft: the maximum distance over all angles from the rod's
// axis to the centre of a ball that he can touch [m]. No man can touch a ball that is further from
// every rod.
double field_reach(const TableSpec& table, const CharacterBody& body);

// y of a man on his rod at slide 0 [m]. Precondition: 0 <= man < rod.men.
inline double man_offset(const RodSpec& rod, int man) {
  return (man - 0.5 * (rod.men - 1)) * rod.spacing;
}

// The man whose y at slide 0 is nearest to y [m].
int man_nearest(const RodSpec& rod, double y);

// The rods of a team, in order from its goal: index into TableSpec::rods by Line.
std::array<int, 4> rods_of_team(const TableSpec& table, int team);

}  // namespace foosball
