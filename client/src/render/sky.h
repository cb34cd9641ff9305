// The sky: nebula and planet baked once into a cube map, stars as points over it.
#pragma once

#include <glm/vec2.hpp>
#include <string>
#include <tl/expected.hpp>

#include "render/camera.h"
#include "render/program.h"

namespace client {

class Sky {
 public:
  static tl::expected<Sky, std::string> create(Quality quality);

  GLuint cube() const { return cube_.get(); }
  // Behind all that is drawn already. pixel_scale: pixels of this target for one of a 720-line
  // screen.
  void draw(const Camera& camera, float pixel_scale, float time) const;

 private:
  void bake(const Program& bake, Quality quality);
  void scatter_stars(int count);

  Program background_, star_;
  GlTexture cube_;
  GlVertexArray empty_, stars_;
  GlBuffer star_buffer_;
  GLsizei star_count_ = 0;
};

}  // namespace client
