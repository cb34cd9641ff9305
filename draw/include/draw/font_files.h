// Where to find DejaVu Sans.
#pragma once

#include <string>
#include <vector>

namespace draw {

// The directories of Debian, of other systems and of the page; before them `first`, if not empty.
std::vector<std::string> font_directories(const std::string& first);
// The error message that says which package to install.
std::string no_font();

}  // namespace draw
