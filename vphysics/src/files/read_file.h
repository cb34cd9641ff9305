// A file as bytes, never more of them than a limit.
#pragma once

#include <cstddef>
#include <string>

#include "vphysics/error.h"

namespace vp::detail {

// Errc::bad_data where it cannot be read; Errc::unsupported where it has more than so many bytes.
// The message begins with the path.
Expected<std::string> read_file(const std::string& path, std::size_t max_bytes);

}  // namespace vp::detail
