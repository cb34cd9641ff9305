#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <map>
#include <tuple>

#include "render/figure_mesh.h"
#include "render/mesh_builder.h"
#include "render/table_mesh.h"

namespace client {
namespace {

using Place = std::tuple<long, long, long>;

// Vertices at one position are one corner of the surface, whatever their normals.
Place place_of(const glm::vec3& p) {
  const auto grid = [](float v) { return std::lround(static_cast<double>(v) * 2e6); };
  return {grid(p.x), grid(p.y), grid(p.z)};
}

// Every edge is traversed equally often in both directions: the surface has no hole and no flipped
// triangle.
void expect_closed(const MeshData& mesh) {
  std::map<std::pair<Place, Place>, int> walked;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Place a = place_of(mesh.vertices[mesh.indices[i + k]].position);
      const Place b = place_of(mesh.vertices[mesh.indices[i + (k + 1) % 3]].position);
      if (a < b) ++walked[{a, b}];
      if (b < a) --walked[{b, a}];
    }
  }
  int open = 0;
  for (const auto& [edge, balance] : walked) open += balance != 0;
  EXPECT_EQ(open, 0);
}

void expect_sound_triangles(const MeshData& mesh) {
  ASSERT_EQ(mesh.indices.size() % 3, 0u);
  int degenerate = 0, against = 0;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const MeshVertex &a = mesh.vertices[mesh.indices[i]], &b = mesh.vertices[mesh.indices[i + 1]],
                     &c = mesh.vertices[mesh.indices[i + 2]];
    const glm::vec3 normal = glm::cross(b.position - a.position, c.position - a.position);
    degenerate += glm::length(normal) < 1e-10f;
    against += glm::dot(normal, a.normal + b.normal + c.normal) <= 0.0f;
  }
  EXPECT_EQ(degenerate, 0);
  EXPECT_EQ(against, 0);
  for (const MeshVertex& v : mesh.vertices) ASSERT_NEAR(glm::length(v.normal), 1.0f, 1e-3f);
}

double volume(const MeshData& mesh) {
  double six = 0;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    six += static_cast<double>(glm::dot(mesh.vertices[mesh.indices[i]].position,
                                        glm::cross(mesh.vertices[mesh.indices[i + 1]].position,
                                                   mesh.vertices[mesh.indices[i + 2]].position)));
  }
  return six / 6.0;
}

class Solids : public ::testing::TestWithParam<float> {};

