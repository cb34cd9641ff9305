#include "render/ui_batch.h"

#include <cstddef>
#include <glm/common.hpp>

#include "draw/target.h"
#include "render/shaders.h"

namespace client {

tl::expected<UiBatch, std::string> UiBatch::create(Font font) {
  auto program = draw::Program::build(shader_source, {"ui.vert"}, {"ui.frag"}, draw::Quality::high);
  if (!program) return tl::unexpected(program.error());
  UiBatch batch;
  batch.program_ = std::move(*program);
  batch.font_ = std::move(font);
  batch.atlas_ = draw::GlTexture::make();
  draw::bind_texture(0, GL_TEXTURE_2D, batch.atlas_.get());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  const glm::ivec2 size = batch.font_.atlas_size();
  glTexImage2D(GL_TEXTURE_2D, 0, GL_R8, size.x, size.y, 0, GL_RED, GL_UNSIGNED_BYTE,
               batch.font_.atlas().data());
  for (const GLenum key : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTexParameteri(GL_TEXTURE_2D, key, GL_LINEAR);
  for (const GLenum key : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    glTexParameteri(GL_TEXTURE_2D, key, GL_CLAMP_TO_EDGE);
  batch.array_ = draw::GlVertexArray::make();
  batch.buffer_ = draw::GlBuffer::make();
  glBindVertexArray(batch.array_.get());
  glBindBuffer(GL_ARRAY_BUFFER, batch.buffer_.get());
  const auto attribute = [](GLuint index, GLint count, std::size_t offset) {
    glVertexAttribPointer(index, count, GL_FLOAT, GL_FALSE, sizeof(Vertex),
                          reinterpret_cast<const void*>(offset));
    glEnableVertexAttribArray(index);
  };
  attribute(0, 2, offsetof(Vertex, position));
  attribute(1, 2, offsetof(Vertex, uv));
  attribute(2, 4, offsetof(Vertex, colour));
  attribute(3, 4, offsetof(Vertex, shape));
  glBindVertexArray(0);
  return batch;
}

void UiBatch::quad(const glm::vec2& low, const glm::vec2& high, const glm::vec2& uv_low,
                   const glm::vec2& uv_high, const Colour& colour, const glm::vec4& shape) {
  const bool turned = turned_about_.x > 0.0f;
  const auto at = [&](float x, float y) {
    return turned ? turned_about_ - glm::vec2(x, y) : glm::vec2(x, y);
  };
  const Vertex a{at(low.x, low.y), uv_low, colour, shape},
      c{at(high.x, high.y), uv_high, colour, shape};
  const Vertex b{at(high.x, low.y), {uv_high.x, uv_low.y}, colour, shape};
  const Vertex d{at(low.x, high.y), {uv_low.x, uv_high.y}, colour, shape};
  vertices_.insert(vertices_.end(), {a, b, c, a, c, d});
}

void UiBatch::text(std::string_view utf8, const TextStyle& style, const glm::vec2& at,
                   const Colour& colour, float glow) {
  const float softness = font_.softness(style.size);
  for (const PlacedGlyph& g : font_.place(utf8, style, at)) {
    quad(g.low, g.high, g.uv_low, g.uv_high, colour, {0.0f, softness, glow, 0.0f});
  }
}

void UiBatch::panel(const glm::vec2& low, const glm::vec2& high, float corner, const Colour& colour,
                    float outline) {
  const glm::vec2 half = 0.5f * (high - low);
  quad(low, high, -half, half, colour, {std::max(corner, 0.01f), half.x, half.y, outline});
}

void UiBatch::set_pictures(GLuint texture, const glm::ivec2& cells) {
  pictures_ = texture;
  picture_cells_ = cells;
}

void UiBatch::picture(int column, int row, const glm::vec2& low, const glm::vec2& high) {
  if (pictures_ == 0) return;
  const glm::vec2 cell = 1.0f / glm::vec2(picture_cells_);
  const glm::vec2 uv{static_cast<float>(column) * cell.x, static_cast<float>(row) * cell.y};
  // The texture's rows run upwards.
  quad(low, high, {uv.x, uv.y + cell.y}, {uv.x + cell.x, uv.y}, Colour(1.0f), {-1.0f, 0, 0, 0});
}

void UiBatch::flush(const glm::ivec2& screen) {
  bounds_ = {glm::vec2(1e9f), glm::vec2(-1e9f)};
  for (const Vertex& vertex : vertices_) {
    bounds_.low = glm::min(bounds_.low, vertex.position);
    bounds_.high = glm::max(bounds_.high, vertex.position);
  }
  if (!vertices_.empty()) {
    glDisable(GL_DEPTH_TEST);
    glEnable(GL_BLEND);
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE);
    program_.use();
    program_.set("u_screen", glm::vec2(screen));
    program_.set("u_glyphs", 0);
    program_.set("u_pictures", 1);
    draw::bind_texture(1, GL_TEXTURE_2D, pictures_ != 0 ? pictures_ : atlas_.get());
    draw::bind_texture(0, GL_TEXTURE_2D, atlas_.get());
    glBindVertexArray(array_.get());
    glBindBuffer(GL_ARRAY_BUFFER, buffer_.get());
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices_.size() * sizeof(Vertex)),
                 vertices_.data(), GL_STREAM_DRAW);
    glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(vertices_.size()));
    glDisable(GL_BLEND);
  }
  vertices_.clear();
}

}  // namespace client
