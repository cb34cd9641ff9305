// A ragdoll of bodies and joints falls down stairs and comes to rest. Public headers only.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "vphysics/world.h"

namespace {

// A frame whose z axis, the axis of a capsule and of a joint's twist, is along another axis.
vp::SE3 z_along(const vp::Vec3& axis, const vp::Vec3& at) {
  const vp::Vec3 z{0.0, 0.0, 1.0};
  const vp::Vec3 turn = vp::cross(z, axis);
  const double angle = std::atan2(vp::norm(turn), vp::dot(z, axis));
  const double length = vp::norm(turn);
  const vp::Vec3 about = length > 0.0 ? (1.0 / length) * turn : vp::Vec3{1.0, 0.0, 0.0};
  return vp::SE3(vp::Exp(angle * about), at);
}

struct Joined {
  vp::JointId joint;
  vp::BodyId a, b;
  vp::Vec3 on_a, on_b;  // the joint's point in both body frames
};

}  // namespace

int main() {
  vp::WorldDesc desc;
  desc.sleep_after = 0.5;
  vp::World world(desc);
  bool ok = true;

  vp::BodyDesc fixed;
  fixed.motion = vp::Motion::fixed;
  const auto ground = world.create_body(fixed);
  if (!ground) return 1;
  vp::ColliderDesc floor;
  floor.shape = vp::HalfSpace{};
  ok = ok && world.add_collider(*ground, floor);
  for (int stair = 0; stair < 6; ++stair) {
    vp::ColliderDesc step;
    step.shape = vp::Box{{0.2, 1.0, 0.1 * (6 - stair)}};
    step.T_body_shape = vp::SE3(vp::Vec3{0.4 * stair, 0.0, 0.1 * (6 - stair)});
    ok = ok && world.add_collider(*ground, step);
  }

  // begin: ragdoll
  // A limb is a capsule from one point to another; its mass follows from its volume.
  const vp::Vec3 start{0.0, 0.0, 2.2};
  const auto limb = [&](const vp::Vec3& from, const vp::Vec3& to, double radius) {
    vp::BodyDesc body;
    body.angular_damping = 2.0;  // soft tissue: damps swinging limbs
    const vp::Vec3 along = to - from;
    body.T_world_body = z_along((1.0 / vp::norm(along)) * along, start + 0.5 * (from + to));
    vp::ColliderDesc capsule;
    capsule.shape = vp::Capsule{radius, 0.5 * vp::norm(along)};
    capsule.material.friction = 0.7;
    capsule.material.rolling_friction = 0.01;
    const auto made = world.create_body(body);
    ok = ok && made && world.add_collider(*made, capsule);
    return made ? *made : vp::BodyId{};
  };
  std::vector<Joined> joints;
  // A joint at a point; the z axis of its frame is along `axis`.
  const auto join = [&](vp::BodyId a, vp::BodyId b, const vp::Vec3& at, const vp::Vec3& axis,
                        const vp::JointKind& kind) {
    const vp::SE3 frame = z_along(axis, start + at);
    vp::JointDesc joint;
    joint.kind = kind;
    joint.T_a_joint = vp::Inv(world.pose(a)) * frame;
    joint.T_b_joint = vp::Inv(world.pose(b)) * frame;
    const auto made = world.create_joint(a, b, joint);
    ok = ok && made;
    if (made) {
      joints.push_back({*made, a, b, joint.T_a_joint.position(), joint.T_b_joint.position()});
    }
  };
  const vp::Vec3 up{0.0, 0.0, 1.0}, down{0.0, 0.0, -1.0}, across{0.0, 1.0, 0.0};
  const vp::BodyId pelvis = limb({0.0, -0.08, 0.0}, {0.0, 0.08, 0.0}, 0.09);
  const vp::BodyId chest = limb({0.0, 0.0, 0.22}, {0.0, 0.0, 0.42}, 0.12);
  const vp::BodyId head = limb({0.0, 0.0, 0.64}, {0.0, 0.0, 0.70}, 0.09);
  join(pelvis, chest, {0.0, 0.0, 0.1}, up, vp::ConeTwist{0.5, 0.3, -0.5, 0.5, {}});
  join(chest, head, {0.0, 0.0, 0.55}, up, vp::ConeTwist{0.6, 0.6, -1.0, 1.0, {}});
  for (const double side : {-1.0, 1.0}) {
    const vp::BodyId thigh = limb({0.0, 0.1 * side, -0.1}, {0.0, 0.1 * side, -0.42}, 0.06);
    const vp::BodyId shin = limb({0.0, 0.1 * side, -0.54}, {0.0, 0.1 * side, -0.86}, 0.05);
    join(pelvis, thigh, {0.0, 0.1 * side, -0.02}, down, vp::ConeTwist{1.2, 0.5, -0.4, 0.4, {}});
    join(thigh, shin, {0.0, 0.1 * side, -0.48}, across, vp::Hinge{0.0, 2.3, {}});
    const vp::BodyId arm = limb({0.0, 0.24 * side, 0.42}, {0.0, 0.46 * side, 0.42}, 0.045);
    const vp::BodyId forearm = limb({0.0, 0.56 * side, 0.42}, {0.0, 0.78 * side, 0.42}, 0.04);
    join(chest, arm, {0.0, 0.17 * side, 0.42}, side * across,
         vp::ConeTwist{1.4, 1.4, -0.8, 0.8, {}});
    join(arm, forearm, {0.0, 0.51 * side, 0.42}, up,
         vp::Hinge{side > 0.0 ? -2.4 : 0.0, side > 0.0 ? 0.0 : 2.4, {}});
  }
  if (!ok || !world.apply_impulse(chest, {30.0, 0.0, 0.0}, start + vp::Vec3{0.0, 0.1, 0.4})) {
    return 1;
  }
  // end: ragdoll

  double widest = 0.0, lowest = 1.0;
  int tick = 0;
  for (; tick < 60 * 20 && !world.is_asleep(pelvis); ++tick) {
    if (!world.step(1.0 / 60.0)) return 1;
    for (const Joined& j : joints) {
      const vp::SE3 T_a = world.pose(j.a), T_b = world.pose(j.b);
      widest = std::max(widest, vp::norm(T_a * j.on_a - T_b * j.on_b));
      lowest = std::min({lowest, T_a.position().z, T_b.position().z});
    }
  }
  std::printf("asleep after %.1f s at x = %.2f m; joints were open by %.2f mm at most\n",
              tick / 60.0, world.pose(pelvis).position().x, 1e3 * widest);
  return world.is_asleep(pelvis) && widest < 0.01 && lowest > 0.03 ? 0 : 1;
}
