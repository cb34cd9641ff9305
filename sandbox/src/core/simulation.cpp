#include "core/simulation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scenes/catalogue.h"

namespace sandbox {
namespace {

constexpr std::size_t kTimesKept = 100'000;  // 100 s at 1 kHz, in 0.8 MB
constexpr double kReach = 1e6;               // of a pick [m]
constexpr double kDensity = 1000.0;          // of a thrown body [kg/m^3]

Piece piece_of(const scenes::Body& body, vp::BodyId id, scenes::EngineShapes& shapes) {
  Piece piece{id, body.motion, {}, {}};
  if (body.motion == scenes::Motion::dynamic) {
    const scenes::Mass mass = scenes::mass_of(body);
    piece.inertia = vp::Inertia(mass.mass, mass.moments);
  }
  for (const scenes::Part& part : body.parts) {
    if (auto shape = shapes.of(part.shape))
      piece.parts.push_back({*std::move(shape), part.T_body_shape});
  }
  return piece;
}

// Radius of the solid sphere with the same mass and mean moment of inertia.
double radius_of(const vp::Inertia& inertia) {
  const vp::Sym3 I = inertia.central();
  return std::sqrt(2.5 * (I.xx + I.yy + I.zz) / (3.0 * inertia.mass()));
}

}  // namespace

Simulation::Simulation(scenes::SceneWorld world, int rate, const Clocks& clocks)
    : world_(std::move(world)), rate_(rate), clocks_(clocks), times_(kTimesKept) {
  collect_pieces();
  watch_stages();
}

void Simulation::watch_stages() {
  if (clocks_.stages == nullptr) return;
  stage_clock_ = std::make_shared<vp::StageClock>(clocks_.stages);
  world_.world().observe_stages(stage_clock_);
  stage_us_ = {};
  stages_averaged_ = 0;
}

void Simulation::collect_pieces() {
  pieces_.clear();
  for (std::size_t i = 0; i < world_.bodies().size(); ++i) {
    pieces_.push_back(piece_of(scene().bodies[i], world_.bodies()[i], world_.shapes()));
  }
  happened_ = world_.happened();
  typical_ = {};
  const auto dynamic = std::count_if(pieces_.begin(), pieces_.end(), [](const Piece& piece) {
    return piece.motion == scenes::Motion::dynamic;
  });
  if (dynamic == 0) return;
  const double share = 1.0 / static_cast<double>(dynamic);
  typical_ = {0.0, 0.0};
  for (const Piece& piece : pieces_) {
    if (piece.motion != scenes::Motion::dynamic) continue;
    typical_.mass += share * piece.inertia.mass();
    typical_.size += share * radius_of(piece.inertia);
  }
}

void Simulation::follow_events() {
  if (happened_ == world_.happened()) return;
  happened_ = world_.happened();
  for (std::size_t i = 0; i < world_.bodies().size(); ++i) pieces_[i].body = world_.bodies()[i];
  if (grip_ && !world().contains(grip_->body)) grip_.reset();
}

vp::Expected<Simulation> Simulation::open(std::string_view name, int rate, const Clocks& clocks) {
  auto scene = scenes::make_scene(name);
  if (!scene) return tl::make_unexpected(scene.error());
  auto world = scenes::SceneWorld::create(std::move(*scene));
  if (!world) return tl::make_unexpected(world.error());
  return Simulation(std::move(*world), rate, clocks);
}

vp::Expected<void> Simulation::reset() {
  auto world = scenes::SceneWorld::create(scene());
  if (!world) return tl::make_unexpected(world.error());
  world_ = std::move(*world);
  collect_pieces();
  watch_stages();
  times_.clear();
  status_ = {};
  grip_.reset();
  owed_ = 0.0;
  steps_ = 0;
  return {};
}

std::size_t Simulation::moving() const {
  return static_cast<std::size_t>(std::count_if(
      pieces_.begin(), pieces_.end(),
      [](const Piece& piece) { return piece.body && piece.motion == scenes::Motion::dynamic; }));
}

void Simulation::bounds(vp::Vec3& low, vp::Vec3& high) const {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  constexpr double kAround = 1.25;  // distance to a body's corners, in radii of that sphere
  low = {kFar, kFar, kFar};
  high = -low;
  const bool any = moving() > 0;
  for (const Piece& piece : pieces_) {
    if (!piece.body || (any && piece.motion != scenes::Motion::dynamic)) continue;
    const vp::Vec3 p = world().pose(piece.body).position();
    const double around = kAround * (any ? radius_of(piece.inertia) : 1.0);
    for (int i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], p[i] - around);
      high[i] = std::max(high[i], p[i] + around);
    }
  }
  if (low.x > high.x) low = {-1.0, -1.0, -1.0}, high = {1.0, 1.0, 1.0};
}

