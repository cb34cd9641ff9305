// Lie groups for rigid bodies, in the notation of the paper (sections 4.1 to 4.3, appendix B).
//
//   Vec3     a vector of R^3
//   SE3      a pose: rotation R (9 scalars) and position p (3)
//   se3      a generalized velocity (w, v): angular first
//   dse3     a generalized force (m, f): moment first
//   SO3      a rotation, with its algebra written as Vec3
//   Inertia  a generalized inertia of a rigid body: 10 scalars
//   AInertia an articulated inertia: 21 scalars
//
// Each type is a template on the scalar, with the suffix T. The names without it are in double.
// Other scalars: float, DualT (lie/dual.h), PackT (lie/pack.h), Count (lie/count.h).
#pragma once

#include "vphysics/lie/ainertia.h"
#include "vphysics/lie/inertia.h"
#include "vphysics/lie/scalar.h"
#include "vphysics/lie/se3.h"
#include "vphysics/lie/so3.h"
#include "vphysics/lie/vec3.h"
