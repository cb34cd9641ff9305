// The table, its glass and its rods, from foosball::TableSpec. World frame (foosball/table.h).
#pragma once

#include "foosball/table.h"
#include "render/mesh_data.h"

namespace client {

// Thickness of the side walls and length of a rod beyond its outermost reach [m].
inline constexpr float kWallThickness = 0.034f;
inline constexpr float kEndMargin = 0.045f;
// What is solid of a side wall; glass above it. Higher, the near wall would hide a ball at its
// foot.
inline constexpr float kSolidWallHeight = 0.024f;

// What lies below the field, and what stands around it: the field mirrors only the latter.
MeshData body_mesh(const foosball::TableSpec& table, float detail);
MeshData rim_mesh(const foosball::TableSpec& table, float detail);
// What carries the rods on the side walls.
MeshData bearings_mesh(const foosball::TableSpec& table, float detail);
// The side walls above that, drawn blended.
MeshData glass_mesh(const foosball::TableSpec& table);
// The surface between the walls.
MeshData field_mesh(const foosball::TableSpec& table);
// One rod in its own frame: origin on the axis, y along it, handle on its team's side.
MeshData rod_mesh(const foosball::TableSpec& table, int rod, float detail);
// The box around the table, without its rods [m].
struct Extent {
  glm::vec3 low, high;
};
Extent table_extent(const foosball::TableSpec& table);
// Where the outer end of a rod's handle is when the rod is in the middle of its slide, along y,
// signed [m].
float handle_reach(const foosball::TableSpec& table, int rod);
inline constexpr float kHandleRadius = 0.0165f;  // [m]
// From the middle of a rod to the middle of its handle, along y, signed [m].
float handle_offset(const foosball::TableSpec& table, int rod);

}  // namespace client
