// Tuning values as a file that people edit: TOML, one `name = value` a line, those that are left
// out at their defaults. What is wrong with a file is said in one sentence that names file and line
// and what to do.
#pragma once

#include <string>
#include <string_view>

#include "foosball/tuning.h"
#include "vphysics/error.h"  // tl::expected

namespace profile {

// name: of the file, for messages. Refused: what is not TOML, names that are none, values that are
// not numbers or out of their range.
tl::expected<foosball::Tuning, std::string> parse_tuning(std::string_view text,
                                                         std::string_view name);
// The same of a file of at most 64 KiB.
tl::expected<foosball::Tuning, std::string> load_tuning(const std::string& path);

// The whole profile, each value with its unit, range and meaning as a comment; parse_tuning() of it
// gives the same values bit for bit.
std::string format_tuning(const foosball::Tuning& tuning);
// Writes it so that a profile is there whole or as it was before; makes its folder. A file there
// that is no profile is kept beside it (".bad").
tl::expected<void, std::string> save_tuning(const foosball::Tuning& tuning,
                                            const std::string& path);

}  // namespace profile
