// Characters as files that people edit: TOML, one file a character; docs/characters.md explains the
// lines. What is wrong with a file is said in one sentence that names file and line, what may stand
// there, and what to do.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "foosball/character.h"

namespace characters {

// name: of the file, for messages. Only the character's own name must be there; what else is left
// out is as in foosball::Character. Refused: what is not TOML, names that are none, values of
// another type or out of their range.
tl::expected<foosball::Character, std::string> parse_character(std::string_view text,
                                                               std::string_view name);
// The same of a file of at most 64 KiB; not of a folder, a FIFO or a device, which it does not wait
// for.
tl::expected<foosball::Character, std::string> load_character(const std::string& path);

// All files *.toml of a folder, in the order of their names; 1 to kMaxCharacters, no name twice.
tl::expected<foosball::Characters, std::string> load_characters(const std::string& folder);

// base, and the files of the folder, if there is one: a character of a name that base has takes its
// place, the others come behind.
tl::expected<foosball::Characters, std::string> load_more_characters(foosball::Characters base,
                                                                     const std::string& folder);

// The whole file, each number with its unit, range and meaning as a comment; parse_character() of
// it gives the same character bit for bit.
std::string format_character(const foosball::Character& character);

}  // namespace characters
