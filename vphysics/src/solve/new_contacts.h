// New contacts for the slots of one block, the input of the pass `renew`: NewContact
// (contact_slot.h) in structure-of-arrays layout, with the states of their bodies. In double
// precision: the origin of positions need not be close.
#pragma once

#include <cstdint>

#include "solve/body_state.h"
#include "solve/field.h"

namespace vphysics_solver {

struct alignas(64) DoubleField {
  double lane[kLanes];
};
struct DoubleField3 {
  DoubleField x, y, z;
};

// A body of each contact, as its solver state has it.
struct NewContactSide {
  DoubleField3 x;  // centre of mass [m]; for the fixed world any value near the contact
  DoubleField inverse_mass;
  DoubleField inertia[6];  // inverse: xx yy zz xy yz zx
  DoubleField3 displacement, rotation;
};

// World frame. All positions of a contact are relative to one arbitrary origin near its two bodies.
struct NewContacts {
  std::uint32_t lanes = 0;  // a bit for each slot that gets a contact; the others do not change
  DoubleField3 normal;      // from a to b
  NewContactSide a, b;
  // Points, the first `count` of each contact: midway between the surfaces [m]; their separation
  // [m]; the accumulated impulse of the matching point of the last manifold, or 0 [N s].
  DoubleField count;
  DoubleField3 position[4];
  DoubleField separation[4], impulse[4];
  DoubleField friction, restitution, rolling, spinning;  // the last two are lever arms [m]
  DoubleField3 surface_velocity;  // target velocity of b's surface relative to a's [m/s]
  DoubleField slid_limit;         // [m]
};

}  // namespace vphysics_solver

namespace vp::solve {
using namespace vphysics_solver;  // NOLINT(google-build-using-namespace): see passes.h
}  // namespace vp::solve
