// The window's pixels, and PNG files of them.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <tl/expected.hpp>
#include <vector>

namespace draw {

struct Image {
  glm::ivec2 size{0, 0};
  std::vector<std::uint8_t> rgb;  // row-major, from the top

  glm::ivec3 at(int x, int y) const;  // 0..255
};

// Reads the bound framebuffer. Call before the buffers are swapped.
Image read_pixels(const glm::ivec2& size);
tl::expected<void, std::string> write_png(const Image& image, const std::string& path);

}  // namespace draw
