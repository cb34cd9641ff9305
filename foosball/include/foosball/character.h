// The characters that teams choose from (paper, section 5: tall and thin attacks well, small and
// fat defends well). Each is plain data: its physics (CharacterBody), its appearance
// (CharacterLook) and its sound (CharacterVoice). A match has a list of them, which it records and
// hashes (MatchDesc::characters).
//
// People edit the files characters/data/*.toml; docs/characters.md explains them.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "vphysics/lie.h"

namespace foosball {

// Of a list, which has at least one. The selection screen shows six at a time. The wire format has
// 4 bits for an index.
inline constexpr int kMaxCharacters = 12;
inline constexpr std::size_t kMaxCharacterName = 32;        // bytes of UTF-8, at least 1
inline constexpr std::size_t kMaxCharacterSpecialty = 100;  // bytes of UTF-8

// Parameters of the physics. For speeds, forces and torques the lower of this limit and the
// tuning's (foosball/tuning.h) applies. The defaults here are the largest allowed values, so that
// the tuning's limits apply. A man is a stack of boxes from sole to crown (boxes_of).
struct CharacterBody {
  double foot_width = 0.024;
  double foot_depth = 0.020;
  double foot_reach = 0.0730;
  double torso_width = 0.032;
  double torso_depth = 0.022;
  double head_height = 0.040;
  double mass = 0.070;
  double friction = 0.60;
  double restitution = 0.72;
  double bounce = 1.0;
  double slide_speed = 12.0;
  double slide_force = 2000.0;
  double turn_speed = 160.0;
  double turn_torque = 100.0;

  bool operator==(const CharacterBody&) const = default;
};

// Appearance only: it does not affect the physics.
enum class Headgear : std::uint8_t { helmet, antenna, cap, horns, hood, bubble };
inline constexpr int kHeadgears = 6;
inline constexpr std::array kHeadgearNames{"helmet", "antenna", "cap", "horns", "hood", "bubble"};
enum class Face : std::uint8_t { visor, eyes, goggles, beard };
inline constexpr int kFaces = 4;
inline constexpr std::array kFaceNames{"visor", "eyes", "goggles", "beard"};
using Colour = std::array<std::uint8_t, 3>;  // sRGB

struct CharacterLook {
  Colour skin{206, 170, 140};
  Colour accent{230, 230, 235};  // second colour beside the team's: gloves, boots, headgear
  Headgear headgear = Headgear::helmet;
  Face face = Face::visor;

  bool operator==(const CharacterLook&) const = default;
};

// Sound.
struct CharacterVoice {
  double pitch = 240.0;
  double timbre = 0.4;

  bool operator==(const CharacterVoice&) const = default;
};

struct Character {
  std::string name;
  std::string specialty;  // one line: its strength and its weakness
  CharacterBody body;
  CharacterLook look;
  CharacterVoice voice;

