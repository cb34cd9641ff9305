// Reads a file into memory, up to a size limit.
#pragma once

#include <cstddef>
#include <string>

#include "vphysics/error.h"

namespace vp::detail {

// Errc::bad_data if it cannot be read; Errc::unsupported if it has more than max_bytes bytes. The
// message begins with the path.
Expected<std::string> read_file(const std::string& path, std::size_t max_bytes);

}  // namespace vp::detail
