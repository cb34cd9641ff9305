// The memory of the derivatives, and the passes that forward and inverse dynamics share.
#pragma once

#include <algorithm>
#include <array>
#include <cstring>
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

// Lanes of the inner loops: a register of the target's, for wider packs pass through memory. Arrays
// are padded to 64 bytes, so that whole packs may be read and written past the end of a run.
#if defined(__AVX512F__)
inline constexpr std::size_t kRegister = 64;
#elif defined(__AVX__)
inline constexpr std::size_t kRegister = 32;
#else
inline constexpr std::size_t kRegister = 16;
#endif
template <class T>
inline constexpr std::size_t kPack = kRegister / sizeof(T);
template <class T>
using Lanes = PackT<T, static_cast<int>(kPack<T>)>;
template <class T>
inline constexpr std::size_t kWidestPack = 64 / sizeof(T);
template <class T>
std::size_t padded(std::size_t n) {
  return (n + kWidestPack<T> - 1) / kWidestPack<T> * kWidestPack<T>;
}

template <class T>
Lanes<T> load_lanes(const T* from) {
  Lanes<T> x;
  std::memcpy(&x.lanes, from, sizeof x.lanes);
  return x;
}
template <class T>
void store_lanes(T* to, const Lanes<T>& x) {
  std::memcpy(to, &x.lanes, sizeof x.lanes);
}

// Twists of every velocity, each of their numbers contiguous: the inner loops run along velocities.
template <class T>
class TwistArray {
 public:
  explicit TwistArray(std::size_t n) : stride_(padded<T>(n + kWidestPack<T>)), x_(6 * stride_) {}

  void set(std::size_t i, const se3T<T>& V) {
    T* x = x_.data() + i;
    x[0] = V.w.x, x[stride_] = V.w.y, x[2 * stride_] = V.w.z;
    x[3 * stride_] = V.v.x, x[4 * stride_] = V.v.y, x[5 * stride_] = V.v.z;
  }
  se3T<T> get(std::size_t i) const {
    const T* x = x_.data() + i;
    return {{x[0], x[stride_], x[2 * stride_]}, {x[3 * stride_], x[4 * stride_], x[5 * stride_]}};
  }
  // Number f of velocities i and after.
  Lanes<T> lanes(std::size_t f, std::size_t i) const {
    return load_lanes(x_.data() + f * stride_ + i);
  }

 private:
  std::size_t stride_;
  AlignedArray<T> x_;
};

// A square matrix by rows; its rows may be longer than it is wide.
template <class T>
struct MatrixView {
  T* at;
  std::size_t stride;
  T* row(std::size_t i) const { return at + i * stride; }
  T& operator()(std::size_t i, std::size_t k) const { return at[i * stride + k]; }
};
// One with room for whole packs.
template <class T>
class PaddedMatrix {
 public:
  explicit PaddedMatrix(std::size_t n) : stride_(padded<T>(n)), x_(n * stride_) {}
  operator MatrixView<T>() { return {x_.data(), stride_}; }
  MatrixView<T> view() { return *this; }
  void clear() { std::fill_n(x_.data(), x_.size(), T(0)); }

 private:
  std::size_t stride_;
  AlignedArray<T> x_;
};
template <class T>
struct InverseMatrices {
  MatrixView<T> q, v, a;
};

template <class T>
struct DerivativesWork {
  explicit DerivativesWork(const Tree<T>& tree);

  // All on the way from the root to a velocity, with itself as the last.
  std::span<const Run> way(const Branch& branch) const {
    return std::span(runs).subspan(static_cast<std::size_t>(branch.first_run),
                                   static_cast<std::size_t>(branch.end_run - branch.first_run));
  }

  std::vector<Branch> branches;  // of each velocity
  std::vector<Run> runs;
  std::vector<se3T<T>> A;                // of each node: acceleration on top of gravity's
  std::vector<Composite<T>> composites;  // of each node
  std::vector<UserSlopes<T>> slopes;     // of each user's node, in the tree's frame
  std::vector<int> slopes_of;            // a node's, or -1
  TwistArray<T> S, S1, S2, Sv;           // of each velocity: derivatives.cpp
  std::array<AlignedArray<T>, 5> along;  // of one velocity, along those before it
  // Of forward dynamics: M = L^T D L, L's transpose, and what the solution works in.
  PaddedMatrix<T> L, L_transposed, Q, V, inverse;
  std::vector<T> D_inverse;
};

template <class T>
bool is_square(std::span<T> matrix, std::size_t n) {
  return matrix.size() == n * n;
}

}  // namespace vp::detail
