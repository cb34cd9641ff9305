// What a data is inside: the numbers of each slot, in the order of the passes.
//
// Everything is in one frame, the tree's: the axes of the world, the origin where the root is now
// (at its coordinates, if it is free). Then no inertia, twist or wrench changes frame between a
// link and its parent: the recursion adds. The root's own place keeps the numbers small wherever in
// the world the tree is.
#pragma once

#include <array>
#include <vector>

#include "multibody/instruction_set.h"
#include "multibody/rows.h"
#include "multibody/tree.h"
#include "vphysics/multibody/data.h"

namespace vp::detail {

// A slot's numbers (lanes.h).
enum Field : int {
  kX = 0,        // pose
  kS = 12,       // motion subspace
  kV = 18,       // velocity
  kA = 24,       // acceleration that the velocities make, on top of that of the gravity field
  kH = 30,       // of the body: first moment,
  kI = 33,       // rotational inertia,
  kF = 39,       // and bias force
  kOwn = 45,     // velocity relative to the parent; before that:
  kTurned = 45,  // sine and cosine of the joint's angle, and its slide
  kFields = 51
};

// Numbers of a slot for the recursions by rows (rows.h): the pose; the body's rotational inertia,
// mass and a zero; its first moment, the same with the other sign and two zeros; its bias force.
enum RowField : int {
  kRowPose = 0,
  kRowInertia = 16,
  kRowMoment = 24,
  kRowForce = 32,
  kRowSize = 40
};

// What the inward pass leaves for the outward one.
template <class T>
struct alignas(kSlots<T> > 1 ? 8 * sizeof(T) : alignof(T)) Factor {
  dse3T<T> W;  // J^ S / Omega
  T inverse;   // 1 / Omega, Omega = <S, J^ S> + armature
  T x;         // u / Omega, u what is left of tau
};

// What flows inwards: an articulated inertia and its bias force, a force alone, or what is left of
// a composite rigid body when its mass is known.
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
struct Moments {
  Vec3T<T> h;
  Sym3T<T> I;
};
template <class T>
Moments<T> operator+(const Moments<T>& a, const Moments<T>& b) {
  return {a.h + b.h, a.I + b.I};
}

// Of a ball's, a free or a user's node.
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

  // What the roots hang on rests, under an acceleration.
  void set_world(const Vec3T<T>& acceleration) {
    Fields<T, T>(world.data()).set(kA + 3, acceleration);
  }

  T* row(int i) const { return rows.data() + i * kRowSize; }

  InstructionSet instruction_set;
  mutable AlignedArray<T> rows;  // of one state: kRowSize for each slot
  mutable AlignedArray<T> fields;
  AlignedArray<T> world;  // the fields of what the roots hang on
  std::vector<Factor<T>> factors;
  std::vector<Articulated<T>> articulated_flow;
  struct None {};
  std::vector<std::conditional_t<(kSlots<T> > 1), ArticulatedRows<T>, None>> row_flow;
  std::vector<dse3T<T>> force_flow;
  std::vector<Moments<T>> moment_flow;
  std::vector<se3T<T>> added;       // what the joints add to A
  std::vector<Columns<T>> columns;  // of each node that is not simple
  std::vector<int> columns_of;      // a node's, or -1
  std::vector<int> body_slot;       // of each node
  std::vector<int> root;            // of each node
  std::vector<Vec3T<T>> origins;    // of each root's tree in the world
  std::vector<T> zeros;             // velocities or accelerations of a tree at rest

 private:
  T* fields_at(int i) const {
    return fields.data() + (i / kSlots<T>)*kFields * kSlots<T> + i % kSlots<T>;
  }
};

// What a pass has left, of one node. Poses, subspaces and velocities are in the tree's frame.
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
  return work.slot(tree.nodes[static_cast<std::size_t>(node)].v + k).twist(kS);
}
// The columns in which the inertia is factored: a free root's are the axes of the tree.
template <class T>
se3T<T> factored_column_of(const Tree<base_t<T>>& tree, const Work<T>& work, int node, int k) {
  const int slot = tree.nodes[static_cast<std::size_t>(node)].v + k;
  if (tree.slots[static_cast<std::size_t>(slot)].kind != SlotKind::root) {
    return column_of(tree, work, node, k);
  }
  se3T<T> S{};
  (k < 3 ? S.w : S.v)[k % 3] = T(1);
  return S;
}
// What factoring has left of such a column: the articulated inertia times it, without what the
// columns after it have taken out, by Omega; and 1 / Omega.
template <class T>
dse3T<T> gain_of(const Tree<base_t<T>>& tree, const Work<T>& work, int node, int k) {
  const int slot = tree.nodes[static_cast<std::size_t>(node)].v + k;
  return work.factors[static_cast<std::size_t>(slot)].W;
}
template <class T>
T omega_inverse_of(const Tree<base_t<T>>& tree, const Work<T>& work, int node, int k) {
  const int slot = tree.nodes[static_cast<std::size_t>(node)].v + k;
  return work.factors[static_cast<std::size_t>(slot)].inverse;
}
// Where the origin of the node's tree is in the world.
template <class T>
Vec3T<T> origin_of(const Work<T>& work, int node) {
  const int root = work.root[static_cast<std::size_t>(node)];
  return work.origins[static_cast<std::size_t>(root)];
}

}  // namespace vp::detail
