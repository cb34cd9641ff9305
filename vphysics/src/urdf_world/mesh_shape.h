// A mesh becomes a shape that the world can collide.
#pragma once

#include <string>

#include "vphysics/urdf_world.h"

namespace vp::detail {

struct MadeShape {
  Shape shape;
  std::string note;  // what was mended, or empty
};

// scale: factors of the mesh's axes, of any sign but zero. triangles: as a TriangleMesh.
Expected<MadeShape> shape_of_mesh(const MeshFile& mesh, const Vec3& scale, bool triangles,
                                  const UrdfWorldOptions& options);

}  // namespace vp::detail
