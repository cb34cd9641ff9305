// Ray casts, overlap, nearest points and first impacts of every shape, against ray marching along
// the signed distance, against brute force over all parts, and against fine samples.
#include "collide/shape_query.h"

#include <gtest/gtest.h>

#include <limits>
#include <numeric>
#include <optional>

#include "collide/compound_data.h"
#include "collide/ray.h"
#include "collide/surface.h"
#include "samples.h"
#include "shape_truth.h"
#include "surfaces.h"

namespace vp::test {
namespace {

using collide::CastScratch;
using collide::PartsScratch;
using collide::Ray;
using collide::RayEntry;

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr Kind kSolids[] = {Kind::sphere, Kind::capsule, Kind::box,       Kind::cylinder,
                            Kind::cone,   Kind::hull,    Kind::half_space};

std::optional<RayEntry> cast(const Geometry& g, const Ray& ray, double limit) {
  CastScratch scratch;
  RayEntry entry{};
  if (!cast_ray(g, ray, limit, scratch, entry)) return std::nullopt;
  return entry;
}

Vec3 at(const Ray& ray, double distance) {
  return ray.origin + distance * ray.direction;
}

// Ray marching with steps of the current distance; negative on a miss.
double marched(const Geometry& g, const Ray& ray, double limit) {
  double t = 0.0;
  for (int i = 0; i < 20000 && t <= limit; ++i) {
    const double d = signed_distance(g, at(ray, t)).distance;
    if (d < 1e-9) return t;
    t += d;
  }
  return -1.0;
}

// --- rays

TEST(Ray, EntersEachSolidWhereMarchingDoes) {
  Random random(601);
  for (const Kind kind : kSolids) {
    int hits = 0, misses = 0;
    double worst = 0.0;
    for (int i = 0; i < 400; ++i) {
      const Solid solid = random_solid(random, kind);
      const Vec3 origin = random.uniform(1.0, 4.0) * random.direction();
      const Vec3 way = random.in_cube(0.7) - origin;
      const Ray ray{origin, (1.0 / norm(way)) * way};
      const auto hit = cast(solid.geometry, ray, 6.0);
      const double truth = marched(solid.geometry, ray, 6.0);
      if (!hit) {
        // Marching counts a pass within 1e-9 as a hit.
        EXPECT_LT(truth, 0.0) << "kind " << static_cast<int>(kind);
        ++misses;
        continue;
      }
      ++hits;
      ASSERT_GE(truth, 0.0) << "kind " << static_cast<int>(kind) << " at " << hit->distance;
      // A ray at a grazing angle is within 1e-9 of the surface long before it hits.
      const double flat = std::max(1e-3, -dot(hit->normal, ray.direction));
      worst = std::max(worst, std::fabs(hit->distance - truth) * flat);
      if (hit->distance == 0.0) continue;
      const auto surface = signed_distance(solid.geometry, at(ray, hit->distance));
      EXPECT_NEAR(surface.distance, 0.0, 1e-12);
      EXPECT_NEAR(norm(hit->normal), 1.0, 1e-12);
      EXPECT_LE(dot(hit->normal, ray.direction), 1e-9);
      // Just outside, the distance grows along the normal.
      const Vec3 outside = at(ray, hit->distance) + 1e-4 * hit->normal;
      EXPECT_NEAR(signed_distance(solid.geometry, outside).distance, 1e-4, 1e-9);
    }
    EXPECT_GE(hits, 60) << static_cast<int>(kind);
    if (kind != Kind::half_space) {
      EXPECT_GE(misses, 20) << static_cast<int>(kind);
    }
    EXPECT_LT(worst, 2e-9) << static_cast<int>(kind);
  }
}

// Along and beside the axes through the centre, along faces, along a side, at a rim.
TEST(Ray, IsRightWhereFormulasHaveNoSlope) {
  const Solid cone(Cone{0.5, 1.0}), cylinder(Cylinder{0.5, 1.0}), capsule(Capsule{0.5, 1.0}),
      box(Box{{0.5, 0.5, 1.0}});
  for (const Solid* s : {&cone, &cylinder, &capsule, &box}) {
    const double top = s == &capsule ? 1.5 : 1.0;
    EXPECT_NEAR(cast(s->geometry, {{0, 0, 5}, {0, 0, -1}}, 10)->distance, 5 - top, 1e-12);
    EXPECT_NEAR(cast(s->geometry, {{0, 0, -5}, {0, 0, 1}}, 10)->distance, 5 - top, 1e-12);
    EXPECT_FALSE(cast(s->geometry, {{0.6, 0, 5}, {0, 0, -1}}, 10));
    EXPECT_FALSE(cast(s->geometry, {{0, 0, 5}, {1, 0, 0}}, 10));
    EXPECT_FALSE(cast(s->geometry, {{0, 0, 5}, {0, 0, 1}}, 10));
    EXPECT_FALSE(cast(s->geometry, {{0, 0, 5}, {0, 0, -1}}, 5 - top - 1e-9));
    EXPECT_TRUE(cast(s->geometry, {{0, 0, 5}, {0, 0, -1}}, 5 - top + 1e-9));
  }
  // At height 0 the cone's radius is 0.25; its side rises by 4 for each metre inwards.
  EXPECT_NEAR(cast(cone.geometry, {{5, 0, 0}, {-1, 0, 0}}, 10)->distance, 4.75, 1e-12);
  EXPECT_NEAR(cast(cone.geometry, {{0.25, 0, 5}, {0, 0, -1}}, 10)->distance, 5.0, 1e-12);
  const double slope = 1.0 / std::sqrt(17.0);
  const Vec3 n = cast(cone.geometry, {{5, 0, 0}, {-1, 0, 0}}, 10)->normal;
  EXPECT_NEAR(n.x, 4.0 * slope, 1e-12);
  EXPECT_NEAR(n.z, slope, 1e-12);
  // Parallel to the side, 1 um within and beside it: A = 0 in the cone's quadratic.
  const Vec3 along{-slope, 0, 4.0 * slope}, out{4.0 * slope, 0, slope};
  const Vec3 low = Vec3{0.5, 0, -1.0} - 3.0 * along;
  EXPECT_TRUE(cast(cone.geometry, {low - 1e-6 * out, along}, 10));
  EXPECT_FALSE(cast(cone.geometry, {low + 1e-6 * out, along}, 10));
  // The mirrored nappe above the apex does not belong to the cone.
  EXPECT_FALSE(cast(cone.geometry, {{5, 0, 2.0}, {-1, 0, 0}}, 10));
  EXPECT_FALSE(cast(cone.geometry, {{0.2, 0, 5}, {0, 0.6, 0.8}}, 10));
  // A ray along a face hits if it is slightly inside.
  EXPECT_TRUE(cast(box.geometry, {{-5, 0, 1.0 - 1e-12}, {1, 0, 0}}, 10));
  EXPECT_FALSE(cast(box.geometry, {{-5, 0, 1.0 + 1e-12}, {1, 0, 0}}, 10));
}

TEST(Ray, StartingInsideIsThereAtOnceWithTheWayOut) {
  Random random(602);
  for (const Kind kind : kSolids) {
    int inside = 0;
    for (int i = 0; i < 200; ++i) {
      const Solid solid = random_solid(random, kind);
      const Ray ray{random.in_cube(0.5), random.direction()};
      const auto d = signed_distance(solid.geometry, ray.origin);
      if (d.distance > -1e-9) continue;
      ++inside;
      const auto hit = cast(solid.geometry, ray, 0.0);
      ASSERT_TRUE(hit);
      EXPECT_EQ(hit->distance, 0.0);
      EXPECT_EQ(hit->normal, d.normal);
    }
    EXPECT_GE(inside, 10) << static_cast<int>(kind);
  }
}

TEST(Ray, FromFarAwayHitsASmallSphereAsFromNearBy) {
  const Solid ball(Sphere{0.01});
  for (const double far : {1e2, 1e4, 1e6}) {
    const auto hit = cast(ball.geometry, {{-far, 0.005, 0}, {1, 0, 0}}, 2e6);
    ASSERT_TRUE(hit);
    EXPECT_NEAR(far - hit->distance, std::sqrt(0.01 * 0.01 - 0.005 * 0.005), 1e-15 * far);
    EXPECT_NEAR(hit->normal.y, 0.5, 1e-12);
    EXPECT_FALSE(cast(ball.geometry, {{-far, 0.0101, 0}, {1, 0, 0}}, 2e6));
  }
}

// Brute force over all triangles, by the formula of Moeller and Trumbore.
struct Brute {
  double distance = kInfinite;
  std::uint32_t triangle = 0;
};
Brute brute_force(const collide::Surface& surface, std::span<const std::uint32_t> ids,
                  const Ray& ray, double limit) {
  Brute best;
  for (const std::uint32_t id : ids) {
    const auto t = surface.triangle(id);
    const Vec3 e1 = t.p[1] - t.p[0], e2 = t.p[2] - t.p[0], h = cross(ray.direction, e2);
    const double a = dot(e1, h);
    if (a == 0.0 || (a < 0.0 && !surface.two_sided())) continue;
    const Vec3 s = ray.origin - t.p[0], q = cross(s, e1);
    const double u = dot(s, h) / a, v = dot(ray.direction, q) / a, w = dot(e2, q) / a;
    if (u < 0.0 || v < 0.0 || u + v > 1.0 || w < 0.0 || w > limit || w >= best.distance) continue;
    best = {w, id};
  }
  return best;
}

std::vector<double> random_heights(Random& random, std::size_t count, double high) {
  std::vector<double> heights(count);
  for (double& h : heights) h = random.uniform(-high, high);
  return heights;
}

// A bumpy mesh, closed and with outward normals.
TriangleMesh lumpy_mesh(Random& random, bool two_sided) {
  MeshPoints points = sphere_mesh(1.0, 2);
  for (Vec3& v : points.vertices) v = random.uniform(0.7, 1.2) * v;
  return points.made({two_sided, false}).scaled({1.5, 1.0, 0.5}).value();
}

std::vector<std::uint32_t> all_of(std::size_t count) {
  std::vector<std::uint32_t> ids(count);
  std::iota(ids.begin(), ids.end(), 0u);
  return ids;
}

void expect_as_brute_force(Random& random, const Geometry& g, std::span<const std::uint32_t> ids,
                           const Vec3& middle, double reach, int least_hits) {
  const collide::Surface surface = surface_of(g);
  int hits = 0, misses = 0;
  for (int i = 0; i < 500; ++i) {
    const Vec3 origin = middle + random.uniform(0.0, 2.0) * reach * random.direction();
    const Vec3 way = middle + random.in_cube(reach) - origin;
    const Ray ray{origin, (1.0 / norm(way)) * way};
    const double limit = random.uniform(0.5, 4.0) * reach;
    const Brute truth = brute_force(surface, ids, ray, limit);
    const auto hit = cast(g, ray, limit);
    ASSERT_EQ(hit.has_value(), truth.distance < kInfinite) << i;
    if (!hit) {
      ++misses;
      continue;
    }
    ++hits;
    EXPECT_NEAR(hit->distance, truth.distance, 1e-12 * reach);
    EXPECT_EQ(hit->part, truth.triangle);
    EXPECT_LT(dot(hit->normal, ray.direction), 0.0);
    EXPECT_NEAR(std::fabs(dot(hit->normal, surface.triangle(hit->part).normal)), 1.0, 1e-12);
  }
  EXPECT_GE(hits, least_hits);
  EXPECT_GE(misses, 20);
}

TEST(Ray, MeetsAMeshWhereATryOfEveryTriangleDoes) {
  Random random(603);
  for (const bool two_sided : {false, true}) {
    const TriangleMesh mesh = lumpy_mesh(random, two_sided);
    const auto ids = all_of(mesh.triangles().size());
    expect_as_brute_force(random, collide::make_geometry(mesh), ids, {}, 1.5,
                          two_sided ? 250 : 100);
  }
}

TEST(Ray, MeetsAHeightFieldWhereATryOfEveryTriangleDoes) {
  Random random(604);
  HeightGrid grid;
  grid.columns = 13;
  grid.rows = 9;
  grid.spacing_x = 0.5;
  grid.spacing_y = 0.7;
  const auto heights = random_heights(random, 13 * 9, 0.6);
  std::vector<std::uint8_t> holes(12 * 8);
  for (auto& h : holes) h = random.word() % 6 == 0 ? 1 : 0;
  grid.heights = heights;
  grid.holes = holes;
  const HeightField field = HeightField::of(grid).value().scaled({1.0, 0.8, 1.5}).value();
  std::vector<std::uint32_t> ids;
  for (std::uint32_t j = 0; j < 8; ++j) {
    for (std::uint32_t i = 0; i < 12; ++i) {
      if (field.is_hole(i, j)) continue;
      ids.push_back(2 * (j * 12 + i));
      ids.push_back(2 * (j * 12 + i) + 1);
    }
  }
  expect_as_brute_force(random, collide::make_geometry(field), ids, {3.0, 2.24, 0.5}, 3.0, 80);
}

// Downwards at vertices and along edges of a plane of arbitrary triangles: no ray passes through.
TEST(Ray, NeverPassesBetweenNeighbours) {
  Random random(605);
  const MeshPoints points = random_plane(random, 12, 3.0);
  const TriangleMesh mesh = points.made();
  const Geometry g = collide::make_geometry(mesh);
  const auto expect_hit = [&](const Vec3& target) {
    const Vec3 origin = target + Vec3{random.uniform(-1, 1), random.uniform(-1, 1), 2.0};
    const Vec3 way = target - origin;
    const auto hit = cast(g, {origin, (1.0 / norm(way)) * way}, 10.0);
    ASSERT_TRUE(hit) << target.x << " " << target.y;
    EXPECT_NEAR(hit->distance, norm(way), 1e-12);
  };
  for (const auto& t : mesh.triangles()) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &p = mesh.vertices()[t[k]], &q = mesh.vertices()[t[(k + 1) % 3]];
      const auto is_border = [](double x) { return x < 1e-9 || x > 3.0 - 1e-9; };
      for (const double s : {0.0, 0.25, 0.5, 0.7391}) {
        const Vec3 x = p + s * (q - p);
        if (!is_border(x.x) && !is_border(x.y)) expect_hit(x);
      }
    }
  }
}

