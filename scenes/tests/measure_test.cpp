#include "scenes/measure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "../src/random.h"

namespace scenes {
namespace {

constexpr Box kCube{{0.5, 0.5, 0.5}};
const double kRoot2 = std::sqrt(2.0), kRoot3 = std::sqrt(3.0);

SE3 at(double x, double y, double z) {
  return SE3(Vec3{x, y, z});
}
SE3 turned(const Vec3& w, const Vec3& p) {
  return SE3(vp::Exp(w), p);
}

struct Case {
  const char* what;
  Shape a;
  SE3 pose_a;
  Shape b;
  SE3 pose_b;
  double depth;
};

TEST(Penetration, IsWhatASketchSays) {
  const SE3 on_edge = turned({0.25 * vp::kPi, 0, 0}, {0, 0, 0});
  // Its diagonal from (-1, -1, -1) to (1, 1, 1) is vertical.
  const double tilt = std::acos(1.0 / kRoot3);
  const SE3 on_corner = turned(Vec3{-tilt / kRoot2, tilt / kRoot2, 0}, {0, 0, 0});
  const SE3 up(on_corner.rotation(), {0, 0, 0.85});
  std::vector<double> rises;  // by 45 degrees along x
  for (int k = 0; k < 25; ++k) rises.push_back(k % 5);
  const Terrain slope{5, 5, 1.0, std::make_shared<const std::vector<double>>(rises)};
  const Case kCases[] = {
      {"box on ground", Ground{}, SE3{}, kCube, at(3, 4, 0.49), 0.01},
      {"box over ground", Ground{}, SE3{}, kCube, at(3, 4, 0.51), -0.01},
      {"box corner in ground", Ground{}, SE3{}, kCube, up, 0.5 * kRoot3 - 0.85},
      {"box on a slope of terrain", slope, SE3{}, kCube,
       turned({0, -0.25 * vp::kPi, 0}, {2, 2, 2 + 0.5 * std::sqrt(2.0) - 0.01}),
       0.01 / std::sqrt(2.0)},
      {"sphere in terrain", slope, at(0, 0, 1), Sphere{0.5}, at(2, 2, 3 + 0.3 * std::sqrt(2.0)),
       0.2},
      {"sphere in ground", Sphere{0.5}, at(0, 0, 0.4), Ground{}, SE3{}, 0.1},
      {"capsule standing in ground", Capsule{0.3, 0.3}, at(0, 0, 0.5), Ground{}, SE3{}, 0.1},
      {"ground that slopes", Ground{}, turned({0, 0.25 * vp::kPi, 0}, {}), Sphere{0.5},
       at(0, 0, 0.5 * kRoot2), 0.0},
      {"box in box", kCube, SE3{}, kCube, at(0.2, 0.3, 0.98), 0.02},
      {"box wholly in box", kCube, SE3{}, Box{{0.1, 0.1, 0.1}}, at(0.3, 0, 0), 0.3},
      {"edge of a box in a face", kCube, on_edge, kCube, at(0, 0, 0.5 * kRoot2 + 0.49), 0.01},
      {"edge in edge", kCube, on_edge, kCube, turned({0, 0.25 * vp::kPi, 0}, {0, 0, kRoot2 - 0.03}),
       0.03},
      {"corner in a face", kCube, up, kCube, at(0, 0, -0.5), 0.5 * kRoot3 - 0.85},
      {"spheres", Sphere{0.5}, SE3{}, Sphere{0.25}, at(0.3, 0.4, 0), 0.25},
      {"sphere at a face", Sphere{0.5}, at(0, 0, 0.9), kCube, SE3{}, 0.1},
      {"sphere at an edge", Sphere{0.5}, at(0.5 + 0.3, 0, 0.5 + 0.3), kCube, SE3{},
       0.5 - 0.3 * kRoot2},
      {"sphere at a corner", Sphere{0.5}, at(0.7, 0.7, 0.7), kCube, SE3{}, 0.5 - 0.2 * kRoot3},
      {"sphere's centre in a box", Sphere{0.5}, at(0, 0, 0.4), kCube, SE3{}, 0.6},
      {"capsule over an edge", Capsule{0.3, 1.0}, turned({0, 0.5 * vp::kPi, 0}, {0, 0.6, 0.7}),
       kCube, SE3{}, 0.3 - std::sqrt(0.05)},
      {"capsule's end at a face", Capsule{0.3, 0.3}, at(0, 0, 1.05), kCube, SE3{}, 0.05},
      {"capsule through a box", Capsule{0.1, 2.0}, at(0.45, 0, 0), kCube, SE3{}, 0.15},
      {"capsules crossed", Capsule{0.3, 1.0}, SE3{}, Capsule{0.2, 1.0},
       turned({0.5 * vp::kPi, 0, 0}, {0.45, 0, 0}), 0.05},
      {"capsules side by side", Capsule{0.3, 1.0}, SE3{}, Capsule{0.2, 0.5}, at(0.3, 0.3, 0.2),
       0.5 - 0.3 * kRoot2},
      {"capsules in line", Capsule{0.3, 1.0}, SE3{}, Capsule{0.2, 0.5}, at(0, 0, 1.95), 0.05},
      {"capsules through each other", Capsule{0.3, 1.0}, SE3{}, Capsule{0.2, 1.0},
       turned({0.5 * vp::kPi, 0, 0}, {0, 0, 0}), 0.5},
      {"sphere beside a capsule", Sphere{0.5}, at(0.6, 0, 0.9), Capsule{0.2, 1.0}, SE3{}, 0.1},
  };
  for (const Case& c : kCases) {
    EXPECT_NEAR(penetration(c.a, c.pose_a, c.b, c.pose_b), c.depth, 1e-12) << c.what;
    EXPECT_NEAR(penetration(c.b, c.pose_b, c.a, c.pose_a), c.depth, 1e-12) << c.what;
  }
}

TEST(Penetration, IsAsItIsFromEveryPointOfView) {
  const SE3 view = turned({0.4, -1.1, 0.7}, {20, -30, 10});
  const SE3 a = turned({0.2, 0.1, 0.3}, {0, 0, 0}), b = turned({-0.3, 0.8, 0.1}, {0.5, 0.4, 0.6});
  for (const Shape& shape : {Shape(kCube), Shape(Capsule{0.3, 0.4}), Shape(Sphere{0.4})}) {
    EXPECT_NEAR(penetration(kCube, a, shape, b), penetration(kCube, view * a, shape, view * b),
                1e-13);
  }
}

// A translation along n separates two convex bodies by their overlap along n: the depth is the
// minimum over all directions. Sampled directions give no smaller value, and with many samples one
// is close to the minimum.
TEST(Penetration, OfBoxesIsTheLeastOverlapOverAllDirections) {
  Random random(7);
  const auto reach = [](const Box& box, const SE3& T, const Vec3& n) {
    const Vec3 local = T.unrotate(n);
    return std::fabs(local.x) * box.half_extents.x + std::fabs(local.y) * box.half_extents.y +
           std::fabs(local.z) * box.half_extents.z;
  };
  int meeting = 0;
  for (int pair = 0; pair < 40; ++pair) {
    const Box a{Vec3{0.6, 0.6, 0.6} + random.in_cube(0.3)};
    const Box b{Vec3{0.6, 0.6, 0.6} + random.in_cube(0.3)};
    const SE3 A = turned(2.0 * random.in_cube(1.0), random.in_cube(0.2));
    const SE3 B = turned(2.0 * random.in_cube(1.0), random.in_cube(0.8));
    const double depth = penetration(a, A, b, B);
    if (depth <= 0.0) continue;
    ++meeting;
    double min = 1e9;
    for (int k = 0; k < 40000; ++k) {
      const Vec3 any = random.in_cube(1.0);
      if (norm(any) < 0.1) continue;
      const Vec3 n = (1.0 / norm(any)) * any;
      const double overlap =
          reach(a, A, n) + reach(b, B, n) - std::fabs(dot(n, B.position() - A.position()));
      min = std::min(min, overlap);
    }
    EXPECT_LE(depth, min + 1e-12);
    EXPECT_GE(depth, min - 0.03);
  }
  EXPECT_GT(meeting, 20);
  // Measured: 0.016 m at worst; the directions are about a degree apart.
}

Scene two_boxes() {
  Scene scene;
  Body ground;
  ground.motion = Motion::fixed;
  ground.parts = {{Ground{}, SE3{}, 1000.0, {}}};
  Body box;
  box.parts = {{kCube, SE3{}, 1000.0, {}}};
  box.T_world_body = at(0, 0, 0.5);
  scene.bodies = {ground, box, box};
  scene.bodies[2].T_world_body = at(0, 0, 1.5);
  scene.in_place.rule = InPlace::Rule::near_start;
  return scene;
}

TEST(Standing, TellsDriftSinkAndWhoIsInPlace) {
  const Scene scene = two_boxes();
  const SE3 moved[] = {SE3{}, at(0.03, 0.04, 0.49), at(0.0, 0.12, 1.47)};
  const Standing standing = measure(scene, moved);
  EXPECT_EQ(standing.of, 2);
  EXPECT_EQ(standing.in_place, 1);
  EXPECT_EQ(standing.lost, 0);
  EXPECT_NEAR(standing.drift, 0.12, 1e-15);
  EXPECT_NEAR(standing.sink, 0.03, 1e-15);
  EXPECT_NEAR(standing.penetration, 0.02, 1e-15);  // of the two boxes; 0.01 in the ground
}

TEST(Standing, CountsWhoIsInsideWhereThatIsTheRule) {
  Scene scene = two_boxes();
  scene.in_place.rule = InPlace::Rule::inside;
  scene.in_place.lower = {-5, -5, 0};
  scene.in_place.upper = {5, 5, 100};
  const SE3 moved[] = {SE3{}, at(4, 4, 0.5), at(0, 5.1, 0.5)};
  EXPECT_EQ(measure(scene, moved).in_place, 1);
}

TEST(Standing, LeavesOutJoinedBodiesAndMeasuresTheirJoint) {
  Scene scene = two_boxes();
  const SE3 moved[] = {SE3{}, at(0, 0, 0.5), at(0.3, 0, 1.4)};
  EXPECT_NEAR(measure(scene, moved).penetration, 0.1, 1e-15);
  scene.joints.push_back({Joint::Kind::ball, 2, 1, at(0, 0, -0.5), at(0, 0, 0.5)});
  EXPECT_EQ(measure(scene, moved).penetration, 0.0);
  EXPECT_NEAR(measure(scene, moved).gap, std::hypot(0.3, 0.1), 1e-15);
}

TEST(Standing, CountsBodiesWithoutAPoseAsLost) {
  const Scene scene = two_boxes();
  const double kNan = std::numeric_limits<double>::quiet_NaN();
  const SE3 moved[] = {SE3{}, at(0, 0, 0.5), at(0, kNan, 1.5)};
  const Standing standing = measure(scene, moved);
  EXPECT_EQ(standing.lost, 1);
  EXPECT_EQ(standing.in_place, 1);
  EXPECT_EQ(standing.drift, 0.0);
}

// Sweep and prune along x omits no pair: against brute force.
TEST(Standing, FindsTheDeepestOfAllPairs) {
  Random random(11);
  for (int round = 0; round < 20; ++round) {
    Scene scene;
    for (int i = 0; i < 60; ++i) {
      Body body;
      const Shape shapes[] = {Box{{0.3, 0.1, 0.5}}, Sphere{0.3}, Capsule{0.2, 0.6}};
      body.parts = {{shapes[i % 3], SE3{}, 1000.0, {}}};
      body.T_world_body = turned(3.0 * random.in_cube(1.0), random.in_cube(2.5));
      scene.bodies.push_back(body);
    }
    const auto poses = start_poses(scene);
    double deepest = 0.0;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        deepest = std::max(deepest, penetration(scene.bodies[i].parts[0].shape, poses[i],
                                                scene.bodies[j].parts[0].shape, poses[j]));
      }
    }
    EXPECT_GT(deepest, 0.0);
    EXPECT_NEAR(measure(scene, poses).penetration, deepest, 1e-12);
  }
}

