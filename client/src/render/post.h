// From light to the screen: bloom over five halvings and the tone curve (high quality), or a plain
// enlargement (low).
#pragma once

#include <array>
#include <string>
#include <tl/expected.hpp>

#include "render/program.h"
#include "render/target.h"

namespace client {

class Post {
 public:
  static tl::expected<Post, std::string> create(Quality quality);

  void resize(const glm::ivec2& screen);
  // The target that the scene is drawn into.
  const Target& scene() const { return scene_; }
  // To the window's framebuffer, which stays bound.
  void present(const glm::ivec2& screen);

 private:
  void pass(const Program& program, const Target& to, GLuint image) const;

  Quality quality_ = Quality::low;
  Program bright_, down_, up_, present_;
  GlVertexArray empty_;
  Target scene_;
  std::array<Target, 5> small_;
  std::array<Target, 4> bloom_;
  glm::ivec2 screen_{0, 0};
};

}  // namespace client
