// Cost of a frame. High: full resolution, 4 samples per pixel, soft shadows, bloom. Low: two thirds
// of the resolution, no post pass, for software OpenGL and old laptops.
#pragma once

#include <cstdint>

namespace draw {

enum class Quality : std::uint8_t { low, high };

}  // namespace draw
