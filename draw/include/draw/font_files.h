// Where DejaVu Sans lies.
#pragma once

#include <string>
#include <vector>

namespace draw {

// Where Debian, other systems and the page keep it; first, if not empty, is looked into first.
std::vector<std::string> font_directories(const std::string& first);
// The sentence that says which package to install.
std::string no_font();

}  // namespace draw