TEST_P(Solids, AreClosedAndFaceOutwards) {
  MeshBuilder box(GetParam()), ball(GetParam()), loft(GetParam()), turned(GetParam()),
      ring(GetParam()), wedge(GetParam());
  box.rounded_box({0.1f, 0, 0}, {0.03f, 0.02f, 0.01f}, 0.004f);
  ball.ellipsoid({0, 0.1f, 0}, {0.01f, 0.02f, 0.03f});
  loft.loft(std::array{LoftRing{{0, 0, 0}, {0.02f, 0.03f}, 3.0f},
                       LoftRing{{0, 0, 0.05f}, {0.01f, 0.02f}, 2.0f}});
  turned.turned(std::array{ProfilePoint{0, 0}, ProfilePoint{0.02f, 0}, ProfilePoint{0.02f, 0.04f},
                           ProfilePoint{0, 0.05f}},
                16, true);
  ring.torus({0, 0, 0.1f}, 0.03f, 0.005f);
  wedge.tetrahedron({glm::vec3(0), {0.1f, 0, 0}, {0, 0.1f, 0}, {0, 0, 0.1f}});
  for (const MeshBuilder* b : {&box, &ball, &loft, &turned, &ring, &wedge}) {
    expect_sound_triangles(b->mesh());
    expect_closed(b->mesh());
    EXPECT_GT(volume(b->mesh()), 0.0);
  }
  EXPECT_NEAR(volume(wedge.mesh()), 0.001 / 6, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(FineAndCoarse, Solids, ::testing::Values(1.0f, 0.4f));

TEST(MeshBuilder, AFineEllipsoidHasItsVolume) {
  MeshBuilder b;
  b.ellipsoid({0, 0, 0}, {0.1f, 0.2f, 0.3f}, 64, 48);
  const double exact = 4.0 / 3.0 * 3.14159265 * 0.1 * 0.2 * 0.3;
  EXPECT_NEAR(volume(b.mesh()), exact, 0.01 * exact);
}

// The built-in characters, then men at the limits that a file may specify.
int figure_count() {
  return static_cast<int>(foosball::built_in_characters().size()) + 2;
}
foosball::Character figure_of(int number) {
  const auto& built_in = foosball::built_in_characters();
  const auto i = static_cast<std::size_t>(number);
  if (i < built_in.size()) return built_in[i];
  foosball::Character c;
  for (const auto& f : foosball::kBodyFields) {
    c.body.*f.value = i == built_in.size() ? f.min : f.max;
  }
  c.look = built_in[3].look;
  return c;
}

class Figures : public ::testing::TestWithParam<std::tuple<int, float>> {};

TEST_P(Figures, AreClosedSolidsThatFillTheBoxesOfThePhysics) {
  const auto [number, detail] = GetParam();
  const foosball::Character character = figure_of(number);
  const auto boxes = foosball::boxes_of(character.body);
  const MeshData mesh = figure_mesh(boxes, 0.008f, figure_look(character.look, 1, true), detail);
  expect_sound_triangles(mesh);
  expect_closed(mesh);
  glm::vec3 box_low(1e9f), box_high(-1e9f), low(1e9f), high(-1e9f);
  float sole_low = 1e9f;
  for (const auto& box : boxes) {
    for (int i = 0; i < 3; ++i) {
      box_low[i] = std::min(box_low[i], static_cast<float>(box.centre[i] - box.half_extents[i]));
      box_high[i] = std::max(box_high[i], static_cast<float>(box.centre[i] + box.half_extents[i]));
    }
  }
  for (const MeshVertex& v : mesh.vertices) {
    low = glm::min(low, v.position);
    high = glm::max(high, v.position);
    sole_low = std::min(sole_low, v.position.z);
  }
  EXPECT_NEAR(sole_low, box_low.z, 1e-5f);  // the sole matches the collision model
  for (int i = 0; i < 3; ++i) {
    EXPECT_GE(low[i], box_low[i] - kFigureOverhang) << i;
    EXPECT_LE(high[i], box_high[i] + kFigureOverhang) << i;
    EXPECT_LE(low[i], box_low[i] + 0.003f) << i;
    EXPECT_GE(high[i], box_high[i] - 0.003f) << i;
  }
}

TEST_P(Figures, FeetAndLegsStayInsideTheirBoxes) {
  const auto [number, detail] = GetParam();
  const foosball::Character character = figure_of(number);
  float foot_top = 0, half_width = 0, half_depth = 0;
  for (const auto& box : foosball::boxes_of(character.body)) {
    if (box.part != foosball::ManBox::Part::foot) continue;
    foot_top = static_cast<float>(box.centre.z + box.half_extents.z);
    half_width = static_cast<float>(box.half_extents.y);
    half_depth = static_cast<float>(box.half_extents.x);
  }
  for (const MeshVertex& v : figure_mesh(foosball::boxes_of(character.body), 0.008f,
                                         figure_look(character.look, 1, true), detail)
                                 .vertices) {
    if (v.position.z > foot_top) continue;
    EXPECT_LE(std::abs(v.position.y), half_width + 1e-5f);
    EXPECT_LE(std::abs(v.position.x), half_depth + 1e-5f);
  }
}

INSTANTIATE_TEST_SUITE_P(Characters, Figures,
                         ::testing::Combine(::testing::Range(0, figure_count()),
                                            ::testing::Values(1.0f, 0.4f)));

TEST(TableMesh, IsClosedAndLeavesTheGoalMouthsOpen) {
  for (const auto layout : {foosball::Layout::paper, foosball::Layout::tournament}) {
    const auto& table = foosball::table_spec(layout);
    const MeshData body = body_mesh(table, 1.0f), mesh = rim_mesh(table, 1.0f);
    const MeshData bearings = bearings_mesh(table, 1.0f);
    for (const MeshData* part : {&body, &mesh, &bearings}) {
      expect_sound_triangles(*part);
      expect_closed(*part);
    }
    // Parts that are mirrored as if they stood on the field must not extend below it.
    for (const MeshVertex& v : body.vertices) EXPECT_LT(v.position.z, 0.0f);
    // No vertex is in the mouth, where the ball rolls in.
    for (const MeshVertex& v : mesh.vertices) {
      const bool in_mouth =
          std::abs(v.position.x) > 0.5 * table.length + 0.02 &&
          std::abs(v.position.x) < 0.5 * table.length + table.goal_depth - 0.005 &&
          std::abs(v.position.y) < 0.5 * table.goal_width - 0.005 && v.position.z > 0.002 &&
          v.position.z < table.goal_height;
      EXPECT_FALSE(in_mouth);
    }
  }
}

// Without drawn rods, no bearings obstruct the men.
TEST(TableMesh, SideWallsAreLowAndBareWithoutTheirBearings) {
  const auto& table = foosball::table_spec(foosball::Layout::paper);
  for (const MeshVertex& v : rim_mesh(table, 1.0f).vertices) {
    const bool between_ends = std::abs(v.position.x) < 0.5 * table.length - 0.01;
    if (!between_ends || std::abs(v.position.y) < 0.5 * table.width - 0.001) continue;
    EXPECT_LT(v.position.z, kSolidWallHeight + 1e-4f);
  }
  float high = 0.0f;
  for (const MeshVertex& v : bearings_mesh(table, 1.0f).vertices)
    high = std::max(high, v.position.z);
  EXPECT_GT(high, table.rod_height);
}

TEST(RodMesh, ReachesThroughBothWallsAtTheEndOfItsSlideWithTheHandleOnItsTeamsSide) {
  const auto& table = foosball::table_spec(foosball::Layout::tournament);
  for (int rod = 0; rod < foosball::kRods; ++rod) {
    const MeshData mesh = rod_mesh(table, rod, 1.0f);
    expect_sound_triangles(mesh);
    expect_closed(mesh);
    float low = 0, high = 0;
    for (const MeshVertex& v : mesh.vertices) {
      low = std::min(low, v.position.y);
      high = std::max(high, v.position.y);
    }
    const auto& spec = table.rods[static_cast<std::size_t>(rod)];
    const auto need = static_cast<float>(0.5 * table.width + spec.slide_limit) + kWallThickness;
    EXPECT_LT(low, -need);
    EXPECT_GT(high, need);
    EXPECT_EQ(-low > high, spec.team == 0);
    EXPECT_EQ(handle_offset(table, rod) < 0, spec.team == 0);
  }
}

}  // namespace
}  // namespace client
