// Places to draw to: a texture, optionally with several samples a pixel and with depth.
#pragma once

#include <glm/vec2.hpp>

#include "draw/gl_handle.h"

namespace draw {

struct TargetDesc {
  glm::ivec2 size{1, 1};
  GLenum format = GL_RGB10_A2;  // color-renderable in ES 3.0 without extensions
  int samples = 0;              // 0: drawn straight into the texture
  bool depth = false;
};

class Target {
 public:
  Target() = default;
  explicit Target(const TargetDesc& desc);

  void bind() const;     // to draw into
  void resolve() const;  // several samples into the texture; nothing to do without
  GLuint texture() const { return texture_.get(); }
  GLuint framebuffer() const { return framebuffer_.get(); }
  const glm::ivec2& size() const { return desc_.size; }

 private:
  TargetDesc desc_;
  GlTexture texture_;
  GlFramebuffer framebuffer_, multisampled_;
  GlRenderbuffer colour_, depth_;
};

// A depth texture for shadows, compared while it is sampled.
class ShadowTarget {
 public:
  ShadowTarget() = default;
  // smooth: compared at four texels and mixed; else at the nearest.
  ShadowTarget(int size, bool smooth);
  void bind() const;
  GLuint texture() const { return texture_.get(); }
  int size() const { return size_; }  // of its side [px]

 private:
  int size_ = 0;
  GlTexture texture_;
  GlFramebuffer framebuffer_;
};

void bind_texture(int unit, GLenum kind, GLuint texture);

}  // namespace draw
