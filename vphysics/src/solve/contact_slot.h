// A contact's lane made from what the narrow phase has found.
#pragma once

#include "solve/body_row.h"
#include "solve/contact_graph.h"
#include "vphysics/lie/vec3.h"

namespace vp::solve {

struct NewPoint {
  Vec3 position;  // midway between the surfaces [m]
  double separation;
  float impulse;  // of the point that it was before, or 0
};

// World frame; all positions against any one origin near the two.
struct NewContact {
  Vec3 normal;    // from a to b
  Vec3 x_a, x_b;  // centres of mass; of the fixed world: anything
  NewPoint points[4];
  int count;
  double friction, restitution, rolling, spinning;  // arms of the latter two [m]
  Vec3 surface_velocity;  // of b's surface against a's, that friction wants [m/s]
  Vec3 old_friction;      // tangent impulse so far [N s]
  Vec3 old_moment;        // of twisting and rolling [N m s]
  double slid_limit;      // [m]
};

template <int P>
void write_slot(ContactBlock<P>& block, int lane, const NewContact& contact, const BodyRow& a,
                const BodyRow& b);

// All accumulated impulses of a block times a factor.
template <int P>
void rescale_impulses(ContactBlock<P>& block, float factor);

}  // namespace vp::solve
