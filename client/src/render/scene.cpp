#include "render/scene.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

#include "render/figure_mesh.h"
#include "render/mesh_builder.h"
#include "render/palette.h"
#include "render/shaders.h"
#include "render/table_mesh.h"
#include "wire/enums.h"

namespace client {
namespace {

const glm::vec3 kKeyDirection = glm::normalize(glm::vec3(-0.42f, -0.04f, 0.90f));
const glm::vec3 kKeyColour{3.5f, 3.35f, 3.1f};
const glm::vec3 kHeldColour{0.95f, 0.62f, 0.08f};
// Decay of reflected light with height [1/m]: the turf is not glass, so only low objects are clear.
constexpr float kMirrorFade = 13.0f;
constexpr float kLightReach = 1.0f;  // [m]: the table fits into the light's box

glm::vec3 vec(const std::array<float, 3>& a) {
  return {a[0], a[1], a[2]};
}
glm::quat quat(const std::array<float, 4>& q) {
  return {q[3], q[0], q[1], q[2]};
}

glm::mat4 pose(const wire::PoseVelocity& body) {
  glm::mat4 m = glm::mat4_cast(quat(body.orientation));
  m[3] = glm::vec4(vec(body.position), 1.0f);
  return m;
}

// Mirrored at the field plane, for the field's reflections.
Camera mirrored(const Camera& camera) {
  const glm::mat4 flip = glm::scale(glm::mat4(1.0f), glm::vec3(1, 1, -1));
  Camera below = camera;
  below.eye.z = -camera.eye.z;
  below.view = camera.view * flip;
  below.view_projection = camera.view_projection * flip;
  return below;
}

// The key light's camera: a box around the table.
glm::mat4 light_matrix() {
  const glm::mat4 view = glm::lookAt(2.0f * kKeyDirection, glm::vec3(0), glm::vec3(0, 1, 0));
  return glm::ortho(-kLightReach, kLightReach, -0.72f * kLightReach, 0.72f * kLightReach, 1.0f,
                    3.0f) *
         view;
}

const glm::mat4 kTextureFromClip{
    {0.5f, 0, 0, 0}, {0, 0.5f, 0, 0}, {0, 0, 0.5f, 0}, {0.5f, 0.5f, 0.5f, 1}};

}  // namespace

float Scene::drawn_ball_radius(const foosball::TableSpec& table, float height) {
  const auto radius = static_cast<float>(table.ball_radius);
  const float above = std::max(height - radius, 0.0f);
  return radius * (1.0f + kMaxBallGrowth * (1.0f - std::exp(-above / kBallGrowthHeight)));
}

bool ball_is_seen(const wire::Snapshot& state) {
  return state.ball_in_play || state.ball_visible;
}

bool rod_is_held(const wire::RodSnapshot& rod) {
  return rod.status == number(wire::RodStatus::held) &&
         rod.source != number(wire::RodSource::replay);
}

void shift_scene(wire::Snapshot& state, const std::array<float, 8>& rod_shift) {
  const auto& table = foosball::table_spec(static_cast<foosball::Layout>(state.layout));
  for (wire::ManState& man : state.men)
    man.body.position[0] += rod_shift[std::min<std::size_t>(man.rod, 7)];
  // Between two rods interpolates their shifts; beyond the outermost rod decays to zero at the goal
  // line.
  const auto line = static_cast<float>(0.5 * table.length);
  float from = -line, shift_from = 0.0f;
  const float x = std::clamp(state.ball.position[0], -line, line);
  for (std::size_t rod = 0; rod <= rod_shift.size(); ++rod) {
    const float to = rod < rod_shift.size() ? static_cast<float>(table.rods[rod].x) : line;
    const float shift_to = rod < rod_shift.size() ? rod_shift[rod] : 0.0f;
    if (x <= to) {
      const float share = (x - from) / (to - from);
      state.ball.position[0] += shift_from + share * (shift_to - shift_from);
      return;
    }
    from = to;
    shift_from = shift_to;
  }
}

tl::expected<std::unique_ptr<Scene>, std::string> Scene::create(draw::Quality quality) {
  std::unique_ptr<Scene> scene(new Scene(quality));
  if (const std::string error = scene->build_programs(); !error.empty())
    return tl::unexpected(error);
  auto sky = Sky::create(quality);
  if (!sky) return tl::unexpected(sky.error());
  scene->sky_ = std::move(*sky);
  auto post = Post::create(quality);
  if (!post) return tl::unexpected(post.error());
  scene->post_ = std::move(*post);
  scene->shadow_ = quality == draw::Quality::high ? draw::ShadowTarget(2048, true)
                                                  : draw::ShadowTarget(768, false);
  scene->light_matrix_ = light_matrix();
  scene->build_static_meshes();
  scene->use_layout(foosball::Layout::tournament);
  return scene;
}

std::string Scene::build_programs() {
  struct Wanted {
    draw::Program* program;
    std::initializer_list<std::string_view> vertex, fragment;
  };
  const Wanted wanted[] = {
      {&solid_,
       {"lighting.glsl", "solid.glsl", "solid.vert"},
       {"common.glsl", "lighting.glsl", "solid.glsl", "solid.frag"}},
      {&depth_, {"depth.vert"}, {"depth.frag"}},
      {&field_, {"field.vert"}, {"common.glsl", "lighting.glsl", "field.frag"}},
      {&ball_, {"ball.vert"}, {"common.glsl", "lighting.glsl", "ball.frag"}},
      {&glass_, {"glass.vert"}, {"common.glsl", "glass.frag"}},
      {&particle_, {"particle.vert"}, {"common.glsl", "particle.frag"}},
  };
  for (const Wanted& w : wanted) {
    auto program = draw::Program::build(shader_source, w.vertex, w.fragment, quality_);
    if (!program) return program.error();
    *w.program = std::move(*program);
  }
  return {};
}

void Scene::build_static_meshes() {
  const float detail = quality_ == draw::Quality::high ? 1.0f : 0.4f;
  build_figures(stripes_);
  MeshBuilder ball(detail);
  ball.ellipsoid(glm::vec3(0), glm::vec3(1), 32, 20);
  ball_mesh_ = GpuMesh(ball.take());
  particle_array_ = draw::GlVertexArray::make();
  particle_buffer_ = draw::GlBuffer::make();
  glBindVertexArray(particle_array_.get());
  glBindBuffer(GL_ARRAY_BUFFER, particle_buffer_.get());
  glVertexAttribPointer(0, 4, GL_FLOAT, GL_FALSE, sizeof(ParticleVertex), nullptr);
  glVertexAttribPointer(1, 4, GL_FLOAT, GL_FALSE, sizeof(ParticleVertex),
                        reinterpret_cast<const void*>(sizeof(glm::vec4)));
  glEnableVertexAttribArray(0);
  glEnableVertexAttribArray(1);
  glBindVertexArray(0);
}

void Scene::build_figures(bool stripes) {
  stripes_ = stripes;
  const float detail = quality_ == draw::Quality::high ? 1.0f : 0.4f;
  const auto rod_radius =
      static_cast<float>(foosball::table_spec(foosball::Layout::tournament).rod_radius);
  figure_meshes_.clear();
  for (int team = 0; team < foosball::kTeams; ++team) {
    for (const foosball::Character& c : characters_) {
      figure_meshes_.emplace_back(figure_mesh(foosball::boxes_of(c.body), rod_radius,
                                              figure_look(c.look, team, stripes), detail));
    }
  }
  men_.resize(kinds());
}

void Scene::set_characters(const foosball::Characters& characters) {
  characters_ = characters;
  portraits_.reset();
  build_figures(stripes_);
}

void Scene::use_layout(foosball::Layout layout) {
  const foosball::TableSpec& table = foosball::table_spec(layout);
  if (table_ == &table) return;
  table_ = &table;
  const float detail = quality_ == draw::Quality::high ? 1.0f : 0.4f;
  body_mesh_ = GpuMesh(body_mesh(table, detail));
  rim_mesh_ = GpuMesh(rim_mesh(table, detail));
  bearings_mesh_ = GpuMesh(bearings_mesh(table, detail));
  for (GpuMesh* mesh : {&body_mesh_, &rim_mesh_, &bearings_mesh_})
    mesh->set_instances(std::array{make_instance(glm::mat4(1.0f), glm::vec3(1), 0)});
  glass_mesh_ = GpuMesh(glass_mesh(table));
  field_mesh_ = GpuMesh(field_mesh(table));
  for (int rod = 0; rod < foosball::kRods; ++rod) {
    rod_meshes_[static_cast<std::size_t>(rod)] = GpuMesh(rod_mesh(table, rod, detail));
  }
}

// A band of light on the field under each active rod, as many as the shader supports.
void Scene::set_active_lanes(const SceneView& view) const {
  constexpr std::array<const char*, 4> kLanes{"u_active_rods[0]", "u_active_rods[1]",
                                              "u_active_rods[2]", "u_active_rods[3]"};
  const float pulse = view.reduced_flashes ? 0.0f : 0.15f * std::sin(4.0f * view.time);
  std::size_t lane = 0;
  for (std::size_t rod = 0; rod < table_->rods.size() && lane < kLanes.size(); ++rod) {
    if ((view.active_rods >> rod & 1) == 0) continue;
    const float x = static_cast<float>(table_->rods[rod].x) + view.rod_shift[rod];
    field_.set(kLanes[lane++], glm::vec2(x, 0.85f + pulse));
  }
  while (lane < kLanes.size()) field_.set(kLanes[lane++], glm::vec2(0.0f));
}

void Scene::place_instances(const wire::Snapshot& state, const SceneView& view) {
  const auto glow = [&](std::size_t rod) {
    if ((view.active_rods >> rod & 1) == 0) return 0.0f;
    return 0.30f + (view.reduced_flashes ? 0.0f : 0.08f * std::sin(4.0f * view.time));
  };
  // Above 1 it is striped too.
  const auto rod_glow = [&](std::size_t rod) { return glow(rod) > 0.0f ? 1.0f + glow(rod) : 0.0f; };
  const auto tint = [&](std::size_t rod) {
    const glm::vec3& team = kTeamColour[static_cast<std::size_t>(table_->rods[rod].team)];
    return rod_is_held(state.rods[rod]) ? glm::mix(team, kHeldColour, 0.35f) : team;
  };
  for (std::size_t rod = 0; rod < rod_meshes_.size(); ++rod) {
    const foosball::RodSpec& spec = table_->rods[rod];
    glm::mat4 m = glm::rotate(glm::mat4(1.0f), state.rods[rod].angle, glm::vec3(0, 1, 0));
    m[3] = {static_cast<float>(spec.x) + view.rod_shift[rod], state.rods[rod].slide,
            static_cast<float>(table_->rod_height), 1.0f};
    rod_meshes_[rod].set_instances(std::array{make_instance(m, tint(rod), rod_glow(rod))});
  }
  for (auto& men : men_) men.clear();
  static const glm::mat4 kFacingBack =
      glm::rotate(glm::mat4(1.0f), glm::radians(180.0f), glm::vec3(0, 0, 1));
  for (const wire::ManState& man : state.men) {
    const std::size_t rod = std::min<std::size_t>(man.rod, foosball::kRods - 1);
    const auto team = static_cast<std::size_t>(table_->rods[rod].team);
    const std::size_t kind = team * characters_.size() +
                             std::min<std::size_t>(state.character[team], characters_.size() - 1);
    const glm::mat4 m = team == 1 ? pose(man.body) * kFacingBack : pose(man.body);
    men_[kind].push_back(make_instance(m, tint(rod), glow(rod)));
  }
  for (std::size_t kind = 0; kind < kinds(); ++kind) figure_meshes_[kind].set_instances(men_[kind]);
}

// Everything on the field or around it.
void Scene::draw_standing() const {
  rim_mesh_.draw();
  if (rods_drawn_) {
    bearings_mesh_.draw();
    for (const GpuMesh& rod : rod_meshes_) rod.draw();
  }
  for (const GpuMesh& figures : figure_meshes_) figures.draw();
}

void Scene::draw_shadows() const {
  shadow_.bind();
  glClear(GL_DEPTH_BUFFER_BIT);
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(1.5f, 2.0f);
  depth_.use();
  depth_.set("u_light_matrix", light_matrix_);
  draw_standing();
  glDisable(GL_POLYGON_OFFSET_FILL);
}

void Scene::light(const draw::Program& program, const Camera& camera, float fade) const {
  program.use();
  program.set("u_view_projection", camera.view_projection);
  program.set("u_shadow_matrix", kTextureFromClip * light_matrix_);
  program.set("u_eye", camera.eye);
  program.set("u_fade", fade);
  program.set("u_key_direction", kKeyDirection);
  program.set("u_key_colour", kKeyColour);
  program.set("u_shadow_map", 1);
  program.set("u_sky", 2);
}

void Scene::draw_field(const wire::Snapshot& state, const SceneView& view) const {
  light(field_, view.camera, 0.0f);
  field_.set("u_half_field", 0.5f * glm::vec2(table_->length, table_->width));
  field_.set("u_goal_width", static_cast<float>(table_->goal_width));
  field_.set("u_team_colour[0]", kTeamColour[0]);
  field_.set("u_team_colour[1]", kTeamColour[1]);
  field_.set("u_team_lamp[0]", kTeamLamp[0]);
  field_.set("u_team_lamp[1]", kTeamLamp[1]);
  const auto radius = static_cast<float>(table_->ball_radius);
  field_.set("u_ball", glm::vec4(vec(state.ball.position), ball_is_seen(state) ? radius : 0.0f));
  set_active_lanes(view);
  // Blended over the reflections already drawn; alpha is their fraction.
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_SRC_ALPHA);
  field_mesh_.draw();
  glDisable(GL_BLEND);
}

