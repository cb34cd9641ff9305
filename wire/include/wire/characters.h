// The characters that teams choose from, as they are recorded and as they go to clients: one
// description for both (wire/characters_description.h). What their numbers mean and what they may
// be is foosball's (foosball/character.h): here they are bits, in its order.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "wire/limits.h"

namespace wire {

inline constexpr std::size_t kMaxCharacterName = 32;        // bytes of UTF-8
inline constexpr std::size_t kMaxCharacterSpecialty = 100;  // bytes of UTF-8

struct CharacterRecord {
  std::string name, specialty;
  std::array<std::uint64_t, kBodyNumberCount> body{};    // in order: the bits of doubles (IEEE 754)
  std::array<std::uint64_t, kVoiceNumberCount> voice{};  // likewise
  std::array<std::uint8_t, 3> skin{}, accent{};          // sRGB
  std::uint8_t headgear = 0, face = 0;
  bool operator==(const CharacterRecord&) const = default;
};

// All that a match has, 1 to kMaxCharacterCount. Server to client, after its Welcome.
struct Characters {
  std::vector<CharacterRecord> characters;
  bool operator==(const Characters&) const = default;
};

// The bytes of a list: what is beyond a limit is cut, texts are made plain.
std::vector<std::byte> encode_characters(const Characters& characters);
// False unless the bytes are a whole list of at least one, each field within its limits.
bool decode_characters(std::span<const std::byte> bytes, Characters& characters);

}  // namespace wire
