#include "view/scene_view.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <optional>

#include "view/debug_marks.h"
#include "view/palette.h"
#include "view/see_through.h"
#include "view/shaders.h"
#include "view/shadow_fit.h"

namespace sandbox {
namespace {

constexpr std::size_t kWatched = 96;   // number of bodies tested for walls in front of them
constexpr float kShadowAround = 2.2f;  // in camera distances; no shadows are cast from farther away
constexpr float kHaze = 0.04f;         // extinction of light per camera distance
constexpr double kGroundReach = 50.0;  // in camera distances

// Marks: points have a size relative to the bodies, within legible limits.
constexpr double kPoint = 0.2;                           // of a body's size
constexpr double kSmallestPoint = 3.0;                   // [px]
constexpr double kLargestPoint = 0.012, kLine = 0.0025;  // of the picture's height

const glm::mat4 kTextureFromClip{
    {0.5f, 0, 0, 0}, {0, 0.5f, 0, 0}, {0, 0, 0.5f, 0}, {0.5f, 0.5f, 0.5f, 1}};

glm::vec3 narrow(const vp::Vec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

std::optional<ShapeKind> kind_of(const vp::Shape& shape) {
  if (std::holds_alternative<vp::Box>(shape)) return ShapeKind::box;
  if (std::holds_alternative<vp::Sphere>(shape)) return ShapeKind::sphere;
  if (std::holds_alternative<vp::Capsule>(shape)) return ShapeKind::capsule;
  if (std::holds_alternative<vp::Cylinder>(shape)) return ShapeKind::cylinder;
  if (std::holds_alternative<vp::Cone>(shape)) return ShapeKind::cone;
  return std::nullopt;
}

glm::vec4 colour_of(const Piece& piece, std::size_t index, const Simulation& simulation,
                    Colouring colouring) {
  if (piece.motion == scenes::Motion::fixed) return kFixedColour;
  if (simulation.grip() && simulation.grip()->body == piece.body) return kHeldColour;
  if (colouring == Colouring::speed)
    return speed_colour(norm(simulation.world().velocity(piece.body).v));
  return piece.motion == scenes::Motion::kinematic ? kKinematicColour : body_colour(index);
}

double radius_of(const Instance& instance) {
  return glm::length(glm::vec3(instance.stretch)) + instance.stretch.w;
}

}  // namespace

tl::expected<std::unique_ptr<SceneView>, std::string> SceneView::create(draw::Quality quality) {
  std::unique_ptr<SceneView> view(new SceneView(quality));
  if (const std::string error = view->build_programs(); !error.empty())
    return tl::unexpected(error);
  auto marks = Marks::create(quality);
  if (!marks) return tl::unexpected(marks.error());
  view->marks_ = std::move(*marks);
  const bool high = quality == draw::Quality::high;
  view->shadow_ = draw::ShadowTarget(high ? 4096 : 1536, true);
  for (int kind = 0; kind < kShapeKinds; ++kind) {
    view->meshes_[static_cast<std::size_t>(kind)] =
        InstancedMesh(shape_mesh(static_cast<ShapeKind>(kind), high ? 1.0f : 0.5f));
  }
  view->ghost_mesh_ = InstancedMesh(shape_mesh(ShapeKind::box, 1.0f));
  view->empty_ = draw::GlVertexArray::make();
  view->square_ = draw::GlVertexArray::make();
  view->square_corners_ = draw::GlBuffer::make();
  constexpr std::array<glm::vec2, 4> kCorners{{{-1, -1}, {1, -1}, {-1, 1}, {1, 1}}};
  glBindVertexArray(view->square_.get());
  glBindBuffer(GL_ARRAY_BUFFER, view->square_corners_.get());
  glBufferData(GL_ARRAY_BUFFER, sizeof kCorners, kCorners.data(), GL_STATIC_DRAW);
  glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, sizeof(glm::vec2), nullptr);
  glEnableVertexAttribArray(0);
  glBindVertexArray(0);
  return view;
}

std::string SceneView::build_programs() {
  struct Wanted {
    draw::Program* program;
    std::initializer_list<std::string_view> vertex, fragment;
  };
  const Wanted wanted[] = {
      {&body_, {"body.vert"}, {"common.glsl", "body.frag"}},
      {&depth_, {"body.vert"}, {"depth.frag"}},
      {&ground_, {"ground.vert"}, {"common.glsl", "ground.frag"}},
      {&ghost_, {"body.vert"}, {"ghost.frag"}},
      {&sky_, {"sky.vert"}, {"common.glsl", "sky.frag"}},
  };
  for (const Wanted& w : wanted) {
    auto program = draw::Program::build(shader_source, w.vertex, w.fragment, quality_);
    if (!program) return program.error();
    *w.program = std::move(*program);
  }
  return {};
}

glm::vec3 SceneView::seen(const vp::Vec3& world) const {
  return narrow(world - origin_);
}

// Null: the shape is of another kind.
template <class T>
std::vector<Instance>* SceneView::instances_of(const vp::Shape& shape,
                                               ShapeMesh (*mesh)(const T&)) {
  const T* own = std::get_if<T>(&shape);
  if (own == nullptr) return nullptr;
  for (Built& known : built_) {
    const T* other = std::get_if<T>(&known.shape);
    if (other == nullptr || other->data() != own->data()) continue;
    if constexpr (requires { own->scale(); }) {
      if (!(other->scale() == own->scale())) continue;
    }
    return &known.instances;
  }
  built_.push_back({shape, InstancedMesh(mesh(*own)), {}});
  return &built_.back().instances;
}

void SceneView::add(const vp::Shape& shape, const vp::SE3& T, const glm::vec4& colour) {
  if (!vp::is_finite(T.position()) || !vp::is_finite(T.rotation().cx)) return;
  if (std::holds_alternative<vp::HalfSpace>(shape)) {
    grounds_.push_back(T);
    return;
  }
  const vp::Mat3& R = T.rotation();
  const glm::vec3 p = seen(T.position());
  Instance instance;
  for (int i = 0; i < 3; ++i) instance.row[i] = {narrow({R.cx[i], R.cy[i], R.cz[i]}), p[i]};
  instance.stretch = stretch_of(shape);
  instance.colour = colour;
  if (const auto kind = kind_of(shape)) {
    instances_[static_cast<std::size_t>(*kind)].push_back(instance);
    return;
  }
  std::vector<Instance>* of_shape = instances_of<vp::ConvexHull>(shape, hull_mesh);
  if (!of_shape) of_shape = instances_of<vp::TriangleMesh>(shape, surface_mesh);
  if (!of_shape) of_shape = instances_of<vp::HeightField>(shape, surface_mesh);
  if (of_shape) of_shape->push_back(instance);
}

// Fixed boxes that hide moving bodies from the eye become transparent ghosts without a shadow.
void SceneView::gather(const Simulation& simulation, const OrbitCamera& camera,
                       const ViewOptions& options) {
  for (auto& list : instances_) list.clear();
  for (Built& built : built_) built.instances.clear();
  ghosts_.clear();
  grounds_.clear();
  const std::span<const Piece> pieces = simulation.pieces();
  std::vector<vp::Vec3> watched;
  const std::size_t stride = 1 + pieces.size() / kWatched;
  for (std::size_t i = 0; i < pieces.size(); i += stride) {
    if (pieces[i].body && pieces[i].motion == scenes::Motion::dynamic)
      watched.push_back(simulation.world().pose(pieces[i].body).position());
  }
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (!pieces[i].body) continue;
    const vp::SE3 T = simulation.world().pose(pieces[i].body);
    const glm::vec4 colour = colour_of(pieces[i], i, simulation, options.colouring);
    for (const Piece::Part& part : pieces[i].parts) {
      const vp::SE3 T_world_part = T * part.T_body_part;
      const auto* box = std::get_if<vp::Box>(&part.shape);
      if (pieces[i].motion == scenes::Motion::fixed && box != nullptr &&
          hides_many(*box, T_world_part, camera.eye(), watched)) {
        auto& boxes = instances_[static_cast<std::size_t>(ShapeKind::box)];
        add(part.shape, T_world_part, colour);
        ghosts_.push_back(boxes.back());
        boxes.pop_back();
      } else {
        add(part.shape, T_world_part, colour);
      }
    }
  }
}

