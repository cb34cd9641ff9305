// A gate on a powered hinge: a ray hits the closed gate, and the wall behind the open gate. Public
// headers only.
#include <cmath>
#include <cstdio>
#include <numbers>

#include "vphysics/world.h"

int main() {
  // begin: gate
  vp::World world;

  const auto add_box = [&](vp::Motion motion, const vp::Vec3& half, const vp::Vec3& at) {
    vp::ColliderDesc box;
    box.shape = vp::Box{half};
    box.density = 500.0;
    vp::BodyDesc desc;
    desc.motion = motion;
    desc.T_world_body = vp::SE3(at);
    desc.inertia = vp::solid_inertia(box.shape, box.density);
    auto body = world.create_body(desc);
    if (body && !world.add_collider(*body, box)) body = vp::BodyId{};
    return body;
  };
  const auto post = add_box(vp::Motion::fixed, {0.05, 0.05, 1.0}, {1.0, -0.1, 1.0});
  const auto wall = add_box(vp::Motion::fixed, {0.1, 2.0, 2.0}, {3.1, 0.0, 2.0});
  const auto gate = add_box(vp::Motion::dynamic, {0.02, 0.5, 0.5}, {1.0, 0.5, 0.7});
  if (!post || !wall || !gate) return 1;

  // Both joint frames are at the gate's edge, z up. The motor acts as a spring and damper towards
  // its target position, with at most 100 N m.
  vp::JointDesc hinge;
  hinge.T_a_joint = vp::SE3(vp::Vec3{0.0, 0.1, -0.3});
  hinge.T_b_joint = vp::SE3(vp::Vec3{0.0, -0.5, 0.0});
  hinge.kind = vp::Hinge{.lower = 0.0, .upper = 2.0, .drive = {}};
  const auto joint = world.create_joint(*post, *gate, hinge);
  if (!joint) return 1;

  const auto seen = [&] {
    const auto hit = world.ray_cast({0.0, 0.3, 0.7}, {1.0, 0.0, 0.0}, 10.0);
    return hit && *hit ? (*hit)->distance : -1.0;
  };
  const double shut = seen();
  const vp::JointDrive open{
      .position = std::numbers::pi / 2, .stiffness = 60.0, .damping = 40.0, .max_force = 100.0};
  if (!world.set_drive(*joint, open)) return 1;
  for (int tick = 0; tick < 4000; ++tick) {
    if (!world.step(0.001)) return 1;
  }
  const double angle = world.joint_coordinate(*joint);
  std::printf("shut: %.3f m to see; turned by %.4f rad: %.3f m\n", shut, angle, seen());
  // end: gate
  const bool opened = std::fabs(angle - std::numbers::pi / 2) < 1e-3;
  return opened && std::fabs(shut - 0.98) < 1e-9 && std::fabs(seen() - 3.0) < 1e-9 ? 0 : 1;
}
