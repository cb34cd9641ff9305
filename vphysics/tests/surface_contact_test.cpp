// Contacts with meshes, height fields and compounds.
#include <gtest/gtest.h>

#include "collide/bounds.h"
#include "collide/compound_data.h"
#include "collide/corner_over_face.h"
#include "collide/distance.h"
#include "collide/manifolds.h"
#include "collide/support.h"
#include "collide/triangle_contact.h"
#include "surface_rig.h"
#include "surfaces.h"

namespace vp::test {
namespace {

using collide::Geometry;
using collide::ManifoldScratch;
using collide::SubManifold;
using collide::Surface;

// Random triangles near boxes and hulls: what their corners and the other's faces show is what the
// general search finds.
TEST(CornerOverFace, AgreesWithTheGeneralSearch) {
  Random random(52);
  int found = 0, yes = 0, no = 0;
  for (const Shape& shape : {Shape{Box{{0.3, 0.2, 0.1}}}, Shape{rock(random, 0.25, 12)},
                             Shape{rock(random, 0.25, 60)}}) {
    const Geometry b = collide::make_geometry(shape);
    const collide::PolytopeOf polytope(b);
    for (int i = 0; i < 20000; ++i) {
      const double size = random.uniform(0.01, 0.3);
      Vec3 p[3];
      for (Vec3& corner : p) corner = size * random.direction();
      const Geometry a = collide::triangle_geometry(p);
      const collide::CorePair pair(a, b, SE3(random.rotation(), random.in_cube(0.4)));
      const collide::GjkResult truth = collide::gjk(pair, {0, 0, 1}, 1e300);
      const auto fast = collide::corner_over_face(p, polytope.view(), pair.T_a_b, 1e300);
      if (fast) {
        ++found;
        ASSERT_EQ(truth.state, collide::GjkResult::State::separated);
        EXPECT_NEAR(fast->distance, truth.distance, 1e-12);
        EXPECT_LT(norm(fast->normal - truth.normal), 1e-5);
        EXPECT_LT(norm(fast->on_b - fast->on_a - fast->distance * fast->normal), 1e-15);
      }
      const auto overlap = collide::corners_overlap(p, polytope.view(), pair.T_a_b);
      if (!overlap) continue;
      ++(*overlap ? yes : no);
      EXPECT_EQ(*overlap, truth.state == collide::GjkResult::State::overlaps);
    }
  }
  std::printf("of 60000: %d over a face, %d overlap, %d do not\n", found, yes, no);
  EXPECT_GT(found, 10000);
  EXPECT_GT(yes, 1000);
  EXPECT_GT(no, 10000);
}
// Faces merged with a tolerance do not fill their planes.
TEST(CornerOverFace, IsNotUsedForHullsWithMergedFaces) {
  Random random(53);
  std::vector<Vec3> corners;  // of a box, one of them moved into it
  for (int i = 0; i < 8; ++i)
    corners.push_back({i & 1 ? 0.25 : -0.25, i & 2 ? 0.25 : -0.25, i & 4 ? 0.25 : -0.25});
  corners.back() -= Vec3{0, 0, 1e-3};
  const ConvexHull exact = ConvexHull::of(corners, {.tolerance = 0.0}).value();
  EXPECT_GT(exact.faces().size(), 6u);
  EXPECT_TRUE(has_few_flat_faces(collide::make_geometry(exact)));
  const ConvexHull merged = ConvexHull::of(corners, {.tolerance = 1e-2}).value();
  EXPECT_EQ(merged.faces().size(), 6u);
  EXPECT_FALSE(has_few_flat_faces(collide::make_geometry(merged)));
  EXPECT_TRUE(has_few_flat_faces(collide::make_geometry(rock(random, 0.25, 30))));
  EXPECT_FALSE(has_few_flat_faces(collide::make_geometry(rock(random, 0.25, 200))));
  EXPECT_FALSE(has_few_flat_faces(collide::make_geometry(Capsule{0.1, 0.2})));
}
// Beyond the limit only that is told.
TEST(CornerOverFace, StopsAtTheLimit) {
  const Geometry box = collide::make_geometry(Box{{1, 1, 1}});
  const collide::PolytopeOf polytope(box);
  const Vec3 p[3] = {{0, 0, 1.5}, {0.1, 0, 1.6}, {0, 0.1, 1.7}};
  const auto near = collide::corner_over_face(p, polytope.view(), SE3{}, 0.6);
  ASSERT_TRUE(near.has_value());
  EXPECT_EQ(near->state, collide::GjkResult::State::separated);
  EXPECT_DOUBLE_EQ(near->distance, 0.5);
  EXPECT_EQ(near->normal, (Vec3{0, 0, -1}));
  EXPECT_EQ(near->on_a, p[0]);
  const auto far = collide::corner_over_face(p, polytope.view(), SE3{}, 0.4);
  ASSERT_TRUE(far.has_value());
  EXPECT_EQ(far->state, collide::GjkResult::State::beyond);
  // Closest to an edge, and inside: neither is over a face.
  const Vec3 beside[3] = {{1.5, 0, 1.5}, {1.6, 0, 1.6}, {1.5, 0.1, 1.6}};
  EXPECT_FALSE(collide::corner_over_face(beside, polytope.view(), SE3{}, 9.0).has_value());
  const Vec3 inside[3] = {{0, 0, 0.5}, {0.1, 0, 0.6}, {0, 0.1, 0.7}};
  EXPECT_FALSE(collide::corner_over_face(inside, polytope.view(), SE3{}, 9.0).has_value());
}

// The height of a shape's lowest point above z = 0.
double height_of(const Shape& shape, const SE3& T) {
  const Geometry g = collide::make_geometry(shape), plane = collide::make_geometry(HalfSpace{});
  collide::PairCache cache;
  return closest_points(g, T, plane, SE3{}, cache).distance;
}

// Places the shape with a random rotation and its lowest point at the given height.
SE3 placed(Random& random, const Shape& shape, double height, double from, double to, bool flat) {
  const Mat3 R = flat ? Exp(random.uniform(0, 6) * Vec3{0, 0, 1}).matrix() : random.rotation();
  const double x = random.uniform(from, to), y = random.uniform(from, to);
  const SE3 T(R, Vec3{x, y, 0});
  return {R, Vec3{x, y, height - height_of(shape, T)}};
}

void expect_of_plane(const Found& found, const Vec3& normal, double height, double margin) {
  ASSERT_EQ(found.manifolds.size(), height <= margin ? 1u : 0u);
  if (found.manifolds.empty()) return;
  const collide::Manifold& m = found.manifolds[0].manifold;
  EXPECT_NEAR(norm(m.normal - normal), 0.0, 1e-9);
  EXPECT_GE(m.count, 1);
  EXPECT_NEAR(found.deepest(), height, 2e-6);
}

// Ghost contacts: on a plane with any triangulation, every normal is the plane's, and the deepest
// point is as deep as in a half-space.
TEST(SurfaceContact, OfAPlaneOfRandomTrianglesHasNoNormalButThePlanes) {
  Random random(32);
  const TriangleMesh mesh = random_plane(random, 25, 5.0).made();
  const SE3 T_mesh = random.pose(3.0);
  const Vec3 up = T_mesh.rotate({0, 0, 1});
  for (const Shape& shape : convex_shapes()) {
    for (int k = 0; k < 300; ++k) {
      const double height = random.uniform(-0.02, 0.012), margin = 0.01;
      const SE3 T = placed(random, shape, height, 1.0, 4.0, k % 3 == 0);
      expect_of_plane(find(mesh, T_mesh, shape, T_mesh * T, margin), up, height, margin);
      expect_of_plane(find(shape, T_mesh * T, mesh, T_mesh, margin), -up, height, margin);
    }
  }
}

// The same while sliding: internal edges never affect a box or a ball in contact.
TEST(SurfaceContact, OfABoxAndABallThatSlideOverAPlaneNeverFeelsAnEdge) {
  Random random(33);
  const TriangleMesh mesh = random_plane(random, 40, 5.0).made();
  const Shape shapes[] = {Box{{0.2, 0.15, 0.1}}, Sphere{0.1}, Capsule{0.05, 0.2}};
  for (const Shape& shape : shapes) {
    for (int path = 0; path < 10; ++path) {
      const SE3 start = placed(random, shape, 0.0, 1.5, 2.0, true);
      const Vec3 way{random.uniform(0.5, 1.0), random.uniform(0.5, 1.0), 0.0};
      for (int k = 0; k < 200; ++k) {
        const double height = 1e-4 * std::sin(0.3 * k);
        const SE3 T(start.rotation(), start.position() + (k / 200.0) * way + Vec3{0, 0, height});
        expect_of_plane(find(mesh, SE3{}, shape, T, 1e-3), {0, 0, 1}, height, 1e-3);
      }
    }
  }
}

TEST(SurfaceContact, OfAFlatHeightFieldHasNoNormalButThePlanesAndNoneOverHoles) {
  Random random(34);
  const std::vector<double> heights(30 * 30, 0.0);
  std::vector<std::uint8_t> holes(29 * 29, 0);
  for (std::size_t k = 0; k < holes.size(); ++k) holes[k] = k % 29 < 10 ? 1 : 0;
  const HeightField field = HeightField::of({30, 30, 0.2, 0.2, heights, holes}).value();
  for (const Shape& shape : convex_shapes()) {
    for (int k = 0; k < 100; ++k) {
      const double height = random.uniform(-0.02, 0.012);
      const SE3 T = placed(random, shape, height, 3.0, 5.0, k % 3 == 0);
      expect_of_plane(find(field, SE3{}, shape, T, 0.01), {0, 0, 1}, height, 0.01);
      const SE3 over_hole(T.rotation(),
                          T.position() - Vec3{0, 0, 0} + Vec3{1.0 - T.position().x, 0, 0});
      EXPECT_TRUE(find(field, SE3{}, shape, over_hole, 0.01).manifolds.empty());
    }
  }
}

// A flat box keeps its four corners as support, on any triangles.
TEST(SurfaceContact, OfABoxThatLiesFlatSpansItsWholeFace) {
  Random random(35);
  const TriangleMesh mesh = random_plane(random, 25, 5.0).made();
  const Vec3 half{0.3, 0.2, 0.1};
  double worst = 1.0;
  for (int k = 0; k < 200; ++k) {
    const SE3 T = placed(random, Box{half}, 0.0, 1.0, 4.0, true);
    const Found found = find(mesh, SE3{}, Box{half}, T, 1e-3);
    ASSERT_EQ(found.manifolds.size(), 1u);
    const collide::Manifold& m = found.manifolds[0].manifold;
    ASSERT_EQ(m.count, 4);
    // Twice the area of the hull of four points is the largest product of diagonals.
    double most = 0.0;
    for (int a = 0; a < 3; ++a) {
      const int others[3][4] = {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2}};
      const auto at = [&](int i) { return m.points[others[a][i]].position; };
      most = std::max(most, std::fabs(cross(at(1) - at(0), at(3) - at(2)).z));
    }
    worst = std::min(worst, 0.5 * most / (4.0 * half.x * half.y));
  }
  EXPECT_GT(worst, 0.75) << worst;
}

double distance_to_mesh(const Surface& surface, std::uint32_t triangles, const Vec3& p) {
  double least = 1e300;
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const collide::SurfaceTriangle t = surface.triangle(i);
    least = std::min(least, norm(p - collide::nearest_on_triangle(t.p, p).point));
  }
  return least;
}