void SceneView::upload() {
  for (std::size_t kind = 0; kind < meshes_.size(); ++kind)
    meshes_[kind].set_instances(instances_[kind]);
  for (Built& built : built_) built.mesh.set_instances(built.instances);
  ghost_mesh_.set_instances(ghosts_);
}

void SceneView::draw_bodies(int& calls) const {
  for (std::size_t kind = 0; kind < meshes_.size(); ++kind) {
    if (instances_[kind].empty()) continue;
    meshes_[kind].draw();
    ++calls;
  }
  for (const Built& built : built_) {
    if (built.instances.empty()) continue;
    built.mesh.draw();
    ++calls;
  }
}

void SceneView::draw(const Simulation& simulation, const OrbitCamera& camera,
                     const ViewOptions& options, const glm::ivec2& screen) {
  if (screen != screen_) {
    screen_ = screen;
    target_ = draw::Target({.size = screen,
                            .format = GL_RGBA8,
                            .samples = quality_ == draw::Quality::high ? 4 : 0,
                            .depth = true});
  }
  origin_ = camera.target();
  view_projection_ = camera.projection(screen) * camera.view();
  draw_calls_ = 0;
  gather(simulation, camera, options);
  upload();
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glEnable(GL_CULL_FACE);
  draw_shadow(camera, options.shadows);
  target_.bind();
  glClear(GL_DEPTH_BUFFER_BIT);
  draw::bind_texture(1, GL_TEXTURE_2D, shadow_.texture());
  light(body_, camera);
  draw_bodies(draw_calls_);
  draw_grounds(camera);
  draw_sky(camera);
  draw_ghosts(camera);
  glDisable(GL_CULL_FACE);
  draw_marks(simulation, camera, options.marks);
  glDisable(GL_DEPTH_TEST);
  target_.resolve();
  glBindFramebuffer(GL_READ_FRAMEBUFFER, target_.framebuffer());
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  glBlitFramebuffer(0, 0, screen.x, screen.y, 0, 0, screen.x, screen.y, GL_COLOR_BUFFER_BIT,
                    GL_NEAREST);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, screen.x, screen.y);
}

