// Only a world created with the same constants, bit for bit, accepts a snapshot.
#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "rig.h"

namespace vp::test {
namespace {

LinkSpec swinging_link() {
  LinkSpec link;
  link.parent = 0;
  link.joint = RevoluteJoint{{1, 0, 0}};
  link.T_parent_joint = SE3(Vec3{0, 0.1, 0});
  link.inertia = Inertia(0.1, Vec3{1e-4, 1e-4, 1e-4});
  return link;
}

struct Recipe {
  WorldDesc world;
  BodyDesc body;
  ColliderDesc collider;
  Shape second = Box{{1, 1, 1}}, third = Capsule{0.2, 0.3};
  LinkSpec link = rod_link(0, 0.1), swinging = swinging_link();
  bool links_collide = false;
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
  must(world.create_articulation({model_of({r.link, r.swinging}), r.links_collide}));
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

// Values that calls can change are in the snapshot; user_data does not affect the motion.
TEST(Restore, TakesWhatDiffersInStateOrUserDataOnly) {
  EXPECT_TRUE(takes([](Recipe& r) { r.body.T_world_body = SE3(Vec3{3, 0, 0}); }));
  EXPECT_TRUE(takes([](Recipe& r) { r.body.velocity.v.x = 3; }));
  EXPECT_TRUE(takes([](Recipe& r) { r.body.user_data = 3; }));
  EXPECT_TRUE(takes([](Recipe& r) { r.collider.user_data = 3; }));
  EXPECT_TRUE(takes([](Recipe& r) { r.link.name = "another"; }));
}

TEST(Restore, RefusesASnapshotOfAWorldWithOtherConstants) {
  const auto next = [](double x) { return std::nextafter(x, 1e300); };
  const std::pair<const char*, Change> changes[] = {
      {"gravity", [&](Recipe& r) { r.world.gravity.z = next(r.world.gravity.z); }},
      {"restitution_threshold", [](Recipe& r) { r.world.restitution_threshold = 0.06; }},
      {"contact_slop", [](Recipe& r) { r.world.contact_slop = 2e-4; }},
      {"velocity_iterations", [](Recipe& r) { r.world.velocity_iterations = 13; }},
      {"max_impacts_per_step", [](Recipe& r) { r.world.max_impacts_per_step = 33; }},
      {"region_bodies", [](Recipe& r) { r.world.region_bodies = 1024; }},
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
      {"gravity_scale", [](Recipe& r) { r.body.gravity_scale = 0.5; }},
      {"allow_sleep", [](Recipe& r) { r.body.allow_sleep = false; }},
      {"no inertia", [](Recipe& r) { r.body.inertia = {}; }},
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
      {"spinning_friction", [](Recipe& r) { r.collider.material.spinning_friction = 0.1; }},
      {"surface_velocity", [](Recipe& r) { r.collider.surface_velocity.y = 1e-300; }},
      {"density", [&](Recipe& r) { r.collider.density = next(1000.0); }},
      {"category", [](Recipe& r) { r.collider.filter.category = 3; }},
      {"mask", [](Recipe& r) { r.collider.filter.mask = 1; }},
      {"sensor", [](Recipe& r) { r.collider.sensor = true; }},
      {"joint",
       [](Recipe& r) {
         r.swinging.joint = PrismaticJoint{{1, 0, 0}};
       }},
      {"axis",
       [&](Recipe& r) {
         r.swinging.joint = RevoluteJoint{{next(1.0), 0, 0}};
       }},
      {"parent", [](Recipe& r) { r.swinging.parent = kWorld; }},
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
      {"armature", [](Recipe& r) { r.link.armature = 0.1; }},
      {"damping", [](Recipe& r) { r.swinging.damping = 0.1; }},
      {"lower limit", [](Recipe& r) { r.link.forces[0].lower = -0.13; }},
      {"spring", [](Recipe& r) { r.link.forces[1].stiffness = 1.0; }},
      {"rest of the spring", [](Recipe& r) { r.link.forces[1].rest = 0.1; }},
      {"stiffness of a limit", [](Recipe& r) { r.link.forces[0].limit_stiffness = 1e4; }},
      {"damping of a limit", [](Recipe& r) { r.link.forces[0].limit_damping = 1.0; }},
      {"friction", [](Recipe& r) { r.link.forces[0].friction = 1.0; }},
      {"motor_limit", [](Recipe& r) { r.link.forces[0].motor_limit = 1.0; }},
      {"upper limit", [](Recipe& r) { r.link.forces[1].upper = 0.13; }},
      {"links_collide", [](Recipe& r) { r.links_collide = true; }},
  };
  for (const auto& [name, change] : changes) EXPECT_FALSE(takes(change)) << name;
}

// The order of creation is part of it, too.
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
