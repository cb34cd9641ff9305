// Meshes of the engine's shapes in the form that body.vert stretches, and how much each is
// stretched. No OpenGL here.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <vector>

#include "vphysics/shapes.h"

namespace sandbox {

// A point is core * stretch + round * normal.
struct ShapeVertex {
  glm::vec3 core, normal;
};
static_assert(sizeof(ShapeVertex) == 24);

struct ShapeMesh {
  std::vector<ShapeVertex> vertices;
  std::vector<std::uint32_t> indices;  // triangles, counter-clockwise from outside
};

// The kinds that share a mesh, whatever their sizes.
enum class ShapeKind : std::uint8_t { box, sphere, capsule, cylinder, cone };
inline constexpr int kShapeKinds = 5;

// detail: 1 for a close look; less where triangles are dear.
ShapeMesh shape_mesh(ShapeKind kind, float detail);
ShapeMesh hull_mesh(const vp::ConvexHull& hull);  // of one hull; stretched by 1, not round
// The same of triangles; of a two-sided mesh both sides.
ShapeMesh surface_mesh(const vp::TriangleMesh& mesh);
ShapeMesh surface_mesh(const vp::HeightField& field);

// xyz: stretch of the core; w: round [m]. The bounds are the shape's own. Of hulls and
// surfaces: 1 and 0.
glm::vec4 stretch_of(const vp::Shape& shape);

}  // namespace sandbox
