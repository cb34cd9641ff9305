// A snapshot is taken only by a world that is made of the same constants, bit for bit.
#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "rig.h"

namespace vp::test {
namespace {

struct Recipe {
  WorldDesc world;
  BodyDesc body;
  ColliderDesc collider;
  Shape second = Box{{1, 1, 1}}, third = Capsule{0.2, 0.3};
  LinkDesc link = rod_link(0, 0.1);
};
using Change = std::function<void(Recipe&)>;

Recipe recipe() {
  Recipe r;
  r.body.inertia = Inertia(2.0, Vec3{1, 1, 1});
  r.collider.shape = Sphere{0.5};
  return r;
}
World make(const Recipe& r) {
  World world(r.world);
  const BodyId body = must(world.create_body(r.body));
  must(world.add_collider(body, r.collider));
  BodyDesc fixed;
  fixed.motion = Motion::fixed;
  fixed.T_world_body = SE3(Vec3{9, 0, 0});
  const BodyId other = must(world.create_body(fixed));
  ColliderDesc collider;
  collider.shape = r.second;
  must(world.add_collider(other, collider));
  collider.shape = r.third;
  must(world.add_collider(other, collider));
  must(world.create_articulation({{r.link}}));
  return world;
}
bool takes(const Change& change) {
  std::vector<std::byte> bytes;
  World made = make(recipe());
  must(made.step(0.001));
  made.snapshot(bytes);
  Recipe r = recipe();
  change(r);
  World other = make(r);
  const std::uint64_t before = other.state_hash();
  const auto result = other.restore(bytes);
  if (!result) {
    EXPECT_EQ(result.error().code, Errc::bad_data);
    EXPECT_EQ(other.state_hash(), before);
  }
  return result.has_value();
}

TEST(Restore, TakesASnapshotOfAWorldMadeOfTheSame) {
  EXPECT_TRUE(takes([](Recipe&) {}));
}

// Of what calls can change, the snapshot holds the value; and user_data moves nothing.
TEST(Restore, TakesWhatDiffersInStateOrUserDataOnly) {
  EXPECT_TRUE(takes([](Recipe& r) { r.body.T_world_body = SE3(Vec3{3, 0, 0}); }));
  EXPECT_TRUE(takes([](Recipe& r) { r.body.velocity.v.x = 3; }));
  EXPECT_TRUE(takes([](Recipe& r) { r.body.user_data = 3; }));
  EXPECT_TRUE(takes([](Recipe& r) { r.collider.user_data = 3; }));
  EXPECT_TRUE(takes([](Recipe& r) { r.link.user_data = 3; }));
}

TEST(Restore, RefusesASnapshotOfAWorldWithOtherConstants) {
  const auto next = [](double x) { return std::nextafter(x, 1e300); };
  const std::pair<const char*, Change> changes[] = {
      {"gravity", [&](Recipe& r) { r.world.gravity.z = next(r.world.gravity.z); }},
      {"restitution_threshold", [](Recipe& r) { r.world.restitution_threshold = 0.06; }},
      {"contact_slop", [](Recipe& r) { r.world.contact_slop = 2e-4; }},
      {"velocity_iterations", [](Recipe& r) { r.world.velocity_iterations = 13; }},
      {"max_impacts_per_step", [](Recipe& r) { r.world.max_impacts_per_step = 33; }},
      {"motion", [](Recipe& r) { r.body.motion = Motion::kinematic; }},
      {"continuous", [](Recipe& r) { r.body.continuous = true; }},
      {"mass",
       [&](Recipe& r) {
         r.body.inertia = Inertia(next(2.0), Vec3{1, 1, 1});
       }},
      {"moment",
       [&](Recipe& r) {
         r.body.inertia = Inertia(2.0, Vec3{1, next(1), 1});
       }},
      {"first moment",
       [](Recipe& r) {
         r.body.inertia = Inertia(2.0, {1e-9, 0, 0}, {1, 1, 1, 0, 0, 0});
       }},
      {"product of inertia",
       [](Recipe& r) {
         r.body.inertia = Inertia(2.0, {}, {1, 1, 1, 0, 0, 1e-9});
       }},
      {"linear_damping", [](Recipe& r) { r.body.linear_damping = 0.1; }},
      {"angular_damping", [](Recipe& r) { r.body.angular_damping = 0.1; }},
      {"radius", [&](Recipe& r) { r.collider.shape = Sphere{next(0.5)}; }},
      {"shape",
       [](Recipe& r) {
         r.collider.shape = Capsule{0.5, 0.0};
       }},
      {"half extents",
       [](Recipe& r) {
         r.second = Box{{1, 2, 1}};
       }},
      {"half length",
       [](Recipe& r) {
         r.third = Capsule{0.2, 0.4};
       }},
      {"T_body_shape",
       [](Recipe& r) {
         r.collider.T_body_shape = SE3(Vec3{0, 1e-9, 0});
       }},
      {"turn of the shape",
       [](Recipe& r) {
         r.collider.T_body_shape = SE3(Exp(Vec3{1e-3, 0, 0}), {});
       }},
      {"friction", [](Recipe& r) { r.collider.material.friction = 0.4; }},
      {"restitution", [](Recipe& r) { r.collider.material.restitution = 0.1; }},
      {"rolling_friction", [](Recipe& r) { r.collider.material.rolling_friction = 0.1; }},
      {"category", [](Recipe& r) { r.collider.filter.category = 3; }},
      {"mask", [](Recipe& r) { r.collider.filter.mask = 1; }},
      {"sensor", [](Recipe& r) { r.collider.sensor = true; }},
      {"joint", [](Recipe& r) { r.link.joint = JointKind::revolute; }},
      {"T_parent_joint",
       [](Recipe& r) {
         r.link.T_parent_joint = SE3(Vec3{0, 0, 0.2});
       }},
      {"the link's mass",
       [](Recipe& r) {
         r.link.inertia = Inertia(1.6, Vec3{0.2, 0.2, 0.0015});
       }},
      {"the link's moment",
       [](Recipe& r) {
         r.link.inertia = Inertia(1.5, Vec3{0.2, 0.2, 0.0016});
       }},
      {"armature of the slide", [](Recipe& r) { r.link.armature[0] = 0.1; }},
      {"armature of the angle", [](Recipe& r) { r.link.armature[1] = 0.1; }},
      {"joint_damping of the slide", [](Recipe& r) { r.link.joint_damping[0] = 0.1; }},
      {"joint_damping of the angle", [](Recipe& r) { r.link.joint_damping[1] = 0.1; }},
      {"lower limit", [](Recipe& r) { r.link.limit[0].lower = -0.13; }},
      {"upper limit", [](Recipe& r) { r.link.limit[1].upper = 0.13; }},
  };
  for (const auto& [name, change] : changes) EXPECT_FALSE(takes(change)) << name;
}

// The order of creation is part of it too.
TEST(Restore, RefusesASnapshotOfAWorldWhoseBodyWasDestroyed) {
  World a = make(recipe()), b = make(recipe());
  BodyDesc desc;
  desc.inertia = Inertia(1.0, Vec3{1, 1, 1});
  const BodyId body = must(b.create_body(desc));
  must(b.destroy_body(body));
  std::vector<std::byte> bytes;
  a.snapshot(bytes);
  EXPECT_FALSE(b.restore(bytes));
}

}  // namespace
}  // namespace vp::test
