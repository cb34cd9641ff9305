// Tuning values as a file that people edit: TOML, one `name = value` per line. Omitted values keep
// their defaults. An error is one sentence with file and line and what to do.
#pragma once

#include <string>
#include <string_view>

#include "foosball/tuning.h"
#include "vphysics/error.h"  // tl::expected

namespace profile {

// name: of the file, for messages. Fails for text that is not TOML, unknown names, and values that
// are not numbers or out of range.
tl::expected<foosball::Tuning, std::string> parse_tuning(std::string_view text,
                                                         std::string_view name);
// Reads a file of at most 64 KiB.
tl::expected<foosball::Tuning, std::string> load_tuning(const std::string& path);

// The complete profile, each value with its unit, range and meaning as a comment. parse_tuning()
// restores the same values bit for bit.
std::string format_tuning(const foosball::Tuning& tuning);
// Writes the profile atomically, and creates its folder. If the existing file is not a profile, it
// is kept under another name (".bad").
tl::expected<void, std::string> save_tuning(const foosball::Tuning& tuning,
                                            const std::string& path);

}  // namespace profile
