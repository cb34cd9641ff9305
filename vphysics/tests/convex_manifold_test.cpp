// Manifolds of every pair of convex shapes: against the distance (proven in closest_points_test),
// against each other, and for shapes that stand or roll. PAIRS is the number of samples for each
// pair.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>
#include <vector>

#include "collide/distance.h"
#include "collide/gjk.h"
#include "collide/manifold.h"
#include "collide/polytope.h"
#include "random.h"
#include "shape_truth.h"

namespace vp::test {
namespace {

#ifdef PAIRS
constexpr int kManifoldSamples = PAIRS;
#else
constexpr int kManifoldSamples = 60;
#endif

using collide::ClosestPoints;
using collide::Manifold;
using collide::PairCache;

Manifold manifold_of(const Solid& a, const SE3& Ta, const Solid& b, const SE3& Tb, double margin) {
  Manifold m;
  PairCache cache;
  find_manifold(a.geometry, Ta, b.geometry, Tb, margin, cache, m);
  return m;
}

double deepest(const Manifold& m) {
  double least = 1e300;
  for (int i = 0; i < m.count; ++i) least = std::min(least, m.points[i].separation);
  return least;
}

class EveryPairsManifold : public ::testing::TestWithParam<std::pair<Kind, Kind>> {};

std::vector<std::pair<Kind, Kind>> all_pairs() {
  std::vector<std::pair<Kind, Kind>> pairs;
  for (const Kind a : kBounded) {
    for (const Kind b : kBounded) pairs.emplace_back(a, b);
  }
  return pairs;
}

TEST_P(EveryPairsManifold, TouchesAsDeepAsItIs) {
  Random random(71);
  const auto [ka, kb] = GetParam();
  int touching = 0;
  for (int i = 0; i < kManifoldSamples; ++i) {
    const Solid a = random_solid(random, ka), b = random_solid(random, kb);
    const SE3 Ta = random.pose(0.4);
    SE3 Tb = random.pose(1.0);
    // As sampled, nearly touching, and touching to a tenth of a millimetre.
    const ClosestPoints before = closest(a, Ta, b, Tb);
    const double wanted = i % 3 == 0   ? before.distance
                          : i % 3 == 1 ? random.uniform(-0.01, 0.02)
                                       : random.uniform(-1e-4, 2e-4);
    Tb = SE3(Tb.rotation(), Tb.position() + (wanted - before.distance) * before.normal);
    const ClosestPoints c = closest(a, Ta, b, Tb);
    const double margin = i % 2 ? 0.01 : 1e-4;
    const Manifold m = manifold_of(a, Ta, b, Tb, margin);
    const double size =
        collide::CorePair(a.geometry, b.geometry, collide::relative_pose(Ta, Tb)).size;
    // The manifold may use a face that is worse by 5% and 1e-5 of the size. This may happen twice,
    // where a face is accepted before the best is known.
    const double behind = 0.1 * std::fabs(c.distance) + 2e-5 * size;
    if (m.count == 0) {
      ASSERT_GT(c.distance, margin - behind) << i;
      continue;
    }
    ++touching;
    ASSERT_LE(c.distance, margin + 1e-9) << i;
    ASSERT_NEAR(deepest(m), c.distance, behind) << i;
    ASSERT_NEAR(norm(m.normal), 1.0, 1e-12);
    ASSERT_GT(separation_along(a.geometry, Ta, b.geometry, Tb, m.normal), c.distance - behind) << i;
    std::set<std::uint32_t> names;
    for (int k = 0; k < m.count; ++k) {
      const auto& p = m.points[k];
      ASSERT_LE(p.separation, margin);
      names.insert(p.feature);
      if (c.distance < -0.02) continue;  // deep: other directions may be shorter
      // Each point is midway between the surfaces along the normal. Measured: 1.4e-2 of the size,
      // where the corner of a rim's polygon stands for the rim.
      for (const bool of_a : {true, false}) {
        const Geometry& g = of_a ? a.geometry : b.geometry;
        const double d = signed_distance(g, inverse_times(of_a ? Ta : Tb, p.position)).distance;
        const bool round =
            g.kind == Kind::cylinder || g.kind == Kind::cone || g.kind == Kind::capsule;
        ASSERT_LT(d, 0.5 * std::fabs(p.separation) + 3e-6 * size) << i;
        ASSERT_GT(d, -0.5 * std::fabs(p.separation) - (round ? 0.05 : 3e-6) * size) << i;
      }
    }
    ASSERT_EQ(static_cast<int>(names.size()), m.count) << i;  // unique ids
  }
  EXPECT_GT(touching, kManifoldSamples / 4);
}

TEST_P(EveryPairsManifold, IsTheSameSwappedAndFarFromTheOrigin) {
  Random random(72);
  const auto [ka, kb] = GetParam();
  for (int i = 0; i < kManifoldSamples; ++i) {
    const Solid a = random_solid(random, ka), b = random_solid(random, kb);
    const SE3 Ta = random.pose(0.4), Tb = random.pose(0.8);
    const Manifold m = manifold_of(a, Ta, b, Tb, 0.01), s = manifold_of(b, Tb, a, Ta, 0.01);
    const Vec3 far{1e6, -1e6, 3e5};
    const Manifold f = manifold_of(a, SE3(Ta.rotation(), Ta.position() + far), b,
                                   SE3(Tb.rotation(), Tb.position() + far), 0.01);
    ASSERT_EQ(m.count > 0, s.count > 0);
    ASSERT_EQ(m.count > 0, f.count > 0);
    if (m.count == 0) continue;
    // Between equally good faces, the first shape's is taken.
    const double apart = 0.1 * std::fabs(deepest(m)) + 4e-5 * 4.0;
    ASSERT_NEAR(deepest(m), deepest(s), apart) << i;
    ASSERT_NEAR(deepest(m), deepest(f), apart) << i;
    if (ka != kb) {  // the order is that of the kinds
      ASSERT_EQ(m.count, s.count);
      ASSERT_EQ(m.normal, -s.normal);
      for (int k = 0; k < m.count; ++k) {
        ASSERT_EQ(m.points[k].position, s.points[k].position);
        ASSERT_EQ(m.points[k].feature, s.points[k].feature);
      }
    }
  }
}

// Extreme proportions, deep and far; one cache used for pair after pair, or filled with arbitrary
// bytes.
TEST_P(EveryPairsManifold, GivesNumbersWhateverComes) {
  Random random(73);
  const auto [ka, kb] = GetParam();
  PairCache cache;
  for (int i = 0; i < 10 * kManifoldSamples; ++i) {
    const auto solid = [&](Kind kind) {
      const auto size = [&] { return std::pow(10.0, random.uniform(-3, 3)); };
      switch (kind) {
        case Kind::sphere:
          return Solid(Sphere{size()});
        case Kind::capsule:
          return Solid(Capsule{size(), i % 7 ? size() : 0.0});
        case Kind::box:
          return Solid(Box{{size(), size(), size()}});
        case Kind::cylinder:
          return Solid(Cylinder{size(), size()});
        case Kind::cone:
          return Solid(Cone{size(), size()});
        default:
          break;
      }
      const double k = size();
      return Solid(
          scaled(random_solid(random, kind).shape, {k, k, k * random.uniform(0.01, 1)}).value());
    };
    const Solid a = solid(ka), b = solid(kb);
    const SE3 Ta = i % 3 ? random.pose(0.1) : SE3{};
    const SE3 Tb =
        i % 5 ? SE3(random.rotation(), std::pow(10.0, random.uniform(-6, 2)) * random.direction())
              : SE3(i % 2 ? Mat3::identity() : random.rotation(), {});
    if (i % 4 == 0) {
      unsigned char bytes[sizeof(PairCache)];
      for (unsigned char& byte : bytes) byte = static_cast<unsigned char>(random.word());
      std::memcpy(&cache, bytes, sizeof cache);
      cache.feature %= 5;
    }
    Manifold m;
    find_manifold(a.geometry, Ta, b.geometry, Tb, 0.01, cache, m);
    ASSERT_GE(m.count, 0);
    ASSERT_LE(m.count, 4);
    for (int k = 0; k < m.count; ++k) {
      ASSERT_NEAR(norm(m.normal), 1.0, 1e-9) << i;
      ASSERT_TRUE(is_finite(m.points[k].position)) << i;
      ASSERT_TRUE(std::isfinite(m.points[k].separation)) << i;
      ASSERT_LT(std::fabs(m.points[k].separation), 1e4) << i;
    }
    const ClosestPoints c = closest_points(a.geometry, Ta, b.geometry, Tb, cache);
    ASSERT_TRUE(std::isfinite(c.distance) && is_finite(c.on_a) && is_finite(c.on_b)) << i;
    ASSERT_NEAR(norm(c.normal), 1.0, 1e-9) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Convex, EveryPairsManifold, ::testing::ValuesIn(all_pairs()));

// --- boxes and hulls

TEST(Polytope, ABoxIsNumberedAsTheHullOfItsCorners) {
  const Solid box(Box{{0.5, 0.7, 0.9}});
  const ConvexHull hull = hull_of(box_corners({0.5, 0.7, 0.9}));
  const collide::PolytopeOf room(box.geometry);
  const collide::Polytope& p = room.view();
  ASSERT_TRUE(std::equal(p.vertices.begin(), p.vertices.end(), hull.vertices().begin()));
  ASSERT_TRUE(std::equal(p.edges.begin(), p.edges.end(), hull.data()->edges.begin()));
  for (std::size_t f = 0; f < 6; ++f) {
    const auto &ours = p.faces[f], &theirs = hull.faces()[f];
    EXPECT_LT(norm(ours.normal - theirs.normal), 1e-15);
    EXPECT_EQ(ours.offset, theirs.offset);
    ASSERT_TRUE(std::equal(ours.vertices.begin(), ours.vertices.end(), theirs.vertices.begin()));
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(collide::kBoxCornerEdges[f][i],
                hull.data()->corner_edges[hull.data()->first_corner[f] + i]);
    }
  }
}

// Boxes given as hulls have the manifolds of boxes: one of the two (a box comes first), or both.
TEST(Manifold, OfABoxGivenAsAHullIsThatOfTheBox) {
  Random random(74);
  double worst = 0.0;
  int points = 0;
  for (int i = 0; i < 40 * kManifoldSamples; ++i) {
    const Solid a = random_solid(random, Kind::box), b = random_solid(random, Kind::box);
    const Solid ha(hull_of(box_corners(a.geometry.half))),
        hb(hull_of(box_corners(b.geometry.half)));
    const SE3 Ta = random.pose(0.4);
    SE3 Tb = random.pose(0.8);
    if (i % 2) {  // touching
      const ClosestPoints c = closest(a, Ta, b, Tb);
      const double wanted = random.uniform(-2e-3, 1e-3);
      Tb = SE3(Tb.rotation(), Tb.position() + (wanted - c.distance) * c.normal);
    }
    const double margin = 1e-3;
    const Manifold boxes = manifold_of(a, Ta, b, Tb, margin);
    for (const Solid* s : {&ha, &a}) {
      const Manifold hulls = manifold_of(*s, Ta, hb, Tb, margin);
      ASSERT_EQ(boxes.count, hulls.count) << i;
      if (boxes.count == 0) continue;
      worst = std::max(worst, norm(boxes.normal - hulls.normal));
      for (int k = 0; k < boxes.count; ++k) {
        worst = std::max({worst, norm(boxes.points[k].position - hulls.points[k].position),
                          std::fabs(boxes.points[k].separation - hulls.points[k].separation)});
      }
      points += boxes.count;
    }
  }
  EXPECT_GT(points, 40 * kManifoldSamples);
  EXPECT_LT(worst, 1e-9);  // measured 3e-12
}

// A box rotated on another: of the eight corners of the overlap, the four that span the largest
// area.
TEST(Manifold, KeepsTheWidestFourPoints) {
  const Solid box(Box{{0.5, 0.5, 0.5}});
  for (int i = 1; i < 90; ++i) {
    const SE3 Tb(Exp(Vec3{0, 0, i * kPi / 180}), {0, 0, 0.999});
    const Manifold m = manifold_of(box, SE3{}, box, Tb, 1e-3);
    ASSERT_EQ(m.count, 4);
    const Vec3 across = m.points[2].position - m.points[0].position,
               other = m.points[3].position - m.points[1].position;
    const double area = 0.5 * norm(cross(across, other));
    // The eight corners are where lines at a distance of 1/2 cross at 45 degrees at most. The
    // squares that they form have at least the area of a square of side 1 / (1 + sin) ... 1.
    const double turn = i <= 45 ? i * kPi / 180 : kPi / 2 - i * kPi / 180;
    const double corner = 0.5 / std::cos(0.5 * std::min(turn, kPi / 2 - turn));
    ASSERT_GT(area, 2.0 * corner * corner - 1e-3) << i;
  }
}

// Rounding and very small motions do not change feature ids.
TEST(Manifold, OfWhatRestsKeepsItsNames) {
  Random random(75);
  const Mat3 on_side = Exp(Vec3{kPi / 2, 0, 0}).matrix(), yaw = Exp(Vec3{0, 0, 0.4}).matrix();
  const Solid ground(Box{{2, 2, 0.5}}), plane(HalfSpace{}), box(Box{{0.5, 0.5, 0.5}}),
      cylinder(Cylinder{0.5, 0.5}), cone(Cone{0.5, 0.5}), capsule(Capsule{0.5, 0.5}),
      hull(hull_of(box_corners({0.5, 0.5, 0.5})));
  struct Case {
    const char* what;
    const Solid* a;
    const Solid* b;
    SE3 T;
    int points;
  };
  const double rise = std::atan(0.5);  // half the apex's angle of the cone
  const Mat3 on_slant = Exp(Vec3{kPi / 2 + rise, 0, 0}).matrix();
  const Case cases[] = {
      {"box on equal box", &box, &box, SE3(Vec3{0, 0, 1}), 4},
      {"box on equal box, aside", &box, &box, SE3(Vec3{0.25, 0, 1}), 4},
      {"box on ground, turned", &ground, &box, SE3(yaw, {0.3, 0.1, 1}), 4},
      {"hull on equal hull", &hull, &hull, SE3(Vec3{0, 0, 1}), 4},
      {"cylinder on ground", &ground, &cylinder, SE3(yaw, {0.3, 0.1, 1}), 4},
      {"cylinder on plane", &plane, &cylinder, SE3(yaw, {0.3, 0.1, 0.5}), 4},
      {"cylinder on cylinder", &cylinder, &cylinder, SE3(yaw, {0.1, 0.1, 1}), 4},
      {"cylinder on its side", &ground, &cylinder, SE3(yaw * on_side, {0.3, 0.1, 1}), 2},
      {"cylinder on its side on plane", &plane, &cylinder, SE3(yaw * on_side, {0.3, 0.1, 0.5}), 2},
      {"cone on ground", &ground, &cone, SE3(yaw, {0.3, 0.1, 1}), 4},
      {"cone on its side", &ground, &cone, SE3(on_slant, {0, 0, 0.5 + std::sin(rise) * 0.5}), 2},
      {"capsule on its side", &ground, &capsule, SE3(on_side, {0, 0, 1}), 2},
      {"capsule on its side on plane", &plane, &capsule, SE3(on_side, {0, 0, 0.5}), 2},
  };
  for (const Case& c : cases) {
    std::set<std::uint32_t> first;
    for (int i = 0; i < 200; ++i) {
      const Mat3 turn = Exp(1e-7 * random.in_cube(1.0)).matrix();
      const SE3 T(turn * c.T.rotation(), c.T.position() + 1e-7 * random.in_cube(1.0));
      const Manifold m = manifold_of(*c.a, SE3{}, *c.b, T, 1e-4);
      ASSERT_EQ(m.count, c.points) << c.what;
      ASSERT_GT(std::fabs(m.normal.z), 1.0 - 1e-12) << c.what;
      std::set<std::uint32_t> names;
      for (int k = 0; k < m.count; ++k) names.insert(m.points[k].feature);
      if (i == 0) first = names;
      ASSERT_EQ(names, first) << c.what << i;
    }
  }
}

// A tilted disc touches at the lowest point of its rim, not at a vertex of a polygon.
TEST(Manifold, OfATiltedDiscHasTheLowestPointOfItsRim) {
  Random random(76);
  const Solid ground(Box{{4, 4, 0.5}}), plane(HalfSpace{});
  for (const Shape& shape : {Shape(Cylinder{0.5, 0.1}), Shape(Cone{0.5, 0.2})}) {
    const Solid disc(shape);
    for (int i = 0; i < 300; ++i) {
      const double tilt = std::pow(10.0, random.uniform(-4, -0.5));
      const Mat3 R = Exp(Vec3{0, 0, random.uniform(-3, 3)}).matrix() *
                     Exp(Vec3{tilt, 0, 0}).matrix() *
                     Exp(Vec3{0, 0, random.uniform(-3, 3)}).matrix();
      const double low = support(disc.geometry, SE3(R, {}), {0, 0, -1}).z;
      const Manifold on_box =
          manifold_of(ground, SE3{}, disc, SE3(R, {0, 0, 0.5 - low - 1e-4}), 1e-3);
      const Manifold on_plane = manifold_of(plane, SE3{}, disc, SE3(R, {0, 0, -low - 1e-4}), 1e-3);
      // Along the disc's own normal, if that is chosen, the depth is slightly smaller.
      ASSERT_NEAR(deepest(on_box), -1e-4, 1e-5) << tilt;
      ASSERT_NEAR(deepest(on_plane), -1e-4, 1e-6) << tilt;
    }
  }
}

// The contact patch of a cylinder that overhangs a table's edge ends at the edge.
TEST(Manifold, OfACylinderOverAnEdgeEndsThere) {
  const Solid table(Box{{1, 1, 0.5}}), cylinder(Cylinder{0.5, 0.5});
  for (double x = 0.6; x < 1.4; x += 0.05) {
    const Manifold m = manifold_of(table, SE3{}, cylinder, SE3(Vec3{x, 0, 0.999}), 1e-3);
    ASSERT_EQ(m.count, 4);
    double right = -1e300;
    for (int k = 0; k < 4; ++k) right = std::max(right, m.points[k].position.x);
    ASSERT_NEAR(right, std::min(1.0, x + 0.5), 1e-9) << x;
  }
}

}  // namespace
}  // namespace vp::test