Compound random_compound(Random& random) {
  std::vector<CompoundPart> parts;
  for (int i = 0; i < 12; ++i) {
    parts.push_back({random_solid(random, kSolids[i % 6]).shape, random.pose(1.5)});
  }
  return Compound::of(parts).value();
}

TEST(Ray, MeetsTheFirstPartOfACompound) {
  Random random(606);
  int hits = 0;
  for (int i = 0; i < 100; ++i) {
    const Compound compound = random_compound(random);
    const Vec3 origin = 5.0 * random.direction(), way = random.in_cube(1.5) - origin;
    const Ray ray{origin, (1.0 / norm(way)) * way};
    double first = kInfinite;
    std::uint32_t part = 0;
    for (std::uint32_t k = 0; k < compound.parts().size(); ++k) {
      const SE3& T = compound.parts()[k].T_compound_part;
      const double t = marched(compound.data()->geometries[k],
                               {inverse_times(T, origin), T.unrotate(ray.direction)}, 10.0);
      if (t >= 0.0 && t < first) first = t, part = k;
    }
    const auto hit = cast(collide::make_geometry(compound), ray, 10.0);
    ASSERT_EQ(hit.has_value(), first < kInfinite);
    if (!hit) continue;
    ++hits;
    EXPECT_NEAR(hit->distance, first, 1e-6);
    EXPECT_EQ(hit->part, part);
  }
  EXPECT_GE(hits, 50);
}