MeshPoints bumpy_ground(Random& random) {
  MeshPoints m = random_plane(random, 15, 5.0);
  for (Vec3& v : m.vertices) v.z = random.uniform(-0.3, 0.3);
  return m;
}

TEST(SurfaceContact, OfABallIsAsDeepAsTheNearestOfAllTriangles) {
  Random random(36);
  const TriangleMesh meshes[] = {bumpy_ground(random).made(), sphere_mesh(1.0, 2).made(),
                                 box_mesh({0.7, 0.5, 0.9}).made()};
  for (const TriangleMesh& mesh : meshes) {
    const auto n = static_cast<std::uint32_t>(mesh.triangles().size());
    const Surface surface(*mesh.data(), mesh.scale());
    const collide::Bounds b = surface.bounds();
    int met = 0;
    for (int k = 0; k < 2000; ++k) {
      Vec3 centre;
      for (int i = 0; i < 3; ++i) centre[i] = random.uniform(b.lower[i] - 0.3, b.upper[i] + 0.3);
      const double radius = 0.2, distance = distance_to_mesh(surface, n, centre);
      const Found found = find(mesh, SE3{}, Sphere{radius}, SE3(centre), 0.02);
      // Inside a closed mesh there is no contact; on other surfaces there may be one with the
      // border only.
      const bool inside = mesh.closed() ? norm(centre) < 0.5 : false;
      if (inside) {
        EXPECT_TRUE(found.manifolds.empty());
      }
      if (found.manifolds.empty()) continue;
      ++met;
      EXPECT_GE(found.deepest(), distance - radius - 1e-9);
      for (const SubManifold& s : found.manifolds) {
        EXPECT_NEAR(norm(s.manifold.normal), 1.0, 1e-12);
        EXPECT_LT(s.sub_a, n);
      }
    }
    EXPECT_GT(met, 100);
  }
}

