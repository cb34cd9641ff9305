// tinyxml2 on text from outside: bounded in depth, in attributes and in time.
#pragma once

#include <tinyxml2.h>

#include <string_view>

#include "vphysics/error.h"

namespace vp::detail {

// An error's message begins with the line: "line 12: ...". Zero bytes at the end, of strings
// written by programs in C, are left out.
Expected<void> parse_xml(std::string_view text, tinyxml2::XMLDocument& document);

}  // namespace vp::detail
