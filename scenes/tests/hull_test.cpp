// Hulls, their masses, their principal axes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "scenes/scene.h"
#include "vphysics/convex_hull.h"

namespace scenes {
namespace {

std::vector<Vec3> box_corners(const Vec3& half) {
  std::vector<Vec3> out;
  for (int i = 0; i < 8; ++i) {
    out.push_back({i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 4 ? half.z : -half.z});
  }
  return out;
}

// Each edge occurs once in each direction: the surface is closed.
bool is_closed(const Polyhedron& hull) {
  std::vector<std::pair<int, int>> edges;
  for (const Polyhedron::Face& face : hull.faces) {
    for (std::size_t k = 0; k < face.corners.size(); ++k) {
      edges.emplace_back(face.corners[k], face.corners[(k + 1) % face.corners.size()]);
    }
  }
  std::sort(edges.begin(), edges.end());
  return std::adjacent_find(edges.begin(), edges.end()) == edges.end() &&
         std::all_of(edges.begin(), edges.end(), [&](const std::pair<int, int>& e) {
           return std::binary_search(edges.begin(), edges.end(), std::pair(e.second, e.first));
         });
}

TEST(HullOf, OfABoxesCornersHasItsFacesAndNothingElse) {
  std::vector<Vec3> points = box_corners({1.0, 2.0, 3.0});
  points.push_back({0.2, 0.3, -0.4});  // inside
  points.push_back({1.0, 0.5, 0.5});   // on a face
  points.push_back({1.0, 2.0, 0.7});   // on an edge
  points.push_back(points[3]);         // a duplicate corner
  const Hull hull = hull_of(points);
  EXPECT_EQ(hull.data->points.size(), 8u);
  ASSERT_EQ(hull.data->faces.size(), 6u);
  for (const Polyhedron::Face& face : hull.data->faces) {
    EXPECT_EQ(face.corners.size(), 4u);
    EXPECT_NEAR(norm(face.normal), 1.0, 1e-15);
    EXPECT_NEAR(face.offset, std::fabs(dot(face.normal, Vec3{1.0, 2.0, 3.0})), 1e-12);
  }
  EXPECT_TRUE(is_closed(*hull.data));
}

TEST(HullOf, ManyPointsOnASphereCloses) {
  std::vector<Vec3> points;
  for (int i = 0; i < 40; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / 40.0;
    const auto [s, c] = vp::sin_cos(2.4 * i);
    points.push_back({std::sqrt(1.0 - z * z) * c, std::sqrt(1.0 - z * z) * s, z});
  }
  const Hull hull = hull_of(points);
  EXPECT_EQ(hull.data->points.size(), 40u);
  EXPECT_EQ(hull.data->faces.size(), 2u * 40u - 4u);  // Euler's formula, all faces triangles
  EXPECT_TRUE(is_closed(*hull.data));
}

TEST(HullMass, OfABoxesCornersIsTheBoxes) {
  const Vec3 half{0.3, 0.5, 0.7};
  const Mass hull = mass_of(Shape(hull_of(box_corners(half))), 800.0);
  const Mass box = mass_of(Shape(Box{half}), 800.0);
  EXPECT_NEAR(hull.mass, box.mass, 1e-12 * box.mass);
  EXPECT_LT(norm(hull.moments - box.moments), 1e-12 * box.mass);
}

TEST(HullMass, IsAboutTheCentreOfMassWhereverTheOriginIs) {
  const Vec3 half{0.3, 0.5, 0.7};
  std::vector<Vec3> points = box_corners(half);
  for (Vec3& p : points) p += Vec3{5.0, -3.0, 2.0};
  const Mass hull = mass_of(Shape(hull_of(points)), 800.0);
  EXPECT_LT(norm(hull.moments - mass_of(Shape(Box{half}), 800.0).moments), 1e-9);
}

TEST(HullMass, AgreesWithTheEngines) {
  std::vector<Vec3> points;
  for (int i = 0; i < 12; ++i) {
    const auto [s, c] = vp::sin_cos(1.7 * i);
    points.push_back({s + 0.1 * i, 0.5 * c, 0.3 * vp::sin_cos(0.9 * i * i).sin});
  }
  const vp::Inertia engine = vp::ConvexHull::of(points).value().inertia(500.0);
  const Mass own = mass_of(Shape(hull_of(points)), 500.0);
  const vp::Sym3 I = engine.central();
  EXPECT_NEAR(own.mass, engine.mass(), 1e-12 * own.mass);
  EXPECT_LT(norm(own.moments - Vec3{I.xx, I.yy, I.zz}), 1e-12 * own.mass);
}

TEST(MakePrincipal, GivesATurnedBoxItsMomentsAndLeavesItWhereItIs) {
  const Vec3 half{0.3, 0.5, 0.7};
  const SE3 T(vp::Exp(Vec3{0.4, -0.8, 1.1}), {2.0, 1.0, -3.0});
  std::vector<Vec3> points = box_corners(half);
  for (Vec3& p : points) p = T * p;
  Body body;
  body.parts.push_back({hull_of(points), SE3{}, 800.0, {}});
  make_principal(body);
  const Mass mass = mass_of(body), box = mass_of(Shape(Box{half}), 800.0);
  std::array<double, 3> moments{mass.moments.x, mass.moments.y, mass.moments.z};
  std::sort(moments.begin(), moments.end());
  EXPECT_NEAR(moments[0], box.moments.z, 1e-11 * box.mass);
  EXPECT_NEAR(moments[1], box.moments.y, 1e-11 * box.mass);
  EXPECT_NEAR(moments[2], box.moments.x, 1e-11 * box.mass);
  EXPECT_LT(norm(body.T_world_body.position() - T.position()), 1e-12);
  const auto& hull = *std::get<Hull>(body.parts[0].shape).data;
  for (const Vec3& p : hull.points) {
    const Vec3 in_world = body.T_world_body * p;
    EXPECT_TRUE(std::any_of(points.begin(), points.end(),
                            [&](const Vec3& q) { return norm(q - in_world) < 1e-12; }));
  }
}

// A cube cut in two: the parts together have the moments of the complete cube.
TEST(MakePrincipal, TakesSeveralPartsTogether) {
  Body body;
  body.parts.push_back({Box{{0.5, 0.25, 0.5}}, SE3(Vec3{3.0, 0.25, 1.0}), 1000.0, {}});
  std::vector<Vec3> points = box_corners({0.5, 0.25, 0.5});
  for (Vec3& p : points) p += Vec3{3.0, -0.25, 1.0};
  body.parts.push_back({hull_of(points), SE3{}, 1000.0, {}});
  make_principal(body);
  const Mass mass = mass_of(body), cube = mass_of(Shape(Box{{0.5, 0.5, 0.5}}), 1000.0);
  EXPECT_NEAR(mass.mass, cube.mass, 1e-9);
  EXPECT_LT(norm(mass.moments - cube.moments), 1e-9);
  EXPECT_LT(norm(body.T_world_body.position() - Vec3{3.0, 0.0, 1.0}), 1e-12);
}

}  // namespace
}  // namespace scenes