// Drawn mirrored before all else, without its depth: the field is drawn over it, and the table and
// the sky cover what lies outside the field.
void Scene::draw_reflections(const wire::Snapshot& state, const SceneView& view) {
  const Camera below = mirrored(view.camera);
  glFrontFace(GL_CW);
  light(solid_, below, kMirrorFade);
  draw_standing();
  light(ball_, below, kMirrorFade);
  draw_ball(state);
  glFrontFace(GL_CCW);
  draw_particles(below, static_cast<float>(post_.scene().size().y));
  glClear(GL_DEPTH_BUFFER_BIT);
}

void Scene::draw_ball(const wire::Snapshot& state) const {
  if (!ball_is_seen(state)) return;
  const float radius = drawn_ball_radius(*table_, state.ball.position[2]);
  ball_.set("u_model", pose(state.ball) * glm::scale(glm::mat4(1.0f), glm::vec3(radius)));
  ball_mesh_.draw();
}

// Makes men and rods between the eye and the ball transparent: two of three of their pixels in
// front of the ball are discarded (solid.frag). A drawn ball is located by its position on the
// target.
void Scene::see_through(const wire::Snapshot& state, const Camera& camera, const glm::ivec2& size) {
  solid_.use();
  glm::vec4 disc(0.0f);
  if (ball_is_seen(state)) {
    const glm::vec3 at = vec(state.ball.position);
    const float radius = drawn_ball_radius(*table_, at.z);
    const glm::vec4 clip = camera.view_projection * glm::vec4(at, 1.0f);
    const glm::vec3 near = camera.project(at, size);
    const float pixels =
        0.5f * static_cast<float>(size.y) * camera.projection[1][1] * radius / clip.w;
    disc = {near.x, static_cast<float>(size.y) - near.y, 1.12f * pixels,
            0.5f + 0.5f * clip.z / clip.w};
  }
  solid_.set("u_see_through", disc);
}

