// Sixteen contacts in structure-of-arrays layout.
//
// Entry l of every field belongs to one contact, between the bodies of states a[l] and b[l]. No
// body except the fixed world is in two slots of a block. A block lives as long as its contacts:
// between steps only the fields that a pass writes change. With rA, rB the arms of a point from the
// centres of mass of a and b, d = x_a - x_b (so that rB = rA + d), n the normal from a to b:
//
//   u_i = n . (v_b - v_a) + (d x n) . w_b + (rA_i x n) . (w_b - w_a)        separation speed
//   s_i = base_i + the same of the states' displacement and rotation          separation
//   K_ij = du_i / dp_j = 1/m_a + 1/m_b + jA_i . I_a^-1 jA_j + jB_i . I_b^-1 jB_j
//
// with jA_i = rA_i x n, jB_i = jA_i + d x n. Friction acts at the centre of the near points
// (renew_pass.h): along two tangents t, b = n x t, and about the normal.
#pragma once

#include <cstddef>
#include <cstdint>

#include "solve/field.h"

namespace vphysics_solver {

struct FieldTangent {
  Field t, b;  // along the tangents t and b = n x t
};

// The index of K_ij, i != j, in `off_diagonal`.
constexpr int pair_index(int i, int j) {
  const int low = i < j ? i : j, high = i < j ? j : i;
  return high * (high - 1) / 2 + low;
}

template <int kPoints>
struct ContactBlock {
  static constexpr int kPairs = kPoints * (kPoints - 1) / 2;

  IndexField a, b;     // indices of the bodies' states; kWorldState in an empty slot
  IndexField contact;  // index in the world's contacts; kNoContact in an empty slot
  IndexField touches;  // 1: the contact is reported as touching
  Field active;        // 1: the next iteration or restitution pass must process it; else 0
  Field given;         // normal impulse, summed over this step's sub-steps so far [N s]
  FieldSym3 inertia_a, inertia_b;  // inverse; copied from the states before the sub-steps
  Field bias[kPoints];             // from the sub-step's first iteration (find_bias) [m/s]

  Field3 normal, tangent, d;
  FieldTangent arm[kPoints];  // jA_i
  Field base[kPoints];        // [m]; kFarSeparated for an absent point
  Field impulse[kPoints];     // [N s], accumulated
  Field inverse[kPoints];     // 1 / K_ii; 0 for an absent point
  Field off_diagonal[kPairs > 0 ? kPairs : 1];

  // Friction. The inverse of the 2x2 tangent block (xx, xy, yy), and the single effective mass that
  // corrects sliding points.
  Field friction;  // coefficient
  Field3 grip;     // rA of the point where friction acts
  Field stick[3];
  Field slide;
  Field tangent_impulse[2];
  Field surface_speed[2];  // target relative velocity along the tangents [m/s]
  Field twist_mass, twist_arm, twist_impulse;
  Field roll_mass, roll_arm, roll_impulse[2];

  // Not read by the hot passes.
  Field restitution;
  Field approach_speed;  // the maximum approach speed in this step [m/s]
  Field impact;          // the impulse of its restitution [N s]; both are zero when a step begins
  // Relative pose when the geometry was last computed (find_moved).
  Field3 slid;  // relative displacement at the grip
  Field3 rotated_a, rotated_b;
  Field slid_limit;  // maximum slip until the geometry is computed again [m]
};

// The number of fields from `normal` on, in memory order: the floats of a block that persist across
// steps.
template <int P>
inline constexpr std::size_t kFieldsOf = (sizeof(ContactBlock<P>) -
                                          offsetof(ContactBlock<P>, normal)) /
                                         sizeof(Field);

static_assert(sizeof(ContactBlock<4>) == 89 * sizeof(Field));
static_assert(sizeof(ContactBlock<1>) == 66 * sizeof(Field));

inline constexpr std::uint32_t kNoContact = 0xffffffffu;
// The separation of an absent point.
inline constexpr float kFarSeparated = 1e9f;

}  // namespace vphysics_solver

namespace vp::solve {
using namespace vphysics_solver;  // NOLINT(google-build-using-namespace): see passes.h
}  // namespace vp::solve
