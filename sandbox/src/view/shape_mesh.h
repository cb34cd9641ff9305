// Meshes of the engine's shapes in the form that body.vert scales, and the scale of each shape. No
// OpenGL here.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <vector>

#include "vphysics/shapes.h"

namespace sandbox {

// A point is core * stretch + rounding radius * normal.
struct ShapeVertex {
  glm::vec3 core, normal;
};
static_assert(sizeof(ShapeVertex) == 24);

struct ShapeMesh {
  std::vector<ShapeVertex> vertices;
  std::vector<std::uint32_t> indices;  // triangles, counter-clockwise from outside
};

// The kinds whose shapes share a mesh for all sizes.
enum class ShapeKind : std::uint8_t { box, sphere, capsule, cylinder, cone };
inline constexpr int kShapeKinds = 5;

// detail: 1 for close views; less where triangles are expensive.
ShapeMesh shape_mesh(ShapeKind kind, float detail);
ShapeMesh hull_mesh(const vp::ConvexHull& hull);  // of one hull; stretch 1, rounding radius 0
// The same for triangles; for a two-sided mesh both sides.
ShapeMesh surface_mesh(const vp::TriangleMesh& mesh);
ShapeMesh surface_mesh(const vp::HeightField& field);

// xyz: stretch of the core; w: rounding radius [m]. The result has the shape's bounds. For hulls
// and surfaces: 1 and 0.
glm::vec4 stretch_of(const vp::Shape& shape);

}  // namespace sandbox