TEST(SurfaceContact, OfABallOutsideAClosedMeshMissesNothing) {
  Random random(37);
  const double radius = 0.1;
  for (const MeshPoints& points : {sphere_mesh(1.0, 2), box_mesh({0.7, 0.5, 0.9})}) {
    const TriangleMesh mesh = points.made();
    const auto n = static_cast<std::uint32_t>(mesh.triangles().size());
    const Surface surface(*mesh.data(), mesh.scale());
    for (int k = 0; k < 2000; ++k) {
      // Outside by construction: slightly beyond a random point of a triangle, along a direction
      // that leaves the surface.
      const collide::SurfaceTriangle t =
          surface.triangle(static_cast<std::uint32_t>(random.word() % n));
      double u = random.uniform(0, 1), v = random.uniform(0, 1);
      if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
      if (k % 3 == 0) v = 0.0;
      if (k % 9 == 0) u = 0.0;
      const Vec3 on = t.p[0] + u * (t.p[1] - t.p[0]) + v * (t.p[2] - t.p[0]);
      const Vec3 centre = on + random.uniform(0.01, 0.12) * (1.0 / norm(on)) * on;
      const double separation = distance_to_mesh(surface, n, centre) - radius;
      const Found found = find(mesh, SE3{}, Sphere{radius}, SE3(centre), 0.03);
      ASSERT_FALSE(found.manifolds.empty());
      ASSERT_NEAR(found.deepest(), separation, 1e-9);
    }
  }
}

