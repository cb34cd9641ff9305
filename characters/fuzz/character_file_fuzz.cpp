// Fuzzes parse_character() with untrusted files. An accepted character must survive a round trip
// through its file format and through its record.
#include <cstdlib>
#include <string_view>

#include "characters/character_file.h"
#include "characters/record.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto character = characters::parse_character(text, "fuzz.toml");
  if (!character) return character.error().empty() ? (std::abort(), 1) : 0;
  const foosball::Characters one{*character};
  const auto again =
      characters::parse_character(characters::format_character(*character), "again.toml");
  if (!again || foosball::digest({*again}) != foosball::digest(one)) std::abort();
  const auto recorded = characters::from_record(characters::to_record(one));
  if (!recorded || foosball::digest(*recorded) != foosball::digest(one)) std::abort();
  return 0;
}
