// The shaders of sandbox/shaders, embedded by the build.
#pragma once

#include <string_view>

namespace sandbox {

// Text of the file of that name; empty if there is none.
std::string_view shader_source(std::string_view name);

}  // namespace sandbox
