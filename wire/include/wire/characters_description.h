// The only description of a list of characters: part of the journal's header and of the control
// message to clients. wire/description.h defines its elements.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "wire/characters.h"
#include "wire/description.h"

namespace wire {

template <class Codec, class C>
void describe_character(Codec& codec, C& c) {
  constexpr std::uint64_t kAny64 = std::numeric_limits<std::uint64_t>::max();
  codec.text(Text{"name", kMaxCharacterName, ""}, c.name);
  codec.text(Text{"specialty", kMaxCharacterSpecialty, "one line"}, c.specialty);
  codec.array(Group{"body", "kBodyFields of foosball/character.h, in their order"}, c.body,
              [&](auto& bits) {
                codec.integer(Integer{"bits", 64, kAny64, "", "of a double, IEEE 754"}, bits);
              });
  codec.array(Group{"voice", "kVoiceFields, likewise"}, c.voice, [&](auto& bits) {
    codec.integer(Integer{"bits", 64, kAny64, "", "of a double, IEEE 754"}, bits);
  });
  codec.array(Group{"skin", "sRGB"}, c.skin, [&](auto& part) {
    codec.integer(Integer{"part", 8, 255, "", "red, green, blue"}, part);
  });
  codec.array(Group{"accent", "sRGB"}, c.accent, [&](auto& part) {
    codec.integer(Integer{"part", 8, 255, "", "red, green, blue"}, part);
  });
  codec.integer(Integer{"headgear", 4, kHeadgearCount - 1, "",
                        "0 helmet, 1 antenna, 2 cap, 3 horns, 4 hood, 5 bubble"},
                c.headgear);
  codec.integer(Integer{"face", 4, kFaceCount - 1, "", "0 visor, 1 eyes, 2 goggles, 3 beard"},
                c.face);
}

template <class Codec, class List_>
void describe_characters(Codec& codec, List_& characters) {
  codec.list(List{"characters", 8, kMaxCharacterCount, "to choose from, at least 1"}, characters,
             [&](auto& character) { describe_character(codec, character); });
}

}  // namespace wire
