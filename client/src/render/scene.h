// Draws the table in play as a snapshot has it: men, rods, ball, light, shadow, sky, sparks.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "foosball/table.h"
#include "render/camera.h"
#include "render/gpu_mesh.h"
#include "render/particles.h"
#include "render/post.h"
#include "render/sky.h"
#include "wire/snapshot.h"

namespace client {

struct SceneView {
  Camera camera;
  int active_rod = -1;  // lit up; -1: none
  float time = 0.0f;    // [s], for twinkling and pulses
};

class Scene {
 public:
  // Needs a current OpenGL ES 3.0 context. The error is a sentence.
  static tl::expected<std::unique_ptr<Scene>, std::string> create(draw::Quality quality);

  draw::Quality quality() const { return quality_; }
  // Draws to the window's framebuffer of that size, and leaves it bound for the HUD.
  void draw(const wire::Snapshot& state, const SceneView& view, Particles& particles,
            const glm::ivec2& screen);

  // The radius the ball is drawn with: a little larger when high (paper, section 5).
  static float drawn_ball_radius(const foosball::TableSpec& table, float height);

 private:
  explicit Scene(draw::Quality quality) : quality_(quality) {}
  std::string build_programs();
  void build_static_meshes();
  void use_layout(foosball::Layout layout);
  void place_instances(const wire::Snapshot& state, const SceneView& view);
  void draw_shadows() const;
  void draw_standing() const;
  void draw_reflections(const wire::Snapshot& state, const SceneView& view);
  void draw_field(const wire::Snapshot& state, const SceneView& view) const;
  void draw_ball(const wire::Snapshot& state) const;
  void draw_glass(const SceneView& view) const;
  void load_particles(Particles& particles);
  void draw_particles(const Camera& camera, float height) const;
  void light(const draw::Program& program, const Camera& camera, float fade) const;

  static constexpr std::size_t kFigures = foosball::kTeams;
  static constexpr std::size_t kKinds = foosball::kCharacters;

  draw::Quality quality_;
  const foosball::TableSpec* table_ = nullptr;
  draw::Program solid_, depth_, field_, ball_, glass_, particle_;
  Sky sky_;
  Post post_;
  draw::ShadowTarget shadow_;
  glm::mat4 light_matrix_{1.0f};
  GpuMesh body_mesh_, rim_mesh_, glass_mesh_, field_mesh_, ball_mesh_;
  std::array<GpuMesh, foosball::kRods> rod_meshes_;
  std::array<GpuMesh, kKinds> figure_meshes_;  // by character; both teams' men may share one
  std::array<std::vector<Instance>, kKinds> men_;
  draw::GlVertexArray particle_array_;
  draw::GlBuffer particle_buffer_;
  GLsizei particle_count_ = 0;
};

}  // namespace client
