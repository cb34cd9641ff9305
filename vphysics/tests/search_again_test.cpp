// Bodies that move far within a step without CCD: what they reach is found at its start, and what
// an impact throws them at is found within the same step.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "random.h"
#include "rig.h"

namespace vp::test {
namespace {

constexpr double kRadius = 0.1;
constexpr double kLongSteps[] = {0.01, 1.0 / 60.0};  // [s]

WorldDesc without_gravity() {
  WorldDesc desc;
  desc.gravity = {};
  return desc;
}

struct Balls {
  World& world;
  std::vector<BodyId> all;
  double deepest = 0.0;  // overlap of any two at the end of a step [m]

  void add(const Vec3& at, const Material& material, const Vec3& v = {}) {
    all.push_back(add_dynamic(world, {.shape = Sphere{kRadius},
                                      .material = material,
                                      .pose = SE3(at),
                                      .velocity = {Vec3{}, v}}));
  }
  double energy(double gravity) const {  // per kilogram; without rotation
    double sum = 0.0;
    for (const BodyId ball : all) {
      const Vec3 v = world.velocity(ball).v;
      sum += 0.5 * dot(v, v) + gravity * world.pose(ball).position().z;
    }
    return sum;
  }
  void step(double dt) {
    must(world.step(dt));
    for (std::size_t i = 0; i < all.size(); ++i) {
      for (std::size_t j = i + 1; j < all.size(); ++j) {
        const Vec3 d = world.pose(all[j]).position() - world.pose(all[i]).position();
        deepest = std::max(deepest, 2.0 * kRadius - norm(d));
      }
    }
  }
};

// Deepest overlap: 12 mm at 10 ms and a pitch of 2.05 radii, at most 8 mm otherwise. Searched for
// once a step: 133 mm at 10 ms, 196 mm at 1/60 s, where balls passed through one another. Energy
// gained: at most 0.43%.
TEST(SearchAgain, ElasticBallsThatFallTogether) {
  constexpr int kAlong = 6;
  for (const double dt : kLongSteps) {
    for (const double height : {0.5, 2.5}) {
      for (const double pitch : {2.05, 2.5}) {
        SCOPED_TRACE(::testing::Message() << dt << ' ' << height << ' ' << pitch);
        World world;
        const Material elastic{0.0, 1.0, 0.0};
        add_ground(world, elastic);
        Random random(7);
        Balls balls{world, {}};
        for (int i = 0; i < kAlong * kAlong * kAlong; ++i) {
          const int column = i % kAlong, row = i / kAlong % kAlong, level = i / (kAlong * kAlong);
          const Vec3 at{1.0 * column, 1.0 * row, 1.0 * level};
          const Vec3 off = pitch > 2.1 ? random.in_cube(0.005) : Vec3{};
          balls.add(pitch * kRadius * at + Vec3{0, 0, height} + off, elastic);
        }
        const double first = balls.energy(9.81);
        double most = first;
        for (int i = 0; i < std::lround(2.0 / dt); ++i) {
          balls.step(dt);
          most = std::max(most, balls.energy(9.81));
        }
        EXPECT_LT(balls.deepest, 0.02);
        EXPECT_LT(most, 1.005 * first);
      }
    }
  }
}

// A row of balls with gaps: the last one leaves with the speed of the first. The row is crossed
// within a few sub-steps. Searched for once a step, balls overlapped by up to 131 mm.
TEST(SearchAgain, CradleWithGaps) {
  for (const double dt : kLongSteps) {
    for (const double gap : {0.002, 0.02}) {
      SCOPED_TRACE(::testing::Message() << dt << ' ' << gap);
      World world(without_gravity());
      const Material elastic{0.0, 1.0, 0.0};
      Balls balls{world, {}};
      balls.add({-0.5, 0, 0}, elastic, {8, 0, 0});
      for (int i = 0; i < 6; ++i) balls.add({i * (2.0 * kRadius + gap), 0, 0}, elastic);
      for (int i = 0; i < std::lround(0.5 / dt); ++i) balls.step(dt);
      EXPECT_LT(balls.deepest, 1e-4);
      for (const BodyId ball : balls.all) {
        const double expected = ball == balls.all.back() ? 8.0 : 0.0;
        EXPECT_NEAR(world.velocity(ball).v.x, expected, 1e-4);
      }
    }
  }
}

// The balls that the paddle hits first meet the others: 0 overlap with restitution, 23 mm without.
// Searched for once a step: 157 to 185 mm.
TEST(SearchAgain, PaddleIntoBalls) {
  for (const double dt : kLongSteps) {
    for (const double restitution : {0.0, 0.8}) {
      SCOPED_TRACE(::testing::Message() << dt << ' ' << restitution);
      World world(without_gravity());
      const Material material{0.3, restitution, 0.0};
      Balls balls{world, {}};
      for (int i = 0; i < 8; ++i) {
        for (int j = 0; j < 8; ++j) {
          for (int k = 0; k < 3; ++k) balls.add({0.22 * i, 0.22 * j, 0.22 * k}, material);
        }
      }
      add_kinematic(world, Box{{0.05, 1.0, 0.5}}, {Vec3{}, Vec3{12, 0, 0}}, material,
                    SE3(Vec3{-0.4, 0.8, 0.2}));
      for (int i = 0; i < std::lround(0.3 / dt); ++i) balls.step(dt);
      EXPECT_LT(balls.deepest, 0.04);
    }
  }
}

// A sleeping ball is woken by one that was thrown at it within the step. A ball that is thrown by
// less than a fifth of its radius in the rest of the step is not searched for again: 3.3 mm.
TEST(SearchAgain, WakesWhatIsHit) {
  WorldDesc desc = without_gravity();
  desc.sleep_after = 0.1;
  World world(desc);
  const Material elastic{0.0, 1.0, 0.0};
  Balls balls{world, {}};
  for (int i = 0; i < 4; ++i) balls.add({0.21 * i, 0, 0}, elastic);
  for (int i = 0; i < 30; ++i) balls.step(1.0 / 60.0);
  for (const BodyId ball : balls.all) EXPECT_TRUE(world.is_asleep(ball));
  balls.add({-0.5, 0, 0}, elastic, {10, 0, 0});
  for (int i = 0; i < 10; ++i) balls.step(1.0 / 60.0);
  EXPECT_LT(balls.deepest, 0.2 * kRadius);
  EXPECT_NEAR(world.velocity(balls.all[3]).v.x, 10.0, 1e-4);
}

// In the plane x = 0.
TriangleMesh two_sided_square(double half) {
  const std::vector<Vec3> corners{
      {0, -half, -half}, {0, half, -half}, {0, half, half}, {0, -half, half}};
  const std::vector<TriangleMesh::Triangle> triangles{{0, 1, 2}, {0, 2, 3}};
  MeshOptions options;
  options.two_sided = true;
  return must(TriangleMesh::of(corners, triangles, options));
}

// Fast bodies without CCD do not pass through a plate of 20 mm or a mesh:
// contacts are searched for as far as a body moves in a step.
TEST(FastBodies, WithoutRotationPassThroughNothing) {
  const TriangleMesh sheet = two_sided_square(2);
  Random random(7);
  for (const Shape& shape : {Shape(Sphere{0.05}), Shape(Box{{0.05, 0.05, 0.05}}),
                             Shape(Capsule{0.02, 0.2}), Shape(Box{{0.3, 0.02, 0.02}})}) {
    for (const Shape& wall : {Shape(Box{{0.01, 2, 2}}), Shape(sheet)}) {
      for (const double speed : {10.0, 50.0, 200.0}) {
        for (int i = 0; i < 20; ++i) {
          SCOPED_TRACE(::testing::Message()
                       << shape.index() << ' ' << wall.index() << ' ' << speed << " m/s, " << i);
          World world(without_gravity());
          add_fixed(world, wall, {});
          const double from = -1.0 - random.uniform(0.0, speed / 20.0);
          const BodyId body = add_dynamic(
              world, {.shape = shape,
                      .pose = SE3(Vec3{from, random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5)}),
                      .velocity = {Vec3{}, Vec3{speed, 0, 0}}});
          for (int k = 0; k < 12; ++k) {
            must(world.step(1.0 / 60.0));
            ASSERT_LT(world.pose(body).position().x, 0.0);
          }
        }
      }
    }
  }
}

// Neither do those that bounce: after the impact the rest of the step is searched on this side.
TEST(FastBodies, ThatBouncePassThroughNothing) {
  const TriangleMesh sheet = two_sided_square(2);
  for (const Shape& shape :
       {Shape(Sphere{0.05}), Shape(Box{{0.05, 0.05, 0.05}}), Shape(Capsule{0.02, 0.2})}) {
    for (const Shape& wall : {Shape(Box{{0.01, 2, 2}}), Shape(sheet)}) {
      for (const double restitution : {0.3, 0.6, 1.0}) {
        for (const double speed : {20.0, 70.0, 200.0}) {
          for (int i = 0; i < 20; ++i) {
            SCOPED_TRACE(::testing::Message() << shape.index() << ' ' << wall.index() << ' '
                                              << restitution << ' ' << speed << " m/s, " << i);
            const Material bouncy{0.0, restitution, 0.0};
            World world(without_gravity());
            add_fixed(world, wall, bouncy);
            const BodyId body =
                add_dynamic(world, {.shape = shape,
                                    .material = bouncy,
                                    .pose = SE3(Vec3{-0.5 - speed / 60.0 * (i + 0.5) / 20, 0, 0}),
                                    .velocity = {Vec3{}, Vec3{speed, 0, 0}}});
            for (int k = 0; k < 4; ++k) must(world.step(1.0 / 60.0));
            ASSERT_LT(world.pose(body).position().x, 0.0);
            ASSERT_NEAR(world.velocity(body).v.x, -restitution * speed, 1e-3 * speed);
          }
        }
      }
    }
  }
}

// Nor is what stands behind a wall hit by what bounces off it.
TEST(FastBodies, ThatBounceHitNothingBehindAWall) {
  const Material bouncy{0.0, 0.9, 0.0};
  for (int i = 0; i < 100; ++i) {
    World world(without_gravity());
    add_fixed(world, Box{{0.25, 2, 2}}, bouncy);
    const BodyId behind =
        add_dynamic(world, {.shape = Box{{0.1, 0.1, 0.1}}, .pose = SE3(Vec3{0.4, 0, 0})});
    add_dynamic(world, {.shape = Sphere{0.05},
                        .material = bouncy,
                        .pose = SE3(Vec3{-0.35 - 200.0 / 60.0 * (i + 0.5) / 100, 0, 0}),
                        .velocity = {Vec3{}, Vec3{200, 0, 0}}});
    for (int k = 0; k < 4; ++k) must(world.step(1.0 / 60.0));
    EXPECT_EQ(norm(world.velocity(behind).v), 0.0) << i;
  }
}

// Neither do bodies that rotate up to 1.7 rad in the step in which they arrive.
TEST(FastBodies, WithRotationPassThroughNothing) {
  const TriangleMesh sheet = two_sided_square(9);
  Random random(7);
  int passed = 0;
  for (const Shape& shape :
       {Shape(Capsule{0.02, 0.3}), Shape(Box{{0.3, 0.02, 0.02}}), Shape(Box{{0.1, 0.2, 0.01}})}) {
    for (const Shape& wall : {Shape(Box{{0.01, 9, 9}}), Shape(sheet)}) {
      for (const double speed : {10.0, 50.0, 200.0}) {
        for (int i = 0; i < 60; ++i) {
          World world(without_gravity());
          add_fixed(world, wall, {});
          const double from = -1.0 - random.uniform(0.0, speed / 20.0);
          const Vec3 axis{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
          const BodyId body = add_dynamic(
              world,
              {.shape = shape,
               .pose = SE3(Vec3{from, random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5)}),
               .velocity = {random.uniform(10, 100) / norm(axis) * axis, Vec3{speed, 0, 0}}});
          for (int k = 0; k < 12; ++k) must(world.step(1.0 / 60.0));
          if (world.pose(body).position().x > 0.0) ++passed;
        }
      }
    }
  }
  EXPECT_EQ(passed, 0);
}

}  // namespace
}  // namespace vp::test