Hull cube_hull(double half) {
  std::vector<Vec3> points;
  for (int i = 0; i < 8; ++i) {
    points.push_back({i & 1 ? half : -half, i & 2 ? half : -half, i & 4 ? half : -half});
  }
  return hull_of(points);
}

// Four squares of 1 m about the origin, with +z up.
Mesh square_mesh() {
  Triangles out;
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) out.vertices.push_back({i - 1.0, j - 1.0, 0.0});
  }
  for (const std::uint32_t low : {0u, 1u, 3u, 4u}) {
    out.corners.push_back({low, low + 1, low + 4});
    out.corners.push_back({low, low + 4, low + 3});
  }
  return {std::make_shared<const Triangles>(out)};
}

TEST(HullPenetration, IsThatOfTheBoxWhereCornersAreInFaces) {
  const SE3 up(Vec3{0.1, 0.2, 0.9}), turned(vp::Exp(Vec3{0.3, 0.5, 0.2}), {0.1, 0.2, 1.15});
  const Shape hull = cube_hull(0.5), box = Box{{0.5, 0.5, 0.5}};
  for (const Shape& a : {hull, box}) {
    EXPECT_NEAR(penetration(a, SE3{}, hull, up), 0.1, 1e-12);
    EXPECT_NEAR(penetration(hull, up, a, SE3{}), 0.1, 1e-12);
    EXPECT_NEAR(penetration(a, SE3{}, hull, turned), penetration(box, SE3{}, box, turned), 1e-12);
  }
  EXPECT_NEAR(penetration(Ground{}, SE3{}, hull, SE3(Vec3{0, 0, 0.4})), 0.1, 1e-12);
  EXPECT_NEAR(penetration(Ground{}, SE3{}, hull, turned), penetration(Ground{}, SE3{}, box, turned),
              1e-12);
  EXPECT_LT(penetration(hull, SE3{}, hull, SE3(Vec3{0, 0, 1.5})), 0.0);
}

