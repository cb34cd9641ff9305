#include "foosball/character.h"

#include <algorithm>
#include <bit>

#include "bytes.h"

namespace foosball {
namespace {

template <class Fields, class T>
bool all_in_range(const Fields& fields, const T& values) {
  return std::all_of(fields.begin(), fields.end(),
                     [&](const auto& f) { return in_range(f, values.*f.value); });
}

// A box centred on the vertical plane through the axis, between two heights in the man's frame.
ManBox slab(ManBox::Part part, double width, double depth, double bottom, double top) {
  return {{0.0, 0.0, 0.5 * (bottom + top)}, {0.5 * depth, 0.5 * width, 0.5 * (top - bottom)}, part};
}

template <class Archive>
void visit_text(Archive& archive, const std::string& text) {
  archive.any(text.size());
  for (const char c : text) archive.choice(static_cast<unsigned char>(c), 256);
}

}  // namespace

bool in_range(const Character& c) {
  return !c.name.empty() && c.name.size() <= kMaxCharacterName &&
         c.specialty.size() <= kMaxCharacterSpecialty && all_in_range(kBodyFields, c.body) &&
         foot_clears(c.body) && all_in_range(kVoiceFields, c.voice) &&
         static_cast<int>(c.look.headgear) < kHeadgears && static_cast<int>(c.look.face) < kFaces;
}

bool in_range(const Characters& characters) {
  return !characters.empty() && characters.size() <= static_cast<std::size_t>(kMaxCharacters) &&
         std::all_of(characters.begin(), characters.end(),
                     [](const Character& c) { return in_range(c); });
}

std::uint64_t digest(const Characters& characters) {
  ByteHash hash;
  ByteWriter writer(hash);
  writer.any(characters.size());
  for (const Character& c : characters) {
    visit_text(writer, c.name);
    visit_text(writer, c.specialty);
    for (const auto& f : kBodyFields) writer.real(c.body.*f.value, f.min, f.max);
    for (const auto& f : kVoiceFields) writer.real(c.voice.*f.value, f.min, f.max);
    for (const std::uint8_t part : c.look.skin) writer.choice(part, 256);
    for (const std::uint8_t part : c.look.accent) writer.choice(part, 256);
    writer.choice(c.look.headgear, kHeadgears);
    writer.choice(c.look.face, kFaces);
  }
  return hash.value;
}

std::array<ManBox, kManParts> boxes_of(const CharacterBody& c) {
  constexpr double kFootHeight = 0.024;  // top above a ball on the field: no edge lifts the ball
  constexpr double kHip = -0.028;
  constexpr double kShoulder = 0.020;
  const double sole = -c.foot_reach;
  const double ankle = sole + kFootHeight;
  return {{slab(ManBox::Part::foot, c.foot_width, c.foot_depth, sole, ankle),
           // As deep as the foot: a hopping ball meets one upright face instead of an edge.
           slab(ManBox::Part::leg, 0.8 * c.foot_width, c.foot_depth, ankle, kHip),
           slab(ManBox::Part::torso, c.torso_width, c.torso_depth, kHip, kShoulder),
           slab(ManBox::Part::head, 0.016, 0.016, kShoulder, c.head_height)}};
}

}  // namespace foosball