// --- brute force over parts

// Calls f(part, pose, number) for each part of any shape; the parts of surfaces are their
// triangles.
template <class F>
void each_part(const Geometry& g, const SE3& T, std::span<const std::uint32_t> ids, const F& f) {
  if (g.kind == Kind::compound) {
    for (std::uint32_t i = 0; i < g.compound->parts.size(); ++i) {
      f(g.compound->geometries[i], T * g.compound->parts[i].T_compound_part, i);
    }
  } else if (is_surface(g)) {
    const collide::Surface surface = surface_of(g);
    for (const std::uint32_t id : ids) {
      const auto t = surface.triangle(id);
      f(collide::triangle_geometry(t.p), T, id);
    }
  } else {
    f(g, T, 0u);
  }
}

// The smallest separation of all pairs of parts.
double least_separation(const Geometry& a, const SE3& Ta, const Geometry& b, const SE3& Tb,
                        std::span<const std::uint32_t> ids) {
  double least = kInfinite;
  each_part(a, Ta, {}, [&](const Geometry& pa, const SE3& Tpa, std::uint32_t) {
    each_part(b, Tb, ids, [&](const Geometry& pb, const SE3& Tpb, std::uint32_t) {
      collide::PairCache fresh;
      least = std::min(least, closest_points(pa, Tpa, pb, Tpb, fresh).distance);
    });
  });
  return least;
}

