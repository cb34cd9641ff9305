#include "ours.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "vphysics/world.h"

namespace robots {
namespace {

template <class T>
T or_end(vp::Expected<T> result) {
  if (!result) {
    std::fprintf(stderr, "Virtual Physics: %s\n", result.error().message.c_str());
    std::exit(1);
  }
  return std::move(*result);
}
void or_end(vp::Expected<void> result) {
  if (result) return;
  std::fprintf(stderr, "Virtual Physics: %s\n", result.error().message.c_str());
  std::exit(1);
}

vp::Model model_of(const Robot& robot) {
  vp::ModelBuilder builder;
  for (const Link& link : robot.links) (void)or_end(builder.add(link.spec));
  return or_end(builder.build());
}

vp::ColliderDesc collider_of(const RoundShape& shape) {
  vp::ColliderDesc desc;
  desc.material.friction = kFriction;
  const vp::Vec3 along = shape.to - shape.from, middle = 0.5 * (shape.from + shape.to);
  const double length = norm(along);
  desc.T_body_shape = vp::SE3(vp::Mat3::identity(), middle);
  desc.shape = vp::Sphere{shape.radius};
  if (length == 0.0) return desc;
  desc.T_body_shape = vp::SE3(facing((1.0 / length) * along), middle);
  desc.shape = vp::Capsule{shape.radius, 0.5 * length};
  return desc;
}

class Ours final : public Simulation {
 public:
  Ours(const Robot& robot, double dt) : robot_(robot), dt_(dt) {
    vp::BodyDesc ground;
    ground.motion = vp::Motion::fixed;
    const vp::BodyId floor = or_end(world_.create_body(ground));
    vp::ColliderDesc plane;
    plane.shape = vp::HalfSpace{};
    plane.material.friction = kFriction;
    (void)or_end(world_.add_collider(floor, plane));
    art_ = or_end(world_.create_articulation({model_of(robot)}));
    const vp::Model& model = *world_.model(art_);
    std::vector<double> q = model.zero_coordinates();
    const std::vector<double> v(static_cast<std::size_t>(model.velocities()));
    const auto base = static_cast<std::size_t>(model.first_coordinate(0));
    const vp::Vec3& at = robot.start.position();
    const vp::Quaternion turn = to_quaternion(robot.start.rotation());
    const double free[] = {at.x, at.y, at.z, turn.x, turn.y, turn.z, turn.w};
    std::copy(std::begin(free), std::end(free), q.begin() + static_cast<std::ptrdiff_t>(base));
    for (int i = 1; i < model.links(); ++i) {
      q[static_cast<std::size_t>(model.first_coordinate(i))] = link(i).position;
    }
    or_end(world_.set_joint_states(art_, q, v));
    for (int i = 0; i < model.links(); ++i) {
      for (const RoundShape& shape : link(i).shapes) {
        (void)or_end(world_.add_collider(world_.link_body(art_, i), collider_of(shape)));
      }
      if (link(i).stiffness > 0.0) {
        or_end(world_.set_drive(art_, i, 0,
                                {.position = link(i).position,
                                 .stiffness = link(i).stiffness,
                                 .damping = link(i).damping,
                                 .max_force = 1000.0}));
      }
    }
    held_.resize(robot.links.size());
    random_ = robot.is_random();
  }

  void step() override {
    if (random_) {
      for (std::size_t i = 0; i < held_.size(); ++i) {
        const double max = robot_.links[i].random_torque;
        if (max <= 0.0) continue;
        if (steps_ % kHeldSteps == 0) held_[i] = max * torques_.next();
        or_end(world_.apply_joint_force(art_, static_cast<int>(i), 0, held_[i]));
      }
    }
    ++steps_;
    (void)or_end(world_.step(dt_));
  }
  vp::SE3 pose(int link) const override { return world_.pose(world_.link_body(art_, link)); }
  double speed() const override {
    double max = 0.0;
    for (const double v : world_.velocities(art_)) max = std::max(max, std::fabs(v));
    return max;
  }

 private:
  const Link& link(int i) const { return robot_.links[static_cast<std::size_t>(i)]; }

  Robot robot_;
  double dt_;
  vp::World world_;
  vp::ArticulationId art_;
  Torques torques_;
  std::vector<double> held_;
  bool random_ = false;
  int steps_ = 0;
};

}  // namespace

std::unique_ptr<Simulation> make_ours(const Robot& robot, double dt) {
  return std::make_unique<Ours>(robot, dt);
}

}  // namespace robots
