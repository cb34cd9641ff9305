// Lines and points over the picture: contacts, frames, what is held. What lies behind a body shows
// through it, more or less.
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "draw/gl_handle.h"
#include "draw/program.h"

namespace sandbox {

class Marks {
 public:
  static tl::expected<Marks, std::string> create(draw::Quality quality);

  // Opacity behind bodies: of what lies on their surfaces, and of what lies within them.
  static constexpr float kOnSurface = 0.1f, kWithin = 0.75f;

  // Positions relative to the camera's target; colours as the screen shows them.
  void line(const glm::vec3& from, const glm::vec3& to, const glm::vec4& colour, float behind);
  void point(const glm::vec3& at, const glm::vec4& colour, float behind);
  // Draws to the bound target, against its depth, and forgets. [px]; lines may be thinner, as the
  // driver can.
  void flush(const glm::mat4& view_projection, float point_size, float line_width);

 private:
  struct Vertex {
    glm::vec3 position;
    glm::vec4 colour;
    float behind;
  };
  void draw_all(float point_size) const;

  draw::Program program_;
  draw::GlVertexArray array_;
  draw::GlBuffer buffer_;
  std::vector<Vertex> lines_, points_;
};

}  // namespace sandbox