vp::Expected<void> Simulation::step() {
  if (grip_) {
    const vp::Vec3 at = world().pose(grip_->body) * grip_->point_body;
    const auto pulled =
        world_.world().apply_impulse(grip_->body, pull_impulse(world(), *grip_, dt()), at);
    if (!pulled) return pulled;
  }
  const std::int64_t began = clocks_.processor();
  const auto status = world_.step(dt());
  times_.add(1e-3 * static_cast<double>(clocks_.processor() - began));
  if (!status) return tl::make_unexpected(status.error());
  status_ |= *status;
  ++steps_;
  follow_events();
  average_stages();
  return {};
}

void Simulation::average_stages() {
  if (!stage_clock_) return;
  stages_averaged_ = std::min(stages_averaged_ + 1, kStagesOf);
  for (const vp::Stage stage : vp::kStages) {
    double& mean = stage_us_[static_cast<std::size_t>(stage)];
    mean += (1e-3 * static_cast<double>(stage_clock_->total(stage)) - mean) / stages_averaged_;
  }
  stage_clock_->clear();
}

vp::Expected<void> Simulation::advance(double frame, double speed, double budget) {
  owed_ += frame * speed;
  const std::int64_t until = clocks_.real() + static_cast<std::int64_t>(1e9 * budget);
  while (owed_ >= dt()) {
    if (const auto stepped = step(); !stepped) return stepped;
    owed_ -= dt();
    if (clocks_.real() > until) owed_ = std::fmod(owed_, dt());
  }
  return {};
}

bool Simulation::grab(const Ray& ray) {
  grip_.reset();
  const auto cast = world().ray_cast(ray.origin, ray.direction, kReach);
  const auto hit = cast ? *cast : std::nullopt;
  if (!hit || hit->user_data >= pieces_.size()) return false;
  const Piece& piece = pieces_[hit->user_data];
  if (piece.motion != scenes::Motion::dynamic) return false;
  grip_ = Grip{piece.body, piece.inertia, inverse_times(world().pose(piece.body), hit->point),
               hit->point};
  return true;
}

void Simulation::drag(const Ray& ray, const vp::Vec3& forward) {
  if (!grip_) return;
  const double along = dot(ray.direction, forward);
  const double depth = dot(grip_->target - ray.origin, forward);
  if (along < 1e-3 || depth <= 0.0) return;  // the plane is behind the eye, or seen edge-on
  pull_to(ray.origin + (depth / along) * ray.direction);
}

void Simulation::pull_to(const vp::Vec3& target) {
  if (grip_) grip_->target = target;
}

vp::Expected<void> Simulation::throw_body(const vp::Shape& shape, const vp::Vec3& at,
                                          const vp::Vec3& velocity) {
  const vp::Inertia solid = vp::solid_inertia(shape, kDensity);
  const vp::SE3 T_body_shape(-solid.centre_of_mass());
  vp::BodyDesc desc;
  desc.T_world_body = vp::SE3(at);
  desc.velocity.v = velocity;
  desc.inertia = solid.about(solid.centre_of_mass());
  desc.user_data = pieces_.size();
  const auto body = world_.world().create_body(desc);
  if (!body) return tl::make_unexpected(body.error());
  vp::ColliderDesc collider;
  collider.shape = shape;
  collider.T_body_shape = T_body_shape;
  collider.material.friction = 0.6;
  collider.user_data = desc.user_data;
  if (const auto added = world_.world().add_collider(*body, collider); !added) {
    (void)world_.world().destroy_body(*body);
    return tl::make_unexpected(added.error());
  }
  pieces_.push_back({*body, scenes::Motion::dynamic, desc.inertia, {{shape, T_body_shape}}});
  return {};
}

}  // namespace sandbox
