// Results of the kinematics that algorithms outside the kernels read.
#pragma once

#include "multibody/joints.h"
#include "vphysics/multibody/dynamics.h"

namespace vp::detail {

// Inertia of the node's body, in the tree's frame.
template <class T>
InertiaT<T> inertia_of(const Tree<base_t<T>>& tree, const Work<T>& work, int node) {
  const auto& J = tree.nodes[static_cast<std::size_t>(node)].J;
  return wide<T>(J).InvXform(pose_of(work, node));
}

}  // namespace vp::detail
