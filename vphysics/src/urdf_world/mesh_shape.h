// Converts a mesh to a collision shape.
#pragma once

#include <string>

#include "vphysics/urdf_world.h"

namespace vp::detail {

struct MadeShape {
  Shape shape;
  std::string note;  // what was repaired, or empty
};

// scale: factors of the mesh's axes, of either sign, not zero. triangles: make a TriangleMesh.
Expected<MadeShape> shape_of_mesh(const MeshFile& mesh, const Vec3& scale, bool triangles,
                                  const UrdfWorldOptions& options);

}  // namespace vp::detail
