// The sky: nebula and planet rendered once into a cube map, stars drawn over it as points.
#pragma once

#include <glm/vec2.hpp>
#include <string>
#include <tl/expected.hpp>

#include "draw/program.h"
#include "render/camera.h"

namespace client {

class Sky {
 public:
  static tl::expected<Sky, std::string> create(draw::Quality quality);

  GLuint cube() const { return cube_.get(); }
  // Behind all that is drawn already. pixel_scale: pixels of this target per pixel of a 720-line
  // screen.
  void draw(const Camera& camera, float pixel_scale, float time) const;

 private:
  void bake(const draw::Program& bake, draw::Quality quality);
  void scatter_stars(int count);

  draw::Program background_, star_;
  draw::GlTexture cube_;
  draw::GlVertexArray empty_, stars_;
  draw::GlBuffer star_buffer_;
  GLsizei star_count_ = 0;
};

}  // namespace client
