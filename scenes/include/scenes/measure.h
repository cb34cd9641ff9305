// How well a scene stands, from its bodies' poses alone. The geometry is our own and not the
// engine's, and the same for every engine that is measured.
#pragma once

#include <span>

#include "scenes/scene.h"

namespace scenes {

// How deep two shapes are in each other: the shortest way to part them [m]. Negative where they are
// apart, but then not always their distance. One of them may be of fixed bodies only, not both. Of
// Terrain: how far corners are in the triangle under them, and balls at centres and ends of axes in
// the triangles around. Of a Hull and another one or a Box: the deepest corner of the one in the
// other, by the face that is nearest; where only edges cross, nothing is seen. Of a Mesh: how far
// corners, or balls at centres and ends of axes, are behind the triangle that is nearest, if that
// is no farther than the radius of a ball around the other shape; and how deep the mesh's vertices
// are in the other shape.
double penetration(const Shape& a, const SE3& T_world_a, const Shape& b, const SE3& T_world_b);

struct Standing {
  int in_place = 0, of = 0;  // dynamic bodies that exist
  int lost = 0;              // of them, without a finite pose: they are in no other figure
  double penetration = 0.0;  // deepest, of bodies that are not joined [m]; 0: none touch
  double drift = 0.0;        // largest horizontal displacement from the start [m]
  double sink = 0.0;         // largest vertical displacement from the start [m]
  double gap = 0.0;          // largest distance between a joint's two frames' origins [m]
};
// poses: T_world_body of all bodies of the scene, in their order; what does not exist at that time
// [s] is left out.
Standing measure(const Scene& scene, std::span<const SE3> poses, double time = 0.0);
// The poses that the scene begins with.
std::vector<SE3> start_poses(const Scene& scene);

}  // namespace scenes
