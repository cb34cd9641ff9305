// Lines and points over the picture: contacts, frames, what is held. What lies behind a body shows
// through it, faintly.
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

  // Positions relative to the camera's target; colours as the screen shows them.
  void line(const glm::vec3& from, const glm::vec3& to, const glm::vec4& colour);
  void point(const glm::vec3& at, const glm::vec4& colour);
  // Draws to the bound target, against its depth, and forgets.
  void flush(const glm::mat4& view_projection, float point_size);

 private:
  struct Vertex {
    glm::vec3 position;
    glm::vec4 colour;
  };
  void draw_all(float point_size) const;

  draw::Program program_;
  draw::GlVertexArray array_;
  draw::GlBuffer buffer_;
  std::vector<Vertex> lines_, points_;
};

}  // namespace sandbox
