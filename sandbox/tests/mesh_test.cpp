#include "view/shape_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <map>
#include <utility>
#include <vector>

#include "app/thrown.h"
#include "view/palette.h"
#include "view/see_through.h"
#include "view/shadow_fit.h"

namespace sandbox {
namespace {

struct Drawn {
  const char* name;
  ShapeMesh mesh;
  vp::Shape shape;
  glm::vec3 half;    // extents
  double volume;     // of the shape
  double tolerance;  // volume that facets and rounded edges may remove
};

std::vector<Drawn> all_drawn() {
  const double pi = vp::kPi;
  const auto* hull = static_cast<const vp::ConvexHull*>(nullptr);
  const vp::Shape thrown = thrown_shape(5, 1.0);
  hull = std::get_if<vp::ConvexHull>(&thrown);
  return {
      {"box", shape_mesh(ShapeKind::box, 1), vp::Box{{1, 2, 3}}, {1, 2, 3}, 48.0, 0.01},
      {"sphere", shape_mesh(ShapeKind::sphere, 1), vp::Sphere{2}, {2, 2, 2}, 32.0 * pi / 3, 0.03},
      {"capsule",
       shape_mesh(ShapeKind::capsule, 1),
       vp::Capsule{1, 2},
       {1, 1, 3},
       4.0 * pi + 4.0 * pi / 3,
       0.03},
      {"cylinder",
       shape_mesh(ShapeKind::cylinder, 1),
       vp::Cylinder{1, 2},
       {1, 1, 2},
       4.0 * pi,
       0.03},
      {"cone", shape_mesh(ShapeKind::cone, 1), vp::Cone{1, 2}, {1, 1, 2}, 4.0 * pi / 3, 0.03},
      {"hull", hull_mesh(*hull), *hull, {0.934f, 0.934f, 0.934f}, hull->volume(), 1e-4},
  };
}

// As in body.vert.
glm::vec3 point_of(const Drawn& drawn, std::uint32_t index) {
  const ShapeVertex& v = drawn.mesh.vertices[index];
  const glm::vec4 stretch = stretch_of(drawn.shape);
  return v.core * glm::vec3(stretch) + v.normal * stretch.w;
}

TEST(ShapeMesh, IsAsLargeAsItsShapeWithTheShapesVolume) {
  for (const Drawn& drawn : all_drawn()) {
    glm::vec3 low(1e9f), high(-1e9f);
    double volume = 0.0;
    for (std::size_t i = 0; i < drawn.mesh.indices.size(); i += 3) {
      const glm::vec3 a = point_of(drawn, drawn.mesh.indices[i]);
      const glm::vec3 b = point_of(drawn, drawn.mesh.indices[i + 1]);
      const glm::vec3 c = point_of(drawn, drawn.mesh.indices[i + 2]);
      for (const glm::vec3& p : {a, b, c}) low = glm::min(low, p), high = glm::max(high, p);
      // The signed volumes of the triangles' tetrahedra with the origin add up to the shape's
      // volume.
      volume += static_cast<double>(glm::dot(a, glm::cross(b, c))) / 6.0;
    }
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(high[axis], drawn.half[axis], 0.01f * drawn.half[axis]) << drawn.name;
      EXPECT_NEAR(low[axis], -drawn.half[axis], 0.01f * drawn.half[axis]) << drawn.name;
    }
    EXPECT_NEAR(volume / drawn.volume, 1.0, drawn.tolerance) << drawn.name;
    EXPECT_LT(volume, 1.0001 * drawn.volume) << drawn.name;
  }
}

TEST(ShapeMesh, NormalsAreUnitAndLookOutwards) {
  for (const Drawn& drawn : all_drawn()) {
    for (std::uint32_t i = 0; i < drawn.mesh.vertices.size(); ++i) {
      const glm::vec3 n = drawn.mesh.vertices[i].normal;
      EXPECT_NEAR(glm::length(n), 1.0f, 1e-4f) << drawn.name;
      EXPECT_GE(glm::dot(n, point_of(drawn, i)), -1e-4f) << drawn.name;
    }
  }
}

TEST(SeeThrough, AWallHidesWhatLiesBehindItAndNothingElse) {
  const vp::Box wall{{0.1, 5, 5}};
  const vp::SE3 at(vp::Vec3{5, 0, 0});
  EXPECT_TRUE(hides(wall, at, {0, 0, 0}, {10, 0, 0}));
  EXPECT_FALSE(hides(wall, at, {0, 0, 0}, {4, 0, 0}));
  EXPECT_FALSE(hides(wall, at, {6, 0, 0}, {10, 0, 0}));
  EXPECT_FALSE(hides(wall, at, {0, 0, 0}, {10, 12, 0}));
  const vp::SE3 turned(vp::Exp(vp::Vec3{0, 0, 0.5 * vp::kPi}).matrix(), {5, 0, 0});
  EXPECT_TRUE(hides(wall, turned, {0, 0, 0}, {10, 0.05, 0}));
  EXPECT_FALSE(hides(wall, turned, {0, 1, 0}, {10, 1, 0}));
  const std::vector<vp::Vec3> few{{10, 0, 0}, {10, 12, 0}}, none{{4, 0, 0}, {10, 12, 0}};
  EXPECT_TRUE(hides_many(wall, at, {0, 0, 0}, few));
  EXPECT_FALSE(hides_many(wall, at, {0, 0, 0}, none));
}

TEST(ShadowFit, HoldsAllThatCastsAShadow) {
  const std::vector<Caster> casters{{{0, 0, 0}, 1.0f}, {{20, -7, 3}, 0.5f}, {{5, 9, 12}, 2.0f}};
  const ShadowFit fit = fit_shadow(casters, 100.0f);
  for (const Caster& caster : casters) {
    for (const glm::vec3 side : {glm::vec3(1, 0, 0), glm::vec3(0, -1, 0), glm::vec3(0, 0, 1)}) {
      const glm::vec4 clip = fit.matrix * glm::vec4(caster.centre + caster.radius * side, 1.0f);
      EXPECT_LE(std::abs(clip.x), 1.0f);
      EXPECT_LE(std::abs(clip.y), 1.0f);
      EXPECT_LE(std::abs(clip.z), 1.0f);
    }
  }
  EXPECT_LT(fit.width, 60.0f);
  // Casters beyond the given distance do not make the map coarser.
  EXPECT_LT(fit_shadow(casters, 5.0f).width, 4.0f);
}

TEST(Palette, SpeedsGoFromBlueToRedAndNeighboursDiffer) {
  EXPECT_GT(speed_colour(0.0).b, speed_colour(0.0).r);
  EXPECT_GT(speed_colour(1e9).r, speed_colour(1e9).b);
  int same = 0;
  for (std::size_t i = 0; i < 1000; ++i) {
    same += glm::length(body_colour(i) - body_colour(i + 1)) < 0.05f ? 1 : 0;
  }
  EXPECT_LT(same, 250);
}

}  // namespace
}  // namespace sandbox
