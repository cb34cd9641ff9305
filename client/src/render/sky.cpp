#include "render/sky.h"

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <random>
#include <vector>

#include "draw/target.h"
#include "render/shaders.h"

namespace client {
namespace {

constexpr float kLimb = -0.738f;  // cosine of the planet's radius in sky_bake.frag, downwards

struct Star {
  glm::vec4 direction_brightness;
  glm::vec3 colour;
};

// Columns right, up, outward of each face, in the order and with the orientation of OpenGL.
const glm::mat3 kFaces[6] = {
    {{0, 0, -1}, {0, -1, 0}, {1, 0, 0}}, {{0, 0, 1}, {0, -1, 0}, {-1, 0, 0}},
    {{1, 0, 0}, {0, 0, 1}, {0, 1, 0}},   {{1, 0, 0}, {0, 0, -1}, {0, -1, 0}},
    {{1, 0, 0}, {0, -1, 0}, {0, 0, 1}},  {{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}},
};

}  // namespace

tl::expected<Sky, std::string> Sky::create(draw::Quality quality) {
  auto bake = draw::Program::build(shader_source, {"fullscreen.vert"},
                                   {"common.glsl", "sky_bake.frag"}, quality);
  auto background =
      draw::Program::build(shader_source, {"sky.vert"}, {"common.glsl", "sky.frag"}, quality);
  auto star =
      draw::Program::build(shader_source, {"star.vert"}, {"common.glsl", "star.frag"}, quality);
  for (const auto* program : {&bake, &background, &star}) {
    if (!*program) return tl::unexpected(program->error());
  }
  Sky sky;
  sky.background_ = std::move(*background);
  sky.star_ = std::move(*star);
  sky.empty_ = draw::GlVertexArray::make();
  sky.bake(*bake, quality);
  sky.scatter_stars(quality == draw::Quality::high ? 11000 : 6000);
  return sky;
}

void Sky::bake(const draw::Program& bake, draw::Quality quality) {
  const int face_size = quality == draw::Quality::high ? 768 : 384;
  cube_ = draw::GlTexture::make();
  draw::bind_texture(0, GL_TEXTURE_CUBE_MAP, cube_.get());
  // Only high quality has reflections at every roughness; trilinear filtering is expensive in
  // software.
  const bool mirrored = quality == draw::Quality::high;
  const int levels = mirrored ? 1 + static_cast<int>(std::log2(face_size)) : 1;
  glTexStorage2D(GL_TEXTURE_CUBE_MAP, levels, GL_RGBA8, face_size, face_size);
  glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MIN_FILTER,
                  mirrored ? GL_LINEAR_MIPMAP_LINEAR : GL_LINEAR);
  glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  draw::GlFramebuffer framebuffer = draw::GlFramebuffer::make();
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.get());
  glViewport(0, 0, face_size, face_size);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  bake.use();
  glBindVertexArray(empty_.get());
  for (GLenum face = 0; face < 6; ++face) {
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0,
                           GL_TEXTURE_CUBE_MAP_POSITIVE_X + face, cube_.get(), 0);
    bake.set("u_face", kFaces[face]);
    glDrawArrays(GL_TRIANGLES, 0, 3);
  }
  glGenerateMipmap(GL_TEXTURE_CUBE_MAP);
}

// Few bright ones and many faint, from a fixed seed; cool and warm tints.
void Sky::scatter_stars(int count) {
  std::mt19937 random(20240229);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  std::vector<Star> stars;
  for (int i = 0; i < count; ++i) {
    const float z = 2.0f * unit(random) - 1.0f, turn = glm::two_pi<float>() * unit(random);
    if (z < kLimb) continue;  // the planet hides it
    const float r = std::sqrt(1.0f - z * z), brightness = std::pow(unit(random), 6.0f),
                warm = unit(random);
    stars.push_back({{r * std::cos(turn), r * std::sin(turn), z, brightness},
                     glm::mix(glm::vec3(0.65f, 0.80f, 1.0f), glm::vec3(1.0f, 0.86f, 0.70f), warm)});
  }
  star_count_ = static_cast<GLsizei>(stars.size());
  stars_ = draw::GlVertexArray::make();
  star_buffer_ = draw::GlBuffer::make();
  glBindVertexArray(stars_.get());
  glBindBuffer(GL_ARRAY_BUFFER, star_buffer_.get());
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(stars.size() * sizeof(Star)), stars.data(),
               GL_STATIC_DRAW);
  glVertexAttribPointer(0, 4, GL_FLOAT, GL_FALSE, sizeof(Star), nullptr);
  glVertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, sizeof(Star),
                        reinterpret_cast<const void*>(sizeof(glm::vec4)));
  glEnableVertexAttribArray(0);
  glEnableVertexAttribArray(1);
  glBindVertexArray(0);
}

void Sky::draw(const Camera& camera, float pixel_scale, float time) const {
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glDepthMask(GL_FALSE);
  background_.use();
  draw::bind_texture(0, GL_TEXTURE_CUBE_MAP, cube_.get());
  background_.set("u_sky", 0);
  const glm::mat3 from_view = glm::transpose(glm::mat3(camera.view));
  background_.set("u_ray", glm::mat3(from_view[0] / camera.projection[0][0],
                                     from_view[1] / camera.projection[1][1], -from_view[2]));
  glBindVertexArray(empty_.get());
  glDrawArrays(GL_TRIANGLES, 0, 3);

  const bool perspective = camera.projection[3][3] == 0.0f;  // without perspective, no stars
  if (!perspective) {
    glDepthMask(GL_TRUE);
    glDepthFunc(GL_LESS);
    return;
  }
  star_.use();
  star_.set("u_view_projection", camera.projection * glm::mat4(glm::mat3(camera.view)));
  star_.set("u_pixel_scale", pixel_scale);
  star_.set("u_time", time);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE);
  glBindVertexArray(stars_.get());
  glDrawArrays(GL_POINTS, 0, star_count_);
  glDisable(GL_BLEND);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_LESS);
}

}  // namespace client
