// What a model is inside: its joints taken apart into nodes, in the order of the passes.
//
// A node moves about or along the z axis of its own frame, or is a ball, a free or a user's joint.
// A cylindrical, universal or planar joint is a chain of simple nodes, all but the last without
// mass; a fixed joint is none: its link's inertia is its parent's. So the passes know few kinds,
// and most joints cost what a revolute one does.
#pragma once

#include <cstdint>
#include <vector>

#include "vphysics/multibody/model.h"

namespace vp::detail {

enum class NodeKind : std::uint8_t { revolute, prismatic, helical, ball, free, user };

template <class B>
struct Node {
  int parent;  // or kWorld
  NodeKind kind;
  int q, v;  // first coordinate and velocity
  int dofs;
  int block;         // of more than one degree: its number among these
  SE3T<B> T_parent;  // at zero coordinates, from the parent node's frame
  InertiaT<B> J;     // in the node's frame: of its link and all that is fixed to it
  B pitch;           // helical [m/rad]
  B armature, damping;
  const UserJoint* user;
};

template <class B>
struct LinkPlace {
  int node;  // or kWorld
  SE3T<B> T_node_link;
  int q, v;
};

template <class B>
struct Tree {
  std::vector<Node<B>> nodes;
  std::vector<LinkPlace<B>> places;  // of the links
  std::vector<LinkSpec> links;
  int coordinates = 0, velocities = 0, blocks = 0;
};

}  // namespace vp::detail
