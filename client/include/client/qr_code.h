// A text as a QR code (ISO/IEC 18004), for a phone's camera.
#pragma once

#include <string_view>
#include <vector>

namespace client {

struct QrCode {
  int size = 0;            // modules a side; 0: none
  std::vector<bool> dark;  // row by row from the top
  bool operator()(int x, int y) const { return dark[static_cast<std::size_t>(y * size + x)]; }
};

// Of at most wire::kMaxUrl bytes without zeros, error correction level M. None: it is empty or
// longer, or there is no memory.
QrCode qr_code_of(std::string_view text);

}  // namespace client
