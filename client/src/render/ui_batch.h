// Text and panels of a frame, collected and drawn over the scene with one call.
#pragma once

#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "draw/gl_handle.h"
#include "draw/program.h"
#include "render/font.h"

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace client {

using Colour = glm::vec4;  // sRGB, as on the screen, with opacity

class UiBatch {
 public:
  static tl::expected<UiBatch, std::string> create(Font font);

  const Font& font() const { return font_; }
  // glow 0..1: a dark halo that separates the text from its background.
  void text(std::string_view utf8, const TextStyle& style, const glm::vec2& at,
            const Colour& colour, float glow = 0.55f);
  void panel(const glm::vec2& low, const glm::vec2& high, float corner, const Colour& colour,
             float outline = 0.0f);
  // Portraits, in cells: column by character, row by team. None until set.
  void set_pictures(GLuint texture, const glm::ivec2& cells);
  void picture(int column, int row, const glm::vec2& low, const glm::vec2& high);
  // From now on rotates everything by 180 degrees about the centre of a screen of this size, for a
  // person who sits opposite; zero: no rotation.
  void turn(const glm::vec2& screen) { turned_about_ = screen; }
  // Bounding rectangle of what the last flush() drew [px].
  struct Bounds {
    glm::vec2 low{0.0f}, high{0.0f};
  };
  const Bounds& bounds() const { return bounds_; }
  // Draws to the bound framebuffer and clears the batch.
  void flush(const glm::ivec2& screen);

 private:
  struct Vertex {
    glm::vec2 position, uv;
    glm::vec4 colour, shape;
  };
  void quad(const glm::vec2& low, const glm::vec2& high, const glm::vec2& uv_low,
            const glm::vec2& uv_high, const Colour& colour, const glm::vec4& shape);

  Font font_;
  draw::Program program_;
  draw::GlTexture atlas_;
  draw::GlVertexArray array_;
  draw::GlBuffer buffer_;
  std::vector<Vertex> vertices_;
  Bounds bounds_;
  GLuint pictures_ = 0;
  glm::ivec2 picture_cells_{1, 1};
  glm::vec2 turned_about_{0.0f};
};

}  // namespace client