// A box as a mesh and a box as a primitive give the same normal and depth against convex shapes.
TEST(SurfaceContact, OfABoxMeshIsThatOfTheBox) {
  Random random(38);
  const Vec3 half{0.7, 0.5, 0.9};
  const TriangleMesh mesh = box_mesh(half).made();
  int deeper_elsewhere = 0;
  for (const Shape& shape : convex_shapes()) {
    const Geometry g = collide::make_geometry(shape), box = collide::make_geometry(Box{half});
    for (int k = 0; k < 300; ++k) {
      const Mat3 R = random.rotation();
      const SE3 far(R, 3.0 * random.direction());
      collide::PairCache cache;
      const collide::ClosestPoints apart = closest_points(box, SE3{}, g, far, cache);
      const double gap = random.uniform(-0.01, 0.009);
      const SE3 T(R, far.position() - (apart.distance - gap) * apart.normal);
      const collide::ClosestPoints truth = closest_points(box, SE3{}, g, T, cache);
      const Found found = find(mesh, SE3{}, shape, T, 0.01);
      // A face normal is accepted if it is as good within 5%.
      const double allowance = 0.05 * std::fabs(truth.distance) + 1e-4;
      bool told = false;
      for (const SubManifold& s : found.manifolds) {
        const Found one{{s}};
        const double along = dot(s.manifold.normal, truth.normal);
        told = told || (std::fabs(one.deepest() - truth.distance) <= allowance &&
                        (along > 0.75 || std::fabs(truth.distance) < 1e-3));
      }
      EXPECT_TRUE(told) << shape.index() << " " << k << ": " << truth.distance;
      deeper_elsewhere += found.deepest() < truth.distance - allowance ? 1 : 0;
    }
  }
  EXPECT_LE(deeper_elsewhere, 10);  // 2 of 2100
}