// One shape of each kind that has parts, and all its triangles.
struct Parted {
  std::string name;
  Shape shape;
  std::vector<std::uint32_t> ids;
};
std::vector<Parted> parted_shapes(Random& random) {
  const TriangleMesh mesh = lumpy_mesh(random, true);
  HeightGrid grid;
  grid.columns = 8;
  grid.rows = 8;
  grid.spacing_x = grid.spacing_y = 0.5;
  const auto heights = random_heights(random, 64, 0.3);
  grid.heights = heights;
  const HeightField field = HeightField::of(grid).value();
  return {{"mesh", mesh, all_of(mesh.triangles().size())},
          {"height field", field, all_of(2 * 7 * 7)},
          {"compound", random_compound(random), {}},
          {"half-space", HalfSpace{}, {}},
          {"hull", random_solid(random, Kind::hull).shape, {}}};
}

Shape random_asker(Random& random, int i) {
  if (i % 7 == 6) return random_compound(random);
  return random_solid(random, kSolids[i % 7]).shape;
}

TEST(Nearest, IsThatOfAllPartsTriedOneByOne) {
  Random random(607);
  for (const Parted& parted : parted_shapes(random)) {
    const Geometry b = collide::make_geometry(parted.shape);
    int apart = 0, overlapping = 0, beyond = 0;
    for (int i = 0; i < 42; ++i) {
      const Shape shape = random_asker(random, i);
      const Geometry a = collide::make_geometry(shape);
      const SE3 Ta = random.pose(i % 3 ? 5.0 : 1.5), Tb = random.pose(1.0);
      const double truth = least_separation(a, Ta, b, Tb, parted.ids);
      const double limit = random.uniform(0.5, 10.0);
      PartsScratch scratch;
      collide::NearestParts found;
      EXPECT_EQ(parts_touch(a, Ta, b, Tb, scratch), truth <= 0.0) << parted.name << truth;
      const bool near = nearest_parts(a, Ta, b, Tb, limit, scratch, found);
      ASSERT_EQ(near, truth <= limit) << parted.name << " " << truth << " " << limit;
      beyond += near ? 0 : 1;
      if (!near) continue;
      (truth > 0.0 ? apart : overlapping) += 1;
      EXPECT_NEAR(found.points.distance, truth, 1e-9 * (1.0 + std::fabs(truth))) << parted.name;
      // The reported parts are the closest ones.
      each_part(a, Ta, {}, [&](const Geometry& pa, const SE3& Tpa, std::uint32_t ia) {
        each_part(b, Tb, parted.ids, [&](const Geometry& pb, const SE3& Tpb, std::uint32_t ib) {
          if (ia != found.part_a || ib != found.part_b) return;
          collide::PairCache fresh;
          EXPECT_NEAR(closest_points(pa, Tpa, pb, Tpb, fresh).distance, truth,
                      1e-9 * (1.0 + std::fabs(truth)));
        });
      });
    }
    EXPECT_GE(apart, 5) << parted.name;
    if (parted.name != "hull") {
      EXPECT_GE(overlapping, 2) << parted.name;
    }
    EXPECT_GE(apart + beyond, 10) << parted.name;
  }
}

