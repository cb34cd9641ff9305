// Hulls of every kind of point set against the properties of any convex hull; their masses against
// closed forms and against each other.
#include "vphysics/convex_hull.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "random.h"
#include "samples.h"
#include "shape_truth.h"

namespace vp::test {
namespace {

using Points = std::vector<Vec3>;

// The hull is closed, convex and ordered. No point is outside by more than `allowed`, and every
// vertex is one of the points.
void expect_hull_of(const Points& points, const ConvexHull& hull, double allowed) {
  const auto vertices = hull.vertices();
  std::map<std::pair<int, int>, int> edges;
  for (const ConvexHull::Face& face : hull.faces()) {
    ASSERT_NEAR(norm(face.normal), 1.0, 1e-14);
    const std::size_t n = face.vertices.size();
    ASSERT_GE(n, 3u);
    for (std::size_t i = 0; i < n; ++i) {
      const int from = face.vertices[i], to = face.vertices[(i + 1) % n];
      ++edges[{from, to}];
      const Vec3 &a = vertices[static_cast<std::size_t>(from)],
                 &b = vertices[static_cast<std::size_t>(to)],
                 &c = vertices[face.vertices[(i + 2) % n]];
      // The edges turn left around the outward normal.
      ASSERT_GT(dot(face.normal, cross(b - a, c - b)), -allowed * norm(c - a));
      ASSERT_LE(face.offset - dot(face.normal, a), allowed + 1e-12);
    }
    for (const Vec3& p : points) ASSERT_LE(dot(face.normal, p) - face.offset, allowed);
    for (const Vec3& v : vertices) ASSERT_LE(dot(face.normal, v), face.offset);
  }
  std::vector<int> degree(vertices.size(), 0);
  for (const auto& [edge, count] : edges) {
    ASSERT_EQ(count, 1);
    ASSERT_TRUE(edges.contains({edge.second, edge.first}));
    ++degree[static_cast<std::size_t>(edge.first)];
  }
  for (const int d : degree) ASSERT_GE(d, 3);
  ASSERT_EQ(vertices.size() + hull.faces().size(), edges.size() / 2 + 2);  // Euler's formula
  for (const Vec3& v : vertices)
    ASSERT_NE(std::find(points.begin(), points.end(), v), points.end());
  ASSERT_GT(hull.volume(), 0.0);
}

double farthest(std::span<const Vec3> points, const Vec3& n) {
  double most = dot(n, points[0]);
  for (const Vec3& p : points) most = std::max(most, dot(n, p));
  return most;
}

TEST(ConvexHull, OfABoxWithPointsEverywhereHasItsCornersAndSixFaces) {
  const Vec3 half{0.5, 0.25, 2.0};
  Points points = box_corners(half);
  Random random(51);
  for (int i = 0; i < 400; ++i) {
    Vec3 p = random.in_cube(1.0);
    if (i % 4 > 0) p[static_cast<int>(random.word() % 3)] = i % 2 ? 1.0 : -1.0;  // on a face
    if (i % 4 > 1) p[static_cast<int>(random.word() % 3)] = i % 3 ? 1.0 : -1.0;  // on an edge
    points.push_back({p.x * half.x, p.y * half.y, p.z * half.z});
    points.push_back(points[random.word() % points.size()]);  // a duplicate
  }
  const ConvexHull hull = hull_of(points);
  expect_hull_of(points, hull, 1e-12);
  EXPECT_EQ(hull.vertices().size(), 8u);
  ASSERT_EQ(hull.faces().size(), 6u);
  for (const auto& face : hull.faces()) {
    EXPECT_EQ(face.vertices.size(), 4u);
    EXPECT_EQ(std::fabs(face.normal.x) + std::fabs(face.normal.y) + std::fabs(face.normal.z), 1.0);
  }
  const Inertia box = solid_inertia(Box{half}, 700.0), ours = solid_inertia(hull, 700.0);
  EXPECT_NEAR(ours.mass(), box.mass(), 1e-12 * box.mass());
  EXPECT_NEAR(ours.rotational().xx, box.rotational().xx, 1e-12 * box.rotational().xx);
  EXPECT_NEAR(ours.rotational().zz, box.rotational().zz, 1e-12 * box.rotational().zz);
  EXPECT_LT(norm(ours.first_moment()), 1e-12 * box.mass());
}

// One cloud of each kind that is difficult for hull builders.
Points cloud(Random& random, int kind, int n) {
  Points points;
  for (int i = 0; i < n; ++i) {
    Vec3 p = random.in_cube(1.0);
    const auto lattice = [&] { return static_cast<double>(random.word() % 4) / 3.0; };
    switch (kind) {
      case 0:  // a cube full of points
        break;
      case 1:  // a sphere's surface
        p = random.direction();
        break;
      case 2: {  // a lattice, full of coplanar and collinear points
        const double x = lattice(), y = lattice(), z = lattice();
        p = {x, y, z};
        break;
      }
      case 3:  // a needle
        p.x *= 1e-3, p.y *= 1e-3;
        break;
      case 4:  // a plate
        p.z *= 1e-4;
        break;
      case 5:  // two parallel discs: many points on one circle
        p = {std::cos(2 * kPi * i / n), std::sin(2 * kPi * i / n), i % 2 ? 0.5 : -0.5};
        break;
      case 6:  // clusters so tight that points differ only by rounding
        p = Vec3{p.x > 0 ? 1.0 : 0.0, p.y > 0 ? 1.0 : 0.0, p.z > 0 ? 1.0 : 0.0} +
            1e-15 * random.in_cube(1.0);
        break;
      default:  // nearly coplanar sides
        p[static_cast<int>(random.word() % 3)] = random.word() % 2 ? 1.0 : -1.0;
        p += 1e-7 * random.in_cube(1.0);
    }
    points.push_back(p);
  }
  return points;
}

TEST(ConvexHull, OfAnyCloudHoldsAllOfItsPoints) {
  Random random(52);
  HullOptions options;
  options.max_vertices = 256;
  const int clouds = samples(12);
  for (int kind = 0; kind < 8; ++kind) {
    for (int i = 0; i < clouds; ++i) {
      Points points = cloud(random, kind, 20 + 180 / clouds * i);
      const double size = std::pow(10.0, random.uniform(-3, 3));
      const SE3 T = random.pose(i % 3 == 2 ? 1e6 * size : size);
      for (Vec3& p : points) p = T * (size * p);
      const ConvexHull hull = hull_of(points, options);
      // Points left out are outside by at most the tolerance, a fraction of an extent of up to 2
      // sqrt(3).
      SCOPED_TRACE(testing::Message() << "kind " << kind << ", cloud " << i);
      const double allowed = 2e-5 * 3.5 * size;
      Points moved = points;
      expect_hull_of(moved, hull, allowed);
      for (int k = 0; k < 50; ++k) {
        const Vec3 n = random.direction();
        ASSERT_NEAR(farthest(hull.vertices(), n), farthest(points, n), allowed);
      }
    }
  }
}

TEST(ConvexHull, OfNearlyFlatSidesHasFlatSides) {
  Random random(53);
  for (const double noise : {0.0, 1e-12, 1e-9, 1e-6}) {
    Points points = box_corners({1, 1, 1});
    for (int i = 0; i < 1000; ++i) {
      Vec3 p = random.in_cube(1.0);
      p[static_cast<int>(random.word() % 3)] = random.word() % 2 ? 1.0 : -1.0;
      points.push_back(p + noise * random.in_cube(1.0));
    }
    const ConvexHull hull = hull_of(points);
    EXPECT_EQ(hull.faces().size(), 6u) << noise;
    EXPECT_EQ(hull.vertices().size(), 8u) << noise;
  }
}

// A prism of 60 sides: each cap is one face, though made of 58 triangles.
TEST(ConvexHull, JoinsManyTrianglesIntoOneFace) {
  Points points;
  for (int i = 0; i < 60; ++i) {
    for (const double z : {-1.0, 1.0}) {
      points.push_back({std::cos(kPi * i / 30), std::sin(kPi * i / 30), z});
    }
  }
  HullOptions options;
  options.max_vertices = 120;
  const ConvexHull hull = hull_of(points, options);
  EXPECT_EQ(hull.vertices().size(), 120u);
  EXPECT_EQ(hull.faces().size(), 62u);
  expect_hull_of(points, hull, 1e-12);
}

TEST(ConvexHull, DoesNotDependOnTheOrderOfThePoints) {
  Random random(54);
  for (int kind = 0; kind < 8; ++kind) {
    Points points = cloud(random, kind, 150);
    const ConvexHull first = hull_of(points);
    for (std::size_t i = points.size() - 1; i > 0; --i) {
      std::swap(points[i], points[random.word() % (i + 1)]);
    }
    const ConvexHull second = hull_of(points);
    ASSERT_TRUE(std::equal(first.vertices().begin(), first.vertices().end(),
                           second.vertices().begin(), second.vertices().end()));
    ASSERT_EQ(first.faces().size(), second.faces().size());
    for (std::size_t f = 0; f < first.faces().size(); ++f) {
      const auto a = first.faces()[f].vertices, b = second.faces()[f].vertices;
      ASSERT_TRUE(std::equal(a.begin(), a.end(), b.begin(), b.end()));
    }
    ASSERT_EQ(first.inertia(1.0), second.inertia(1.0));
  }
}

TEST(ConvexHull, KeepsTheCornersThatStickOutFarthest) {
  Random random(55);
  Points points;
  for (int i = 0; i < 5000; ++i) points.push_back(random.direction());
  double before = 1.0;
  for (const int limit : {8, 16, 32, 64, 128, 256}) {
    HullOptions options;
    options.max_vertices = limit;
    const ConvexHull hull = hull_of(points, options);
    EXPECT_EQ(static_cast<int>(hull.vertices().size()), limit);
    double outside = 0.0;
    for (const ConvexHull::Face& face : hull.faces()) {
      outside = std::max(outside, farthest(points, face.normal) - face.offset);
    }
    // Of n points spread evenly over a sphere, each has a cap of area 4 pi / n. Between the points
    // of a hexagonal net, the hull is below the sphere by 1 - cos of 1.1 times the cap's radius:
    // 2.4 / n. Measured: 3.4 / n to 4.9 / n.
    EXPECT_LT(outside, 6.0 / limit);
    EXPECT_LT(outside, before);
    before = outside;
    expect_hull_of(points, hull, outside);
  }
}

// The two halves of a cut box together have the box's mass, first moment and inertia.
TEST(ConvexHull, MassesOfTwoHalvesAddUpToTheWhole) {
  Random random(56);
  const Points corners = box_corners({0.4, 0.7, 0.3});
  double worst = 0.0;
  for (int i = 0; i < 200; ++i) {
    const Vec3 n = random.direction();
    const double c = random.uniform(-0.3, 0.3);
    Points sides[2];
    for (const Vec3& p : corners) sides[dot(n, p) > c].push_back(p);
    for (const Vec3& p : corners) {
      for (int axis = 0; axis < 3; ++axis) {
        Vec3 q = p;
        q[axis] = -p[axis];
        const double dp = dot(n, p) - c, dq = dot(n, q) - c;
        if (dp > 0.0 || dq <= 0.0) continue;
        const Vec3 cut = p + (dp / (dp - dq)) * (q - p);
        sides[0].push_back(cut);
        sides[1].push_back(cut);
      }
    }
    const SE3 T = random.pose(2.0);
    Inertia sum;
    for (Points& side : sides) {
      for (Vec3& p : side) p = T * p;
      HullOptions exact;
      exact.tolerance = 0.0;
      const auto hull = ConvexHull::of(side, exact);
      if (!hull) continue;  // a corner that is cut off is too thin for a hull
      sum = sum + hull->inertia(3.0);
    }
    const Inertia whole = solid_inertia(Box{{0.4, 0.7, 0.3}}, 3.0).InvXform(T);
    const auto difference = [&](double a, double b) { worst = std::max(worst, std::fabs(a - b)); };
    difference(sum.mass(), whole.mass());
    for (int k = 0; k < 3; ++k) difference(sum.first_moment()[k], whole.first_moment()[k]);
    const Sym3 &a = sum.rotational(), &b = whole.rotational();
    difference(a.xx, b.xx), difference(a.yy, b.yy), difference(a.zz, b.zz);
    difference(a.xy, b.xy), difference(a.yz, b.yz), difference(a.zx, b.zx);
  }
  EXPECT_LT(worst, 2e-12);  // of a mass of 2 and moments of up to 30; measured 4e-14
}

TEST(ConvexHull, RefusesWhatHasNoVolume) {
  Random random(57);
  const auto message = [](const Points& points, const HullOptions& options = {}) {
    const auto hull = ConvexHull::of(points, options);
    EXPECT_FALSE(hull);
    if (hull) return std::string();
    EXPECT_EQ(hull.error().code, Errc::invalid_argument);
    return hull.error().message;
  };
  const auto has = [](const std::string& text, const char* word) {
    return text.find(word) != std::string::npos;
  };
  EXPECT_TRUE(has(message({}), "four"));
  EXPECT_TRUE(has(message({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), "four"));
  EXPECT_TRUE(has(message(Points(50, Vec3{1, 2, 3})), "four"));
  Points line, plane, speck;
  for (int i = 0; i < 60; ++i) {
    const Vec3 p = random.in_cube(1.0);
    line.push_back({p.x, 2 * p.x, -p.x + 5});
    plane.push_back({p.x, p.y, p.x - 2 * p.y});
    speck.push_back(1e-11 * p);
  }
  EXPECT_TRUE(has(message(line), "line"));
  EXPECT_TRUE(has(message(plane), "plane"));
  EXPECT_TRUE(has(message(speck), "metres"));
  for (Vec3& p : plane) p.z += 1e-9 * random.uniform(-1, 1);
  EXPECT_TRUE(has(message(plane), "plane"));
  for (const double bad : {std::nan(""), 1.0 / 0.0, -1.0 / 0.0, 1e10, -1e300}) {
    for (int axis = 0; axis < 3; ++axis) {
      Points points = box_corners({1, 1, 1});
      points[3][axis] = bad;
      EXPECT_TRUE(has(message(points), "1e9")) << bad;
    }
  }
  for (const int vertices : {-1, 0, 3, 257}) {
    HullOptions options;
    options.max_vertices = vertices;
    EXPECT_TRUE(has(message(box_corners({1, 1, 1}), options), "max_vertices"));
  }
  for (const double tolerance : {-1e-9, 0.02, std::nan("")}) {
    HullOptions options;
    options.tolerance = tolerance;
    EXPECT_TRUE(has(message(box_corners({1, 1, 1}), options), "tolerance"));
  }
}

// --- solid_inertia and scaled

// A prism or a pyramid of n sides, inscribed in a cylinder or a cone.
ConvexHull inscribed(bool cone, int sides) {
  Points points;
  if (cone) points.push_back({0, 0, 0.7});
  for (int i = 0; i < sides; ++i) {
    const Vec3 rim{0.4 * std::cos(2 * kPi * i / sides), 0.4 * std::sin(2 * kPi * i / sides), -0.7};
    points.push_back(rim);
    if (!cone) points.push_back({rim.x, rim.y, 0.7});
  }
  HullOptions options;
  options.max_vertices = 256;
  options.tolerance = 0.0;
  return hull_of(points, options);
}

TEST(SolidInertia, OfCylinderAndConeIsTheLimitOfTheirHulls) {
  for (const bool cone : {false, true}) {
    const Shape shape = cone ? Shape(Cone{0.4, 0.7}) : Shape(Cylinder{0.4, 0.7});
    const Inertia exact = solid_inertia(shape, 800.0);
    const auto errors = [&](int sides) {
      const Inertia hull = inscribed(cone, sides).inertia(800.0);
      return std::array{exact.mass() - hull.mass(), exact.rotational().xx - hull.rotational().xx,
                        exact.rotational().yy - hull.rotational().yy,
                        exact.rotational().zz - hull.rotational().zz,
                        hull.first_moment().z - exact.first_moment().z};
    };
    const auto coarse = errors(32), fine = errors(64);
    for (std::size_t i = 0; i < coarse.size(); ++i) {
      if (i == 4 && !cone) continue;  // its first moment is zero
      // The error falls with the square of the number of sides.
      EXPECT_NEAR(coarse[i] / fine[i], 4.0, 0.03) << cone << i;
      EXPECT_LT(fine[i], 0.004 * exact.mass());
      EXPECT_GT(fine[i], 0.0);
    }
    EXPECT_EQ(norm(Vec3{exact.rotational().xy, exact.rotational().yz, exact.rotational().zx}), 0.0);
  }
}

TEST(Scaled, StretchesWhatCanBeStretched) {
  const Vec3 k{2, 2, 0.5};
  const Shape cylinder = scaled(Cylinder{0.3, 0.8}, k).value();
  EXPECT_EQ(std::get<Cylinder>(cylinder).radius, 0.6);
  EXPECT_EQ(std::get<Cylinder>(cylinder).half_length, 0.4);
  const Shape cone = scaled(Cone{0.3, 0.8}, k).value();
  EXPECT_EQ(std::get<Cone>(cone).radius, 0.6);
  EXPECT_EQ(std::get<Cone>(cone).half_height, 0.4);
  const Shape box = scaled(Box{{1, 2, 3}}, {3, 2, 1}).value();
  EXPECT_EQ(std::get<Box>(box).half_extents, (Vec3{3, 4, 3}));
  EXPECT_EQ(std::get<Sphere>(scaled(Sphere{0.5}, {3, 3, 3}).value()).radius, 1.5);
  const Shape capsule = scaled(Capsule{0.5, 1.0}, {3, 3, 3}).value();
  EXPECT_EQ(std::get<Capsule>(capsule).half_length, 3.0);
  EXPECT_TRUE(std::holds_alternative<HalfSpace>(scaled(HalfSpace{}, {1, 2, 3}).value()));
  Random random(58);
  const Solid solid = random_solid(random, Kind::hull);
  const Inertia before = solid_inertia(solid.shape, 1.0);
  const Shape stretched = scaled(solid.shape, {1, 2, 3}).value();
  EXPECT_NEAR(solid_inertia(stretched, 1.0).mass(), 6.0 * before.mass(), 1e-12);
  EXPECT_EQ(std::get<ConvexHull>(stretched).vertices()[0].z,
            3.0 * std::get<ConvexHull>(solid.shape).vertices()[0].z);
}

TEST(Scaled, RefusesFactorsThatMakeAnotherShape) {
  EXPECT_FALSE(scaled(Sphere{1}, {1, 1, 2}));
  EXPECT_FALSE(scaled(Capsule{1, 1}, {1, 1, 2}));
  EXPECT_FALSE(scaled(Cylinder{1, 1}, {1, 2, 1}));
  EXPECT_FALSE(scaled(Cone{1, 1}, {2, 1, 1}));
  for (const double bad : {0.0, -1.0, 1e7, std::nan(""), 1.0 / 0.0}) {
    for (int axis = 0; axis < 3; ++axis) {
      Vec3 k{1, 1, 1};
      k[axis] = bad;
      const auto result = scaled(Box{{1, 1, 1}}, k);
      ASSERT_FALSE(result);
      EXPECT_EQ(result.error().code, Errc::invalid_argument);
    }
  }
  ConvexHull hull = hull_of(box_corners({1, 1, 1}));
  const ConvexHull taken = std::move(hull);
  EXPECT_FALSE(scaled(hull, {1, 1, 1}));  // NOLINT(bugprone-use-after-move)
}

}  // namespace
}  // namespace vp::test
