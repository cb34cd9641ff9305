// Whatever callers ask for, a world goes on: it restores what it has written and goes on to the
// same bits, what is held collects no speed, and what is pulled hard meets what is in its way.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "joints_rig.h"

namespace vp::test {
namespace {

// --- what is held --------------------------------------------------------------------------------

// A ball, and a link above another ball, that are held in every step from when they would touch:
// at 1 m/s, by the 1 mm that is between them in a step of 1 ms. After a second 9.8 m/s before.
TEST(Held, CollectsNoSpeedFromGravity) {
  WorldDesc desc;
  desc.max_impacts_per_step = 0;
  World world(desc);
  add_ground(world, {});
  Part ball{.shape = Sphere{0.1}, .continuous = true};
  ball.pose = SE3(Vec3{0, 0, 0.101});
  const BodyId falls = add_dynamic(world, ball);
  ball.pose = SE3(Vec3{1, 0, 0.1});
  add_dynamic(world, ball);
  LinkSpec link;
  link.joint = PrismaticJoint{{0, 0, 1}};
  link.T_parent_joint = SE3(Vec3{1, 0, 0.251});
  link.inertia = solid_inertia(Box{{0.05, 0.05, 0.05}}, 1000.0);
  const ArticulationId slides = must(world.create_articulation({model_of({link})}));
  ColliderDesc collider;
  collider.shape = Box{{0.05, 0.05, 0.05}};
  must(world.add_collider(world.link_body(slides, 0), collider));
  int held = 0;
  for (int i = 0; i < 1000; ++i) held += must(world.step(0.001)).impact_limit;
  EXPECT_GT(held, 800);
  EXPECT_LT(norm(world.velocity(falls).v), 1.02);
  EXPECT_LT(std::fabs(world.joint_velocity(slides, 0, 0)), 1.02);
}

}  // namespace
}  // namespace vp::test
