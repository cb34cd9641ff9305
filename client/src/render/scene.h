// Draws a snapshot's table in play: men, rods, ball, light, shadow, sky, sparks.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "client/settings.h"
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
  std::uint8_t active_rods = 0;  // highlighted, by bit
  float time = 0.0f;             // [s], for twinkling and pulses
  RodsShown rods = RodsShown::as_on_the_table;
  bool reduced_flashes = false;      // nothing pulses
  bool distinct_teams = false;       // team 1 wears stripes
  std::array<float, 8> rod_shift{};  // along x, of what is drawn [m]: see shift_scene()
  int room_below = 0;                // [px] of the window below the picture that stay free
};

// The ball is drawn larger with its height in the snapshot (paper, section 5: "a sense of height
// cues"): by a quarter for a hop of 30 mm, never to more than 1 + kMaxBallGrowth.
inline constexpr float kMaxBallGrowth = 0.9f;
inline constexpr float kBallGrowthHeight = 0.090f;  // [m] at which 63% of the growth is reached

// Moves rods, men and ball along x, so that each rod lines up with its handle outside the screen.
// The ball moves with the rods next to it, so that touching bodies still touch.
void shift_scene(wire::Snapshot& state, const std::array<float, 8>& rod_shift);

// A scored ball lies in the goal until the next serve; a ball out of play is not drawn.
bool ball_is_seen(const wire::Snapshot& state);

// Nobody drives the rod: a warning for those who play. False in a recording, which does not store
// who drives a rod: a computer player's two hands leave its other rods all the time.
bool rod_is_held(const wire::RodSnapshot& rod);

class Scene {
 public:
  // Needs a current OpenGL ES 3.0 context. The error is a sentence.
  static tl::expected<std::unique_ptr<Scene>, std::string> create(draw::Quality quality);

  draw::Quality quality() const { return quality_; }
  // Draws to the window's framebuffer of that size, and leaves it bound for the HUD.
  void draw(const wire::Snapshot& state, const SceneView& view, Particles& particles,
            const glm::ivec2& screen);

  // Sets the match's characters, at least one; the built-in ones until this is called. Replaces the
  // portraits.
  void set_characters(const foosball::Characters& characters);
  // Each character in both teams' colours: columns by character, rows by team, with a transparent
  // background. Drawn once; the texture is valid until set_characters() or the end of the scene.
  GLuint portraits();
  glm::ivec2 portrait_cells() const {
    return {static_cast<int>(characters_.size()), foosball::kTeams};
  }

  // Fraction of the ball that is visible between men and rods, 0..1; overwrites the target. 1 if
  // there is no ball.
  float ball_visibility(const wire::Snapshot& state, const SceneView& view,
                        const glm::ivec2& screen);

  // The drawn radius of the ball at that height of its centre [m].
  static float drawn_ball_radius(const foosball::TableSpec& table, float height);

 private:
  explicit Scene(draw::Quality quality) : quality_(quality) {}
  std::string build_programs();
  void build_static_meshes();
  void build_figures(bool stripes);
  void use_layout(foosball::Layout layout);
  void set_active_lanes(const SceneView& view) const;
  void place_instances(const wire::Snapshot& state, const SceneView& view);
  void draw_shadows() const;
  void draw_standing() const;
  void see_through(const wire::Snapshot& state, const Camera& camera, const glm::ivec2& size);
  void draw_reflections(const wire::Snapshot& state, const SceneView& view);
  void draw_field(const wire::Snapshot& state, const SceneView& view) const;
  void draw_ball(const wire::Snapshot& state) const;
  void draw_glass(const SceneView& view) const;
  void load_particles(Particles& particles);
  void draw_particles(const Camera& camera, float height) const;
  void light(const draw::Program& program, const Camera& camera, float fade) const;

  static constexpr std::size_t kFigures = foosball::kTeams;
  // Team 1 has another crest, and stripes if requested: one mesh for each pair of team and
  // character.
  std::size_t kinds() const { return foosball::kTeams * characters_.size(); }

  draw::Quality quality_;
  const foosball::TableSpec* table_ = nullptr;
  draw::Program solid_, depth_, field_, ball_, glass_, particle_;
  Sky sky_;
  Post post_;
  draw::ShadowTarget shadow_;
  glm::mat4 light_matrix_{1.0f};
  std::optional<draw::Target> portraits_;
  GpuMesh body_mesh_, rim_mesh_, bearings_mesh_, glass_mesh_, field_mesh_, ball_mesh_;
  std::array<GpuMesh, foosball::kRods> rod_meshes_;
  foosball::Characters characters_ = foosball::built_in_characters();
  std::vector<GpuMesh> figure_meshes_;  // by team, then character
  bool stripes_ = false, rods_drawn_ = true;
  std::vector<std::vector<Instance>> men_;  // in the same order
  draw::GlVertexArray particle_array_;
  draw::GlBuffer particle_buffer_;
  GLsizei particle_count_ = 0;
};

}  // namespace client
