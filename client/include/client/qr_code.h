// A text as a QR code (ISO/IEC 18004), for a phone's camera.
#pragma once

#include <string_view>
#include <vector>

namespace client {

struct QrCode {
  int size = 0;            // modules per side; 0: none
  std::vector<bool> dark;  // row-major, from the top
  bool operator()(int x, int y) const { return dark[static_cast<std::size_t>(y * size + x)]; }
};

// Precondition: the text has no zero bytes. At most wire::kMaxUrl bytes, error correction level M.
// Returns an empty code if the text is empty or too long, or if memory runs out.
QrCode qr_code_of(std::string_view text);

}  // namespace client
