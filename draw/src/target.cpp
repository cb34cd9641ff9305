#include "draw/target.h"

#include <algorithm>

namespace draw {
namespace {

GlRenderbuffer make_renderbuffer(const TargetDesc& desc, GLenum format) {
  GlRenderbuffer buffer = GlRenderbuffer::make();
  glBindRenderbuffer(GL_RENDERBUFFER, buffer.get());
  if (desc.samples > 0) {
    // The maximum number of samples of a format depends on the driver; 4 is guaranteed for these
    // two.
    GLint max = 4;
    glGetInternalformativ(GL_RENDERBUFFER, format, GL_SAMPLES, 1, &max);
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, std::min(desc.samples, max), format,
                                     desc.size.x, desc.size.y);
  } else {
    glRenderbufferStorage(GL_RENDERBUFFER, format, desc.size.x, desc.size.y);
  }
  return buffer;
}

void set_filter(GLenum kind, GLint filter) {
  glTexParameteri(kind, GL_TEXTURE_MIN_FILTER, filter);
  glTexParameteri(kind, GL_TEXTURE_MAG_FILTER, filter);
  glTexParameteri(kind, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(kind, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

}  // namespace

void bind_texture(int unit, GLenum kind, GLuint texture) {
  glActiveTexture(static_cast<GLenum>(GL_TEXTURE0 + unit));
  glBindTexture(kind, texture);
}

Target::Target(const TargetDesc& desc)
    : desc_(desc), texture_(GlTexture::make()), framebuffer_(GlFramebuffer::make()) {
  bind_texture(0, GL_TEXTURE_2D, texture_.get());
  glTexStorage2D(GL_TEXTURE_2D, 1, desc.format, desc.size.x, desc.size.y);
  set_filter(GL_TEXTURE_2D, GL_LINEAR);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.get());
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture_.get(), 0);
  if (desc.samples > 0) {
    multisampled_ = GlFramebuffer::make();
    glBindFramebuffer(GL_FRAMEBUFFER, multisampled_.get());
    colour_ = make_renderbuffer(desc, desc.format);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour_.get());
  }
  if (desc.depth) {
    depth_ = make_renderbuffer(desc, GL_DEPTH_COMPONENT24);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_.get());
  }
}

void Target::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, multisampled_ ? multisampled_.get() : framebuffer_.get());
  glViewport(0, 0, desc_.size.x, desc_.size.y);
}

void Target::resolve() const {
  if (!multisampled_) return;
  glBindFramebuffer(GL_READ_FRAMEBUFFER, multisampled_.get());
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_.get());
  glBlitFramebuffer(0, 0, desc_.size.x, desc_.size.y, 0, 0, desc_.size.x, desc_.size.y,
                    GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

ShadowTarget::ShadowTarget(int size, bool smooth)
    : size_(size), texture_(GlTexture::make()), framebuffer_(GlFramebuffer::make()) {
  bind_texture(0, GL_TEXTURE_2D, texture_.get());
  glTexStorage2D(GL_TEXTURE_2D, 1, GL_DEPTH_COMPONENT24, size, size);
  set_filter(GL_TEXTURE_2D, smooth ? GL_LINEAR : GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.get());
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, texture_.get(), 0);
  const GLenum none = GL_NONE;
  glDrawBuffers(1, &none);
}

void ShadowTarget::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.get());
  glViewport(0, 0, size_, size_);
}

}  // namespace draw
