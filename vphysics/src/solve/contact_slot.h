// Fills a contact slot from the narrow phase's result.
#pragma once

#include "solve/body_state.h"
#include "solve/contact_graph.h"
#include "vphysics/lie/vec3.h"

namespace vp::solve {

struct NewPoint {
  Vec3 position;  // midway between the surfaces [m]
  double separation;
  float impulse;  // accumulated impulse of the matching point of the last manifold, or 0
};

// World frame. All positions are relative to one arbitrary origin near the two bodies.
struct NewContact {
  Vec3 normal;    // from a to b
  Vec3 x_a, x_b;  // centres of mass; any value for the fixed world
  NewPoint points[4];
  int count;
  double friction, restitution, rolling, spinning;  // the last two are lever arms [m]
  Vec3 surface_velocity;  // target velocity of b's surface relative to a's, for friction [m/s]
  Vec3 old_friction;      // accumulated tangent impulse [N s]
  Vec3 old_moment;        // accumulated twist and rolling impulse [N m s]
  double slid_limit;      // [m]
};

template <int P>
void write_slot(ContactBlock<P>& block, int lane, const NewContact& contact, const BodyState& a,
                const BodyState& b);

// Multiplies all accumulated impulses of a block by a factor.
template <int P>
void rescale_impulses(ContactBlock<P>& block, float factor);

}  // namespace vp::solve
