// A bounding volume hierarchy of AABBs with eight children per node, which are tested at once.
//
// The tree's shape depends on the order of calls, but query results do not: the tree is no part of
// the simulation state. A world restored from a snapshot may have another tree and finds the same.
//
// Building: top down. Each range is divided in two, by Morton codes or, with more effort, at the
// minimum of a binned surface area heuristic. Moving: the ancestors' boxes are refitted; an item
// that moves far is removed and inserted elsewhere. Both make the tree worse over time, so a caller
// with many moving items rebuilds it at intervals (changes()).
//
// Sources: Lauterbach et al. 2009 (Fast BVH construction on GPUs), section 3; Wald 2007 (On fast
// construction of SAH-based BVHs); Wald, Benthin, Boulos 2008 (wide nodes); Ize 2013 (Robust BVH
// ray traversal) for the rounding of the ray test.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "collide/float_bounds.h"

namespace vp::collide {

struct TreeItem {
  FloatBounds bounds;
  std::uint32_t item = 0;  // < 2^31; the tree stores a word for each index up to the maximum
  std::uint32_t spare = 0;
  std::uint64_t code = 0;  // used by the builder
};
static_assert(sizeof(TreeItem) == 48);

// An AABB (a point, for a ray) that moves by `displacement` while the fraction goes from 0 to 1.
struct Sweep {
  Bounds start;
  Vec3 displacement;
};

// Scratch memory of casts, owned by the caller: a heap of nodes and items, ordered by entry
// fraction or distance. A node precedes an item of the same fraction, since it may contain an item
// with a lower number.
class CastScratch {
 public:
  struct Entry {
    float fraction;
    std::uint32_t child;
  };
  void reserve(std::size_t n) { queue_.reserve(n); }
  std::size_t capacity() const { return queue_.capacity(); }
  void clear() { queue_.clear(); }
  bool empty() const { return queue_.empty(); }
  void push(const Entry& entry) {
    queue_.push_back(entry);
    std::push_heap(queue_.begin(), queue_.end(), is_later);
  }
  Entry pop() {
    const Entry first = queue_.front();
    std::pop_heap(queue_.begin(), queue_.end(), is_later);
    queue_.pop_back();
    return first;
  }

 private:
  static bool is_later(const Entry& a, const Entry& b) {
    return a.fraction > b.fraction || (a.fraction == b.fraction && a.child > b.child);
  }
  std::vector<Entry> queue_;
};

class BoundingTree {
 public:
  // Builds the whole tree; reorders the items. Precondition: each item occurs once. quick: for
  // trees that are rebuilt soon; careful: takes several times as long, for trees that persist.
  enum class Effort : std::uint8_t { quick, careful };
  void build(std::span<TreeItem> items, Effort effort = Effort::quick);
  void clear();

  // Returns false if the tree has become too deep and must be rebuilt; the item is then not
  // inserted. Precondition: the tree does not contain the item.
  [[nodiscard]] bool insert(std::uint32_t item, const FloatBounds& bounds);
  void remove(std::uint32_t item);  // precondition: contains(item)
  // The same as remove and insert.
  [[nodiscard]] bool move(std::uint32_t item, const FloatBounds& bounds);
  bool contains(std::uint32_t item) const {
    return item < slot_of_.size() && slot_of_[item] != kNone;
  }

  std::size_t size() const { return size_; }
  std::size_t changes() const { return changes_; }  // insert, remove and move since build()
  FloatBounds bounds() const;                       // of all items; empty if there is none
  FloatBounds bounds_of(std::uint32_t item) const;  // precondition: contains(item)

  // Calls found(item) for all items whose bounds overlap the box. Results must not depend on the
  // order.
  template <class F>
  void overlapping(const FloatBounds& box, const F& found) const;

  // Calls found(item, item) once for each pair of different items whose bounds overlap.
  template <class F>
  void overlapping_pairs(const F& found) const;
  // Calls found(item of this, item of the other).
  template <class F>
  void overlapping_pairs(const BoundingTree& other, const F& found) const;
  // Divides overlapping_pairs(found), if `other` is this tree itself, or overlapping_pairs(other,
  // found) into at least `parts`, of different sizes, if the trees have so many nodes. The parts
  // depend on the trees alone.
  void divide_overlapping_pairs(const BoundingTree& other, std::size_t parts,
                                std::vector<std::uint64_t>& divided) const;
  // Of one part. Several workers may do it at a time.
  template <class F>
  void overlapping_pairs_of(std::uint64_t part, const BoundingTree& other, const F& found) const {
    overlapping_pairs_below(other, part, found);
  }

  // Calls hit(item, entry), in order of entry, then of items, for all items whose bounds the moving
  // box touches at a fraction of at most `limit`; entry is that fraction, up to float rounding. hit
  // returns the new limit: unchanged to continue, a smaller one to search less far, a negative one
  // to stop.
  template <class F>
  void cast(const Sweep& sweep, double limit, CastScratch& scratch, const F& hit) const;

