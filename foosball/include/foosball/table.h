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
#include <span>
#include <vector>

#include "vphysics/lie.h"
#include "vphysics/shapes.h"

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

// A box of a man in the man's frame: origin on the rod's axis, axes as the table's at angle 0.
struct ManBox {
  vp::Vec3 centre;        // [m]
  vp::Vec3 half_extents;  // [m]
  enum class Part : std::uint8_t { foot, leg, torso, head } part;
};
inline constexpr int kManParts = 4;

// For the eye: what a renderer makes of a character. No physics follows from it.
enum class Headgear : std::uint8_t { none, antenna, helmet, cap, crown, visor };
inline constexpr int kHeadgears = 6;
enum class Face : std::uint8_t { calm, happy, fierce, sleepy, sly, robot };
inline constexpr int kFaces = 6;
using Colour = std::array<std::uint8_t, 3>;  // sRGB

struct CharacterLook {
  Colour skin{226, 190, 160};
  Colour accent{240, 240, 240};  // beside the team's colour
  Headgear headgear = Headgear::none;
  Face face = Face::calm;
};
struct CharacterVoice {
  double pitch_hz = 220.0;  // of its cries
  double timbre = 0.5;      // 0 a flute .. 1 a reed
};

// A character a team can choose (paper, section 5: tall and thin attacks well, small and fat
// defends well). The man's body is a set of boxes, stacked from sole to crown.
struct CharacterSpec {
  const char* name;
  const char* specialty;  // one line: its strength and its weakness
  double foot_width;      // along the rod [m]
  double foot_depth;      // fore and aft [m]
  double torso_width;     // along the rod [m]
  double torso_depth;     // fore and aft [m]
  double head_height;     // above the rod's axis [m]
  double foot_reach;      // rod axis to sole [m]
  double mass;            // [kg]
  double foot_friction;
  double foot_restitution;
  double bounce = 1.0;       // factor on Tuning::bounce_gain
  double turn_speed = 1.0;   // factor on Tuning::turn_rate: how fast it can kick
  double slide_speed = 1.0;  // factor on Tuning::slide_rate
  CharacterLook look{};
  CharacterVoice voice{};
};
inline constexpr int kCharacters = 6;
const CharacterSpec& character_spec(int character);  // precondition: 0 <= character < kCharacters

std::span<const ManBox> man_boxes(int character);  // kManParts of them
std::array<ManBox, kManParts> boxes_of(const CharacterSpec& character);

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
double field_reach(const TableSpec& table, int character);

// y of a man on its rod at slide 0 [m]; 0 <= man < rod.men.
double man_offset(const RodSpec& rod, int man);

// The man whose place at slide 0 is nearest to y [m].
int man_nearest(const RodSpec& rod, double y);

// The rods of a team, from its goal outwards: index into TableSpec::rods by Line.
std::array<int, 4> rods_of_team(const TableSpec& table, int team);

}  // namespace foosball
