// Working memory and shared definitions of the derivatives.
//
// Each velocity has a record of numbers. Records are in groups of kSlots, like the slots of a data
// (lanes.h): for one state a pass computes eight velocities at once, for a pack of states one
// velocity of all states.
#pragma once

#include <algorithm>
#include <vector>

#include "multibody/kinematics.h"
#include "multibody/user_derivatives.h"
#include "vphysics/multibody/derivatives.h"

namespace vp::detail {

// Consecutive velocities, from first to end - 1, all on one path to the root.
struct Run {
  int first, end;
};

// A velocity's entry in the tree of velocities.
struct Branch {
  int parent;              // the previous velocity on the path to the root, or -1
  int node, column;        // its node, and its column of the node
  bool last;               // of its node: has the body
  int first_run, end_run;  // of itself and its ancestors, in `runs`
  int first, end;          // lowest index on the path, one past the highest index that it moves
  int tree_end;            // one past the highest index of its tree
};

// Numbers of a velocity: S, S1, S2, Sv, then J, F, B and p (differentiate.h), first of the body,
// then of the body and its descendants.
enum VelocityField : int {
  kColumnS = 0,
  kColumnS1 = 6,
  kColumnS2 = 12,
  kColumnSv = 18,
  kCompositeMass = 24,
  kCompositeMoment = 25,
  kCompositeInertia = 28,
  kCompositeF = 34,
  kCompositeK = 40,
  kCompositeP = 49,
  kCompositeEnd = 52,
  kVelocityFields = 52
};
// Scratch of the current group. Base to tip: V_p, A_p, V and A. Tip to base: the factors of the
// loop along the path, dF^/dq, dF^/dv, dF^/da and B^* S.
enum ScratchField : int {
  kParentV = 0,
  kParentA = 6,
  kNodeV = 12,
  kNodeA = 18,
  kForceQ = 0,
  kForceV = 6,
  kForceA = 12,
  kTransposed = 18,
  kScratchFields = 24
};

// SIMD lanes of the loops along a matrix row: one register of the target, or a pack of states. Rows
// of one state are padded to 64 bytes, so that whole registers may be read and written past the
// end.
#if defined(__AVX512F__)
inline constexpr int kRegister = 64;
#elif defined(__AVX__)
inline constexpr int kRegister = 32;
#else
inline constexpr int kRegister = 16;
#endif
template <class T>
struct RowLanes {
  using type = PackT<T, kRegister / static_cast<int>(sizeof(T))>;
  static constexpr std::size_t kPadding = 64 / sizeof(T);
};
template <class B, int N>
struct RowLanes<PackT<B, N>> {
  using type = PackT<B, N>;
  static constexpr std::size_t kPadding = 1;
};
template <class T>
using Lanes = typename RowLanes<T>::type;
template <class T>
inline constexpr std::size_t kPack = sizeof(Lanes<T>) / sizeof(T);
template <class T>
std::size_t padded(std::size_t n) {
  constexpr std::size_t kPadding = RowLanes<T>::kPadding;
  return (n + kPadding - 1) / kPadding * kPadding;
}

// A matrix by rows, each row in groups of kSlots columns.
template <class T>
struct MatrixView {
  T* at;
  std::size_t stride;                                              // between rows
  std::size_t group_stride = static_cast<std::size_t>(kSlots<T>);  // between groups

  T* group(std::size_t row, std::size_t g) const { return at + row * stride + g * group_stride; }
  T& operator()(std::size_t row, std::size_t column) const {
    constexpr auto kGroup = static_cast<std::size_t>(kSlots<T>);
    return group(row, column / kGroup)[column % kGroup];
  }
};
// Derivatives with respect to q and v, and the mass matrix. For forward dynamics, `a` is the factor
// L below the diagonal (solve_rows.h).
template <class T>
struct InverseMatrices {
  MatrixView<T> q, v, a;
};

template <class T>
struct DerivativesWork {
  explicit DerivativesWork(const Tree<base_t<T>>& tree);

  std::size_t velocities() const { return branches.size(); }
  // The path from the root to a velocity, including itself.
  std::span<const Run> path(const Branch& branch) const {
    return std::span(runs).subspan(static_cast<std::size_t>(branch.first_run),
                                   static_cast<std::size_t>(branch.end_run - branch.first_run));
  }
  std::span<const Run> path_before(const Branch& branch) const {
    if (branch.parent < 0) return {};
    return path(branches[static_cast<std::size_t>(branch.parent)]);
  }

  int groups() const { return (static_cast<int>(branches.size()) + kSlots<T> - 1) / kSlots<T>; }
  Fields<T, T> velocity(int i) {
    return Fields<T, T>(records.data() + (i / kSlots<T>)*kVelocityFields * kSlots<T> +
                        i % kSlots<T>);
  }
  Fields<T, Wide<T>> group(int g) {
    return Fields<T, Wide<T>>(records.data() + g * kVelocityFields * kSlots<T>);
  }
  Fields<T, T> lane(int k) { return Fields<T, T>(scratch.data() + k); }
  Fields<T, Wide<T>> lanes() { return Fields<T, Wide<T>>(scratch.data()); }

  std::vector<Branch> branches;  // one for each velocity
  std::vector<Run> runs;
  std::vector<se3T<T>> A;                       // of each node: acceleration including gravity
  std::vector<UserDerivatives<T>> derivatives;  // of each user node, in the tree's frame
  std::vector<int> derivatives_of;              // of each node, or -1
  AlignedArray<T> records, scratch;
  // For forward dynamics. For one state dtau/dq and dtau/dv share rows, in alternating groups: this
  // doubles the number of independent sums.
  MatrixView<T> L{};
  std::vector<T> D_inverse;
  std::size_t row_size;  // of L and `inverse`
  AlignedArray<T> factor, both, inverse;
};

template <class T>
bool is_square(std::span<T> matrix, std::size_t n) {
  return matrix.size() == n * n;
}

}  // namespace vp::detail
