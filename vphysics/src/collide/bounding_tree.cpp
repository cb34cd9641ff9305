#include "collide/bounding_tree.h"

#include <algorithm>
#include <cmath>

#include "vphysics/assert.h"

namespace vp::collide {
namespace {

// An item is removed and inserted elsewhere if its move enlarges the box around it and its siblings
// by more than this factor.
constexpr float kFarMove = 2.0f;

}  // namespace

void BoundingTree::clear() {
  nodes_.clear();
  free_nodes_.clear();
  slot_of_.assign(slot_of_.size(), kNone);
  size_ = changes_ = 0;
}

std::uint32_t BoundingTree::new_node(std::uint32_t parent_slot) {
  std::uint32_t index = 0;
  if (free_nodes_.empty()) {
    index = static_cast<std::uint32_t>(nodes_.size());
    nodes_.emplace_back();
  } else {
    index = free_nodes_.back();
    free_nodes_.pop_back();
  }
  Node& n = nodes_[index];
  const FloatBounds nothing;
  for (unsigned i = 0; i < 8; ++i) {
    n.bounds.set_lane(i, nothing);
    n.child[i] = kNone;
  }
  n.parent_slot = parent_slot;
  n.used = n.leaves = 0;
  return index;
}

void BoundingTree::set_child(std::uint32_t slot, std::uint32_t child, const FloatBounds& bounds) {
  Node& n = nodes_[slot / 8];
  const unsigned lane = slot % 8, bit = 1u << lane;
  n.bounds.set_lane(lane, bounds);
  n.child[lane] = child;
  n.used |= bit;
  if (child & kLeaf) {
    n.leaves |= bit;
    slot_of_[child & ~kLeaf] = slot;
  } else {
    n.leaves &= ~bit;
    nodes_[child].parent_slot = slot;
  }
}

void BoundingTree::clear_child(std::uint32_t slot) {
  Node& n = nodes_[slot / 8];
  const unsigned lane = slot % 8, bit = 1u << lane;
  n.bounds.set_lane(lane, {});
  n.child[lane] = kNone;
  n.used &= ~bit;
  n.leaves &= ~bit;
}

FloatBounds BoundingTree::bounds_of_node(std::uint32_t node) const {
  const EightBounds& e = nodes_[node].bounds;
  FloatBounds b;
  for (int axis = 0; axis < 3; ++axis) {
    const Lanes4 l = lesser(e.lower[axis][0], e.lower[axis][1]);
    const Lanes4 u = greater(e.upper[axis][0], e.upper[axis][1]);
    b.lower[axis] = std::min(std::min(l[0], l[1]), std::min(l[2], l[3]));
    b.upper[axis] = std::max(std::max(u[0], u[1]), std::max(u[2], u[3]));
  }
  return b;
}

FloatBounds BoundingTree::bounds() const {
  return size_ > 0 ? bounds_of_node(0) : FloatBounds{};
}
FloatBounds BoundingTree::bounds_of(std::uint32_t item) const {
  const std::uint32_t slot = slot_of_[item];
  return nodes_[slot / 8].bounds.lane(slot % 8);
}

// Refits the ancestors' boxes up to the first that does not change; removes nodes that have become
// empty.
void BoundingTree::fit_above(std::uint32_t node) {
  for (std::uint32_t slot = nodes_[node].parent_slot; slot != kNone;) {
    if (nodes_[node].used == 0) {
      clear_child(slot);
      free_nodes_.push_back(node);
    } else {
      const FloatBounds fitted = bounds_of_node(node);
      if (fitted == nodes_[slot / 8].bounds.lane(slot % 8)) return;
      nodes_[slot / 8].bounds.set_lane(slot % 8, fitted);
    }
    node = slot / 8;
    slot = nodes_[node].parent_slot;
  }
}

void BoundingTree::remove(std::uint32_t item) {
  VP_ASSERT(contains(item));
  const std::uint32_t slot = slot_of_[item];
  slot_of_[item] = kNone;
  clear_child(slot);
  fit_above(slot / 8);
  --size_;
  ++changes_;
}

bool BoundingTree::move(std::uint32_t item, const FloatBounds& bounds) {
  VP_ASSERT(contains(item));
  const std::uint32_t slot = slot_of_[item], node = slot / 8;
  const std::uint32_t above = nodes_[node].parent_slot;
  if (above != kNone) {
    const FloatBounds around = nodes_[above / 8].bounds.lane(above % 8);
    if (half_area(merged(around, bounds)) > kFarMove * half_area(around)) {
      remove(item);
      return insert(item, bounds);
    }
  }
  nodes_[node].bounds.set_lane(slot % 8, bounds);
  fit_above(node);
  ++changes_;
  return true;
}

// Descends into the child whose box grows least, to a node with a free slot.
bool BoundingTree::insert(std::uint32_t item, const FloatBounds& bounds) {
  if (item >= slot_of_.size()) slot_of_.resize(item + 1, kNone);
  VP_ASSERT(slot_of_[item] == kNone);
  if (nodes_.empty()) new_node(kNone);
  std::uint32_t node = 0;
  for (unsigned depth = 1; depth < kMaxDepth; ++depth) {
    const Node& n = nodes_[node];
    unsigned best = 8;
    float smallest = 0.0f;
    for_each_bit(n.used, [&](unsigned i) {
      const FloatBounds b = n.bounds.lane(i);
      const float growth = half_area(merged(b, bounds)) - half_area(b);
      if (best < 8 && !(growth < smallest)) return;
      best = i;
      smallest = growth;
    });
    const auto free_slot = static_cast<unsigned>(std::countr_one(n.used));
    const bool into_leaf = best < 8 && ((n.leaves >> best) & 1u) != 0;
    const bool growing = best == 8 || into_leaf || smallest > half_area(bounds);
    if (free_slot < 8 && growing) {
      set_child(8 * node + free_slot, kLeaf | item, bounds);
      fit_above(node);
      ++size_;
      ++changes_;
      return true;
    }
    const std::uint32_t slot = 8 * node + best;
    if (into_leaf) {
      const std::uint32_t neighbour = n.child[best];
      const FloatBounds its = n.bounds.lane(best);
      const std::uint32_t made = new_node(slot);
      set_child(slot, made, its);
      set_child(8 * made, neighbour, its);
    }
    node = nodes_[node].child[best];
  }
  return false;
}

BoxSweep::BoxSweep(const Sweep& sweep) {
  for (int axis = 0; axis < 3; ++axis) {
    const double d = sweep.displacement[axis];
    double lower = sweep.start.lower[axis], upper = sweep.start.upper[axis];
    inverse_[axis] = static_cast<float>(1.0 / d);
    if (!(std::fabs(inverse_[axis]) < 1e30f)) {  // so short that the whole displacement is covered
      inverse_[axis] = 0.0f;
      lower = std::min(lower, lower + d);
      upper = std::max(upper, upper + d);
    }
    add_to_lower_[axis] = -rounded_up(upper);
    add_to_upper_[axis] = -rounded_down(lower);
  }
}

unsigned BoxSweep::overlaps(const EightBounds& eight, float limit, float entry[8]) const {
  // Rounding errors of the differences, the inverse and the products, on both sides of the
  // comparison: 2 * 3 * 2^-24, doubled.
  constexpr float kRounding = 1.0f + 8e-7f;
  unsigned bits = 0;
  for (unsigned h = 0; h < 2; ++h) {
    Lanes4 in = broadcast(0.0f), out = broadcast(limit);
    Mask4 within = in <= out;
    for (int axis = 0; axis < 3; ++axis) {
      const Lanes4 low = eight.lower[axis][h] + broadcast(add_to_lower_[axis]);
      const Lanes4 high = eight.upper[axis][h] + broadcast(add_to_upper_[axis]);
      const float inverse = inverse_[axis];
      if (inverse == 0.0f) {
        within &= (low <= broadcast(0.0f)) & (high >= broadcast(0.0f));
        continue;
      }
      const Lanes4 near = (inverse > 0.0f ? low : high) * inverse;
      const Lanes4 far = (inverse > 0.0f ? high : low) * inverse;
      in = greater(near, in);
      out = lesser(far * kRounding, out);
    }
    within &= in <= out;
    bits |= bits_of(within) << (4 * h);
    for (unsigned k = 0; k < 4; ++k) entry[4 * h + k] = in[k];
  }
  return bits;
}

bool BoxSweep::overlaps(const FloatBounds& bounds, double limit, float& entry) const {
  EightBounds eight;
  for (unsigned i = 0; i < 8; ++i) eight.set_lane(i, bounds);
  float entries[8];
  if (!(limit >= 0.0) || overlaps(eight, beyond(limit), entries) == 0) return false;
  entry = entries[0];
  return true;
}

float distance_between(const Bounds& box, const FloatBounds& other, const Vec3& scale) {
  double square = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double below = static_cast<double>(other.lower[axis]) - box.upper[axis],
                 above = box.lower[axis] - static_cast<double>(other.upper[axis]);
    const double separated = scale[axis] * std::max({0.0, below, above});
    square += separated * separated;
  }
  return std::max(0.0f, rounded_down(std::sqrt(square)));
}

void BoundingTree::divide_overlapping_pairs(const BoundingTree& other, std::size_t parts,
                                            std::vector<std::uint64_t>& divided) const {
  divided.clear();
  if (size_ == 0 || other.size_ == 0) return;
  divided.push_back(0);
  for (std::size_t k = 0; k < divided.size() && divided.size() < parts;) {
    const std::uint64_t pair = divided[k];
    if (((pair >> 32 | pair) & kLeaf) != 0) {
      ++k;
      continue;
    }
    std::uint64_t children[64];
    const std::size_t count = children_of(pair, other, children);
    divided[k] = divided.back();
    divided.pop_back();
    divided.insert(divided.end(), children, children + count);
  }
}

}  // namespace vp::collide
