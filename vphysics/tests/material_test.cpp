// Properties of colliders: scales, offsets, restitution, surface velocity and friction, on every
// kind of ground.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "rig.h"
#include "surfaces.h"

namespace vp::test {
namespace {

constexpr double kEarth = 9.81;

struct FlatTop {
  const char* name;
  Shape shape;
  SE3 pose;  // with its top at z = 0
};
std::vector<FlatTop> flat_tops() {
  Random random(91);
  const std::vector<double> heights(21 * 21, 0.0);
  const std::vector<Vec3> corners{{-3, -3, -1}, {3, -3, -1}, {-3, 3, -1}, {3, 3, -1},
                                  {-3, -3, 0},  {3, -3, 0},  {-3, 3, 0},  {3, 3, 0}};
  const CompoundPart halves[] = {{Box{{1.5, 3, 0.5}}, SE3(Vec3{-1.5, 0, -0.5})},
                                 {Box{{1.5, 3, 0.5}}, SE3(Vec3{1.5, 0, -0.5})}};
  return {{"half-space", HalfSpace{}, {}},
          {"box", Box{{3, 3, 0.5}}, SE3(Vec3{0, 0, -0.5})},
          {"cylinder", Cylinder{3, 0.5}, SE3(Vec3{0, 0, -0.5})},
          {"hull", ConvexHull::of(corners).value(), {}},
          {"mesh", random_plane(random, 20, 6.0).made(), SE3(Vec3{-3, -3, 0})},
          {"height field", HeightField::of({21, 21, 0.3, 0.3, heights, {}}).value(),
           SE3(Vec3{-3, -3, 0})},
          {"compound", Compound::of(halves).value(), {}}};
}
BodyId add_top(World& world, const FlatTop& top, const Material& material,
               const Vec3& surface_velocity = {}) {
  BodyDesc desc;
  desc.motion = Motion::fixed;
  const BodyId body = must(world.create_body(desc));
  ColliderDesc collider;
  collider.shape = top.shape;
  collider.T_body_shape = top.pose;
  collider.material = material;
  collider.surface_velocity = surface_velocity;
  must(world.add_collider(body, collider));
  return body;
}

// Each shape scaled by two, turned upside down in its body's frame and displaced from its origin.
// It comes to rest at the height of its lowest point.
TEST(Collider, OfEveryShapeScaledAndOffsetRestsAtItsHeight) {
  std::vector<Vec3> wedge{{-.2, -.2, -.1}, {.2, -.2, -.1}, {-.2, .2, -.1}, {.2, .2, -.1}};
  for (const double x : {-.1, .1}) wedge.push_back({x, 0, 0.1});
  const CompoundPart parts[] = {{Box{{0.2, 0.2, 0.05}}, SE3(Vec3{0, 0, 0.1})},
                                {Cylinder{0.1, 0.1}, SE3(Vec3{0, 0, -0.05})}};
  struct Case {
    const char* name;
    Shape shape;
    double below;  // lowest point below the origin, upside down, unscaled
  };
  const Case cases[] = {{"sphere", Sphere{0.1}, 0.1},
                        {"box", Box{{0.2, 0.15, 0.1}}, 0.1},
                        {"capsule", Capsule{0.1, 0.0}, 0.1},
                        {"cylinder", Cylinder{0.2, 0.1}, 0.1},
                        {"compound", Compound::of(parts).value(), 0.15}};
  for (const FlatTop& top : flat_tops()) {
    for (const Case& c : cases) {
      World world;
      add_top(world, top, {});
      BodyDesc desc;
      const Vec3 offset{0.3, -0.2, 0.5};
      desc.T_world_body = SE3(Vec3{0, 0, 2.0 * c.below + 0.02} - offset);
      desc.inertia = Inertia(1.0, Vec3{1, 1, 1});
      const BodyId body = must(world.create_body(desc));
      ColliderDesc collider;
      collider.shape = scaled(c.shape, {2, 2, 2}).value();
      collider.T_body_shape = SE3(Mat3{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}, offset);
      must(world.add_collider(body, collider));
      must(world.set_mass_from_colliders(body));
      for (int i = 0; i < 1500; ++i) must(world.step(0.002));
      const SE3 T = world.pose(body);
      EXPECT_NEAR((T * offset).z, 2.0 * c.below, 5e-4) << c.name << " on " << top.name;
      EXPECT_LT(norm(world.velocity(body).v), 1e-3) << c.name << " on " << top.name;
    }
  }
}

// The pair's restitution is the larger of the two: a ball dropped from h rises to e^2 h.
TEST(Collider, RestitutionIsThatOfAnyGround) {
  for (const FlatTop& top : flat_tops()) {
    for (const bool continuous : {false, true}) {
      World world;
      add_top(world, top, {0.5, 0.7, 0.0});
      Part part{.shape = Sphere{0.1}, .pose = SE3(Vec3{0.11, 0.07, 0.6}), .continuous = continuous};
      const BodyId ball = add_dynamic(world, part);
      double highest = 0.0;
      bool rising = false;
      for (int i = 0; i < 800; ++i) {
        must(world.step(0.001));
        rising = rising || world.velocity(ball).v.z > 0.0;
        if (rising) highest = std::max(highest, world.pose(ball).position().z - 0.1);
      }
      EXPECT_NEAR(highest, 0.49 * 0.5, 0.01 * 0.49 * 0.5) << top.name << continuous;
    }
  }
}

// A belt at 0.6 m/s accelerates a box with mu g until the box has the belt's velocity.
TEST(Collider, SurfaceVelocityTakesAlongWhatLiesOnAnyGround) {
  for (const FlatTop& top : flat_tops()) {
    World world;
    const Vec3 belt{0.6, 0, 0};
    add_top(world, top, {0.2, 0.0, 0.0}, belt);
    const BodyId box = add_dynamic(world, {.shape = Box{{0.2, 0.2, 0.1}},
                                           .material = {0.2, 0.0, 0.0},
                                           .pose = SE3(Vec3{-1, 0.1, 0.1})});
    for (int i = 0; i < 150; ++i) must(world.step(0.001));
    EXPECT_NEAR(world.velocity(box).v.x, 0.2 * kEarth * 0.15, 0.01) << top.name;
    for (int i = 0; i < 500; ++i) must(world.step(0.001));
    EXPECT_LT(norm(world.velocity(box).v - belt), 2e-3) << top.name;
  }
}

// A moment of arm * m g slows a ball that spins about the normal, and a ball that rolls, about its
// rolling axis.
TEST(Collider, SpinningAndRollingFrictionAreLeverArmsOnAnyGround) {
  const double r = 0.1, arm = 0.002;
  for (const FlatTop& top : flat_tops()) {
    for (const bool rolls : {false, true}) {
      World world;
      Material material{0.8, 0.0, 0.0};
      (rolls ? material.rolling_friction : material.spinning_friction) = arm;
      add_top(world, top, material);
      const se3 V = rolls ? se3{{0, 10, 0}, {1, 0, 0}} : se3{{0, 0, 10}, {}};
      const BodyId ball = add_dynamic(
          world,
          {.shape = Sphere{r}, .material = material, .pose = SE3(Vec3{0, 0.1, r}), .velocity = V});
      for (int i = 0; i < 1000; ++i) must(world.step(0.001));
      const Vec3 w = world.pose(ball).rotate(world.velocity(ball).w);
      // Rolling friction also stops the ball's translation: the moment of inertia is that about the
      // contact.
      const double slowing = rolls ? arm * kEarth / (1.4 * r * r) : arm * kEarth / (0.4 * r * r);
      EXPECT_NEAR(10.0 - (rolls ? w.y : w.z), slowing, 0.03 * slowing) << top.name << rolls;
    }
  }
}

Vec3 velocity_of(const World& world, BodyId body) {
  return world.pose(body).rotate(world.velocity(body).v);
}

// A rolling friction arm rho slows a body that rolls on a radius r by rho g / r / (1 + k^2 / r^2),
// with k its radius of gyration about the rolling axis. This holds for every shape and both
// solvers.
TEST(Collider, RollingFrictionSlowsAllThatRolls) {
  const double r = 0.5, arm = 0.02, v0 = 2.0;
  const CompoundPart wheels[] = {{Sphere{r}, SE3(Vec3{0, 0, -0.6})},
                                 {Sphere{r}, SE3(Vec3{0, 0, 0.6})}};
  const struct {
    const char* name;
    Shape shape;
    double within;  // tolerance, as a fraction of the deceleration
  } rollers[] = {{"sphere", Sphere{r}, 0.02},
                 {"capsule", Capsule{r, 0.4}, 0.02},
                 {"cylinder", Cylinder{r, 0.4}, 0.02},
                 {"two balls", must(Compound::of(wheels)), 0.02}};
  const SE3 lying(Exp(Vec3{-0.5 * kPi, 0, 0}), Vec3{0, 0, r});  // z along the world's y
  for (const auto& roller : rollers) {
    for (const bool continuous : {false, true}) {
      World world;
      Material material{0.8, 0.0, 0.0};
      material.rolling_friction = arm;
      add_ground(world, material);
      Part part{.shape = roller.shape, .material = material, .pose = lying};
      // In the body frame: along x, about the world's y.
      part.velocity = {{0, 0, v0 / r}, {v0, 0, 0}};
      part.continuous = continuous;
      const BodyId body = add_dynamic(world, part);
      const Inertia J = world.inertia(body);
      const double k2 = J.central().zz / J.mass();
      const double slowing = arm * kEarth / r / (1.0 + k2 / (r * r));
      for (int i = 0; i < 1000; ++i) must(world.step(0.001));
      EXPECT_NEAR(v0 - velocity_of(world, body).x, slowing, roller.within * slowing)
          << roller.name << ' ' << continuous;
      for (int i = 0; i < 8000; ++i) must(world.step(0.001));
      EXPECT_LT(norm(velocity_of(world, body)), 2e-3) << roller.name << ' ' << continuous;
    }
  }
}

}  // namespace
}  // namespace vp::test
