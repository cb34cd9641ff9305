// Reads a complete file into memory, with a size limit: the data comes from outside.
#pragma once

#include <cstddef>
#include <string>
#include <tl/expected.hpp>
#include <vector>

namespace wire {

inline constexpr std::size_t kMaxJournalFile = std::size_t{1} << 30;  // days of play

// The error is a sentence that names the file and says what to do. An empty file is not an error.
tl::expected<std::vector<std::byte>, std::string> read_file(const std::string& path,
                                                            std::size_t max_bytes);

}  // namespace wire
