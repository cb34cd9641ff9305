// Bodies without CCD that move far in a step meet edges: the normal of a contact is that where they
// collide, not that where they started.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "random.h"
#include "rig.h"
#include "vphysics/compound.h"
#include "vphysics/convex_hull.h"

namespace vp::test {
namespace {

constexpr double kSpeeds[] = {1.0, 5.0, 20.0};            // [m/s]
constexpr double kEdgeSteps[] = {1.0 / 60.0, 1.0 / 240};  // [s]

struct Ground {
  const char* name;
  void (*build)(World& world);
};

template <class Build>
void for_each_tile(Build build) {
  for (int i = -6; i < 6; ++i)
    for (int j = -2; j < 3; ++j) build(SE3(Vec3{i + 0.5, static_cast<double>(j), -0.5}));
}
const Box kTile{{0.5, 0.5, 0.5}};

const Ground kGrounds[] = {
    {"boxes",
     [](World& world) {
       for_each_tile([&](const SE3& at) { add_fixed(world, kTile, kRough, at); });
     }},
    {"hulls",
     [](World& world) {
       std::vector<Vec3> corners;
       for (int k = 0; k < 8; ++k)
         corners.push_back({(k & 1) - 0.5, ((k >> 1) & 1) - 0.5, (k >> 2) - 0.5});
       const ConvexHull tile = must(ConvexHull::of(corners));
       for_each_tile([&](const SE3& at) { add_fixed(world, tile, kRough, at); });
     }},
    {"compound", [](World& world) {
       std::vector<CompoundPart> tiles;
       for_each_tile([&](const SE3& at) { tiles.push_back({kTile, at}); });
       add_fixed(world, must(Compound::of(tiles)), kRough);
     }}};

struct Mover {
  const char* name;
  Shape shape;
  double height;  // of its centre over the ground [m]
  Vec3 rotation;  // of its start pose, as a rotation vector
  bool rolls;     // else it slides without friction
};
const Mover kMovers[] = {{"ball", Sphere{0.1}, 0.1, {}, true},
                         {"roller", Cylinder{0.1, 0.3}, 0.1, {kPi / 2, 0, 0}, true},
                         {"box", Box{{0.1, 0.1, 0.1}}, 0.1, {}, false},
                         {"coin", Cylinder{0.2, 0.05}, 0.05, {}, false},
                         {"capsule", Capsule{0.1, 0.3}, 0.1, {0, kPi / 2, 0}, false},
                         {"plate", Box{{0.6, 0.6, 0.05}}, 0.05, {}, false}};

TEST(ImpactNormal, OnATiledFloorNothingIsStoppedByTheSeams) {
  for (const Ground& ground : kGrounds) {
    for (const Mover& mover : kMovers) {
      for (const double speed : kSpeeds) {
        for (const double dt : kEdgeSteps) {
          // The axis of a roller that makes half a revolution in a step nutates.
          if (mover.name == std::string("roller") && speed * dt > 0.3) continue;
          World world;
          ground.build(world);
          const Vec3 v{speed, mover.rolls ? 0.0 : 0.06 * speed, 0.0};
          const BodyId body = add_dynamic(
              world, {.shape = mover.shape,
                      .material = {.friction = mover.rolls ? 0.6 : 0.0},
                      .pose = SE3(Exp(mover.rotation).matrix(), Vec3{-5.0, 0.037, mover.height})});
          must(world.set_velocity_world(
              body, {.linear = v, .angular = mover.rolls ? Vec3{0.0, speed / 0.1, 0.0} : Vec3{}}));
          double risen = 0.0;
          for (double t = 0.0; t < 9.0 / speed; t += dt) {
            must(world.step(dt));
            risen = std::max(risen, world.pose(body).position().z - mover.height);
          }
          SCOPED_TRACE(std::string(mover.name) + " on " + ground.name + " at " +
                       std::to_string(speed) + " m/s in steps of " + std::to_string(dt) + " s");
          EXPECT_LT(risen, 1e-3);
          EXPECT_NEAR(world.velocity_world(body).linear.x, speed, 0.02 * speed);
        }
      }
    }
  }
}

TEST(ImpactNormal, AStepInTheFloorIsMet) {
  for (const double dt : kEdgeSteps) {
    World world;
    add_fixed(world, Box{{10.0, 5.0, 0.5}}, kRough, SE3(Vec3{-10.0, 0.0, -0.5}));
    add_fixed(world, Box{{10.0, 5.0, 0.5}}, kRough, SE3(Vec3{10.0, 0.0, -0.495}));
    const BodyId box = add_dynamic(world, {.shape = Box{{0.1, 0.1, 0.1}},
                                           .material = {.friction = 0.0},
                                           .pose = SE3(Vec3{-1.0, 0.0, 0.1}),
                                           .velocity = {Vec3{}, Vec3{3.0, 0.0, 0.0}}});
    for (double t = 0.0; t < 0.26; t += dt) must(world.step(dt));
    EXPECT_NEAR(world.pose(box).position().x, -0.2, 0.06);
    EXPECT_NEAR(world.velocity(box).v.x, 3.0, 1e-3);
    for (double t = 0.0; t < 0.06; t += dt) must(world.step(dt));
    EXPECT_LT(world.velocity_world(box).linear.x, 2.9);
  }
}

// Equal smooth elastic balls: the one that is hit leaves along the line of centres at the impact.
TEST(ImpactNormal, OfTwoBallsThatHitOffCentreIsTheirLineOfCentres) {
  Random random(74);
  for (const double dt : kEdgeSteps) {
    double worst = 0.0;
    for (int i = 0; i < 300; ++i) {
      WorldDesc desc;
      desc.gravity = {};
      World world(desc);
      const double offset = random.uniform(-0.18, 0.18), speed = random.uniform(2.0, 10.0);
      const Material elastic{.friction = 0.0, .restitution = 1.0};
      add_dynamic(world, {.shape = Sphere{0.1},
                          .material = elastic,
                          .pose = SE3(Vec3{-random.uniform(0.5, 2.0), offset, 0.0}),
                          .velocity = {Vec3{}, Vec3{speed, 0.0, 0.0}}});
      const BodyId hit = add_dynamic(world, {.shape = Sphere{0.1}, .material = elastic});
      for (double t = 0.0; t < 3.0 / speed; t += dt) must(world.step(dt));
      const Vec3 v = world.velocity_world(hit).linear;
      worst = std::max(worst, std::fabs(std::atan2(v.y, v.x) - std::asin(-offset / 0.2)));
    }
    EXPECT_LT(worst, 0.02) << "in steps of " << dt << " s";
  }
}

}  // namespace
}  // namespace vp::test
