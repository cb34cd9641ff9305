// Several seconds of bodies on hills: Release builds only.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "rig.h"
#include "surfaces.h"

namespace vp::test {
namespace {

constexpr double kGravity = 9.81;

double hill(double x, double y) {
  return 0.4 * std::sin(0.9 * x) + 0.3 * std::sin(1.3 * y + 0.5) +
         0.1 * std::sin(3.1 * x + 2.3 * y);
}
constexpr std::uint32_t kSamples = 81;
constexpr double kSpacing = 0.125;
HeightField hilly_field() {
  std::vector<double> heights;
  for (std::uint32_t j = 0; j < kSamples; ++j) {
    for (std::uint32_t i = 0; i < kSamples; ++i)
      heights.push_back(hill(kSpacing * i, kSpacing * j));
  }
  return HeightField::of({kSamples, kSamples, kSpacing, kSpacing, heights, {}}).value();
}
TriangleMesh hilly_mesh() {
  Random random(72);
  MeshPoints m = random_plane(random, 60, 10.0);
  for (Vec3& v : m.vertices) v.z = hill(v.x, v.y);
  return m.made();
}

struct Rider {
  Shape shape;
  bool continuous;
};
const Rider kRiders[] = {{Box{{0.3, 0.2, 0.1}}, false},
                         {Cylinder{0.2, 0.1}, false},
                         {Sphere{0.1}, false},
                         {Sphere{0.1}, true}};

// The energy of bodies that slide over hills without friction, or roll over them, does not grow: no
// edge adds energy.
TEST(SurfaceWorld, HillsGiveNoEnergy) {
  const Shape grounds[] = {hilly_field(), hilly_mesh()};
  double most = 0.0, least = 0.0;
  for (const Shape& ground : grounds) {
    for (const Rider& rider : kRiders) {
      for (const double friction : {0.0, 0.6}) {
        World world;
        const Material material{friction, 0.0, 0.0};
        add_fixed(world, ground, material);
        Part part{.shape = rider.shape, .material = material, .continuous = rider.continuous};
        part.pose = SE3(Vec3{5.0, 4.7, hill(5.0, 4.7) + 0.3});
        const BodyId body = add_dynamic(world, part);
        const Inertia J = solid_inertia(rider.shape, 1000.0);
        const auto energy = [&] {
          const se3 V = world.velocity(body);
          return 0.5 * (V * (J * V)) + J.mass() * kGravity * world.pose(body).position().z;
        };
        double lowest = energy();
        const double start = lowest, scale = J.mass() * kGravity;
        for (int i = 0; i < 1500; ++i) {
          must(world.step(0.001));
          const double now = energy();
          most = std::max(most, (now - lowest) / scale);  // as a height
          lowest = std::min(lowest, now);
        }
        least = std::min(least, (lowest - start) / scale);
      }
    }
  }
  EXPECT_LT(most, 2e-3) << most;  // m
  EXPECT_LT(least, -0.1);         // they moved
}

// Fifty bodies of every kind fall on hills within walls: none falls through.
TEST(SurfaceWorld, APileOfFiftyMixedBodiesStaysAboveAHeightField) {
  Random random(73);
  World world;
  add_fixed(world, hilly_field(), {});
  const double side = kSpacing * (kSamples - 1);
  for (const double at : {0.0, side}) {
    add_fixed(world, Box{{0.1, side, 3}}, {}, SE3(Vec3{at, 0.5 * side, 0}));
    add_fixed(world, Box{{side, 0.1, 3}}, {}, SE3(Vec3{0.5 * side, at, 0}));
  }
  std::vector<Vec3> points;
  for (int i = 0; i < 20; ++i) points.push_back(0.3 * random.direction());
  const CompoundPart bars[] = {{Box{{0.3, 0.08, 0.08}}, SE3(Vec3{0, 0, 0})},
                               {Box{{0.08, 0.3, 0.08}}, SE3(Vec3{0, 0.2, 0})},
                               {Sphere{0.12}, SE3(Vec3{0.2, 0, 0.15})}};
  const Shape shapes[] = {Box{{0.2, 0.15, 0.1}},     Sphere{0.2},    Capsule{0.12, 0.15},
                          Cylinder{0.15, 0.2},       Cone{0.2, 0.2}, ConvexHull::of(points).value(),
                          Compound::of(bars).value()};
  std::vector<BodyId> bodies;
  for (int i = 0; i < 50; ++i) {
    const SE3 T(random.rotation(), Vec3{random.uniform(3, 7), random.uniform(3, 7), 1.5 + 0.2 * i});
    Part part{.shape = shapes[i % 7], .pose = T};
    bodies.push_back(add_dynamic(world, part));
  }
  double lowest = 1.0, fastest = 0.0;
  for (int i = 0; i < 5 * 240; ++i) {
    ASSERT_FALSE(must(world.step(1.0 / 240)).non_finite);
    fastest = 0.0;
    for (const BodyId body : bodies) {
      const SE3 T = world.pose(body);
      const Vec3 centre = T * world.inertia(body).centre_of_mass();
      lowest = std::min(lowest, centre.z - hill(centre.x, centre.y));
      fastest = std::max(fastest, norm(world.velocity(body).v));
    }
  }
  // The centre of mass is never closer to the ground than half the thinnest body, except where the
  // ground is a chord.
  EXPECT_GT(lowest, 0.04) << lowest;
  EXPECT_LT(fastest, 3.0);
}

// After Box3D's trees: logs of hexagonal prisms, each thinner than the one before, fall over on
// waves of 10 and 20 m length.
double wave(double x, double y) {
  return 0.4 * std::sin(0.2 * kPi * x) * std::sin(0.1 * kPi * y);
}
TriangleMesh wavy_mesh(double cell, double along_x, double along_y) {
  MeshPoints m;
  const auto nx = static_cast<std::uint32_t>(along_x / cell),
             ny = static_cast<std::uint32_t>(along_y / cell);
  for (std::uint32_t j = 0; j <= ny; ++j) {
    for (std::uint32_t i = 0; i <= nx; ++i) {
      const double x = cell * i - 0.5 * along_x, y = cell * j - 0.5 * along_y;
      m.vertices.push_back({x, y, wave(x, y)});
      if (i == nx || j == ny) continue;
      const std::uint32_t a = j * (nx + 1) + i, d = a + nx + 1;
      m.triangles.push_back({a, a + 1, d + 1});
      m.triangles.push_back({a, d + 1, d});
    }
  }
  return m.made();
}
HeightField wavy_field(double cell, double along_x, double along_y) {
  const auto nx = static_cast<std::uint32_t>(along_x / cell) + 1,
             ny = static_cast<std::uint32_t>(along_y / cell) + 1;
  std::vector<double> heights;
  for (std::uint32_t j = 0; j < ny; ++j) {
    for (std::uint32_t i = 0; i < nx; ++i)
      heights.push_back(wave(cell * i - 0.5 * along_x, cell * j - 0.5 * along_y));
  }
  return HeightField::of({nx, ny, cell, cell, heights, {}}).value();
}
std::vector<Shape> log_of_prisms(int count) {
  std::vector<Shape> prisms;
  double bottom = 0.25, radius = 0.75;
  for (int k = 0; k < count; ++k) {
    const double length = 1.5 + 2.0 * radius;
    std::vector<Vec3> corners;
    for (int i = 0; i < 6; ++i) {
      const auto [s, c] = sin_cos(kPi / 3.0 * i);
      corners.push_back({radius * c, radius * s, bottom});
      corners.push_back({radius * c, radius * s, bottom + length});
    }
    prisms.emplace_back(ConvexHull::of(corners).value());
    bottom += radius + 1.5 + 0.95 * radius;
    radius *= 0.95;
  }
  return prisms;
}

struct Logs {
  const char* name;
  double cell;
  bool field, compound;
  int prisms;
};

TEST(SurfaceWorld, LogsOfPrismsComeToRestOnWaves) {
  for (const Logs& logs :
       {Logs{"a mesh", 1.0, false, false, 6}, Logs{"fine", 0.5, false, false, 6},
        Logs{"long", 0.5, false, false, 10}, Logs{"compounds", 1.0, false, true, 6},
        Logs{"a height field", 1.0, true, false, 6}}) {
    SCOPED_TRACE(logs.name);
    World world;
    const Material material{0.9, 0.0, 0.05};
    constexpr double kAlongX = 150.0, kAlongY = 100.0;
    const SE3 corner(Vec3{-0.5 * kAlongX, -0.5 * kAlongY, 0.0});
    if (logs.field) {
      add_fixed(world, wavy_field(logs.cell, kAlongX, kAlongY), material, corner);
    } else {
      add_fixed(world, wavy_mesh(logs.cell, kAlongX, kAlongY), material);
    }
    std::vector<BodyId> bodies;
    std::vector<CompoundPart> parts;
    for (const Shape& prism : log_of_prisms(logs.prisms)) parts.push_back({prism, SE3()});
    for (int b = 0; b < 30; ++b) {
      BodyDesc desc;
      desc.T_world_body = SE3(Vec3{0.0, 3.0 * b - 45.0, 0.0});
      desc.velocity.w = {0.0, (b % 2 == 0 ? -0.5 : 0.5) * (0.5 + b / 60.0), 0.0};
      desc.inertia = Inertia(1.0, Vec3{1.0, 1.0, 1.0});
      bodies.push_back(must(world.create_body(desc)));
      ColliderDesc collider;
      collider.material = material;
      if (logs.compound) {
        collider.shape = Compound::of(parts).value();
        must(world.add_collider(bodies.back(), collider));
      }
      for (std::size_t k = 0; k < parts.size() && !logs.compound; ++k) {
        collider.shape = parts[k].shape;
        must(world.add_collider(bodies.back(), collider));
      }
      must(world.set_mass_from_colliders(bodies.back()));
      must(world.set_velocity(bodies.back(), desc.velocity));
    }
    for (int i = 0; i < 20 * 60; ++i) must(world.step(1.0 / 60));
    double fastest = 0.0, lowest = 1.0;
    for (const BodyId body : bodies) {
      const SE3 T = world.pose(body);
      const Vec3 centre = T * world.inertia(body).centre_of_mass();
      fastest = std::max(fastest, norm(world.velocity(body).w));
      lowest = std::min(lowest, centre.z - wave(centre.x, centre.y));
    }
    EXPECT_LT(fastest, 0.01);
    EXPECT_GT(lowest, 0.2);
  }
}

}  // namespace
}  // namespace vp::test