// Balls, boxes and compounds fly at each shape, spinning at up to 100 rad/s. No sample touches
// before the reported time, and at that time the separation is within the tolerance.
TEST(FirstImpact, IsThatOfFineSamplesOfAllParts) {
  Random random(608);
  for (const Parted& parted : parted_shapes(random)) {
    const Geometry b = collide::make_geometry(parted.shape);
    const bool turns = b.kind == Kind::compound || b.kind == Kind::hull;
    int meets = 0, passes = 0;
    for (int i = 0; i < 24; ++i) {
      const Shape shape = random_asker(random, i);
      const Geometry a = collide::make_geometry(shape);
      const SE3 Tb(random.rotation(), Vec3{});
      const Vec3 towards = Tb * (b.kind == Kind::height_field ? Vec3{1.75, 1.75, 0} : Vec3{});
      // One-sided ones from in front.
      Vec3 from = random.direction();
      if (b.kind == Kind::half_space) from = {0, 0, 1};
      if (b.kind == Kind::height_field) from = {0.5 * from.x, 0.5 * from.y, 0.9};
      const SE3 Ta(random.rotation(), towards + 5.0 * (Tb.rotate(from)));
      const Vec3 v = random.uniform(20, 60) *
                     ((1.0 / norm(towards - Ta.position())) * (towards - Ta.position()) +
                      0.4 * random.direction());
      const collide::ImpactQuery q{
          {&a, Ta, {Ta.position(), v, random.uniform(0, 100) * random.direction()}},
          {&b,
           Tb,
           {Tb.position(), {}, turns ? random.uniform(0, 30) * random.direction() : Vec3{}}},
          0.15,
          1e-7};
      const auto separation = [&](double t) {
        return least_separation(a, pose_at(q.a, t), b, pose_at(q.b, t), parted.ids);
      };
      PartsScratch scratch;
      collide::PartsImpact found{};
      const bool met = first_impact(q, 0.0, scratch, found);
      const int looks = samples(parted.ids.empty() ? 150 : 60);
      const double end = met ? found.time : q.duration;
      for (int k = 0; k < looks; ++k) {
        ASSERT_GT(separation(end * k / looks), 0.0) << parted.name << " " << i;
      }
      if (met) {
        ++meets;
        EXPECT_LE(separation(found.time), 1.01e-7) << parted.name;
        EXPECT_NEAR(found.points.distance, 0.0, 1.01e-7);
      } else {
        ++passes;
      }
    }
    EXPECT_GE(meets, 4) << parted.name;
    EXPECT_GE(passes, 1) << parted.name;
  }
}

