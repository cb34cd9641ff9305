// The internal state of a data: the numbers of each slot, in the order of the passes.
//
// Everything is in one frame, the tree's frame: the axes of the world, with the origin at the
// current position of the root (at its coordinates, if it is free). Inertias, twists and wrenches
// therefore need no transformation between a link and its parent: the recursion adds. The origin at
// a free root keeps the numbers small anywhere in the world. On another root the numbers grow with
// its displacement.
#pragma once

#include <array>
#include <vector>

#include "multibody/instruction_set.h"
#include "multibody/rows.h"
#include "multibody/tree.h"
#include "vphysics/multibody/data.h"

namespace vp::detail {

// A slot's fields (lanes.h).
enum Field : int {
  kX = 0,   // pose
  kS = 12,  // motion subspace; unused for a root
  kV = 18,  // velocity
  kH = 24,  // body: first moment,
  kI = 27,  // rotational inertia,
  kF = 33,  // and bias force
  kA = 39,  // acceleration minus gravity; in forward dynamics without the joint accelerations
  kFields = 45
};

// A slot's fields for the recursions by rows (rows.h): the body's rotational inertia, mass and a
// zero; its first moment, the negated first moment and two zeros; its bias force.
enum RowField : int { kRowInertia = 0, kRowMoment = 8, kRowForce = 16, kRowSize = 24 };

// A 6-vector, padded to a row.
template <class T>
struct alignas(kSlots<T> > 1 ? 8 * sizeof(T) : alignof(T)) PaddedSix {
  T x[8]{};
};
template <class T>
se3T<T> twist_from(const T* at) {
  return {{at[0], at[1], at[2]}, {at[3], at[4], at[5]}};
}
template <class T>
dse3T<T> wrench_from(const T* at) {
  return {{at[0], at[1], at[2]}, {at[3], at[4], at[5]}};
}

// Results of the tip-to-base pass for the base-to-tip pass.
template <class T>
struct alignas(kSlots<T> > 1 ? 8 * sizeof(T) : alignof(T)) Factor {
  dse3T<T> W;  // J^ S / Omega
  T inverse;   // 1 / Omega, Omega = <S, J^ S> + armature
  T x;         // u / Omega, u the remaining joint force
};

// Loads of the child accumulation: an articulated inertia with its bias force; a force alone
// (PaddedSix); first moment and inertia of a composite body, whose mass is known (MomentsRow,
// Moments).
template <class T>
struct Articulated {
  AInertiaT<T> J;
  dse3T<T> p;
};
template <class T>
Articulated<T> operator+(const Articulated<T>& a, const Articulated<T>& b) {
  return {a.J + b.J, a.p + b.p};
}
template <class T>
struct MomentsRow {
  T x[9]{};
};
template <class T>
struct Moments {
  Vec3T<T> h;
  Sym3T<T> I;

  static Moments from(const T* x) {
    return {{x[0], x[1], x[2]}, {x[3], x[4], x[5], x[6], x[7], x[8]}};
  }
  void to(T* x) const {
    const T all[9] = {h.x, h.y, h.z, I.xx, I.yy, I.zz, I.xy, I.yz, I.zx};
    for (int k = 0; k < 9; ++k) x[k] = all[k];
  }
};
template <class T>
Moments<T> operator+(const Moments<T>& a, const Moments<T>& b) {
  return {a.h + b.h, a.I + b.I};
}

// Columns of a ball, free or user node.
template <class T>
struct Columns {
  std::array<se3T<T>, 6> S;
  se3T<T> rate;  // S' q'
};

template <class T>
struct Work {
  Work(const Tree<base_t<T>>& tree, Arithmetic arithmetic);

  Fields<T, T> slot(int i) const { return Fields<T, T>(fields_at(i)); }
  Fields<T, Wide<T>> group(int g) const { return Fields<T, Wide<T>>(fields_at(g * kSlots<T>)); }

  T* row(int i) const { return rows.data() + i * kRowSize; }

  InstructionSet instruction_set;
  mutable AlignedArray<T> rows;  // for one state: kRowSize for each slot
  mutable AlignedArray<T> fields;
  se3T<T> A_world;                 // acceleration of the roots' parent
  std::vector<Factor<T>> factors;  // of each velocity
  std::vector<Articulated<T>> articulated_flow;
  struct None {};
  std::vector<std::conditional_t<(kSlots<T> > 1), ArticulatedRows<T>, None>> row_flow;
  std::vector<PaddedSix<T>> force_flow;
  std::vector<MomentsRow<T>> moment_flow;
  std::vector<se3T<T>> added;       // joint part of A, for slots with branches
  std::vector<Columns<T>> columns;  // of each node that is not simple
  std::vector<int> columns_of;      // of each node, or -1
  std::vector<int> body_slot;       // of each node
  std::vector<int> root;            // of each node
  std::vector<Vec3T<T>> origins;    // of each root's tree, in the world
  std::vector<T> zeros;             // velocities or accelerations of a tree at rest

 private:
  T* fields_at(int i) const {
    return fields.data() + (i / kSlots<T>)*kFields * kSlots<T> + i % kSlots<T>;
  }
};

// A node's results of a pass. Poses, subspaces and velocities are in the tree's frame.
template <class T>
SE3T<T> pose_of(const Work<T>& work, int node) {
  return work.slot(work.body_slot[static_cast<std::size_t>(node)]).pose(kX);
}
template <class T>
se3T<T> velocity_of(const Work<T>& work, int node) {
  return work.slot(work.body_slot[static_cast<std::size_t>(node)]).twist(kV);
}
// The k-th column of a node's motion subspace.
template <class T>
se3T<T> column_of(const Tree<base_t<T>>& tree, const Work<T>& work, int node, int k) {
  const auto& mover = tree.nodes[static_cast<std::size_t>(node)];
  if (!mover.free_root()) return work.slot(mover.slot + k).twist(kS);
  const Mat3T<T> R = work.slot(mover.slot).mat(kX);
  const Vec3T<T> axis = k % 3 == 0 ? R.cx : k % 3 == 1 ? R.cy : R.cz;
  se3T<T> S{};
  (k < 3 ? S.w : S.v) = axis;
  return S;
}
// The columns in which the inertia is factored. For a free root: the axes of the tree.
template <class T>
se3T<T> factored_column_of(const Tree<base_t<T>>& tree, const Work<T>& work, int node, int k) {
  if (!tree.nodes[static_cast<std::size_t>(node)].free_root()) {
    return column_of(tree, work, node, k);
  }
  se3T<T> S{};
  (k < 3 ? S.w : S.v)[k % 3] = T(1);
  return S;
}
// The factors of such a column: W, the articulated inertia (after elimination of later columns)
// times the column, divided by Omega; and 1 / Omega.
template <class T>
dse3T<T> projected_wrench_of(const Tree<base_t<T>>& tree, const Work<T>& work, int node, int k) {
  const int velocity = tree.nodes[static_cast<std::size_t>(node)].v + k;
  return work.factors[static_cast<std::size_t>(velocity)].W;
}
template <class T>
T omega_inverse_of(const Tree<base_t<T>>& tree, const Work<T>& work, int node, int k) {
  const int velocity = tree.nodes[static_cast<std::size_t>(node)].v + k;
  return work.factors[static_cast<std::size_t>(velocity)].inverse;
}
// The position of the origin of the node's tree in the world.
template <class T>
Vec3T<T> origin_of(const Work<T>& work, int node) {
  const int root = work.root[static_cast<std::size_t>(node)];
  return work.origins[static_cast<std::size_t>(root)];
}

}  // namespace vp::detail