void SceneView::draw_shadow(const OrbitCamera& camera, bool wanted) {
  std::vector<Caster> casters;
  const auto cast = [&](const std::vector<Instance>& instances) {
    for (const Instance& i : instances) {
      casters.push_back({{i.row[0].w, i.row[1].w, i.row[2].w}, static_cast<float>(radius_of(i))});
    }
  };
  for (const auto& list : instances_) cast(list);
  for (const Built& built : built_) cast(built.instances);
  const ShadowFit fit = fit_shadow(casters, kShadowAround * static_cast<float>(camera.distance()));
  shadow_matrix_ = kTextureFromClip * fit.matrix;
  shadow_texel_ = fit.width / static_cast<float>(shadow_.size());
  shadow_.bind();
  glClear(GL_DEPTH_BUFFER_BIT);
  if (!wanted) return;
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(1.5f, 2.0f);
  depth_.use();
  depth_.set("u_view_projection", fit.matrix);
  draw_bodies(draw_calls_);
  glDisable(GL_POLYGON_OFFSET_FILL);
}

void SceneView::light(const draw::Program& program, const OrbitCamera& camera) const {
  program.use();
  program.set("u_view_projection", view_projection_);
  program.set("u_eye", narrow(camera.eye() - origin_));
  program.set("u_sun_direction", kSunDirection);
  program.set("u_shadow_matrix", shadow_matrix_);
  program.set("u_shadow_texel", shadow_texel_);
  program.set("u_shadow_map", 1);
  program.set("u_haze", kHaze / static_cast<float>(camera.distance()));
}

// The pattern is fixed in the world, wherever the target is; computed in double precision.
void SceneView::draw_grounds(const OrbitCamera& camera) {
  constexpr double kPattern = 10.0;  // [m]
  light(ground_, camera);
  glBindVertexArray(square_.get());
  for (const vp::SE3& T : grounds_) {
    const vp::Vec3 middle = inverse_times(T, origin_);
    const vp::Vec3 at = T * vp::Vec3{middle.x, middle.y, 0.0};
    const glm::mat4 pose{glm::vec4(narrow(T.rotation().cx), 0),
                         glm::vec4(narrow(T.rotation().cy), 0),
                         glm::vec4(narrow(T.rotation().cz), 0), glm::vec4(seen(at), 1)};
    ground_.set("u_pose", pose);
    ground_.set("u_normal", narrow(T.rotation().cz));
    ground_.set("u_phase", glm::vec2(std::fmod(middle.x, kPattern), std::fmod(middle.y, kPattern)));
    ground_.set("u_reach", static_cast<float>(kGroundReach * camera.distance()));
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
    ++draw_calls_;
  }
}

void SceneView::draw_sky(const OrbitCamera& camera) const {
  light(sky_, camera);
  const glm::mat4 view = camera.view(), projection = camera.projection(screen_);
  const glm::mat3 from_view = glm::transpose(glm::mat3(view));
  const glm::vec3 half_width = from_view[0] / projection[0][0];
  sky_.set("u_ray", glm::mat3(half_width, from_view[1] / projection[1][1],
                              projection[2][0] * half_width - from_view[2]));
  glDepthFunc(GL_LEQUAL);
  glBindVertexArray(empty_.get());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glDepthFunc(GL_LESS);
}

void SceneView::draw_ghosts(const OrbitCamera& camera) {
  if (ghosts_.empty()) return;
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glDepthMask(GL_FALSE);
  light(ghost_, camera);
  ghost_mesh_.draw();
  ++draw_calls_;
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
}

void SceneView::draw_marks(const Simulation& simulation, const OrbitCamera& camera,
                           const vp::DebugDrawOptions& options) {
  add_marks(simulation, options, origin_, marks_);
  const double height = screen_.y;
  const double metre = 0.5 * static_cast<double>(camera.projection(screen_)[1][1]) * height /
                       camera.distance();  // [px]
  const double point = std::min(kPoint * simulation.typical().size * metre, kLargestPoint * height);
  marks_.flush(view_projection_, static_cast<float>(std::max(point, kSmallestPoint)),
               static_cast<float>(std::max(kLine * height, 1.0)));
}

}  // namespace sandbox
