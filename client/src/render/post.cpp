#include "render/post.h"
#include "render/shaders.h"

#include <glm/common.hpp>

namespace client {

tl::expected<Post, std::string> Post::create(draw::Quality quality) {
  Post post;
  post.quality_ = quality;
  post.empty_ = draw::GlVertexArray::make();
  if (quality == draw::Quality::low) return post;
  const auto build = [&](draw::Program& into, std::string_view name) -> std::string {
    auto program =
        draw::Program::build(shader_source, {"fullscreen.vert"}, {"common.glsl", name}, quality);
    if (!program) return program.error();
    into = std::move(*program);
    return {};
  };
  for (const std::string& error :
       {build(post.bright_, "bloom_bright.frag"), build(post.down_, "bloom_down.frag"),
        build(post.up_, "bloom_up.frag"), build(post.present_, "present.frag")}) {
    if (!error.empty()) return tl::unexpected(error);
  }
  return post;
}

void Post::resize(const glm::ivec2& screen) {
  if (screen == screen_) return;
  screen_ = screen;
  if (quality_ == draw::Quality::low) {
    scene_ = draw::Target({.size = glm::max(screen * 2 / 3, 1), .format = GL_RGBA8, .depth = true});
    return;
  }
  scene_ = draw::Target({.size = screen, .samples = 4, .depth = true});
  glm::ivec2 size = screen;
  for (draw::Target& target : small_) {
    size = glm::max(size / 2, 1);
    target = draw::Target({.size = size});
  }
  for (std::size_t i = 0; i < bloom_.size(); ++i)
    bloom_[i] = draw::Target({.size = small_[i].size()});
}

void Post::pass(const draw::Program& program, const draw::Target& to, GLuint image) const {
  to.bind();
  program.use();
  program.set("u_image", 0);
  draw::bind_texture(0, GL_TEXTURE_2D, image);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

void Post::present(const glm::ivec2& screen, int room_below) {
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  scene_.resolve();
  if (quality_ == draw::Quality::low) {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, scene_.framebuffer());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    glBlitFramebuffer(0, 0, scene_.size().x, scene_.size().y, 0, room_below, screen.x,
                      room_below + screen.y, GL_COLOR_BUFFER_BIT, GL_LINEAR);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glViewport(0, room_below, screen.x, screen.y);
    return;
  }
  glBindVertexArray(empty_.get());
  pass(bright_, small_[0], scene_.texture());
  for (std::size_t i = 1; i < small_.size(); ++i) pass(down_, small_[i], small_[i - 1].texture());
  GLuint below = small_.back().texture();
  for (std::size_t i = bloom_.size(); i-- > 0;) {
    up_.use();
    up_.set("u_detail", 1);
    draw::bind_texture(1, GL_TEXTURE_2D, small_[i].texture());
    pass(up_, bloom_[i], below);
    below = bloom_[i].texture();
  }
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, room_below, screen.x, screen.y);
  present_.use();
  present_.set("u_image", 0);
  present_.set("u_bloom", 1);
  draw::bind_texture(0, GL_TEXTURE_2D, scene_.texture());
  draw::bind_texture(1, GL_TEXTURE_2D, below);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace client
