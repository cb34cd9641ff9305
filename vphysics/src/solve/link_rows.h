// Builds the rows of contacts and joints on articulations, once per solve.
#pragma once

#include <vector>

#include "solve/contact_solver.h"

namespace vp::solve {

// Row order of a link's side of a contact: for point i, along its normal and its two tangents;
// then, if the contact resists rolling, about the three axes of the world.
inline constexpr int kNormal = 0, kTangent = 1, kRowsOfPoint = 3;
constexpr int row_of(int point, int direction) {
  return kRowsOfPoint * point + direction;
}

inline int rows_of(const ContactConstraint& c) {
  return kRowsOfPoint * c.count + (c.rolling > 0.0 ? 3 : 0);
}

// Whether an impulse moves the body itself: false for links and static bodies.
inline bool moves(const SolverBody& body) {
  return body.inverse_mass != 0.0 || !(body.angular == Sym3{});
}

void prepare_link_rows(const StepContext& context);

}  // namespace vp::solve
