// Scratch memory of the solve of an instant; keeps its capacity between instants.
#pragma once

#include "solve/dense_matrix.h"
#include "solve/islands.h"

namespace vp::solve {

struct InstantScratch {
  Islands islands;
  DenseScratch dense;

  // Reserves memory for this many contacts and joint rows, and for articulations of this many
  // degrees of freedom.
  void reserve(std::size_t contacts, std::size_t joints, std::size_t dofs) {
    islands.reserve(contacts, joints);
    dense.reserve(dofs);
  }
};

}  // namespace vp::solve
