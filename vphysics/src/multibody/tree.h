// The internal form of a model: its joints, decomposed into nodes and slots in the order of the
// passes.
//
// A node rotates about or translates along the z axis of its own frame, or is a ball, free or user
// joint. A cylindrical, universal or planar joint is a chain of simple nodes; all but the last are
// massless. A fixed joint has no node: its link's inertia is added to its parent's. The passes
// therefore have few cases, and most joints cost the same as a revolute joint.
//
// A slot is one degree of freedom, in the order of the velocities. A node with several degrees of
// freedom has as many slots, all in its frame, with no offset between them; its body belongs to the
// last. The recursions process one column of the motion subspace at a time and need no matrix
// inverse. Only a free root has a single slot for its six velocities (free_root.h).
#pragma once

#include <cstdint>
#include <vector>

#include "multibody/lanes.h"
#include "vphysics/multibody/model.h"

namespace vp::detail {

enum class NodeKind : std::uint8_t { revolute, prismatic, helical, ball, free, user };

template <class B>
struct Node {
  int parent;  // or kWorld
  NodeKind kind;
  int q, v;  // first coordinate and velocity
  int dofs;
  int slot;          // its first slot
  int root;          // index of its tree's root
  SE3T<B> T_parent;  // pose in the parent node's frame, at zero coordinates
  InertiaT<B> J;     // of its link and all links fixed to it, in the node's frame
  B pitch;           // helical [m/rad]
  B armature, damping;
  const UserJoint* user;

  bool simple() const { return kind <= NodeKind::helical; }
  bool free_root() const { return kind == NodeKind::free && parent == kWorld; }
  int slots() const { return free_root() ? 1 : dofs; }
  int body_slot() const { return slot + slots() - 1; }
};

template <class B>
struct LinkFrame {
  int node;  // or kWorld
  SE3T<B> T_node_link;
  int q, v;
};

// column: of a node that is not simple; root: of a free node whose parent is the world.
enum class SlotKind : std::uint8_t { simple, column, root };

struct Slot {
  int parent;  // a slot, or kWorld
  SlotKind kind;
  int v;  // its velocity; of a root, the first
  int q;  // coordinate of a simple node, else -1
  int node;
  int root;  // the slot of its tree's free root, or kWorld
  // Child accumulation (child_sum.h): the entry with its children's loads, and the entry for its
  // own.
  static constexpr int kNone = 0, kNext = 1, kOthers = 2;
  int from, to;
  bool from_next_too;  // also adds the entry of the next slot
  bool adds;           // entry `to` already contains loads of other slots
  bool to_previous;    // its parent is the previous slot
  bool forks;          // has a child other than the next slot
};

// Consecutive slots.
struct SlotRun {
  int begin, end;
};

// A slot's constants: field indices (lanes.h).
enum Constant : int {
  kRotation0 = 0,  // rotation of the node relative to its parent, at zero coordinates
  kShift0 = 9,     // and its position there; zero for a root
  kRotation = 12,  // rotation about z for a unit of the coordinate [rad]
  kSlide = 13,     // translation along z for a unit of the coordinate [m]
  kMass = 14,
  kCentre = 15,  // centre of mass
  kSpin = 18,    // central inertia: kSpin 1 + a a^T + b b^T, with scaled axes a and b
  kAxisA = 19,
  kAxisB = 22,
  kArmature = 25,
  kDamping = 26,
  kSubtreeMass = 27,  // mass of its subtree
  kMin = 28,          // rounding bound of Omega (layout.cpp)
  kConstants = 29
};

// Sums or products of poses along the tree within a group, by doubling: in step s each lane
// combines with the lane of its ancestor 2^s levels above, if that is in the group.
template <class B>
struct alignas(64) ScanStep {
  std::conditional_t<sizeof(B) == 8, std::int64_t, std::int32_t> from[8];
  std::uint8_t lanes;  // bit mask of the lanes with such an ancestor
};
// A parent slot outside the group, combined after these steps, and the lanes of its descendants.
struct External {
  int slot;  // or kWorld
  std::uint8_t lanes;
};

// The constants by groups of slots, and properties of each group.
template <class B>
struct Layout {
  struct Group {
    int count;      // number of slots; the remaining lanes are zero
    bool revolute;  // all of them
    bool simple;    // all of them
    // first, if each slot k that has a coordinate (velocity) has it at index first + k; otherwise
    // -1.
    int first_q, first_v;
    // Only for groups of eight.
    int first_step, end_step, first_external, end_external;
  };
  std::vector<Group> groups;
  AlignedArray<B> constants;
  std::vector<ScanStep<B>> steps;
  std::vector<External> externals;
};

template <class B>
struct Tree {
  std::vector<Node<B>> nodes;
  std::vector<LinkFrame<B>> frames;  // one for each link
  std::vector<LinkSpec> links;
  int coordinates = 0, velocities = 0;

  // Computed from the above (layout.cpp).
  std::vector<Slot> slots;
  std::vector<Vec3T<B>> roots;  // their positions at zero coordinates
  int child_slots = Slot::kOthers;
  // The slots on the path from the world to each slot, including itself; without free roots.
  std::vector<SlotRun> runs;
  std::vector<int> first_run;  // of each slot, plus one for the end
  bool all_related = false;    // of any two slots one is an ancestor of the other
  Layout<B> one;               // for one state: groups of eight slots
  Layout<B> states;            // for packs of states: groups of one
  void build_rows();
};

template <class T>
const Layout<base_t<T>>& layout_of(const Tree<base_t<T>>& tree) {
  return kSlots<T> == 1 ? tree.states : tree.one;
}

// The constants of a slot, and those of a group.
template <class T>
Constants<T, T> constants_of(const Tree<base_t<T>>& tree, int slot) {
  const auto* all = layout_of<T>(tree).constants.data();
  return Constants<T, T>(all + (slot / kSlots<T>)*kConstants * kSlots<T> + slot % kSlots<T>);
}
template <class T>
Constants<T, Wide<T>> group_constants(const Tree<base_t<T>>& tree, int group) {
  const auto* all = layout_of<T>(tree).constants.data();
  return Constants<T, Wide<T>>(all + group * kConstants * kSlots<T>);
}

}  // namespace vp::detail
