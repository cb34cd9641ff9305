// Lines and points over the picture: contacts, frames, the grip. Marks behind a body are drawn
// through it with less opacity.
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

  // Opacity behind bodies: of marks on their surfaces, and of marks inside them.
  static constexpr float kOnSurface = 0.1f, kWithin = 0.75f;

  // Positions relative to the camera's target; colours in sRGB, as on the screen.
  void line(const glm::vec3& from, const glm::vec3& to, const glm::vec4& colour, float behind);
  void point(const glm::vec3& at, const glm::vec4& colour, float behind);
  // Draws to the bound target, with its depth test, and clears. [px]; lines may be thinner if the
  // driver limits their width.
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
