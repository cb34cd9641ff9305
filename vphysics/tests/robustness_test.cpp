// Whatever callers ask for, a world goes on: it restores what it has written and goes on to the
// same bits, what is held collects no speed, and what is pulled hard meets what is in its way.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "joints_rig.h"

namespace vp::test {
namespace {

constexpr double kRates[] = {60.0, 240.0, 1000.0};  // [Hz]

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

// --- what is pulled hard -------------------------------------------------------------------------

// Above a plate of 2 cm, towards which a force, or gravity, pulls it. At 60 Hz it was on the other
// side from 3e3 m/s^2 on; now it sinks in by 8 cm at 3e4, as softly as its contacts bear the load.
TEST(Pulled, ABoxStaysOnItsSideOfAPlate) {
  for (const double rate : kRates) {
    for (const double pull : {1e2, 1e3, 3e3, 1e4, 3e4}) {
      for (const bool by_gravity : {false, true}) {
        SCOPED_TRACE(::testing::Message() << rate << " Hz, " << pull << " m/s^2");
        WorldDesc desc;
        desc.gravity = by_gravity ? Vec3{0, 0, -pull} : Vec3{};
        World world(desc);
        add_fixed(world, Box{{1, 1, 0.01}}, {});
        const BodyId box =
            add_dynamic(world, {.shape = Box{{0.1, 0.1, 0.1}}, .pose = SE3(Vec3{0, 0, 0.16})});
        const double weight = pull * world.inertia(box).mass();
        for (int i = 0; i < 10; ++i) {
          if (!by_gravity) must(world.apply_force(box, {0, 0, -weight}));
          must(world.step(1.0 / rate));
          ASSERT_GT(world.pose(box).position().z, 0.02) << i;
        }
      }
    }
  }
}

// A torque turns its one end by 0.8 m towards the plate in a step of 60 Hz.
TEST(Pulled, AStickStaysOnItsSideOfAPlate) {
  World world(weightless());
  add_fixed(world, Box{{2, 1, 0.01}}, {});
  const BodyId stick =
      add_dynamic(world, {.shape = Box{{1.0, 0.05, 0.05}}, .pose = SE3(Vec3{0, 0, 0.2})});
  const double moment = world.inertia(stick).central().yy;
  for (int i = 0; i < 3; ++i) {
    must(world.apply_torque(stick, {0, 6e3 * moment, 0}));
    must(world.step(1.0 / 60.0));
    const SE3 T = world.pose(stick);
    for (const double x : {-1.0, 1.0}) EXPECT_GT((T * Vec3{x, 0, 0}).z, -0.02) << i;
  }
}

}  // namespace
}  // namespace vp::test
