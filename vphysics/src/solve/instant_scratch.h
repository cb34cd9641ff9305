// What the solve of an instant keeps from one to the next for its capacity.
#pragma once

#include "solve/dense_matrix.h"
#include "solve/islands.h"

namespace vp::solve {

struct InstantScratch {
  Islands islands;
  DenseScratch dense;

  // For so many contacts and joint rows, and articulations of so many degrees of freedom.
  void reserve(std::size_t contacts, std::size_t joints, std::size_t dofs) {
    islands.reserve(contacts, joints);
    dense.reserve(dofs);
  }
};

}  // namespace vp::solve
