// Renders Dear ImGui's draw data with OpenGL ES 3.0.
#pragma once

#include <string>
#include <tl/expected.hpp>

#include "draw/gl_handle.h"
#include "draw/program.h"

struct ImDrawData;

namespace sandbox {

class UiRenderer {
 public:
  // Copies the glyphs of the current ImGui context's fonts.
  static tl::expected<UiRenderer, std::string> create(draw::Quality quality);
  // To the bound framebuffer.
  void draw(const ImDrawData& data) const;

 private:
  draw::Program program_;
  draw::GlTexture glyphs_;
  draw::GlVertexArray array_;
  draw::GlBuffer vertices_, indices_;
};

}  // namespace sandbox
