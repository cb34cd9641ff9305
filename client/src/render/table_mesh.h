// The table, its glass and its rods, from foosball::TableSpec. World frame (foosball/table.h).
#pragma once

#include "foosball/table.h"
#include "render/mesh_data.h"

namespace client {

// Thickness of the side walls, and of the table's ends beyond the goal pockets [m].
inline constexpr float kWallThickness = 0.034f;
inline constexpr float kEndMargin = 0.045f;
// Height of the opaque part of a side wall; glass above it. A higher one would let the near wall
// hide a ball at its foot.
inline constexpr float kSolidWallHeight = 0.024f;

// body_mesh: what is below the field; rim_mesh: what is around it. The field mirrors only the rim.
MeshData body_mesh(const foosball::TableSpec& table, float detail);
MeshData rim_mesh(const foosball::TableSpec& table, float detail);
// The bearings of the rods on the side walls.
MeshData bearings_mesh(const foosball::TableSpec& table, float detail);
// The side walls above the opaque part, drawn with blending.
MeshData glass_mesh(const foosball::TableSpec& table);
// The surface between the walls.
MeshData field_mesh(const foosball::TableSpec& table);
// One rod in the rod's frame: origin on the axis, y along it, handle on its team's side.
MeshData rod_mesh(const foosball::TableSpec& table, int rod, float detail);
// The bounding box of the table without its rods [m].
struct Extent {
  glm::vec3 low, high;
};
Extent table_extent(const foosball::TableSpec& table);
// Position along y of the outer end of a rod's handle when the rod is at the centre of its slide,
// signed [m].
float handle_reach(const foosball::TableSpec& table, int rod);
inline constexpr float kHandleRadius = 0.0165f;  // [m]
// From the centre of a rod to the centre of its handle, along y, signed [m].
float handle_offset(const foosball::TableSpec& table, int rod);

}  // namespace client