GLuint Scene::portraits() {
  if (portraits_) return portraits_->texture();
  constexpr glm::ivec2 kCell{200, 250};  // [px]
  auto program = draw::Program::build(shader_source, {"lighting.glsl", "solid.glsl", "solid.vert"},
                                      {"common.glsl", "lighting.glsl", "solid.glsl", "solid.frag"},
                                      draw::Quality::low);  // writes display colours directly
  if (!program) return 0;
  shadow_.bind();
  glClear(GL_DEPTH_BUFFER_BIT);
  portraits_.emplace(
      draw::TargetDesc{.size = kCell * portrait_cells(), .format = GL_RGBA8, .depth = true});
  portraits_->bind();
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_CULL_FACE);
  draw::bind_texture(1, GL_TEXTURE_2D, shadow_.texture());
  draw::bind_texture(2, GL_TEXTURE_CUBE_MAP, sky_.cube());
  // Head and shoulders, 53 mm of the man, a little from the side: faces, headgear and build
  // distinguish the characters at the size of a thumb.
  Camera camera;
  camera.eye = {0.30f, -0.12f, 0.06f};
  camera.view = glm::lookAt(camera.eye, glm::vec3(0.0f, 0.0f, 0.029f), glm::vec3(0, 0, 1));
  camera.projection = glm::perspective(0.163f, 0.8f, 0.05f, 2.0f);
  camera.view_projection = camera.projection * camera.view;
  light(*program, camera, 0.0f);
  program->set("u_see_through", glm::vec4(0.0f));
  for (std::size_t kind = 0; kind < kinds(); ++kind) {
    const auto team = static_cast<int>(kind / characters_.size());
    const auto column = static_cast<int>(kind % characters_.size());
    const foosball::Character& c = characters_[kind % characters_.size()];
    glViewport(column * kCell.x, team * kCell.y, kCell.x, kCell.y);
    GpuMesh figure(
        figure_mesh(foosball::boxes_of(c.body), 0.008f, figure_look(c.look, team, stripes_), 1.0f));
    figure.set_instances(std::array{
        make_instance(glm::mat4(1.0f), kTeamColour[static_cast<std::size_t>(team)], 0.15f)});
    figure.draw();
  }
  glDisable(GL_CULL_FACE);
  return portraits_->texture();
}