TEST(HullPenetration, OfBallsAndCapsulesIsThatOfTheBox) {
  const Shape hull = cube_hull(0.5), box = Box{{0.5, 0.5, 0.5}};
  const Shape ball = Sphere{0.3}, capsule = Capsule{0.2, 0.4};
  for (int i = 0; i < 20; ++i) {
    const auto [s, c] = vp::sin_cos(1.3 * i);
    const SE3 T(vp::Exp(Vec3{s, 0.3 * i, c}), {0.7 * s, 0.7 * c, 0.07 * i - 0.7});
    for (const Shape& other : {ball, capsule}) {
      const double by_box = penetration(box, SE3{}, other, T);
      const double radius = other.index() == ball.index() ? 0.3 : 0.2;
      if (by_box >= radius) continue;  // the cores overlap: another measure
      EXPECT_NEAR(penetration(hull, SE3{}, other, T), by_box, 1e-9) << i;
    }
  }
}

TEST(MeshPenetration, IsHowFarSomethingIsBehindIt) {
  const Shape mesh = square_mesh();
  const SE3 tilted(vp::Exp(Vec3{0.4, 0.0, 0.0}), {});
  const auto at = [&](double height) { return tilted * SE3(Vec3{0.2, 0.1, height}); };
  for (const Shape& cube : {Shape(cube_hull(0.25)), Shape(Box{{0.25, 0.25, 0.25}})}) {
    EXPECT_NEAR(penetration(mesh, tilted, cube, at(0.24)), 0.01, 1e-12);
    EXPECT_NEAR(penetration(cube, at(0.3), mesh, tilted), -0.05, 1e-12);
    // Completely behind it, and no longer in it.
    EXPECT_LT(penetration(mesh, tilted, cube, at(-1.0)), 0.0);
  }
  EXPECT_NEAR(penetration(mesh, tilted, Sphere{0.25}, at(0.24)), 0.01, 1e-12);
  EXPECT_NEAR(penetration(mesh, tilted, Sphere{0.25}, at(-0.01)), 0.26, 1e-12);
  EXPECT_NEAR(penetration(mesh, tilted, Capsule{0.05, 0.2}, at(0.24)), 0.01, 1e-12);
}

