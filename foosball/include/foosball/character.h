// The characters that teams choose from (paper, section 5: tall and thin attacks well, small and
// fat defends well). Each is plain data: what the physics takes of it (CharacterBody), what is seen
// of it (CharacterLook) and heard of it (CharacterVoice). A match is made with a list of them,
// which it records and hashes (MatchDesc::characters).
//
// The files that people edit are characters/data/*.toml; docs/characters.md explains them.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "vphysics/lie.h"

namespace foosball {

// Of a list, at least one. The selection screen shows six at a time; the wire has 4 bits for one.
inline constexpr int kMaxCharacters = 12;
inline constexpr std::size_t kMaxCharacterName = 32;        // bytes of UTF-8, at least 1
inline constexpr std::size_t kMaxCharacterSpecialty = 100;  // bytes of UTF-8

// What the physics takes. Of speeds, forces and torques the lower counts, this one or the tuning's
// (foosball/tuning.h); here they are as high as they may be, so that the tuning's count. The man is
// a stack of boxes from sole to crown (boxes_of).
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

// For the eye. No physics follows from it.
enum class Headgear : std::uint8_t { helmet, antenna, cap, horns, hood, bubble };
inline constexpr int kHeadgears = 6;
inline constexpr std::array kHeadgearNames{"helmet", "antenna", "cap", "horns", "hood", "bubble"};
enum class Face : std::uint8_t { visor, eyes, goggles, beard };
inline constexpr int kFaces = 4;
inline constexpr std::array kFaceNames{"visor", "eyes", "goggles", "beard"};
using Colour = std::array<std::uint8_t, 3>;  // sRGB

struct CharacterLook {
  Colour skin{206, 170, 140};
  Colour accent{230, 230, 235};  // beside the team's colour: gloves, boots, headgear
  Headgear headgear = Headgear::helmet;
  Face face = Face::visor;

  bool operator==(const CharacterLook&) const = default;
};

// For the ear.
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

// --- numbers with their ranges -------------------------------------------------------------------

// A number of T as people write it in a file, with what it may be.
template <class T>
struct CharacterField {
  const char* name;
  const char* unit;  // empty for a plain number
  double T::*value;
  double least, most;
  const char* meaning;  // what it is, and what breaks beyond its range
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

// Within the field's range; false for what is not a number.
template <class T>
constexpr bool in_range(const CharacterField<T>& field, double value) {
  return field.least <= value && value <= field.most;
}

// No corner of the foot further from the rod's axis: what the end wall and the next rod's men
// leave.
inline constexpr double kFootCorner = 0.0749;  // [m]
constexpr bool foot_clears(const CharacterBody& body) {
  const double half = 0.5 * body.foot_depth;
  return body.foot_reach * body.foot_reach + half * half <= kFootCorner * kFootCorner;
}

// Can be played: every number within its range, a name, texts no longer than they may be.
bool in_range(const Character& character);
// 1 to kMaxCharacters of them, each in range.
bool in_range(const Characters& characters);

// The character of this number, or the last one there is: for who draws what was sent.
// Precondition: not empty.
inline const Character& nearest(const Characters& characters, int number) {
  const int last = static_cast<int>(characters.size()) - 1;
  return characters[static_cast<std::size_t>(std::clamp(number, 0, last))];
}

// FNV-1a over all of it: two lists that agree in it are the same.
std::uint64_t digest(const Characters& characters);

// Those that come with the game, in the order of their files (characters/data).
const Characters& built_in_characters();

// --- the man's boxes -----------------------------------------------------------------------------

// A box of a man in the man's frame: origin on the rod's axis, axes as the table's at angle 0.
struct ManBox {
  vp::Vec3 centre;        // [m]
  vp::Vec3 half_extents;  // [m]
  enum class Part : std::uint8_t { foot, leg, torso, head } part;
};
inline constexpr int kManParts = 4;
std::array<ManBox, kManParts> boxes_of(const CharacterBody& body);

}  // namespace foosball
