// The men: astronauts, lofted over the boxes that the physics knows, so that what is seen is what
// is hit. In the man's frame: origin on the rod's axis, facing +x, feet down at angle 0.
#pragma once

#include <span>

#include "foosball/table.h"
#include "render/mesh_data.h"

namespace client {

// How far a helmet or a pack may stand out of its box [m]; legs and feet never do.
inline constexpr float kFigureOverhang = 0.006f;

MeshData figure_mesh(std::span<const foosball::ManBox> boxes, float rod_radius, float detail);

}  // namespace client