  // Calls near(item, distance), in order of distance, then of items, for all items whose bounds are
  // at most `limit` [m] from the box; distance is a lower bound, up to float rounding. near returns
  // the new limit, as in cast(). scale: factors that stretch the axes.
  template <class F>
  void nearest(const Bounds& box, const Vec3& scale, double limit, CastScratch& scratch,
               const F& near) const;

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;
  static constexpr std::uint32_t kLeaf = 0x80000000u;  // in child: an item, not a node
  // The maximum depth of a node: stacks have a fixed size. PaddedSix to the tenth is a billion.
  static constexpr unsigned kMaxDepth = 40;
  static constexpr std::size_t kStack = 7 * kMaxDepth + 16;
  static constexpr std::size_t kPairStack = 63 * kMaxDepth + 128;

  struct alignas(64) Node {
    EightBounds bounds;
    std::uint32_t child[8];         // node, kLeaf | item, or kNone
    std::uint32_t parent_slot = 0;  // 8 * node + index of the child; kNone: the root
    std::uint32_t used = 0;         // bit i: child i exists
    std::uint32_t leaves = 0;       // bit i: child i is an item
    std::uint32_t unused_words[5]{};
  };
  static_assert(sizeof(Node) == 256);  // four cache lines, three of them for a box test

  std::uint32_t new_node(std::uint32_t parent_slot);
  void set_child(std::uint32_t slot, std::uint32_t child, const FloatBounds& bounds);
  void clear_child(std::uint32_t slot);
  FloatBounds bounds_of_node(std::uint32_t node) const;
  void fit_above(std::uint32_t node);
  std::span<TreeItem> sort_by_code(std::span<TreeItem> items);
  FloatBounds build_node(std::span<TreeItem> items, std::uint32_t node, unsigned depth,
                         Effort effort);

  static std::size_t pairs_within(const Node& node, std::uint64_t* out);
  static std::size_t pairs_between(const Node& a, const BoundingTree& other, std::uint32_t node_b,
                                   std::uint64_t* out);
  template <class F>
  void overlapping_pairs_below(const BoundingTree& other, std::uint64_t first,
                               const F& found) const;
  std::size_t children_of(std::uint64_t pair, const BoundingTree& other, std::uint64_t* out) const;
  template <class F>
  void overlapping_below(std::uint32_t node, const SpreadBounds& box, const F& found) const;

  std::vector<Node> nodes_;  // the root is the first
  std::vector<std::uint32_t> free_nodes_;
  std::vector<std::uint32_t> slot_of_;  // by item
  std::size_t size_ = 0, changes_ = 0;
  // Scratch memory of quick building.
  std::vector<TreeItem> sorted_;
  std::vector<std::uint64_t> keys_, key_scratch_;
};

// A sweep prepared for the SIMD slab test. Along an axis, the box touches [lower, upper] at the
// fraction (near - from) * inverse. All values are rounded conservatively.
class BoxSweep {
 public:
  explicit BoxSweep(const Sweep& sweep);
  // Bit i: the sweep touches lane i at a fraction from 0 to limit. entry: the fractions.
  unsigned overlaps(const EightBounds& eight, float limit, float entry[8]) const;
  bool overlaps(const FloatBounds& bounds, double limit, float& entry) const;
  // Entries have rounding errors of some units of 2^-24: returns a fraction that is surely beyond
  // the limit.
  static float beyond(double limit) { return rounded_up(limit * (1.0 + 1e-6)); }

