#include "draw/font_files.h"

namespace draw {

std::vector<std::string> font_directories(const std::string& first) {
  std::vector<std::string> directories{"/usr/share/fonts/truetype/dejavu",
                                       "/usr/share/fonts/dejavu", "/usr/share/fonts/TTF",
                                       "/usr/share/fonts/dejavu-sans-fonts", "/fonts"};
  if (!first.empty()) directories.insert(directories.begin(), first);
  return directories;
}

std::string no_font() {
  return "No font to write with: install DejaVu Sans (on Debian: apt-get install "
         "fonts-dejavu-core), or name its directory with --font-dir.";
}

}  // namespace draw
