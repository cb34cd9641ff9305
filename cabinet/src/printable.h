#pragma once

#include <string>

namespace cabinet {

// Text from a device is untrusted: removes control characters before it reaches a terminal.
inline std::string printable(const std::string& text) {
  std::string clean;
  for (const char c : text) clean += static_cast<unsigned char>(c) < 0x20 || c == 0x7F ? '?' : c;
  return clean;
}

}  // namespace cabinet
