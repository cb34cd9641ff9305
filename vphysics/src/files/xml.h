// tinyxml2 for untrusted text: bounded in depth, attributes and time.
#pragma once

#include <tinyxml2.h>

#include <string_view>

#include "vphysics/error.h"

namespace vp::detail {

// An error's message begins with the line: "line 12: ...". Ignores zero bytes at the end, which C
// programs write after strings.
Expected<void> parse_xml(std::string_view text, tinyxml2::XMLDocument& document);

}  // namespace vp::detail
