// One new contact, as the narrow phase has found it, for the pass `renew`; accumulated impulses of
// contact slots.
#pragma once

#include "solve/contact_block.h"
#include "solve/new_contacts.h"
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
  double slid_limit;      // [m]
};

// Puts a contact into a lane, for the pass `renew`.
void put(NewContacts& contacts, int lane, const NewContact& contact, const BodyState& a,
         const BodyState& b);

// Multiplies all accumulated impulses of a block by a factor.
template <int P>
void rescale_impulses(ContactBlock<P>& block, float factor);

}  // namespace vp::solve
