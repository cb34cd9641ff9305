// Characters as files that people edit: TOML, one file per character; docs/characters.md explains
// the lines. An error is one sentence with file and line, the allowed values, and what to do.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "foosball/character.h"

namespace characters {

// name: of the file, for messages. Only the character's own name is required; other values default
// to foosball::Character's. Fails for text that is not TOML, unknown names, and values of the wrong
// type or out of range.
tl::expected<foosball::Character, std::string> parse_character(std::string_view text,
                                                               std::string_view name);
// Reads a file of at most 64 KiB. Rejects folders, FIFOs and devices, without waiting for them.
tl::expected<foosball::Character, std::string> load_character(const std::string& path);

// Loads all files *.toml of a folder, in the order of their names: 1 to kMaxCharacters, with
// distinct names.
tl::expected<foosball::Characters, std::string> load_characters(const std::string& folder);

// base and the files of the folder, if it exists. A character replaces the one of the same name in
// base; others are appended.
tl::expected<foosball::Characters, std::string> load_more_characters(foosball::Characters base,
                                                                     const std::string& folder);

// The complete file, each number with its unit, range and meaning as a comment. parse_character()
// restores the same character bit for bit.
std::string format_character(const foosball::Character& character);

}  // namespace characters