TEST(SurfaceContact, IsMadeFromTheFrontAloneUnlessTwoSided) {
  const std::vector<Vec3> corners{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
  const std::vector<TriangleMesh::Triangle> one{{0, 1, 2}};
  MeshOptions both;
  both.two_sided = true;
  const TriangleMesh skin = TriangleMesh::of(corners, one).value();
  const TriangleMesh sheet = TriangleMesh::of(corners, one, both).value();
  for (const Shape& shape : convex_shapes()) {
    for (const double side : {1.0, -1.0}) {
      const SE3 T(Vec3{0, -0.2, side * 0.0});
      const double low = -height_of(shape, SE3{});
      const SE3 at(Vec3{0.0, -0.2,
                        side > 0
                            ? low - 0.01
                            : 0.01 + height_of(shape, SE3(Exp(kPi * Vec3{1, 0, 0}).matrix(), {}))});
      const Found on_skin = find(skin, SE3{}, shape, at, 0.001);
      const Found on_sheet = find(sheet, SE3{}, shape, at, 0.001);
      EXPECT_EQ(on_skin.manifolds.size(), side > 0 ? 1u : 0u);
      ASSERT_EQ(on_sheet.manifolds.size(), 1u);
      EXPECT_NEAR(on_sheet.manifolds[0].manifold.normal.z, side, 1e-9);
      EXPECT_NEAR(on_sheet.deepest(), -0.01, 1e-6);
    }
  }
}

// In a valley a ball touches both sides, on a ridge only the ridge.
TEST(SurfaceContact, InAValleyAreTwoAndOnARidgeOne) {
  const std::vector<TriangleMesh::Triangle> triangles{{0, 1, 2}, {0, 2, 3}, {1, 4, 5}, {1, 5, 2}};
  const auto bent = [&](double z) {
    return TriangleMesh::of(
               std::vector<Vec3>{
                   {-1, -1, z}, {0, -1, 0}, {0, 1, 0}, {-1, 1, z}, {1, -1, z}, {1, 1, z}},
               triangles)
        .value();
  };
  const double radius = 0.2, root = std::sqrt(2.0);
  const Found valley =
      find(bent(1.0), SE3{}, Sphere{radius}, SE3(Vec3{0, 0.1, root * radius - 0.001}), 1e-3);
  ASSERT_EQ(valley.manifolds.size(), 2u);
  EXPECT_NEAR(valley.manifolds[0].manifold.normal.x, 1.0 / root, 1e-12);
  EXPECT_NEAR(valley.manifolds[1].manifold.normal.x, -1.0 / root, 1e-12);
  EXPECT_NEAR(valley.deepest(), -0.001 / root, 1e-12);
  const Found ridge = find(bent(-1.0), SE3{}, Sphere{radius}, SE3(Vec3{0.01, 0.1, radius}), 1e-3);
  ASSERT_EQ(ridge.manifolds.size(), 1u);
  EXPECT_EQ(ridge.manifolds[0].manifold.count, 1);
  EXPECT_NEAR(ridge.manifolds[0].manifold.normal.x, 0.01 / std::hypot(0.01, radius), 1e-12);
}

// A box pushed along the ground against a wall of the same mesh has contacts with the ground and
// the wall, but not with the edge between them.
TEST(SurfaceContact, InACornerAreTheFacesNormalsAlone) {
  Random random(39);
  MeshPoints m = random_plane(random, 20, 4.0);
  const auto n = static_cast<std::uint32_t>(m.vertices.size());
  for (const Vec3& v : std::vector<Vec3>(m.vertices)) m.vertices.push_back({4.0, v.y, 4.0 - v.x});
  for (const auto& t : std::vector<TriangleMesh::Triangle>(m.triangles))
    m.triangles.push_back({t[0] + n, t[2] + n, t[1] + n});
  const TriangleMesh mesh = m.made();
  for (int k = 0; k < 200; ++k) {
    const Vec3 half{0.3, 0.2, 0.25};
    const double depth = random.uniform(-1e-3, 1e-3), into = random.uniform(-1e-3, 1e-3);
    const SE3 T(Vec3{4.0 - half.x + into, random.uniform(1, 3), half.z - depth});
    const Found found = find(mesh, SE3{}, Box{half}, T, 2e-3);
    ASSERT_EQ(found.manifolds.size(), 2u);
    double ground = 0.0, wall = 0.0;
    for (const SubManifold& s : found.manifolds) {
      EXPECT_EQ(s.manifold.count, 4);
      ground = std::max(ground, s.manifold.normal.z);
      wall = std::max(wall, -s.manifold.normal.x);
    }
    EXPECT_NEAR(ground, 1.0, 1e-12);
    EXPECT_NEAR(wall, 1.0, 1e-12);
  }
}

TEST(SurfaceContact, HasNoMoreManifoldsThanNormalsAreToldApart) {
  Random random(40);
  const TriangleMesh mesh = bumpy_ground(random).made();
  for (int k = 0; k < 200; ++k) {
    const SE3 T(random.rotation(), {random.uniform(1, 4), random.uniform(1, 4), 0.3});
    const Found found = find(mesh, SE3{}, Box{{0.8, 0.8, 0.2}}, T, 0.05);
    EXPECT_LE(found.manifolds.size(), collide::kMaxClusters);
    std::vector<std::uint32_t> names;
    for (const SubManifold& s : found.manifolds) {
      for (int i = 0; i < s.manifold.count; ++i) names.push_back(s.manifold.points[i].feature);
    }
    std::sort(names.begin(), names.end());
    EXPECT_TRUE(std::adjacent_find(names.begin(), names.end()) == names.end());
  }
}

TEST(SurfaceContact, NamesStayTheSameWhileTheSameFeaturesTouch) {
  Random random(41);
  const TriangleMesh mesh = random_plane(random, 10, 5.0).made();
  const SE3 T = placed(random, Box{{0.2, 0.2, 0.2}}, -1e-4, 2.0, 3.0, true);
  const Found first = find(mesh, SE3{}, Box{{0.2, 0.2, 0.2}}, T, 1e-3);
  const SE3 moved(T.rotation(), T.position() + Vec3{1e-5, -2e-5, 1e-5});
  const Found second = find(mesh, SE3{}, Box{{0.2, 0.2, 0.2}}, moved, 1e-3);
  ASSERT_EQ(first.manifolds.size(), 1u);
  ASSERT_EQ(second.manifolds.size(), 1u);
  EXPECT_EQ(first.manifolds[0].sub_a, second.manifolds[0].sub_a);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(first.manifolds[0].manifold.points[i].feature,
              second.manifolds[0].manifold.points[i].feature);
  }
}

