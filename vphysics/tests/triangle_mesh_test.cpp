// Meshes and height fields as data: rejected input, neighbours, masses, scales.
#include "vphysics/triangle_mesh.h"

#include <gtest/gtest.h>

#include "collide/surface.h"
#include "rig.h"
#include "surfaces.h"
#include "vphysics/shapes.h"

namespace vp::test {
namespace {

using collide::Surface;

using Triangles = std::vector<TriangleMesh::Triangle>;

void expect_refused(const std::vector<Vec3>& vertices, const Triangles& triangles, const char* word,
                    const MeshOptions& options = {}) {
  const Expected<TriangleMesh> made = TriangleMesh::of(vertices, triangles, options);
  ASSERT_FALSE(made) << word;
  EXPECT_EQ(made.error().code, Errc::invalid_argument);
  EXPECT_NE(made.error().message.find(word), std::string::npos) << made.error().message;
}

TEST(TriangleMesh, RefusesWhatIsNoMeshAndSaysWhy) {
  const std::vector<Vec3> corner{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  expect_refused(corner, {}, "no triangles");
  expect_refused({}, {{0, 1, 2}}, "vertex 0 of 0");
  expect_refused(corner, {{0, 1, 2}, {0, 1, 3}}, "triangle 1 names vertex 3");
  for (const double bad : {kNaN, kInfinity, -kInfinity, 1.1e9}) {
    expect_refused({{0, 0, 0}, {1, bad, 0}, {0, 1, 0}}, {{0, 1, 2}}, "vertex 1");
  }
  expect_refused(corner, {{0, 1, 1}}, "area");
  expect_refused({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}, "area");
  expect_refused({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, {{0, 1, 2}}, "area");
  MeshOptions strict;
  strict.reject_degenerate = true;
  expect_refused(corner, {{0, 1, 2}, {2, 1, 2}}, "triangle 1", strict);
  EXPECT_TRUE(TriangleMesh::of(corner, Triangles{{0, 1, 2}}, strict));
}

TEST(TriangleMesh, LeavesTrianglesWithoutAreaOut) {
  MeshPoints m = box_mesh({1, 1, 1});
  m.triangles.push_back({0, 0, 1});
  m.triangles.push_back({3, 3, 3});
  m.vertices.push_back({0, -1, -1});  // at the midpoint of an edge
  m.triangles.push_back({0, 8, 4});
  const TriangleMesh mesh = m.made();
  EXPECT_EQ(mesh.left_out(), 3u);
  EXPECT_EQ(mesh.triangles().size(), 15u);
  EXPECT_NEAR(mesh.volume(), 8.0, 1e-12);
}

TEST(TriangleMesh, RefusesScalesThatAreNone) {
  const TriangleMesh mesh = box_mesh({1, 1, 1}).made();
  for (const double bad : {0.0, -1.0, 1e-7, 1e7, kNaN, kInfinity}) {
    EXPECT_FALSE(mesh.scaled({1, bad, 1}));
  }
  const TriangleMesh small = mesh.scaled({1e-4, 1e-4, 1e-4}).value();
  EXPECT_FALSE(small.scaled({1, 1, 1e-3}));  // the product
  EXPECT_EQ(small.data(), mesh.data());      // no copy
  const TriangleMesh back = small.scaled({1e4, 1e4, 1e4}).value();
  EXPECT_NEAR(back.scale().x, 1.0, 1e-15);
  TriangleMesh moved_from = mesh;
  const TriangleMesh other = std::move(moved_from);
  // NOLINTNEXTLINE(bugprone-use-after-move,clang-analyzer-cplusplus.Move): what is tested
  EXPECT_FALSE(moved_from.scaled({1, 1, 1}));
}

TEST(TriangleMesh, OfABoxHasTheMassOfTheBoxAtAnyScaleAndPlace) {
  Random random(21);
  for (int k = 0; k < 20; ++k) {
    const Vec3 half{random.uniform(0.1, 2), random.uniform(0.1, 2), random.uniform(0.1, 2)};
    const Vec3 stretch{random.uniform(0.1, 3), random.uniform(0.1, 3), random.uniform(0.1, 3)};
    const Vec3 at = random.in_cube(10.0);
    MeshPoints m = box_mesh(half);
    for (Vec3& v : m.vertices) v += at;
    const TriangleMesh mesh = m.made().scaled(stretch).value();
    ASSERT_TRUE(mesh.closed());
    const Box box{{half.x * stretch.x, half.y * stretch.y, half.z * stretch.z}};
    const Vec3 centre{at.x * stretch.x, at.y * stretch.y, at.z * stretch.z};
    const Inertia truth = solid_inertia(box, 700.0).about(-centre);
    const Inertia found = mesh.inertia(700.0).value();
    EXPECT_NEAR(found.mass() / truth.mass(), 1.0, 1e-13);
    EXPECT_NEAR(norm(found.centre_of_mass() - centre), 0.0, 1e-12 * (1.0 + norm(centre)));
    const Sym3 d = found.rotational() - truth.rotational();
    for (const double x : {d.xx, d.yy, d.zz, d.xy, d.yz, d.zx}) {
      EXPECT_NEAR(x / (truth.rotational().xx + truth.rotational().yy), 0.0, 1e-13);
    }
  }
}

TEST(TriangleMesh, OfASphereComesNearItsMass) {
  const TriangleMesh mesh = sphere_mesh(0.5, 4).made();
  const Inertia found = mesh.inertia(1000.0).value(), truth = solid_inertia(Sphere{0.5}, 1000.0);
  EXPECT_NEAR(found.mass() / truth.mass(), 1.0, 4e-3);  // 0.9967
  EXPECT_NEAR(found.rotational().xx / truth.rotational().xx, 1.0, 7e-3);
}

TEST(TriangleMesh, HasNoMassUnlessItIsClosedAndFacesOutwards) {
  MeshPoints open = box_mesh({1, 1, 1});
  open.triangles.pop_back();
  EXPECT_FALSE(open.made().closed());
  EXPECT_FALSE(open.made().inertia(1000.0));
  MeshPoints inside_out = box_mesh({1, 1, 1});
  for (auto& t : inside_out.triangles) std::swap(t[0], t[1]);
  EXPECT_TRUE(inside_out.made().closed());
  EXPECT_FALSE(inside_out.made().inertia(1000.0));
  MeshPoints one_turned = box_mesh({1, 1, 1});
  std::swap(one_turned.triangles[5][0], one_turned.triangles[5][1]);
  EXPECT_FALSE(one_turned.made().closed());
  for (const double bad : {0.0, -1.0, kNaN, kInfinity}) {
    EXPECT_FALSE(box_mesh({1, 1, 1}).made().inertia(bad));
  }
}

// Vertices duplicated for each triangle are matched by position.
TEST(TriangleMesh, KnowsNeighboursByThePlaceOfTheirCorners) {
  const MeshPoints shared = box_mesh({1, 2, 3});
  MeshPoints soup;
  for (const auto& t : shared.triangles) {
    const auto n = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t v : t) soup.vertices.push_back(shared.vertices[v]);
    soup.triangles.push_back({n, n + 1, n + 2});
  }
  const TriangleMesh mesh = soup.made();
  EXPECT_TRUE(mesh.closed());
  const Surface surface(*mesh.data(), mesh.scale());
  for (std::uint32_t i = 0; i < 12; ++i) {
    const collide::SurfaceTriangle t = surface.triangle(i);
    for (int e = 0; e < 3; ++e) {
      EXPECT_TRUE(t.has_opposite[e]);
      // Diagonals of the faces are inactive. The box's edges are active, from outside only.
      const Vec3 middle = 0.5 * (t.p[e] + t.p[(e + 1) % 3]);
      const int on = (std::fabs(middle.x) == 1.0) + (std::fabs(middle.y) == 2.0) +
                     (std::fabs(middle.z) == 3.0);
      EXPECT_EQ((t.active >> e) & 1u, on == 2 ? 1u : 0u);
      EXPECT_EQ((t.active >> (3 + e)) & 1u, 0u);
    }
  }
}

TEST(TriangleMesh, FeelsNoEdgeInsideAPlaneOfAnyTriangulation) {
  Random random(22);
  const TriangleMesh mesh = random_plane(random, 20, 5.0).made();
  const Surface surface(*mesh.data(), mesh.scale());
  for (std::uint32_t i = 0; i < mesh.triangles().size(); ++i) {
    const collide::SurfaceTriangle t = surface.triangle(i);
    EXPECT_NEAR(t.normal.z, 1.0, 1e-12);
    for (unsigned e = 0; e < 3; ++e) {
      EXPECT_EQ((t.active >> e) & 1u, t.has_opposite[e] ? 0u : 1u);  // the border is active
    }
  }
}

// A degenerate triangle between two others does not turn their edge into a border.
TEST(TriangleMesh, LooksAcrossTrianglesWithoutArea) {
  const std::vector<Vec3> v{{0, 0, 0}, {2, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0.5, -1, 0}, {1.5, -1, 0}};
  const TriangleMesh mesh =
      TriangleMesh::of(v, Triangles{{0, 1, 3}, {0, 2, 1}, {0, 4, 2}, {2, 5, 1}}).value();
  EXPECT_EQ(mesh.left_out(), 1u);
  const Surface surface(*mesh.data(), mesh.scale());
  EXPECT_TRUE(surface.triangle(0).has_opposite[0]);
  EXPECT_EQ(surface.triangle(0).active & 1u, 0u);
  EXPECT_TRUE(surface.triangle(2).has_opposite[2]);
  EXPECT_TRUE(surface.triangle(3).has_opposite[2]);
}

// An edge of three triangles, two coincident triangles, and a fold onto itself count as borders.
TEST(TriangleMesh, FeelsEdgesThatHaveNoOneNeighbour) {
  const std::vector<Vec3> v{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0.2, 0.7, 0}};
  for (const Triangles& triangles :
       {Triangles{{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}, Triangles{{0, 1, 2}, {1, 0, 5}}}) {
    const TriangleMesh mesh = TriangleMesh::of(v, triangles).value();
    const Surface surface(*mesh.data(), mesh.scale());
    EXPECT_EQ(surface.triangle(0).active & 9u, 9u);
  }
}

TEST(TriangleMesh, TakesNeedlesAndVerticesOfHighValence) {
  MeshPoints fan;
  fan.vertices.push_back({0, 0, 0});
  constexpr std::uint32_t kBlades = 5000;
  for (std::uint32_t k = 0; k < kBlades; ++k) {
    const double angle = 2.0 * kPi * k / kBlades;
    fan.vertices.push_back({std::cos(angle), std::sin(angle), 0.0});
    fan.triangles.push_back({0, 1 + k, 1 + (k + 1) % kBlades});
  }
  const TriangleMesh mesh = fan.made();
  EXPECT_EQ(mesh.left_out(), 0u);
  const Surface surface(*mesh.data(), mesh.scale());
  EXPECT_TRUE(surface.lies_below(0, {0, 0, 1}));
  EXPECT_FALSE(surface.lies_below(0, {1e-3, 0, 1}));
}

TEST(Surface, FindsTheTrianglesOfAMeshThatBruteForceFinds) {
  Random random(23);
  const TriangleMesh mesh = sphere_mesh(2.0, 3).made().scaled({1.0, 0.5, 2.0}).value();
  const Surface surface(*mesh.data(), mesh.scale());
  for (int k = 0; k < 100; ++k) {
    const Vec3 centre = random.in_cube(4.0), half{0.5, 0.3, 0.2};
    const collide::Bounds box{centre - half, centre + half};
    std::vector<std::uint32_t> found, truth;
    surface.append_overlapping(box, found);
    for (std::uint32_t i = 0; i < mesh.triangles().size(); ++i) {
      const collide::SurfaceTriangle t = surface.triangle(i);
      collide::Bounds b;
      for (const Vec3& p : t.p) b = merged(b, {p, p});
      if (overlap(b, box)) truth.push_back(i);
    }
    // Single-precision bounds may find a few too many, but never too few.
    EXPECT_TRUE(std::includes(found.begin(), found.end(), truth.begin(), truth.end()));
    EXPECT_LE(found.size(), truth.size() + 2);
  }
}

struct Ground {
  std::vector<double> heights;
  std::vector<std::uint8_t> holes;
  HeightGrid grid;

  Ground(Random& random, std::uint32_t columns, std::uint32_t rows, bool with_holes) {
    for (std::uint32_t k = 0; k < columns * rows; ++k) heights.push_back(random.uniform(0, 0.5));
    for (std::uint32_t k = 0; with_holes && k < (columns - 1) * (rows - 1); ++k) {
      holes.push_back(random.word() % 5 == 0 ? 1 : 0);
    }
    grid = {columns, rows, 0.7, 1.1, heights, holes};
  }
};

TEST(HeightField, RefusesWhatIsNoGroundAndSaysWhy) {
  Random random(24);
  const Ground good(random, 4, 3, true);
  ASSERT_TRUE(HeightField::of(good.grid));
  const auto expect_refused = [&](const auto& change, const char* word) {
    Ground ground = good;
    ground.grid.heights = ground.heights;
    ground.grid.holes = ground.holes;
    change(ground);
    const Expected<HeightField> made = HeightField::of(ground.grid);
    ASSERT_FALSE(made) << word;
    EXPECT_NE(made.error().message.find(word), std::string::npos) << made.error().message;
  };
  expect_refused([](Ground& g) { g.grid.columns = 1; }, "columns");
  expect_refused([](Ground& g) { g.grid.rows = 0; }, "rows");
  expect_refused([](Ground& g) { g.grid.columns = 40000; }, "split");
  expect_refused([](Ground& g) { g.grid.rows = 4; }, "heights");
  expect_refused([](Ground& g) { g.grid.heights = {}; }, "heights");
  expect_refused([](Ground& g) { g.grid.holes = g.grid.holes.first(5); }, "hole");
  for (const double bad : {0.0, -1.0, kNaN, kInfinity}) {
    expect_refused([&](Ground& g) { g.grid.spacing_y = bad; }, "spacing");
  }
  for (const double bad : {kNaN, kInfinity, -1.1e9}) {
    expect_refused([&](Ground& g) { g.heights[7] = bad; }, "height 7");
  }
}

// A mesh of the same ground has the same neighbours and edges.
TEST(HeightField, HasTheNeighboursAndFeltEdgesOfTheMeshOfItsTriangles) {
  Random random(25);
  for (const bool with_holes : {false, true}) {
    const Ground ground(random, 9, 7, with_holes);
    const Vec3 scale{0.5, 2.0, 1.5};
    const HeightField field = HeightField::of(ground.grid).value().scaled(scale).value();
    const Surface surface(*field.data(), field.scale());
    MeshPoints m;
    std::vector<std::uint32_t> ids;
    for (std::uint32_t j = 0; j < 7; ++j) {
      for (std::uint32_t i = 0; i < 9; ++i) m.vertices.push_back(field.sample(i, j));
    }
    for (std::uint32_t id = 0; id < 2 * 8 * 6; ++id) {
      if (field.is_hole(id / 2 % 8, id / 2 / 8)) continue;
      const collide::SurfaceTriangle t = surface.triangle(id);
      m.triangles.push_back({t.corners[0], t.corners[1], t.corners[2]});
      ids.push_back(id);
    }
    const TriangleMesh mesh = m.made();
    const Surface truth(*mesh.data(), mesh.scale());
    for (std::uint32_t k = 0; k < ids.size(); ++k) {
      const collide::SurfaceTriangle a = surface.triangle(ids[k]), b = truth.triangle(k);
      EXPECT_GT(a.normal.z, 0.0);
      EXPECT_EQ(a.active, b.active);
      for (int e = 0; e < 3; ++e) {
        EXPECT_EQ(a.p[e], b.p[e]);
        ASSERT_EQ(a.has_opposite[e], b.has_opposite[e]);
        if (a.has_opposite[e]) {
          EXPECT_EQ(a.opposite[e], b.opposite[e]);
        }
      }
    }
    for (std::uint32_t v = 0; v < 9 * 7; ++v) {
      for (int k = 0; k < 20; ++k) {
        const Vec3 d = random.direction();
        EXPECT_EQ(surface.lies_below(v, d), truth.lies_below(v, d)) << v;
      }
    }
  }
}

TEST(HeightField, FindsTheTrianglesThatBruteForceFinds) {
  Random random(26);
  const Ground ground(random, 20, 15, true);
  const HeightField field = HeightField::of(ground.grid).value().scaled({1.0, 0.5, 2.0}).value();
  const Surface surface(*field.data(), field.scale());
  for (int k = 0; k < 300; ++k) {
    const Vec3 centre{random.uniform(-2, 15), random.uniform(-2, 10), random.uniform(-0.5, 1.5)};
    const Vec3 half = random.uniform(0.0, 1.0) * Vec3{1, 1, 0.2};
    const collide::Bounds box{centre - half, centre + half};
    std::vector<std::uint32_t> found, truth;
    surface.append_overlapping(box, found);
    for (std::uint32_t id = 0; id < 2 * 19 * 14; ++id) {
      if (field.is_hole(id / 2 % 19, id / 2 / 19)) continue;
      const collide::SurfaceTriangle t = surface.triangle(id);
      collide::Bounds b;
      for (const Vec3& p : t.p) b = merged(b, {p, p});
      if (overlap(b, box)) truth.push_back(id);
    }
    // A cell is found as soon as one of its triangles is.
    EXPECT_TRUE(std::includes(found.begin(), found.end(), truth.begin(), truth.end()));
    EXPECT_LE(found.size(), 2 * truth.size() + 2);
  }
}

TEST(Surface, CastsMeetEveryTriangleThatTheBoundsMeet) {
  Random random(27);
  const Ground ground(random, 20, 15, true);
  const HeightField field = HeightField::of(ground.grid).value().scaled({1.0, 0.5, 2.0}).value();
  const TriangleMesh mesh = sphere_mesh(2.0, 2).made().scaled({1.0, 0.5, 2.0}).value();
  const Surface surfaces[] = {{*field.data(), field.scale()}, {*mesh.data(), mesh.scale()}};
  collide::CastScratch scratch;
  for (const Surface& surface : surfaces) {
    std::vector<std::uint32_t> all;
    surface.append_overlapping({{-1e6, -1e6, -1e6}, {1e6, 1e6, 1e6}}, all);
    const collide::Bounds whole = surface.bounds();
    for (int k = 0; k < 300; ++k) {
      Vec3 from, to;
      for (int i = 0; i < 3; ++i) {
        from[i] = random.uniform(whole.lower[i] - 1.0, whole.upper[i] + 1.0);
        to[i] = random.uniform(whole.lower[i] - 1.0, whole.upper[i] + 1.0);
      }
      if (k % 7 == 0) to = from;
      if (k % 5 == 0) to.x = from.x;
      const Vec3 half = k % 2 ? Vec3{} : Vec3{0.2, 0.4, 0.1};
      const collide::Sweep sweep{{from - half, from + half}, to - from};
      std::vector<std::uint32_t> found;
      double last = 0.0;
      surface.cast(sweep, 1.0, scratch, [&](std::uint32_t id, double entry) {
        EXPECT_GE(entry, last);
        last = entry;
        found.push_back(id);
        return 1.0;
      });
      std::sort(found.begin(), found.end());
      ASSERT_TRUE(std::adjacent_find(found.begin(), found.end()) == found.end());
      // Every triangle whose bounds overlap the box at one of many fractions is found.
      for (const std::uint32_t id : all) {
        const collide::SurfaceTriangle t = surface.triangle(id);
        collide::Bounds b;
        for (const Vec3& p : t.p) b = merged(b, {p, p});
        for (int s = 0; s <= 50; ++s) {
          const Vec3 at = from + (s / 50.0) * (to - from);
          if (!overlap(b, {at - half, at + half})) continue;
          ASSERT_TRUE(std::binary_search(found.begin(), found.end(), id)) << id << " at " << s;
          break;
        }
      }
    }
  }
}

}  // namespace
}  // namespace vp::test
