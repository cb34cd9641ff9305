// Post-processing: bloom over five half-size levels and the tone curve (high quality), or a plain
// upscale (low).
#pragma once

#include <array>
#include <string>
#include <tl/expected.hpp>

#include "draw/program.h"
#include "draw/target.h"

namespace client {

class Post {
 public:
  static tl::expected<Post, std::string> create(draw::Quality quality);

  void resize(const glm::ivec2& screen);
  // The target that the scene is drawn into.
  const draw::Target& scene() const { return scene_; }
  // To the window's framebuffer, which stays bound.
  void present(const glm::ivec2& screen, int room_below);

 private:
  void pass(const draw::Program& program, const draw::Target& to, GLuint image) const;

  draw::Quality quality_ = draw::Quality::low;
  draw::Program bright_, down_, up_, present_;
  draw::GlVertexArray empty_;
  draw::Target scene_;
  std::array<draw::Target, 5> small_;
  std::array<draw::Target, 4> bloom_;
  glm::ivec2 screen_{0, 0};
};

}  // namespace client
