#include "render/table_mesh.h"

#include <array>
#include <cmath>

#include "render/mesh_builder.h"
#include "render/palette.h"

namespace client {
namespace {

using foosball::TableSpec;

const Paint kBody{{0.028f, 0.036f, 0.052f}, 0.0f, 0.38f, 0.25f, 0.0f};
const Paint kRail{{0.030f, 0.038f, 0.054f}, 0.0f, 0.68f, 0.0f, 0.0f};
const Paint kPlate{{0.011f, 0.014f, 0.021f}, 0.0f, 0.80f, 0.0f, 0.0f};
const Paint kBolt{{0.45f, 0.47f, 0.50f}, 0.0f, 0.3f, 1.0f, 0.0f};
const Paint kWall{{0.040f, 0.052f, 0.070f}, 0.0f, 0.50f, 0.0f, 0.0f};
const Paint kPocket{{0.012f, 0.015f, 0.020f}, 0.0f, 0.8f, 0.0f, 0.0f};
const Paint kCorner{{0.012f, 0.066f, 0.082f}, 0.0f, 0.8f, 0.0f, 0.0f};
const Paint kBearing{{0.10f, 0.11f, 0.13f}, 0.0f, 0.35f, 0.7f, 0.0f};
const Paint kChrome{{0.80f, 0.82f, 0.85f}, 0.0f, 0.17f, 1.0f, 0.0f};
const Paint kRubber{{0.020f, 0.021f, 0.024f}, 0.0f, 0.75f, 0.0f, 0.0f};
const Paint kGrip{glm::vec3(0.80f), 1.0f, 0.42f, 0.0f, 0.0f};
const Paint kMark{{0.75f, 0.77f, 0.80f}, 0.0f, 0.4f, 0.0f, 0.0f};

constexpr float kHandleLength = 0.105f;
constexpr float kHandleInset = 0.004f;  // of the rod's end in its handle
constexpr float kReach = 0.010f;        // of a rod beyond the wall when fully pushed in

constexpr float kPlinthBottom = -0.235f;

float f(double v) {
  return static_cast<float>(v);
}

struct Sizes {
  explicit Sizes(const TableSpec& t)
      : half_length(f(0.5 * t.length)),
        half_width(f(0.5 * t.width)),
        wall(f(t.wall_height)),
        end(f(t.goal_depth) + kEndMargin),
        outer_x(half_length + end),
        outer_y(half_width + kWallThickness) {}
  float half_length, half_width, wall, end, outer_x, outer_y;
};

void add_box(MeshBuilder& b, glm::vec3 low, glm::vec3 high, float bevel) {
  b.rounded_box(0.5f * (low + high), 0.5f * (high - low), bevel);
}

void add_body(MeshBuilder& b, const Sizes& s) {
  b.paint(kBody);
  add_box(b, {-s.outer_x, -s.outer_y, -0.19f}, {s.outer_x, s.outer_y, -0.004f}, 0.012f);
  b.paint(kRail);  // plinth
  add_box(b, {-s.outer_x + 0.05f, -s.outer_y + 0.03f, kPlinthBottom},
          {s.outer_x - 0.05f, s.outer_y - 0.03f, -0.18f}, 0.012f);
  for (const float side : {-1.0f, 1.0f}) {
    b.paint({kTeamLamp[side < 0.0f ? 0 : 1], 0.0f, 0.5f, 0.0f, 3.0f});
    const float y = side * (s.outer_y + 0.0005f);
    add_box(b, {-s.outer_x + 0.06f, y - 0.002f, -0.037f}, {s.outer_x - 0.06f, y + 0.002f, -0.030f},
            0.001f);
  }
}

void add_side_walls(MeshBuilder& b, const Sizes& s) {
  b.paint(kWall);
  for (const float side : {-1.0f, 1.0f}) {
    const float in = side * s.half_width, out = side * s.outer_y;
    add_box(b, {-s.outer_x, std::min(in, out), -0.006f},
            {s.outer_x, std::max(in, out), kSolidWallHeight}, 0.004f);
  }
}

void add_bearings(MeshBuilder& b, const Sizes& s, const TableSpec& table) {
  b.paint(kBearing);
  for (const float side : {-1.0f, 1.0f}) {
    for (const foosball::RodSpec& rod : table.rods) {
      const float x = f(rod.x), z = f(table.rod_height);
      const float y = 0.5f * side * (s.half_width + s.outer_y);
      add_box(b, {x - 0.010f, y - 0.010f, kSolidWallHeight - 0.004f}, {x + 0.010f, y + 0.010f, z},
              0.002f);
      glm::mat4 place = axis_along_y();
      place[3] = {x, y, z, 1.0f};
      b.transform(place);
      const float r = f(table.rod_radius) + 0.0085f, w = 0.5f * kWallThickness;
      b.turned(std::array{ProfilePoint{0.0f, -w}, ProfilePoint{r - 0.002f, -w},
                          ProfilePoint{r, -w + 0.002f}, ProfilePoint{r, w - 0.002f},
                          ProfilePoint{r - 0.002f, w}, ProfilePoint{0.0f, w}},
               18, true);
      b.transform(glm::mat4(1.0f));
    }
  }
}

// An end of the table with a goal in it: the pocket is open above, so that a ball in it is visible.
void add_end(MeshBuilder& b, const Sizes& s, const TableSpec& table, int team) {
  const float side = team == 0 ? -1.0f : 1.0f;
  const float goal = f(0.5 * table.goal_width), depth = f(table.goal_depth),
              bar = f(table.goal_height);
  const auto box = [&](float x0, float x1, float y0, float y1, float z0, float z1, float bevel) {
    const float a = side * (s.half_length + x0), c = side * (s.half_length + x1);
    add_box(b, {std::min(a, c), y0, z0}, {std::max(a, c), y1, z1}, bevel);
  };
  b.paint(kRail);
  box(0.0f, s.end, goal, s.outer_y, -0.006f, s.wall, 0.005f);
  box(0.0f, s.end, -s.outer_y, -goal, -0.006f, s.wall, 0.005f);
  box(depth, s.end, -goal - 0.005f, goal + 0.005f, -0.006f, s.wall, 0.005f);
  box(0.0f, 0.016f, -goal - 0.005f, goal + 0.005f, bar, s.wall, 0.004f);
  // Inlaid plates with bolts decorate the deck.
  for (const float half : {-1.0f, 1.0f}) {
    const float y0 = half < 0 ? -s.outer_y + 0.028f : goal + 0.022f,
                y1 = half < 0 ? -goal - 0.022f : s.outer_y - 0.028f;
    b.paint(kPlate);
    box(0.024f, s.end - 0.024f, y0, y1, s.wall - 0.003f, s.wall + 0.0022f, 0.002f);
    if (!b.fine()) continue;
    b.paint(kBolt);
    for (const float x : {0.036f, s.end - 0.036f}) {
      for (const float y : {y0 + 0.012f, y1 - 0.012f})
        box(x - 0.004f, x + 0.004f, y - 0.004f, y + 0.004f, s.wall, s.wall + 0.0040f, 0.0035f);
    }
  }
  b.paint(kPocket);
  box(-0.0005f, depth + 0.002f, -goal - 0.001f, goal + 0.001f, -0.02f, -0.002f, 0.001f);
  // The frame of the mouth and an inlay on the deck show whose goal it is.
  b.paint({kTeamLamp[static_cast<std::size_t>(team)], 0.0f, 0.4f, 0.0f, 3.2f});
  const float w = 0.0045f;
  box(-0.002f, 0.004f, goal - 0.001f, goal + 2.0f * w, 0.0f, bar + w, 0.0014f);
  box(-0.002f, 0.004f, -goal - 2.0f * w, -goal + 0.001f, 0.0f, bar + w, 0.0014f);
  box(-0.002f, 0.004f, -goal - 2.0f * w, goal + 2.0f * w, bar - 0.001f, bar + w, 0.0014f);
  b.paint({kTeamLamp[static_cast<std::size_t>(team)], 0.0f, 0.4f, 0.0f, 2.6f});
  box(depth + 0.011f, depth + 0.018f, -s.half_width + 0.005f, s.half_width - 0.005f,
      s.wall - 0.002f, s.wall + 0.0034f, 0.001f);
}

void add_corners(MeshBuilder& b, const Sizes& s, const TableSpec& table) {
  const float leg = f(table.corner_size), rise = f(table.corner_rise);
  b.paint(kCorner);
  for (const float x : {-1.0f, 1.0f}) {
    for (const float y : {-1.0f, 1.0f}) {
      const glm::vec3 corner{x * s.half_length, y * s.half_width, 0.0002f};
      b.tetrahedron({corner, corner - glm::vec3(x * leg, 0, 0), corner - glm::vec3(0, y * leg, 0),
                     corner + glm::vec3(0, 0, rise)});
    }
  }
}

float rod_half_length(const TableSpec& table, int rod) {
  const foosball::RodSpec& spec = table.rods[static_cast<std::size_t>(rod)];
  return f(0.5 * table.width) + kWallThickness + f(spec.slide_limit) + kReach;
}

}  // namespace

MeshData body_mesh(const TableSpec& table, float detail) {
  MeshBuilder b(detail);
  add_body(b, Sizes(table));
  return b.take();
}

MeshData rim_mesh(const TableSpec& table, float detail) {
  const Sizes s(table);
  MeshBuilder b(detail);
  add_side_walls(b, s);
  add_end(b, s, table, 0);
  add_end(b, s, table, 1);
  add_corners(b, s, table);
  return b.take();
}

MeshData bearings_mesh(const TableSpec& table, float detail) {
  MeshBuilder b(detail);
  add_bearings(b, Sizes(table), table);
  return b.take();
}

MeshData glass_mesh(const TableSpec& table) {
  const Sizes s(table);
  MeshBuilder b(0.5f);
  for (const float side : {-1.0f, 1.0f}) {
    const float y = side * (s.half_width + 0.5f * kWallThickness);
    add_box(b, {-s.half_length, y - 0.003f, kSolidWallHeight - 0.002f},
            {s.half_length, y + 0.003f, s.wall}, 0.001f);
  }
  return b.take();
}

MeshData field_mesh(const TableSpec& table) {
  const Sizes s(table);
  MeshData mesh;
  for (const glm::vec2 corner :
       {glm::vec2(-1, -1), glm::vec2(1, -1), glm::vec2(1, 1), glm::vec2(-1, 1)}) {
    MeshVertex v{};
    v.position = {corner.x * s.half_length, corner.y * s.half_width, 0.0f};
    v.normal = {0, 0, 1};
    mesh.vertices.push_back(v);
  }
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

MeshData rod_mesh(const TableSpec& table, int rod, float detail) {
  const foosball::RodSpec& spec = table.rods[static_cast<std::size_t>(rod)];
  const float half = rod_half_length(table, rod), r = f(table.rod_radius);
  // In the solid's frame the handle is towards -z; along y that is team 0's side.
  glm::mat4 place = axis_along_y();
  if (spec.team == 1) place = {{1, 0, 0, 0}, {0, 0, 1, 0}, {0, -1, 0, 0}, {0, 0, 0, 1}};
  MeshBuilder b(detail);
  b.transform(place);
  b.paint(kChrome);
  b.turned(std::array{ProfilePoint{r, -half}, ProfilePoint{r, half}}, 20, true);
  b.paint(kRubber);
  const float cap = r + 0.004f;
  b.turned(std::array{ProfilePoint{0, half - 0.004f}, ProfilePoint{cap, half - 0.004f},
                      ProfilePoint{cap, half + 0.012f}, ProfilePoint{cap - 0.004f, half + 0.017f},
                      ProfilePoint{0, half + 0.018f}},
           14, true);
  // Bumper rings that touch the wall when the rod is at its limit.
  const float contact = f(0.5 * table.width - spec.slide_limit), bumper = r + 0.0055f;
  for (const float side : {-1.0f, 1.0f}) {
    const float z = side * (contact - 0.007f);
    b.turned(std::array{ProfilePoint{0, z - 0.007f}, ProfilePoint{bumper - 0.002f, z - 0.007f},
                        ProfilePoint{bumper, z - 0.005f}, ProfilePoint{bumper, z + 0.005f},
                        ProfilePoint{bumper - 0.002f, z + 0.007f}, ProfilePoint{0, z + 0.007f}},
             14, true);
  }
  b.paint(kGrip);
  const float g = kHandleRadius, near = -half + kHandleInset, far = near - kHandleLength;
  b.turned(
      std::array{ProfilePoint{0, far}, ProfilePoint{g * 0.75f, far}, ProfilePoint{g, far + 0.008f},
                 ProfilePoint{g * 0.92f, far + 0.5f * kHandleLength},
                 ProfilePoint{g, near - 0.010f}, ProfilePoint{g * 0.6f, near},
                 ProfilePoint{0, near}},
      static_cast<int>(std::lround(8.0f / detail)), true);
  b.paint(kMark);  // one flat of the grip, on top at angle 0, makes rotation visible
  b.rounded_box({0, (spec.team == 0 ? -0.93f : 0.93f) * g, far + 0.5f * kHandleLength},
                {0.0028f, 0.0022f, 0.36f * kHandleLength}, 0.001f, 1);
  return b.take();
}

Extent table_extent(const TableSpec& table) {
  const Sizes s(table);
  return {{-s.outer_x, -s.outer_y, kPlinthBottom}, {s.outer_x, s.outer_y, s.wall + 0.004f}};
}

float handle_reach(const TableSpec& table, int rod) {
  const foosball::RodSpec& spec = table.rods[static_cast<std::size_t>(rod)];
  const float y = rod_half_length(table, rod) - kHandleInset + kHandleLength;
  return spec.team == 0 ? -y : y;
}

float handle_offset(const TableSpec& table, int rod) {
  const float y = rod_half_length(table, rod) + 0.5f * kHandleLength;
  return table.rods[static_cast<std::size_t>(rod)].team == 0 ? -y : y;
}

}  // namespace client
