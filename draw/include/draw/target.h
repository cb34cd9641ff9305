// Render targets: a texture, optionally with several samples per pixel and with depth.
#pragma once

#include <glm/vec2.hpp>

#include "draw/gl_handle.h"

namespace draw {

struct TargetDesc {
  glm::ivec2 size{1, 1};
  GLenum format = GL_RGB10_A2;  // colour-renderable in ES 3.0 without extensions
  int samples = 0;              // 0: draws directly into the texture
  bool depth = false;
};

class Target {
 public:
  Target() = default;
  explicit Target(const TargetDesc& desc);

  void bind() const;     // as the framebuffer to draw into
  void resolve() const;  // multisampled into the texture; no effect without samples
  GLuint texture() const { return texture_.get(); }
  GLuint framebuffer() const { return framebuffer_.get(); }
  const glm::ivec2& size() const { return desc_.size; }

 private:
  TargetDesc desc_;
  GlTexture texture_;
  GlFramebuffer framebuffer_, multisampled_;
  GlRenderbuffer colour_, depth_;
};

// A depth texture for shadows, with depth comparison when sampled.
class ShadowTarget {
 public:
  ShadowTarget() = default;
  // smooth: filters the comparisons of four texels; otherwise compares the nearest.
  ShadowTarget(int size, bool smooth);
  void bind() const;
  GLuint texture() const { return texture_.get(); }
  int size() const { return size_; }  // side length [px]

 private:
  int size_ = 0;
  GlTexture texture_;
  GlFramebuffer framebuffer_;
};

void bind_texture(int unit, GLenum kind, GLuint texture);

}  // namespace draw