float Scene::ball_visibility(const wire::Snapshot& state, const SceneView& view,
                             const glm::ivec2& screen) {
  if (!ball_is_seen(state)) return 1.0f;
  use_layout(static_cast<foosball::Layout>(state.layout));
  post_.resize(screen);
  place_instances(state, view);
  rods_drawn_ = rods_are_drawn(view.rods, table_->layout);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glEnable(GL_CULL_FACE);
  const draw::Target target({.size = screen, .format = GL_RGBA8, .depth = true});
  const auto lit_pixels = [&](bool between) {
    target.bind();
    glClearColor(0, 0, 0, 1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    if (between) {
      light(solid_, view.camera, 0.0f);
      see_through(state, view.camera, screen);
      draw_standing();
      glClear(GL_COLOR_BUFFER_BIT);
    }
    light(ball_, view.camera, 0.0f);
    draw_ball(state);
    std::vector<std::uint8_t> pixels(static_cast<std::size_t>(screen.x * screen.y) * 4);
    glReadPixels(0, 0, screen.x, screen.y, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
    int count = 0;
    for (std::size_t i = 0; i < pixels.size(); i += 4)
      count += pixels[i] + pixels[i + 1] + pixels[i + 2] > 12;
    return count;
  };
  const int all = lit_pixels(false);
  return all == 0 ? 1.0f : static_cast<float>(lit_pixels(true)) / static_cast<float>(all);
}

void Scene::draw_glass(const SceneView& view) const {
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glDepthMask(GL_FALSE);
  glass_.use();
  glass_.set("u_view_projection", view.camera.view_projection);
  glass_.set("u_eye", view.camera.eye);
  glass_.set("u_top", static_cast<float>(table_->wall_height));
  glass_.set("u_team_lamp[0]", kTeamLamp[0]);
  glass_.set("u_team_lamp[1]", kTeamLamp[1]);
  glass_mesh_.draw();
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
}

void Scene::load_particles(Particles& particles) {
  const std::vector<ParticleVertex>& vertices = particles.vertices();
  particle_count_ = static_cast<GLsizei>(vertices.size());
  glBindBuffer(GL_ARRAY_BUFFER, particle_buffer_.get());
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(ParticleVertex)),
               vertices.data(), GL_STREAM_DRAW);
}