  bool operator==(const Character&) const = default;
};
using Characters = std::vector<Character>;

// --- numbers and their ranges --------------------------------------------------------------------

// A number of T in a character file, with its range.
template <class T>
struct CharacterField {
  const char* name;
  const char* unit;  // empty: dimensionless
  double T::*value;
  double min, max;
  const char* meaning;  // what it is, and what fails beyond its range
};

inline constexpr std::array kBodyFields = std::to_array<CharacterField<CharacterBody>>({
    {"foot_width", "m", &CharacterBody::foot_width, 0.020, 0.044,
     "Along the rod. Narrower, balls pass between two men at the ends of their slides; wider, it "
     "meets the wall."},
    {"foot_depth", "m", &CharacterBody::foot_depth, 0.012, 0.030,
     "Fore and aft; the leg is as deep."},
    {"foot_reach", "m", &CharacterBody::foot_reach, 0.0722, 0.0745,
     "From the rod's axis to the sole; less, and balls lie out of everybody's reach between two "
     "rods. With foot_depth it is bounded once more: no corner of the foot is further than 0.0749 "
     "m "
     "from the axis."},
    {"torso_width", "m", &CharacterBody::torso_width, 0.016, 0.044, "Along the rod."},
    {"torso_depth", "m", &CharacterBody::torso_depth, 0.014, 0.034, "Fore and aft."},
    {"head_height", "m", &CharacterBody::head_height, 0.028, 0.048,
     "From the rod's axis to the crown; more, and a man head down pins the ball."},
    {"mass", "kg", &CharacterBody::mass, 0.030, 0.300,
     "Of one man; a heavy foot strikes hard and is slow to start."},
    {"friction", "", &CharacterBody::friction, 0.0, 2.0,
     "Of the man on the ball; more gives the ball more spin."},
    {"restitution", "", &CharacterBody::restitution, 0.20, 0.90,
     "How much of its speed a ball keeps that meets the man; little traps, much shoots."},
    {"bounce", "", &CharacterBody::bounce, 0.0, 2.5,
     "Factor on how high the ball hops off the man."},
    {"slide_speed", "m/s", &CharacterBody::slide_speed, 0.4, 12.0,
     "No hand slides this team's rods faster."},
    {"slide_force", "N", &CharacterBody::slide_force, 20.0, 2000.0,
     "No hand pushes along this team's rods with more."},
    {"turn_speed", "rad/s", &CharacterBody::turn_speed, 20.0, 160.0,
     "No hand turns this team's rods faster: how fast a foot can strike."},
    {"turn_torque", "N m", &CharacterBody::turn_torque, 1.0, 100.0,
     "No hand turns this team's rods with more."},
});
inline constexpr int kBodyNumbers = static_cast<int>(kBodyFields.size());

inline constexpr std::array kVoiceFields = std::to_array<CharacterField<CharacterVoice>>({
    {"pitch", "Hz", &CharacterVoice::pitch, 60.0, 800.0, "Of its cries; its kicks sound as high."},
    {"timbre", "", &CharacterVoice::timbre, 0.0, 1.0, "0 a flute, 1 a reed."},
});
inline constexpr int kVoiceNumbers = static_cast<int>(kVoiceFields.size());

// False out of the field's range and for NaN.
template <class T>
constexpr bool in_range(const CharacterField<T>& field, double value) {
  return field.min <= value && value <= field.max;
}

// Largest distance of a foot's corner from the rod's axis. The end wall and the men of the next rod
// limit it.
inline constexpr double kFootCorner = 0.0749;  // [m]
constexpr bool foot_clears(const CharacterBody& body) {
  const double half = 0.5 * body.foot_depth;
  return body.foot_reach * body.foot_reach + half * half <= kFootCorner * kFootCorner;
}

// Every number is in its range, the name is not empty, and no text is too long.
bool in_range(const Character& character);
// 1 to kMaxCharacters characters, each in range.
bool in_range(const Characters& characters);

// The character of this index, clamped to the list: for renderers of received data. Precondition:
// not empty.
inline const Character& nearest(const Characters& characters, int number) {
  const int last = static_cast<int>(characters.size()) - 1;
  return characters[static_cast<std::size_t>(std::clamp(number, 0, last))];
}

// FNV-1a over every field. Equal digests mean equal lists.
std::uint64_t digest(const Characters& characters);

// The characters that come with the game, in the order of their files (characters/data).
const Characters& built_in_characters();

// --- the man's boxes -----------------------------------------------------------------------------

// A box of a man in the man's frame: origin on the rod's axis, axes parallel to the table's at
// angle 0.
struct ManBox {
  vp::Vec3 centre;        // [m]
  vp::Vec3 half_extents;  // [m]
  enum class Part : std::uint8_t { foot, leg, torso, head } part;
};
inline constexpr int kManParts = 4;
std::array<ManBox, kManParts> boxes_of(const CharacterBody& body);

}  // namespace foosball