 private:
  float add_to_lower_[3], add_to_upper_[3];  // Minkowski sum with the box, reflected
  float inverse_[3];                         // 0: the sweep has no displacement along this axis
};

// A lower bound of the distance between the two.
float distance_between(const Bounds& box, const FloatBounds& other, const Vec3& scale);

template <class F>
void BoundingTree::overlapping_below(std::uint32_t node, const SpreadBounds& box,
                                     const F& found) const {
  std::uint32_t stack[kStack];
  std::size_t depth = 0;
  stack[depth++] = node;
  while (depth > 0) {
    const Node& n = nodes_[stack[--depth]];
    const unsigned hit = overlap_mask(n.bounds, box);
    for_each_bit(hit & n.leaves, [&](unsigned i) { found(n.child[i] & ~kLeaf); });
    for_each_bit(hit & ~n.leaves, [&](unsigned i) { stack[depth++] = n.child[i]; });
  }
}

template <class F>
void BoundingTree::overlapping(const FloatBounds& box, const F& found) const {
  if (size_ > 0) overlapping_below(0, SpreadBounds(box), found);
}

// Uses a stack of pairs of children that overlap; the first of each pair is in this tree. A node
// paired with itself represents the pairs within it.
template <class F>
void BoundingTree::overlapping_pairs_below(const BoundingTree& other, std::uint64_t first,
                                           const F& found) const {
  std::uint64_t stack[kPairStack];
  std::size_t depth = 0;
  stack[depth++] = first;
  while (depth > 0) {
    const std::uint64_t pair = stack[--depth];
    const auto i = static_cast<std::uint32_t>(pair >> 32), j = static_cast<std::uint32_t>(pair);
    if (i & j & kLeaf) {
      found(i & ~kLeaf, j & ~kLeaf);
    } else if (i & kLeaf) {
      other.overlapping_below(j, SpreadBounds(bounds_of(i & ~kLeaf)),
                              [&](std::uint32_t item) { found(i & ~kLeaf, item); });
    } else if (j & kLeaf) {
      overlapping_below(i, SpreadBounds(other.bounds_of(j & ~kLeaf)),
                        [&](std::uint32_t item) { found(item, j & ~kLeaf); });
    } else {
      depth += children_of(pair, other, stack + depth);
    }
  }
}

// Precondition: a pair of nodes.
inline std::size_t BoundingTree::children_of(std::uint64_t pair, const BoundingTree& other,
                                             std::uint64_t* out) const {
  const auto i = static_cast<std::uint32_t>(pair >> 32), j = static_cast<std::uint32_t>(pair);
  return i == j && this == &other ? pairs_within(nodes_[i], out)
                                  : pairs_between(nodes_[i], other, j, out);
}

inline std::size_t BoundingTree::pairs_between(const Node& a, const BoundingTree& other,
                                               std::uint32_t node_b, std::uint64_t* out) {
  const Node& b = other.nodes_[node_b];
  const std::uint32_t slot = b.parent_slot;
  const SpreadBounds around_b = slot == kNone
                                    ? SpreadBounds(other.bounds())
                                    : SpreadBounds(other.nodes_[slot / 8].bounds, slot % 8);
  std::size_t n = 0;
  for_each_bit(overlap_mask(a.bounds, around_b), [&](unsigned i) {
    const unsigned hit = overlap_mask(b.bounds, SpreadBounds(a.bounds, i));
    n += append_chosen(hit, b.child, std::uint64_t{a.child[i]} << 32, out + n);
  });
  return n;
}

inline std::size_t BoundingTree::pairs_within(const Node& node, std::uint64_t* out) {
  std::size_t n = 0;
  for_each_bit(node.used & ~node.leaves, [&](unsigned i) {
    out[n++] = (std::uint64_t{node.child[i]} << 32) | node.child[i];
  });
  for_each_bit(node.used, [&](unsigned i) {
    const unsigned hit = overlap_mask(node.bounds, SpreadBounds(node.bounds, i));
    n += append_chosen(hit & ~((2u << i) - 1u), node.child, std::uint64_t{node.child[i]} << 32,
                       out + n);
  });
  return n;
}

template <class F>
void BoundingTree::overlapping_pairs(const F& found) const {
  if (size_ > 0) overlapping_pairs_below(*this, 0, found);
}
template <class F>
void BoundingTree::overlapping_pairs(const BoundingTree& other, const F& found) const {
  if (size_ > 0 && other.size_ > 0) overlapping_pairs_below(other, 0, found);
}

template <class F>
void BoundingTree::cast(const Sweep& sweep, double limit, CastScratch& scratch,
                        const F& hit) const {
  scratch.clear();
  if (size_ == 0 || !(limit >= 0.0)) return;
  const BoxSweep lanes(sweep);
  scratch.push({0.0f, 0});
  while (!scratch.empty()) {
    const CastScratch::Entry next = scratch.pop();
    const float farthest = BoxSweep::beyond(limit);
    if (next.fraction > farthest) return;
    if (next.child & kLeaf) {
      limit = hit(next.child & ~kLeaf, next.fraction);
      if (limit < 0.0) return;
      continue;
    }
    const Node& n = nodes_[next.child];
    float entry[8];
    for_each_bit(lanes.overlaps(n.bounds, farthest, entry) & n.used, [&](unsigned i) {
      scratch.push({entry[i], n.child[i]});
    });
  }
}

template <class F>
void BoundingTree::nearest(const Bounds& box, const Vec3& scale, double limit, CastScratch& scratch,
                           const F& near) const {
  scratch.clear();
  if (size_ == 0 || !(limit >= 0.0)) return;
  scratch.push({0.0f, 0});
  while (!scratch.empty()) {
    const CastScratch::Entry next = scratch.pop();
    if (static_cast<double>(next.fraction) > limit) return;
    if (next.child & kLeaf) {
      limit = near(next.child & ~kLeaf, next.fraction);
      if (limit < 0.0) return;
      continue;
    }
    const Node& n = nodes_[next.child];
    for_each_bit(n.used, [&](unsigned i) {
      const float distance = distance_between(box, n.bounds.lane(i), scale);
      if (static_cast<double>(distance) <= limit) scratch.push({distance, n.child[i]});
    });
  }
}

}  // namespace vp::collide