void Scene::draw_particles(const Camera& camera, float height) const {
  if (particle_count_ == 0) return;
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE);
  glDepthMask(GL_FALSE);
  particle_.use();
  particle_.set("u_view_projection", camera.view_projection);
  particle_.set("u_pixels_per_unit", 0.5f * height * camera.projection[1][1]);
  glBindVertexArray(particle_array_.get());
  glDrawArrays(GL_POINTS, 0, particle_count_);
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
}

void Scene::draw(const wire::Snapshot& state, const SceneView& view, Particles& particles,
                 const glm::ivec2& screen) {
  use_layout(static_cast<foosball::Layout>(state.layout));
  post_.resize(screen);
  if (view.distinct_teams != stripes_) build_figures(view.distinct_teams);
  rods_drawn_ = rods_are_drawn(view.rods, table_->layout);
  place_instances(state, view);
  load_particles(particles);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glEnable(GL_CULL_FACE);
  draw_shadows();

  post_.scene().bind();
  glClearColor(0, 0, 0, 1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  draw::bind_texture(1, GL_TEXTURE_2D, shadow_.texture());
  draw::bind_texture(2, GL_TEXTURE_CUBE_MAP, sky_.cube());
  draw_reflections(state, view);
  light(solid_, view.camera, 0.0f);
  see_through(state, view.camera, post_.scene().size());
  draw_standing();
  solid_.set("u_see_through", glm::vec4(0.0f));
  light(ball_, view.camera, 0.0f);
  draw_ball(state);
  draw_field(state, view);
  solid_.use();
  body_mesh_.draw();
  const auto height = static_cast<float>(post_.scene().size().y);
  sky_.draw(view.camera, height / 720.0f, view.time);
  draw_glass(view);
  draw_particles(view.camera, height);
  glDisable(GL_CULL_FACE);
  post_.present(screen, view.room_below);
}

}  // namespace client
