// What a model is inside: its joints taken apart into nodes and slots, in the order of the passes.
//
// A node moves about or along the z axis of its own frame, or is a ball, a free or a user's joint.
// A cylindrical, universal or planar joint is a chain of simple nodes, all but the last without
// mass; a fixed joint is none: its link's inertia is its parent's. So the passes know few kinds,
// and most joints cost what a revolute one does.
//
// A slot is one degree of freedom, in the order of the velocities. A node of several has that many,
// all in its frame, with nothing between them; its body is at the last. So the recursions take one
// column of the motion subspace at a time and never see a matrix to invert. Only a free root is one
// slot for its six (free_root.h).
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
  int slot;          // its first
  int root;          // the root of its tree: a number, counted from 0
  SE3T<B> T_parent;  // at zero coordinates, from the parent node's frame
  InertiaT<B> J;     // in the node's frame: of its link and all that is fixed to it
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

// column: of a node that is not simple; root: the one of a node that is free and hangs on the
// world.
enum class SlotKind : std::uint8_t { simple, column, root };

struct Slot {
  int parent;  // a slot, or kWorld
  SlotKind kind;
  int v;  // its velocity, a root's first
  int q;  // of a simple node its coordinate, else -1
  int node;
  int root;  // the slot of the free root that its tree hangs on, or kWorld
  // Inwards (child_sum.h): the places where its children's loads are, and where its own goes.
  static constexpr int kNone = 0, kNext = 1, kOthers = 2;
  int from, to;
  bool from_next_too;  // besides from: the next slot's
  bool adds;           // others have given to that place before
  bool to_previous;    // the slot before it is its parent
  bool forks;          // somebody else than the next slot hangs on it
};

// Slots that follow each other.
struct SlotRun {
  int begin, end;
};

// A slot's constants: numbers of the fields (lanes.h).
enum Constant : int {
  kRotation0 = 0,  // rotation of the node against its parent's at zero coordinates
  kShift0 = 9,     // and its place there; a root is at the origin of its tree
  kRotation = 12,  // [rad] of turn about z for a unit of the coordinate
  kSlide = 13,     // [m] of slide along z
  kMass = 14,
  kCentre = 15,  // centre of mass
  kSpin = 18,    // central inertia: kSpin 1 + a a^T + b b^T, two axes of a length
  kAxisA = 19,
  kAxisB = 22,
  kArmature = 25,
  kDamping = 26,
  kComposite = 27,  // mass of all that hangs on it, itself included
  kMin = 28,        // what of Omega may be rounding (layout.cpp)
  kConstants = 29
};

// How numbers are summed along the tree within a group, or poses multiplied: by doubling. In step s
// each lane takes up the one of its ancestor 2^s above it, where that is in the group.
template <class B>
struct alignas(64) ScanStep {
  std::conditional_t<sizeof(B) == 8, std::int64_t, std::int32_t> from[8];
  std::uint8_t lanes;  // that have such an ancestor: a bit each
};
// What lanes of a group hang on outside of it, after that.
struct External {
  int slot;  // or kWorld
  std::uint8_t lanes;
};

// The constants by groups of slots, and what the slots of a group have in common.
template <class B>
struct Layout {
  struct Group {
    int count;      // of slots; the others are zero
    bool revolute;  // all of them
    bool simple;    // all of them
    // Where slot k has number first + k in the arrays of coordinates and velocities, each slot that
    // has one; else -1.
    int first_q, first_v;
    // Of groups of eight.
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
  std::vector<LinkFrame<B>> frames;  // of the links
  std::vector<LinkSpec> links;
  int coordinates = 0, velocities = 0;

  // Made of the above (layout.cpp).
  std::vector<Slot> slots;
  std::vector<Vec3T<B>> roots;  // where they are at zero coordinates
  int child_slots = Slot::kOthers;
  // The slots on the way from the world to each slot, itself included; without free roots.
  std::vector<SlotRun> runs;
  std::vector<int> first_run;  // of each slot; one more for the end
  bool all_related = false;    // of any two slots one is above the other
  Layout<B> one;               // for one state: groups of eight slots
  Layout<B> states;            // for packs of states: groups of one
  void lay_out();
};

template <class T>
const Layout<base_t<T>>& layout_of(const Tree<base_t<T>>& tree) {
  return kSlots<T> == 1 ? tree.states : tree.one;
}

// The constants of a slot, and those of a group of them.
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
