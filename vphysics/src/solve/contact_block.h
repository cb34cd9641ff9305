// Sixteen contacts side by side.
//
// Lane l of every field is of one contact between the bodies of rows a[l] and b[l]; no body but
// the fixed world is in two lanes of a block. A block lives as long as its contacts: from step to
// step nothing in it is made anew but what a pass writes. With rA, rB a point's arms from the
// centres of mass a and b, d = x_a - x_b (so that rB = rA + d), n the normal from a to b:
//
//   u_i = n . (v_b - v_a) + (d x n) . w_b + (rA_i x n) . (w_b - w_a)        speed of separation
//   s_i = base_i + the same of the rows' x and turn                          separation
//   K_ij = du_i / dp_j = 1/m_a + 1/m_b + jA_i . I_a^-1 jA_j + jB_i . I_b^-1 jB_j
//
// with jA_i = rA_i x n, jB_i = jA_i + d x n. Friction acts at the middle of the points: along two
// tangents t, b = n x t, and about the normal.
#pragma once

#include <cstddef>
#include <cstdint>

#include "solve/field.h"

namespace vphysics_solver {

struct FieldTangent {
  Field t, b;  // along the tangents t and b = n x t
};

// The place of K_ij, i != j, among `off_diagonal`.
constexpr int pair_index(int i, int j) {
  const int low = i < j ? i : j, high = i < j ? j : i;
  return high * (high - 1) / 2 + low;
}

template <int kPoints>
struct ContactBlock {
  static constexpr int kPairs = kPoints * (kPoints - 1) / 2;

  IndexField a, b;     // rows of the bodies; of an empty lane the world's
  IndexField contact;  // index in the world's contacts; kNoContact: an empty lane
  IndexField touches;  // 1: it has been told that the two touch
  Field active;        // 1: the next round of pushing, or strike, must look at it; else 0
  Field given;         // normal impulse of the sub-steps of this step so far [N s]
  FieldSym3 inertia_a, inertia_b;  // inverse, copied from the rows before the sub-steps
  Field bias[kPoints];             // of the sub-step's first round of pushing (find_bias) [m/s]

  Field3 normal, tangent, d;
  FieldTangent arm[kPoints];  // jA_i
  Field base[kPoints];        // [m]; of a point that is not there: far
  Field impulse[kPoints];     // [N s], accumulated
  Field inverse[kPoints];     // 1 / K_ii; 0 of a point that is not there
  Field off_diagonal[kPairs > 0 ? kPairs : 1];

  // Friction. The 2x2 inverse of what the tangents feel (xx, xy, yy), and the one mass with which
  // sliding points are corrected.
  Field friction;  // coefficient
  Field3 grip;     // rA of where friction acts
  Field stick[3];
  Field slide;
  Field tangent_impulse[2];
  Field surface_speed[2];  // wanted relative velocity along the tangents [m/s]
  Field twist_mass, twist_arm, twist_impulse;
  Field roll_mass, roll_arm, roll_impulse[2];

  // Not of the hot passes.
  Field restitution;
  Field approach_speed;  // the fastest approach seen in this step [m/s]
  Field impact;          // the impulse of its bounces [N s]; both are zero when a step begins
  // Where the two were when the geometry was last computed (find_moved).
  Field3 slid;  // relative displacement at the grip
  Field3 rotated_a, rotated_b;
  Field slid_limit;  // how far they may slide by until it is computed again [m]
};

// All fields from the normal on, as they lie: those that outlast a step, but indices.
template <int P>
inline constexpr std::size_t kFieldsOf = (sizeof(ContactBlock<P>) -
                                          offsetof(ContactBlock<P>, normal)) /
                                         sizeof(Field);

static_assert(sizeof(ContactBlock<4>) == 89 * sizeof(Field));
static_assert(sizeof(ContactBlock<1>) == 66 * sizeof(Field));

inline constexpr std::uint32_t kNoContact = 0xffffffffu;
// A separation that no point comes near: of those that are not there.
inline constexpr float kFarSeparated = 1e9f;

}  // namespace vphysics_solver

namespace vp::solve {
using namespace vphysics_solver;  // NOLINT(google-build-using-namespace): see passes.h
}  // namespace vp::solve
