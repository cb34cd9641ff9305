// A triangle and a box or a hull, as far as the triangle's corners and the faces of the other show
// how they lie to each other: most small triangles near a large shape need no general search.
//
// The planes of all faces bound the shape, and each face fills its plane. Hulls with merged faces,
// whose corners lie up to a tolerance behind the planes, are therefore left to the general search,
// as are those of many faces, for which it is faster.
#pragma once

#include <optional>

#include "collide/gjk.h"
#include "collide/polytope.h"

namespace vp::collide {

// Precondition of the functions below.
bool has_few_flat_faces(const Geometry& shape);

// Of the planes of b's faces, the one that separates the two farthest gives the distance if its
// closest corner is over the face. This is so for many of the small triangles under a large shape,
// at a tenth to a half of the cost of a general search. Empty if the closest points may be
// elsewhere. p: the triangle's corners, in the frame of T_a_b. limit: as of gjk().
std::optional<GjkResult> corner_over_face(const Vec3 p[3], const Polytope& b, const SE3& T_a_b,
                                          double limit);

// Whether the two overlap: yes if a corner is inside b, no if a face separates them, else empty.
std::optional<bool> corners_overlap(const Vec3 p[3], const Polytope& b, const SE3& T_a_b);

}  // namespace vp::collide
