// The memory of the derivatives, and the passes that forward and inverse dynamics share.
#pragma once

#include <array>
#include <vector>

#include "multibody/kinematics.h"
#include "multibody/user_slopes.h"
#include "vphysics/multibody/derivatives.h"

namespace vp::detail {

// Of a node: at first of its body, then of the body and all that hangs on it.
template <class T>
struct Composite {
  InertiaT<T> J;
  dse3T<T> F;  // J A - dad_V (J V) less the loads: the force through the joint
  // B of derivatives.cpp: angular part K w, linear part 2 w x p of a twist with angular part w
  Mat3T<T> K;
  Vec3T<T> p;  // linear momentum
};

// Velocities by their numbers first to end - 1, all on one way to the root.
struct Run {
  int first, end;
};

// What the tree's shape says of one velocity.
struct Branch {
  int parent;              // the velocity before it on the way to the root, or -1
  int first_run, end_run;  // of itself and all before it, in `runs`
  int first, end;          // the least number on the way, one more than the largest that it moves
  int tree_end;            // one more than the largest of its tree
};

// Six numbers of each velocity, each kind contiguous: the inner loops run along velocities.
template <class T>
struct TwistArray {
  std::array<std::vector<T>, 6> x;

  void resize(std::size_t n) {
    for (auto& column : x) column.resize(n);
  }
  void set(std::size_t i, const se3T<T>& V) {
    x[0][i] = V.w.x, x[1][i] = V.w.y, x[2][i] = V.w.z;
    x[3][i] = V.v.x, x[4][i] = V.v.y, x[5][i] = V.v.z;
  }
  se3T<T> get(std::size_t i) const {
    return {{x[0][i], x[1][i], x[2][i]}, {x[3][i], x[4][i], x[5][i]}};
  }
};

template <class T>
struct DerivativesWork {
  explicit DerivativesWork(const Tree<T>& tree);

  std::vector<Branch> branches;  // of each velocity
  std::vector<Run> runs;
  std::vector<se3T<T>> A;                // of each node: acceleration on top of gravity's
  std::vector<Composite<T>> composites;  // of each node
  std::vector<UserSlopes<T>> slopes;     // of each user's node, in the tree's frame
  std::vector<int> slopes_of;            // a node's, or -1
  TwistArray<T> S, S1, S2, Sv;           // of each velocity: derivatives.cpp
  std::array<std::vector<T>, 2> column;  // of one velocity, along those before it
  std::vector<T> L, D_inverse;           // M = L^T D L
};

template <class T>
bool is_square(std::span<T> matrix, std::size_t n) {
  return matrix.size() == n * n;
}

// Fills out, from what a call with the same q, v and a has left in the data's work.
template <class T>
Expected<void> differentiate(const char* call, const Tree<T>& tree, const Work<T>& work,
                             DerivativesWork<T>& memory, Span<T> q, Span<T> v, Span<T> a,
                             const LoadsT<T>& loads, const InverseDerivativesT<T>& out);

}  // namespace vp::detail