// A vertex that penetrates a face between the face's corners.
TEST(MeshPenetration, SeesAPeakInAFace) {
  Triangles out;
  out.vertices = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {0, 0, 0.5}};
  out.corners = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  const Shape peak = Mesh{std::make_shared<const Triangles>(out)};
  for (const Shape& cube : {Shape(cube_hull(0.1)), Shape(Box{{0.1, 0.1, 0.1}})}) {
    EXPECT_NEAR(penetration(peak, SE3{}, cube, SE3(Vec3{0, 0, 0.58})), 0.02, 1e-12);
  }
}

TEST(Measure, LeavesOutWhatDoesNotExist) {
  Scene scene;
  for (const double x : {0.0, 0.5}) {
    Body ball;
    ball.T_world_body = SE3(Vec3{x, 0, 0});
    ball.parts.push_back({Sphere{0.3}, SE3{}, 1000.0, {}});
    scene.bodies.push_back(ball);
  }
  scene.bodies[1].from = 1.0;
  scene.bodies[1].until = 2.0;
  const auto poses = start_poses(scene);
  for (const double time : {0.0, 2.0}) {
    EXPECT_EQ(measure(scene, poses, time).of, 1);
    EXPECT_EQ(measure(scene, poses, time).penetration, 0.0);
  }
  EXPECT_EQ(measure(scene, poses, 1.0).of, 2);
  EXPECT_NEAR(measure(scene, poses, 1.0).penetration, 0.1, 1e-12);
}

}  // namespace
}  // namespace scenes