// A one-sided surface stops bodies from in front only; a two-sided one from both sides.
TEST(FirstImpact, OneSidedTrianglesLetPassFromBehind) {
  const std::vector<Vec3> vertices{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
  const std::vector<TriangleMesh::Triangle> triangles{{0, 1, 2}};
  const Solid ball(Sphere{0.1});
  for (const bool two_sided : {false, true}) {
    const TriangleMesh mesh = TriangleMesh::of(vertices, triangles, {two_sided, false}).value();
    const Geometry g = collide::make_geometry(mesh);
    for (const double side : {1.0, -1.0}) {
      const collide::ImpactQuery q{
          {&ball.geometry, SE3(Vec3{0, 0, side}), {{0, 0, side}, {0, 0, -2.0 * side}, {}}},
          {&g, SE3{}, {}},
          1.0,
          1e-9};
      PartsScratch scratch;
      collide::PartsImpact found{};
      ASSERT_EQ(first_impact(q, 0.0, scratch, found), side > 0.0 || two_sided);
      if (side > 0.0 || two_sided) {
        EXPECT_NEAR(found.time, 0.45, 1e-8);
      }
      const auto hit = cast(g, {{0, 0, side}, {0, 0, -side}}, 2.0);
      EXPECT_EQ(hit.has_value(), side > 0.0 || two_sided);
    }
  }
}

// A ball that rolls over the internal edges of a mesh has no impact; one that is pressed in has.
TEST(FirstImpact, FromATargetBelowWhatItIsFeelsNoInnerEdges) {
  Random random(609);
  const Solid ball(Sphere{0.1});
  const TriangleMesh mesh = random_plane(random, 12, 3.0).made();
  const Geometry g = collide::make_geometry(mesh);
  const auto impact = [&](double height, const Vec3& v) {
    const Vec3 x{0.5, 0.6, 0.1 + height};
    PartsScratch scratch;
    collide::PartsImpact found{};
    const collide::ImpactQuery q{{&ball.geometry, SE3(x), {x, v, {}}}, {&g, SE3{}, {}}, 0.1, 1e-7};
    return first_impact(q, -1e-3, scratch, found) ? found.time : -1.0;
  };
  EXPECT_LT(impact(1e-5, {20, 5, 0}), 0.0);
  EXPECT_LT(impact(-5e-4, {20, 5, 0}), 0.0);
  EXPECT_NEAR(impact(0.0, {0, 0, -1}), 1e-3, 1e-6);
  EXPECT_NEAR(impact(0.0, {20, 5, -1}), 1e-3, 1e-6);
  EXPECT_LT(impact(-5e-4, {0, 0, 1}), 0.0);
}

}  // namespace
}  // namespace vp::test
