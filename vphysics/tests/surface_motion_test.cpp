// Shapes that move on, into and past meshes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "collide/time_of_impact.h"
#include "joints_rig.h"
#include "samples.h"
#include "surface_rig.h"
#include "surfaces.h"

namespace vp::test {
namespace {

// The least separation that the points of b reach if it moves as the solver moves it.
double least_after(const Found& found, const collide::Motion& b) {
  double least = 1e300;
  for (const collide::SubManifold& s : found.manifolds) {
    for (int i = 0; i < s.manifold.count; ++i) {
      const collide::ManifoldPoint& p = s.manifold.points[i];
      const Vec3 on_b = p.position + 0.5 * p.separation * s.manifold.normal;
      least = std::min(least, p.separation + dot(s.manifold.normal, b.velocity(on_b)));
    }
  }
  return least;
}

int points_of(const Found& found) {
  int n = 0;
  for (const collide::SubManifold& s : found.manifolds) n += s.manifold.count;
  return n;
}

// Shapes move from above into a mesh of waves. What they enter is among the contacts that are found
// at the start, with fewer points than a margin for all directions finds.
TEST(SurfaceMotion, FindsWhatAShapeEnters) {
  constexpr double kSlack = 0.0023, kHeight = 0.15;
  const Shape waves = wave_mesh(24, 0.15, kHeight).made();
  Random random(7);
  for (const double angle : {0.0, 0.02, 0.1}) {
    int entered = 0, missed = 0, points = 0, points_everywhere = 0;
    for (const Shape& shape : convex_shapes()) {
      const collide::Geometry geometry = collide::make_geometry(shape);
      for (int k = 0; k < samples(600); ++k) {
        const SE3 T(random.rotation(), Vec3{random.uniform(-0.8, 0.8), random.uniform(-0.8, 0.8),
                                            random.uniform(kHeight + 0.05, 0.8)});
        const collide::Motion motion{T.position(), random.in_cube(0.2), angle * random.direction()};
        const collide::PairMotion pair{{}, motion, 1.0, 0.0};
        const auto pose = [&](double time) {
          return collide::pose_at({&geometry, T, motion}, time);
        };
        if (find(waves, SE3{}, shape, T, 0.005).deepest() < 0.003) continue;
        double deepest = 0.0;
        for (int i = 1; i <= 20; ++i)
          deepest = std::min(deepest, find(waves, SE3{}, shape, pose(0.05 * i), 0.0).deepest());
        const double largest = kSlack + norm(motion.v) + 0.6 * angle;
        const Found found = find(waves, SE3{}, shape, T, {largest, kSlack, 0.0, pair});
        points += points_of(found);
        points_everywhere += points_of(find(waves, SE3{}, shape, T, largest));
        if (deepest > -1e-4) continue;
        ++entered;
        missed += least_after(found, motion) > kSlack + 1e-4;
      }
    }
    EXPECT_GT(entered, samples(200)) << angle;
    EXPECT_LE(missed, entered / 50) << angle;
    EXPECT_LT(2 * points, points_everywhere) << angle;
  }
}

Compound hammer() {
  const std::vector<CompoundPart> parts{{Box{{0.3, 0.05, 0.05}}, SE3{}},
                                        {Sphere{0.1}, SE3(Vec3{0.3, 0, 0})},
                                        {Box{{0.1, 0.1, 0.1}}, SE3(Vec3{-0.3, 0, 0})}};
  return Compound::of(parts).value();
}

// Few bodies pass through bumpy ground that they graze at up to 200 m/s: one that must not needs
// BodyDesc::continuous.
TEST(SurfaceMotion, RarelyPassesThroughWaves) {
  constexpr double kHeight = 0.3;
  constexpr Material kRough{0.4, 0.2, 0.0};
  const TriangleMesh waves = wave_mesh(100, 0.2, kHeight).made();
  int below = 0, shots = 0;
  for (const double speed : {30.0, 60.0, 200.0}) {
    Random random(11);
    for (const Shape& shape :
         {Shape(Sphere{0.1}), Shape(Box{{0.1, 0.1, 0.1}}), Shape(Capsule{0.05, 0.3}),
          Shape(Box{{0.4, 0.05, 0.05}}), Shape(Cylinder{0.2, 0.1}), Shape(hammer())}) {
      for (int i = 0; i < samples(40); ++i) {
        World world;
        add_fixed(world, waves, kRough);
        Vec3 towards = random.direction();
        towards.z = -std::fabs(towards.z);
        const Vec3 from{random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(1.0, 1.6)};
        const BodyId body = add_dynamic(
            world, {.shape = shape, .material = kRough, .pose = SE3(random.rotation(), from)});
        must(world.set_velocity_world(
            body, {speed * towards, random.uniform(0.0, 10.0) * random.direction()}));
        bool is_below = false;
        for (int k = 0; k < 20 && !is_below; ++k) {
          must(world.step(1.0 / 60.0));
          const Vec3 x = world.pose(body).position();
          if (std::fabs(x.x) > 9.5 || std::fabs(x.y) > 9.5) break;  // beyond the border
          is_below = x.z < wave(x.x, x.y, kHeight) - 0.02;
        }
        below += is_below ? 1 : 0;
        ++shots;
      }
    }
  }
  EXPECT_LE(200 * below, shots);
}

// A body that flies past a round mesh does not collide with the planes of its triangles.
TEST(SurfaceMotion, IsNotDeflectedByWhatItPasses) {
  const TriangleMesh boulder = sphere_mesh(1.0, 3).made();
  Random random(3);
  for (const double speed : {5.0, 15.0, 50.0}) {
    for (const double gap : {0.01, 0.03, 0.1}) {
      for (const auto& [shape, radius] :
           {std::pair{Shape(Sphere{0.1}), 0.1}, std::pair{Shape(Box{{0.1, 0.1, 0.1}}), 0.174},
            std::pair{Shape(Capsule{0.05, 0.3}), 0.35},
            std::pair{Shape(Box{{0.3, 0.05, 0.05}}), 0.309}}) {
        for (int i = 0; i < 10; ++i) {
          World world(weightless());
          add_fixed(world, boulder, {});
          const Vec3 along = random.direction(), across = cross(along, random.direction());
          const Vec3 from =
              (1.0 + radius + gap) / norm(across) * across - random.uniform(1.0, 2.0) * along;
          const BodyId body =
              add_dynamic(world, {.shape = shape, .pose = SE3(random.rotation(), from)});
          must(world.set_velocity_world(body, {speed * along, 3.0 * random.direction()}));
          for (int k = 1; k * speed / 60.0 < 4.0; ++k) must(world.step(1.0 / 60.0));
          EXPECT_LT(norm(world.velocity_world(body).linear - speed * along), 1e-3 * speed)
              << shape.index() << ' ' << speed << " m/s, gap " << gap;
        }
      }
    }
  }
}

// Without friction a ball that spins keeps its spin when it lands on a mesh.
TEST(SurfaceMotion, KeepsItsSpinWithoutFriction) {
  World world(weightless());
  const auto flat = [](double, double) { return 0.0; };
  add_fixed(world, grid_mesh(1, 18.0, -9.0, flat).made(), {.friction = 0.0});
  const Vec3 spin{10.0, 0.0, 0.0};
  const BodyId ball = add_dynamic(
      world,
      {.shape = Sphere{0.1}, .material = {.friction = 0.0}, .pose = SE3(Vec3{0.2, 0.1, 0.3})});
  must(world.set_velocity_world(ball, {{0, 0, -5.0}, spin}));
  for (int k = 0; k < 20; ++k) must(world.step(1.0 / 60.0));
  EXPECT_GT(world.pose(ball).position().z, 0.09);
  EXPECT_LT(norm(world.velocity_world(ball).angular - spin), 0.01);
}

// A frictionless drum turns under bodies that lie in it: it moves none of them.
TEST(SurfaceMotion, InADrumWithoutFrictionStaysSlow) {
  constexpr std::uint32_t kSides = 24;
  constexpr double kRadius = 2.0, kHalfLength = 4.0;
  MeshPoints drum;
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const auto at = sin_cos(2.0 * kPi * i / kSides);
    for (const double x : {-kHalfLength, kHalfLength})
      drum.vertices.push_back({x, kRadius * at.cos, kRadius * at.sin});
    const std::uint32_t a = 2 * i, b = 2 * ((i + 1) % kSides);
    drum.triangles.push_back({a, b + 1, b});
    drum.triangles.push_back({a, a + 1, b + 1});
  }
  constexpr Material kSlippery{0.0, 0.0, 0.0};
  for (const double rate : {60.0, 240.0}) {
    for (const Shape& shape : {Shape(Sphere{0.1}), Shape(Box{{0.1, 0.1, 0.1}}),
                               Shape(Capsule{0.05, 0.3}), Shape(Cylinder{0.2, 0.1})}) {
      World world;
      add_kinematic(world, drum.made(), {{20.0, 0, 0}, {}}, kSlippery);
      Random random(3);
      std::vector<BodyId> bodies;
      for (int i = 0; i < 8; ++i) {
        const Vec3 at{i - 3.5, random.uniform(-0.9, 0.9), random.uniform(-0.9, 0.9)};
        bodies.push_back(add_dynamic(
            world, {.shape = shape, .material = kSlippery, .pose = SE3(random.rotation(), at)}));
      }
      double fastest = 0.0;
      for (int k = 0; k < 2.0 * rate; ++k) {
        must(world.step(1.0 / rate));
        for (const BodyId body : bodies) {
          fastest = std::max(fastest, norm(world.velocity_world(body).linear));
          const Vec3 x = world.pose(body).position();
          ASSERT_LT(x.y * x.y + x.z * x.z, kRadius * kRadius) << shape.index() << ", " << rate;
        }
      }
      EXPECT_LT(fastest, std::sqrt(2.0 * 9.81 * (0.9 + kRadius))) << shape.index() << ", " << rate;
    }
  }
}

}  // namespace
}  // namespace vp::test