TEST(Compound, RefusesWhatIsNoneAndSaysWhy) {
  const auto expect_refused = [](const std::vector<CompoundPart>& parts, const char* word) {
    const Expected<Compound> made = Compound::of(parts);
    ASSERT_FALSE(made) << word;
    EXPECT_NE(made.error().message.find(word), std::string::npos) << made.error().message;
  };
  Random random(42);
  expect_refused({}, "no parts");
  expect_refused({{HalfSpace{}, {}}}, "half-spaces");
  expect_refused({{Sphere{1.0}, {}}, {box_mesh({1, 1, 1}).made(), {}}}, "part 1");
  for (const double bad : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), 1e10}) {
    expect_refused({{Sphere{bad}, {}}}, "radius");
    expect_refused({{Box{{1, bad, 1}}, {}}}, "half extents");
    expect_refused({{Capsule{bad, 1}, {}}}, "radius");
    expect_refused({{Cylinder{1, bad}, {}}}, "half length");
    expect_refused({{Cone{bad, 1}, {}}}, "radius");
  }
  expect_refused({{Sphere{1.0}, SE3(Mat3{{2, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {})}}, "pose");
  expect_refused({{Sphere{1.0}, SE3(Vec3{0, std::numeric_limits<double>::infinity(), 0})}}, "pose");
}

struct Parts {
  std::vector<CompoundPart> parts;
  explicit Parts(Random& random) {
    for (const Shape& shape : convex_shapes()) {
      if (shape.index() != 1) parts.push_back({shape, random.pose(0.4)});
    }
  }
};

TEST(Compound, HasTheMassOfItsPartsAndTakesCompoundsApart) {
  Random random(43);
  const Parts inner(random);
  const SE3 T = random.pose(1.0);
  const Compound one = Compound::of(inner.parts).value();
  const Compound nested =
      Compound::of(std::vector<CompoundPart>{{one, T}, {Sphere{0.3}, {}}}).value();
  EXPECT_EQ(nested.parts().size(), inner.parts.size() + 1);
  Inertia truth = solid_inertia(Sphere{0.3}, 500.0);
  for (const CompoundPart& p : inner.parts) {
    truth = truth + solid_inertia(p.shape, 500.0).InvXform(T * p.T_compound_part);
  }
  const Inertia found = nested.inertia(500.0);
  EXPECT_NEAR(found.mass(), truth.mass(), 1e-9);
  EXPECT_NEAR(norm(found.first_moment() - truth.first_moment()), 0.0, 1e-9);
  EXPECT_NEAR(found.rotational().xy, truth.rotational().xy, 1e-9);
  EXPECT_NEAR(solid_inertia(nested, 500.0).rotational().zz, truth.rotational().zz, 1e-9);
}

TEST(Compound, ScaledIsTheCompoundOfScaledParts) {
  Random random(44);
  const Parts inner(random);
  const Compound one = Compound::of(inner.parts).value();
  EXPECT_FALSE(scaled(one, {1, 2, 1}));
  const Shape twice = scaled(one, {2, 2, 2}).value();
  EXPECT_NEAR(solid_inertia(twice, 1.0).mass(), 8.0 * one.inertia(1.0).mass(), 1e-9);
  EXPECT_NEAR(
      norm(solid_inertia(twice, 1.0).centre_of_mass() - 2.0 * one.inertia(1.0).centre_of_mass()),
      0.0, 1e-9);
}

TEST(Compound, MeetsWithEachPartWhatThePartMeets) {
  Random random(45);
  const Parts of_a(random), of_b(random);
  const Compound a = Compound::of(of_a.parts).value(), b = Compound::of(of_b.parts).value();
  std::size_t met = 0;
  for (int k = 0; k < 100; ++k) {
    const SE3 T_a = random.pose(0.5), T_b = random.pose(0.5);
    for (const bool both : {true, false}) {
      const Shape other = both ? Shape(b) : Shape(Box{{0.3, 0.3, 0.3}});
      std::vector<std::pair<std::uint32_t, std::uint32_t>> truth, found;
      for (std::uint32_t i = 0; i < of_a.parts.size(); ++i) {
        for (std::uint32_t j = 0; j < (both ? of_b.parts.size() : 1); ++j) {
          const SE3 T_i = T_a * of_a.parts[i].T_compound_part;
          const SE3 T_j = both ? T_b * of_b.parts[j].T_compound_part : T_b;
          if (!find(of_a.parts[i].shape, T_i, both ? of_b.parts[j].shape : other, T_j, 0.01)
                   .manifolds.empty())
            truth.emplace_back(i, j);
        }
      }
      for (const SubManifold& s : find(a, T_a, other, T_b, 0.01).manifolds)
        found.emplace_back(s.sub_a, s.sub_b);
      EXPECT_EQ(found, truth);
      found.clear();
      for (const SubManifold& s : find(other, T_b, a, T_a, 0.01).manifolds)
        found.emplace_back(s.sub_b, s.sub_a);
      std::sort(found.begin(), found.end());
      EXPECT_EQ(found, truth);
      met += truth.size();
    }
  }
  EXPECT_GT(met, 500u);
}

TEST(Compound, StandsOnAMeshWithEachPart) {
  Random random(46);
  const TriangleMesh mesh = random_plane(random, 25, 5.0).made();
  const std::vector<CompoundPart> legs{{Box{{0.5, 0.3, 0.05}}, SE3(Vec3{0, 0, 0.5})},
                                       {Capsule{0.05, 0.2}, SE3(Vec3{0.4, 0.2, 0.25})},
                                       {Capsule{0.05, 0.2}, SE3(Vec3{-0.4, 0.2, 0.25})},
                                       {Box{{0.05, 0.05, 0.25}}, SE3(Vec3{0.0, -0.2, 0.25})}};
  const Compound table = Compound::of(legs).value();
  const Found found = find(mesh, SE3{}, table, SE3(Vec3{2.5, 2.4, 0.0}), 1e-3);
  ASSERT_EQ(found.manifolds.size(), 3u);
  for (std::uint32_t i = 0; i < 3; ++i) {
    EXPECT_EQ(found.manifolds[i].sub_b, i + 1);
    EXPECT_NEAR(found.manifolds[i].manifold.normal.z, 1.0, 1e-12);
    EXPECT_NEAR(found.manifolds[i].manifold.points[0].separation, 0.0, 1e-12);
  }
}

}  // namespace
}  // namespace vp::test
