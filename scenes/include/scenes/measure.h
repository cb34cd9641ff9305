// Measures of a scene from its bodies' poses alone: bodies in place, penetration, drift, joint
// separation. The geometry code is independent of the engine, and the same for every engine that is
// measured.
#pragma once

#include <span>

#include "scenes/scene.h"

namespace scenes {

// Penetration depth: the shortest translation that separates two shapes [m]. Negative if they are
// separated, but then not always their distance. At most one of the shapes may be of a kind for
// fixed bodies only.
// Terrain: the depth of corners below the triangle under them, and of spheres at centres and ends
// of axes in the triangles around them.
// A Hull and another Hull or a Box: the depth of the deepest corner of one in the other, by the
// nearest face. Crossings of edges only are not detected.
// Mesh: the depth of corners, or of spheres at centres and ends of axes, behind the nearest
// triangle, if it is within the other shape's bounding radius; and the depth of the mesh's vertices
// in the other shape.
double penetration(const Shape& a, const SE3& T_world_a, const Shape& b, const SE3& T_world_b);

struct Standing {
  int in_place = 0, of = 0;  // dynamic bodies that exist
  int lost = 0;              // those without a finite pose, left out of all other results
  double penetration = 0.0;  // maximum, of bodies without a common joint [m]; 0: no contact
  double drift = 0.0;        // maximum horizontal displacement from the start [m]
  double sink = 0.0;         // maximum vertical displacement from the start [m]
  double gap = 0.0;          // maximum distance between the origins of a joint's two frames [m]
};
// poses: T_world_body of all bodies of the scene, in their order. Bodies that do not exist at the
// given time [s] are left out.
Standing measure(const Scene& scene, std::span<const SE3> poses, double time = 0.0);
// The initial poses of the scene.
std::vector<SE3> start_poses(const Scene& scene);

}  // namespace scenes
