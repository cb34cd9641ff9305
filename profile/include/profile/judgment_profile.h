// Values of a computer player's judgment (foosball/judgment.h) as a file that people and
// `space-foosball-match --train` write: TOML, one `name = value` a line; those that are left out
// stay as the player has them.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "foosball/judgment.h"

namespace profile {

// base with the values of the text. name: of the file, for messages, which name file, line and what
// to do. Refused: what is not TOML, names that are none, values that are not numbers or out of
// their range.
tl::expected<foosball::Judgment, std::string> parse_judgment(std::string_view text,
                                                             std::string_view name,
                                                             const foosball::Judgment& base);
// The same of a file of at most 64 KiB.
tl::expected<foosball::Judgment, std::string> load_judgment(const std::string& path,
                                                            const foosball::Judgment& base);

// All values, each with its unit, range and meaning as a comment, and as base has it.
std::string format_judgment(const foosball::Judgment& judgment, const foosball::Judgment& base);

}  // namespace profile
