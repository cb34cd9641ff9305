// What a data is inside: one record a node, in the order of the passes.
//
// Everything is in one frame, the tree's: the axes of the world, the origin where the root is now
// (at its coordinates, if it is free). Then no inertia, twist or wrench changes frame between a
// link and its parent: the recursion adds. The root's own place keeps the numbers small wherever in
// the world the tree is.
#pragma once

#include <array>
#include <vector>

#include "multibody/tree.h"
#include "vphysics/multibody/data.h"

namespace vp::detail {

template <class T>
struct NodeState {
  SE3T<T> X;   // pose
  se3T<T> S;   // motion subspace, of a node of one degree
  se3T<T> V;   // velocity
  se3T<T> A;   // acceleration: without the joints' own at first, as of the gravity field
  dse3T<T> p;  // bias force; its articulated sum; in inverse dynamics the force through the joint
  AInertiaT<T> J;  // articulated inertia
  dse3T<T> U;      // J S
  T D_inverse, u;  // 1 / (S, J S + armature), and what is left of tau
};

// A node of several degrees: what a node of one degree has, of each.
template <class T>
struct BlockState {
  std::array<se3T<T>, 6> S;
  std::array<dse3T<T>, 6> U;
  std::array<T, 6> D_inverse, u;
};

template <class T>
struct Work {
  explicit Work(const Tree<base_t<T>>& tree);

  std::vector<NodeState<T>> nodes;
  std::vector<BlockState<T>> blocks;
  std::vector<InertiaT<T>> composites;  // of the mass matrix
  std::vector<se3T<T>> added;           // what the joints add to A
  std::vector<Vec3T<T>> origins;        // of each node's tree in the world
  std::vector<T> zeros;                 // velocities or accelerations of a tree at rest
};

// What a pass has left, of one node. Poses, subspaces and velocities are in the tree's frame.
template <class T>
SE3T<T> pose_of(const Work<T>& work, int node) {
  return work.nodes[static_cast<std::size_t>(node)].X;
}
template <class T>
se3T<T> velocity_of(const Work<T>& work, int node) {
  return work.nodes[static_cast<std::size_t>(node)].V;
}
// The k-th column of a node's motion subspace.
template <class T>
se3T<T> column_of(const Tree<base_t<T>>& tree, const Work<T>& work, int node, int k) {
  const auto i = static_cast<std::size_t>(node);
  const int block = tree.nodes[i].block;
  if (block < 0) return work.nodes[i].S;
  return work.blocks[static_cast<std::size_t>(block)].S[static_cast<std::size_t>(k)];
}
// What factoring has left, of the k-th column: the articulated inertia times it, J^ S, with the
// columns before it (inwards) taken out; and 1 / Omega.
template <class T>
dse3T<T> gain_of(const Tree<base_t<T>>& tree, const Work<T>& work, int node, int k) {
  const auto i = static_cast<std::size_t>(node);
  const int block = tree.nodes[i].block;
  if (block < 0) return work.nodes[i].U;
  return work.blocks[static_cast<std::size_t>(block)].U[static_cast<std::size_t>(k)];
}
template <class T>
T omega_inverse_of(const Tree<base_t<T>>& tree, const Work<T>& work, int node, int k) {
  const auto i = static_cast<std::size_t>(node);
  const int block = tree.nodes[i].block;
  if (block < 0) return work.nodes[i].D_inverse;
  return work.blocks[static_cast<std::size_t>(block)].D_inverse[static_cast<std::size_t>(k)];
}
// Where the origin of the node's tree is in the world.
template <class T>
Vec3T<T> origin_of(const Work<T>& work, int node) {
  return work.origins[static_cast<std::size_t>(node)];
}

}  // namespace vp::detail
