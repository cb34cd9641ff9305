// The characters that teams choose from, in recordings and in messages to clients; both use one
// description (wire/characters_description.h). foosball/character.h defines the meaning and the
// ranges of the numbers. Here they are bits, in its order.
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
  std::array<std::uint64_t, kBodyNumberCount> body{};    // in order, as bits of doubles (IEEE 754)
  std::array<std::uint64_t, kVoiceNumberCount> voice{};  // likewise
  std::array<std::uint8_t, 3> skin{}, accent{};          // sRGB
  std::uint8_t headgear = 0, face = 0;
  bool operator==(const CharacterRecord&) const = default;
};

// All characters of a match, 1 to kMaxCharacterCount. Server to client, after its Welcome.
struct Characters {
  std::vector<CharacterRecord> characters;
  bool operator==(const Characters&) const = default;
};

// Encodes a list. Truncates what exceeds a limit; cleans texts (wire/text.h).
std::vector<std::byte> encode_characters(const Characters& characters);
// Returns false unless the bytes are exactly one list with at least one character and each field is
// within its limits.
bool decode_characters(std::span<const std::byte> bytes, Characters& characters);

}  // namespace wire
