// A file with values of a computer player's judgment (foosball/judgment.h), written by people and
// by `space-foosball-match --train`: TOML, one `name = value` per line. Omitted values keep the
// player's.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "foosball/judgment.h"

namespace profile {

// base with the values of the text. name: of the file, for messages, which give file, line and what
// to do. Fails for text that is not TOML, unknown names, and values that are not numbers or out of
// range.
tl::expected<foosball::Judgment, std::string> parse_judgment(std::string_view text,
                                                             std::string_view name,
                                                             const foosball::Judgment& base);
// Reads a file of at most 64 KiB.
tl::expected<foosball::Judgment, std::string> load_judgment(const std::string& path,
                                                            const foosball::Judgment& base);

// All values, each with its unit, its range, its meaning and base's value as a comment.
std::string format_judgment(const foosball::Judgment& judgment, const foosball::Judgment& base);

}  // namespace profile
