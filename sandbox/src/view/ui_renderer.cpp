#include "view/ui_renderer.h"

#include <imgui.h>

#include <cstddef>
#include <glm/vec2.hpp>

#include "draw/target.h"
#include "view/shaders.h"

namespace sandbox {

tl::expected<UiRenderer, std::string> UiRenderer::create(draw::Quality quality) {
  auto program = draw::Program::build(shader_source, {"ui.vert"}, {"ui.frag"}, quality);
  if (!program) return tl::unexpected(program.error());
  UiRenderer renderer;
  renderer.program_ = std::move(*program);
  renderer.glyphs_ = draw::GlTexture::make();
  unsigned char* pixels = nullptr;
  int width = 0, height = 0;
  ImGui::GetIO().Fonts->GetTexDataAsAlpha8(&pixels, &width, &height);
  draw::bind_texture(0, GL_TEXTURE_2D, renderer.glyphs_.get());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_R8, width, height, 0, GL_RED, GL_UNSIGNED_BYTE, pixels);
  for (const GLenum key : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTexParameteri(GL_TEXTURE_2D, key, GL_LINEAR);
  renderer.array_ = draw::GlVertexArray::make();
  renderer.vertices_ = draw::GlBuffer::make();
  renderer.indices_ = draw::GlBuffer::make();
  glBindVertexArray(renderer.array_.get());
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, renderer.indices_.get());
  glBindBuffer(GL_ARRAY_BUFFER, renderer.vertices_.get());
  const auto attribute = [](GLuint index, GLint count, GLenum type, GLboolean share,
                            std::size_t offset) {
    glVertexAttribPointer(index, count, type, share, sizeof(ImDrawVert),
                          reinterpret_cast<const void*>(offset));
    glEnableVertexAttribArray(index);
  };
  attribute(0, 2, GL_FLOAT, GL_FALSE, offsetof(ImDrawVert, pos));
  attribute(1, 2, GL_FLOAT, GL_FALSE, offsetof(ImDrawVert, uv));
  attribute(2, 4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(ImDrawVert, col));
  glBindVertexArray(0);
  return renderer;
}

// Scissor boxes are counted from the bottom, ImGui's rectangles from the top.
void UiRenderer::draw(const ImDrawData& data) const {
  constexpr GLenum kIndex = sizeof(ImDrawIdx) == 2 ? GL_UNSIGNED_SHORT : GL_UNSIGNED_INT;
  const glm::vec2 scale{data.FramebufferScale.x, data.FramebufferScale.y};
  const float height = data.DisplaySize.y * scale.y;
  glEnable(GL_BLEND);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE);
  glEnable(GL_SCISSOR_TEST);
  program_.use();
  program_.set("u_screen", glm::vec2(data.DisplaySize.x, data.DisplaySize.y));
  program_.set("u_glyphs", 0);
  draw::bind_texture(0, GL_TEXTURE_2D, glyphs_.get());
  glBindVertexArray(array_.get());
  for (int i = 0; i < data.CmdListsCount; ++i) {
    const ImDrawList& list = *data.CmdLists[i];
    glBindBuffer(GL_ARRAY_BUFFER, vertices_.get());
    glBufferData(GL_ARRAY_BUFFER, list.VtxBuffer.size_in_bytes(), list.VtxBuffer.Data,
                 GL_STREAM_DRAW);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, list.IdxBuffer.size_in_bytes(), list.IdxBuffer.Data,
                 GL_STREAM_DRAW);
    for (const ImDrawCmd& command : list.CmdBuffer) {
      const ImVec4& clip = command.ClipRect;
      const auto pixels = [](float x) { return static_cast<GLint>(x); };
      glScissor(pixels(clip.x * scale.x), pixels(height - clip.w * scale.y),
                pixels((clip.z - clip.x) * scale.x), pixels((clip.w - clip.y) * scale.y));
      glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(command.ElemCount), kIndex,
                     reinterpret_cast<const void*>(command.IdxOffset * sizeof(ImDrawIdx)));
    }
  }
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_BLEND);
}

}  // namespace sandbox
