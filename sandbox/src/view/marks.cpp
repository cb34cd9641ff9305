#include "view/marks.h"

#include <cstddef>

#include "view/shaders.h"

namespace sandbox {
tl::expected<Marks, std::string> Marks::create(draw::Quality quality) {
  auto program = draw::Program::build(shader_source, {"line.vert"}, {"line.frag"}, quality);
  if (!program) return tl::unexpected(program.error());
  Marks marks;
  marks.program_ = std::move(*program);
  marks.array_ = draw::GlVertexArray::make();
  marks.buffer_ = draw::GlBuffer::make();
  glBindVertexArray(marks.array_.get());
  glBindBuffer(GL_ARRAY_BUFFER, marks.buffer_.get());
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(Vertex), nullptr);
  glVertexAttribPointer(1, 4, GL_FLOAT, GL_FALSE, sizeof(Vertex),
                        reinterpret_cast<const void*>(offsetof(Vertex, colour)));
  glVertexAttribPointer(2, 1, GL_FLOAT, GL_FALSE, sizeof(Vertex),
                        reinterpret_cast<const void*>(offsetof(Vertex, behind)));
  for (GLuint i = 0; i < 3; ++i) glEnableVertexAttribArray(i);
  glBindVertexArray(0);
  return marks;
}

void Marks::line(const glm::vec3& from, const glm::vec3& to, const glm::vec4& colour,
                 float behind) {
  lines_.push_back({from, colour, behind});
  lines_.push_back({to, colour, behind});
}

void Marks::point(const glm::vec3& at, const glm::vec4& colour, float behind) {
  points_.push_back({at, colour, behind});
}

void Marks::draw_all(float point_size) const {
  program_.set("u_point_size", point_size);
  program_.set("u_round", 0);
  glDrawArrays(GL_LINES, 0, static_cast<GLsizei>(lines_.size()));
  program_.set("u_round", 1);
  glDrawArrays(GL_POINTS, static_cast<GLint>(lines_.size()), static_cast<GLsizei>(points_.size()));
}

void Marks::flush(const glm::mat4& view_projection, float point_size, float line_width) {
  if (!lines_.empty() || !points_.empty()) {
    std::vector<Vertex> all = lines_;
    all.insert(all.end(), points_.begin(), points_.end());
    program_.use();
    program_.set("u_view_projection", view_projection);
    glBindVertexArray(array_.get());
    glBindBuffer(GL_ARRAY_BUFFER, buffer_.get());
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(all.size() * sizeof(Vertex)), all.data(),
                 GL_STREAM_DRAW);
    glLineWidth(line_width);
    glEnable(GL_BLEND);
    glDepthMask(GL_FALSE);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    glDepthFunc(GL_GREATER);
    program_.set("u_behind", 1);
    draw_all(point_size);
    glDepthFunc(GL_LEQUAL);
    program_.set("u_behind", 0);
    draw_all(point_size);
    glDepthFunc(GL_LESS);
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
  }
  lines_.clear();
  points_.clear();
}

}  // namespace sandbox
