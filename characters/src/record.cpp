#include "characters/record.h"

#include <bit>

namespace characters {
namespace {

static_assert(wire::kMaxCharacterCount == foosball::kMaxCharacters);
static_assert(wire::kBodyNumberCount == foosball::kBodyNumbers);
static_assert(wire::kVoiceNumberCount == foosball::kVoiceNumbers);
static_assert(wire::kHeadgearCount == foosball::kHeadgears);
static_assert(wire::kFaceCount == foosball::kFaces);
static_assert(wire::kMaxCharacterName == foosball::kMaxCharacterName);
static_assert(wire::kMaxCharacterSpecialty == foosball::kMaxCharacterSpecialty);

template <class Fields, class T, std::size_t kSize>
void put(const Fields& fields, const T& values, std::array<std::uint64_t, kSize>& bits) {
  for (std::size_t i = 0; i < kSize; ++i) {
    bits[i] = std::bit_cast<std::uint64_t>(values.*fields[i].value);
  }
}

template <class Fields, class T, std::size_t kSize>
void take(const Fields& fields, const std::array<std::uint64_t, kSize>& bits, T& values) {
  for (std::size_t i = 0; i < kSize; ++i) {
    values.*fields[i].value = std::bit_cast<double>(bits[i]);
  }
}

wire::CharacterRecord record_of(const foosball::Character& character) {
  wire::CharacterRecord record;
  record.name = character.name;
  record.specialty = character.specialty;
  put(foosball::kBodyFields, character.body, record.body);
  put(foosball::kVoiceFields, character.voice, record.voice);
  record.skin = character.look.skin;
  record.accent = character.look.accent;
  record.headgear = static_cast<std::uint8_t>(character.look.headgear);
  record.face = static_cast<std::uint8_t>(character.look.face);
  return record;
}

foosball::Character character_of(const wire::CharacterRecord& record) {
  foosball::Character character;
  character.name = record.name;
  character.specialty = record.specialty;
  take(foosball::kBodyFields, record.body, character.body);
  take(foosball::kVoiceFields, record.voice, character.voice);
  character.look = {record.skin, record.accent, static_cast<foosball::Headgear>(record.headgear),
                    static_cast<foosball::Face>(record.face)};
  return character;
}

}  // namespace

wire::Characters to_record(const foosball::Characters& characters) {
  wire::Characters record;
  for (const foosball::Character& c : characters) record.characters.push_back(record_of(c));
  return record;
}

std::optional<foosball::Characters> from_record(const wire::Characters& record) {
  foosball::Characters characters;
  for (const wire::CharacterRecord& c : record.characters) characters.push_back(character_of(c));
  if (!in_range(characters)) return std::nullopt;
  return characters;
}

}  // namespace characters
