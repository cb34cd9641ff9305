#include "draw/image.h"

#include <GLES3/gl3.h>
#include <stb/stb_image_write.h>

#include <cstddef>

namespace draw {

glm::ivec3 Image::at(int x, int y) const {
  const std::size_t i = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(size.x) +
                             static_cast<std::size_t>(x));
  return {rgb[i], rgb[i + 1], rgb[i + 2]};
}

Image read_pixels(const glm::ivec2& size) {
  const auto width = static_cast<std::size_t>(size.x), height = static_cast<std::size_t>(size.y);
  std::vector<std::uint8_t> rgba(4 * width * height);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, size.x, size.y, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
  Image image{size, std::vector<std::uint8_t>(3 * width * height)};
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      for (std::size_t c = 0; c < 3; ++c) {
        image.rgb[3 * (y * width + x) + c] = rgba[4 * ((height - 1 - y) * width + x) + c];
      }
    }
  }
  return image;
}

tl::expected<void, std::string> write_png(const Image& image, const std::string& path) {
  if (stbi_write_png(path.c_str(), image.size.x, image.size.y, 3, image.rgb.data(),
                     3 * image.size.x))
    return {};
  return tl::unexpected("Cannot write the picture " + path +
                        ": choose a directory that exists and can be written to.");
}

}  // namespace draw
