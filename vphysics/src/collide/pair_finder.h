// The broad phase: finds the pairs of colliders that are close enough for the narrow phase.
//
// Each collider has a proxy with enlarged bounds. While its true bounds stay inside them, nothing
// is done. When they leave, the proxy gets new ones and counts as moved. update() then finds the
// new overlapping pairs. Pairs stay in the set until the caller removes them, which it may do as
// soon as should_pair() is false.
//
// The pairs found and their order depend on bounds, filters, owners, the pair set and the moved
// proxies. A snapshot contains all of these, but not the trees.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "collide/bounding_tree.h"
#include "collide/pair_set.h"
#include "parallel.h"

namespace vp::collide {

enum class Mobility : std::uint8_t {
  fixed,  // two fixed proxies never pair
  moving,
};

inline constexpr std::uint32_t kNoOwner = ~0u;

struct ProxyDesc {
  Bounds bounds;  // beyond 1e9 m: stored in a list that is compared with all proxies
  Mobility mobility = Mobility::moving;
  // Two proxies pair if each one's category is in the other's mask.
  std::uint32_t category = 1, mask = ~0u;
  std::uint32_t owner = kNoOwner;  // two proxies of one owner never pair
  std::uint32_t user = 0;
  double margin = 0.0;  // [m] >= 0
};

class PairFinder {
 public:
  // Preconditions of all functions: bounds are no NaN, lower <= upper; indices are of existing
  // proxies.
  std::uint32_t add(const ProxyDesc& desc);
  // Also removes its pairs. Cheap if the caller has removed them before; otherwise it scans the
  // whole set.
  void remove(std::uint32_t proxy);

  // Returns true if the bounds had left the enlarged ones (or those had become much too large).
  // Then the proxy gets new ones: enlarged by the margin, and extended by the expected
  // displacement.
  bool set_bounds(std::uint32_t proxy, const Bounds& bounds, double margin = 0.0,
                  const Vec3& displacement = {}) {
    if (fits(bounds_[proxy], bounds, margin, displacement)) return false;
    return enlarge(proxy, bounds, margin, displacement);
  }
  // Whether the enlarged bounds contain these.
  bool holds(std::uint32_t proxy, const Bounds& bounds) const {
    return contains(bounds_[proxy], rounded_outward(bounds));
  }
  // The proxy counts as moved: update() finds its new pairs, old ones stay.
  void set_filter(std::uint32_t proxy, std::uint32_t category, std::uint32_t mask);

  // Whether update() has work to do.
  bool has_moved() const { return !moved_.empty(); }
  // Appends the new pairs, in ascending order, and inserts them into the set.
  void update(std::vector<ProxyPair>& found, const Workers& workers = {});
  // The proxies whose enlarged bounds or filter changed before the last update(), ascending.
  std::span<const std::uint32_t> moved() const { return moved_list_; }

  bool enlarged_overlap(std::uint32_t i, std::uint32_t j) const {
    return overlap(bounds_[i], bounds_[j]);
  }
  // Whether update() would find the pair if it were not in the set and one of the two had moved.
  bool should_pair(std::uint32_t i, std::uint32_t j) const {
    return agree(filters_[i], filters_[j]) && (is_moving(places_[i]) || is_moving(places_[j])) &&
           enlarged_overlap(i, j);
  }
  bool remove_pair(std::uint32_t i, std::uint32_t j);  // false: it was not in the set
  bool has_pair(std::uint32_t i, std::uint32_t j) const {
    return pairs_.contains(ProxyPair::ordered(i, j).key());
  }
  std::size_t pairs() const { return pairs_.size(); }

  bool exists(std::uint32_t proxy) const {
    return proxy < places_.size() && places_[proxy] != TreeKind::none;
  }
  std::uint32_t user(std::uint32_t proxy) const { return filters_[proxy].user; }
  std::uint32_t owner(std::uint32_t proxy) const { return filters_[proxy].owner; }
  Bounds enlarged_bounds(std::uint32_t proxy) const { return widened(bounds_[proxy]); }

  // Updates the trees for queries; update() does so too.
  void refresh();
  // Appends the proxies whose enlarged bounds overlap the box, in ascending order. Precondition of
  // all queries: refresh() was called since the last change.
  void overlapping(const Bounds& box, std::vector<std::uint32_t>& found) const;
  // Calls hit(proxy, entry) as in BoundingTree::cast: in order of entry among the fixed proxies,
  // then among the moving ones. The unbounded ones come first, in ascending order.
  template <class F>
  void cast(const Sweep& sweep, double limit, CastScratch& scratch, const F& hit) const;
  // Calls near(proxy, distance) as in BoundingTree::nearest, with the groups in the order of
  // cast().
  template <class F>
  void nearest(const Bounds& box, double limit, CastScratch& scratch, const F& near) const;

  // Writes the snapshot state to a sink with word(std::uint64_t).
  template <class Sink>
  void write(Sink& sink) const;
  // Reads the snapshot state from a reader with word(), check(bool) and ok() into separate memory;
  // adopt() makes it current. Precondition of adopt(): the reader was ok after the last read().
  template <class Reader>
  void read(Reader& in);
  void adopt();
  // Whether the state that was read has the same proxies as the current one, bounds aside.
  bool incoming_fits() const;

 private:
  // The tree or list that contains a proxy.
  enum class TreeKind : std::uint8_t { fixed, moving, unbounded_fixed, unbounded_moving, none };

  struct Filter {
    std::uint32_t category = 0, mask = 0, owner = 0, user = 0;

    bool operator==(const Filter&) const = default;
  };

  // The state in a snapshot.
  struct State {
    std::vector<FloatBounds> bounds;
    std::vector<Filter> filters;
    std::vector<TreeKind> tree_kinds;
    std::vector<std::uint32_t> free, moved;
    std::vector<std::uint64_t> pairs;
  };

  static constexpr double kUnbounded = 1e9;  // [m]
  static TreeKind tree_kind_of(const FloatBounds& enlarged, Mobility mobility);
  static bool is_moving(TreeKind tree_kind) {
    return tree_kind == TreeKind::moving || tree_kind == TreeKind::unbounded_moving;
  }
  static bool fits(const FloatBounds& enlarged, const Bounds& b, double margin, const Vec3& d);
  bool enlarge(std::uint32_t proxy, const Bounds& bounds, double margin, const Vec3& displacement);
  void put(std::uint32_t proxy, const FloatBounds& enlarged, Mobility mobility);
  void take_out(std::uint32_t proxy);
  void resize(std::size_t proxies);
  static bool agree(const Filter& a, const Filter& b) {
    return (a.owner != b.owner || a.owner == kNoOwner) && (a.category & b.mask) != 0 &&
           (b.category & a.mask) != 0;
  }
  BoundingTree& tree(TreeKind tree_kind) { return trees_[static_cast<std::size_t>(tree_kind)]; }
  void rebuild(TreeKind tree_kind);
  void refresh(TreeKind tree_kind, std::size_t pending);
  void consider(std::uint32_t i, std::uint32_t j, std::vector<std::uint64_t>& candidates) const;
  // Returns a function (item, item) that adds the pair to the candidates if one of the two moved.
  auto moved_pairs(std::vector<std::uint64_t>& candidates) const {
    return [this, &candidates](std::uint32_t i, std::uint32_t j) {
      if (moved_.test(i) || moved_.test(j)) consider(i, j, candidates);
    };
  }
  void take_candidates();
  void find_by_queries();
  void find_by_join(const Workers& workers);
  void reserve_join_parts();
  void join_moving_with(const BoundingTree& other, const Workers& workers);
  void find_unbounded();
  void count_pair(std::uint64_t key, std::uint32_t change);
  template <class Reader>
  void read_slot(Reader& in);

  // By proxy.
  std::vector<FloatBounds> bounds_;  // enlarged
  std::vector<Filter> filters_;
  std::vector<TreeKind> places_;
  std::vector<std::uint32_t> pair_counts_;
  std::vector<std::uint32_t> free_;       // the last one is used next
  std::vector<std::uint32_t> unbounded_;  // ascending
  IndexSet moved_;                        // since the last update()
  PairSet pairs_;
  // Changes that the trees do not contain yet.
  IndexSet pending_;
  std::array<BoundingTree, 2> trees_;  // of fixed and of moving proxies

  // Scratch memory and results of the last update().
  std::vector<std::uint32_t> moved_list_, pending_list_;
  std::vector<TreeItem> items_;
  std::vector<std::uint64_t> candidates_, new_keys_;
  std::vector<std::uint64_t> join_parts_;
  std::vector<std::vector<std::uint64_t>> candidates_of_parts_;
  mutable std::vector<std::uint64_t> key_scratch_, written_keys_;
  State incoming_;
  IndexSet seen_;
};

// Whether b is inside, and the enlarged bounds are nowhere larger by more than four margins and
// twice the displacement: otherwise they would keep useless pairs. Rounding to float may add two
// units of 2^-23.
inline bool PairFinder::fits(const FloatBounds& enlarged, const Bounds& b, double margin,
                             const Vec3& d) {
  bool fits = true;
  for (int axis = 0; axis < 3; ++axis) {
    const double lower = enlarged.lower[axis], upper = enlarged.upper[axis];
    const double slack =
        4.0 * margin + 2.0 * std::fabs(d[axis]) + (std::fabs(lower) + std::fabs(upper)) * 0x1p-22;
    const double below = b.lower[axis] - lower, above = upper - b.upper[axis];
    fits = fits && below >= 0.0 && above >= 0.0 && below <= slack && above <= slack;
  }
  return fits;
}

template <class F>
void PairFinder::cast(const Sweep& sweep, double limit, CastScratch& scratch, const F& hit) const {
  const BoxSweep lanes(sweep);
  const auto update_limit = [&](std::uint32_t proxy, float entry) {
    return limit = hit(proxy, entry);
  };
  for (const std::uint32_t proxy : unbounded_) {
    float entry = 0.0f;
    if (!lanes.overlaps(bounds_[proxy], limit, entry)) continue;
    if (update_limit(proxy, entry) < 0.0) return;
  }
  for (const BoundingTree& tree : trees_) {
    tree.cast(sweep, limit, scratch, update_limit);
    if (limit < 0.0) return;
  }
}

template <class F>
void PairFinder::nearest(const Bounds& box, double limit, CastScratch& scratch,
                         const F& near) const {
  const Vec3 scale{1.0, 1.0, 1.0};
  const auto update_limit = [&](std::uint32_t proxy, float distance) {
    return limit = near(proxy, distance);
  };
  for (const std::uint32_t proxy : unbounded_) {
    const float distance = distance_between(box, bounds_[proxy], scale);
    if (static_cast<double>(distance) <= limit && update_limit(proxy, distance) < 0.0) return;
  }
  for (const BoundingTree& tree : trees_) {
    tree.nearest(box, scale, limit, scratch, update_limit);
    if (limit < 0.0) return;
  }
}

// Slots: state (tree kind | moved), category | mask, owner | user, bounds; only the state for a
// free slot. Then the free list and the pairs, each after its count.
template <class Sink>
void PairFinder::write(Sink& sink) const {
  const auto both = [](std::uint32_t high, std::uint32_t low) {
    return (std::uint64_t{high} << 32) | low;
  };
  sink.u64(places_.size());
  for (std::uint32_t i = 0; i < places_.size(); ++i) {
    const Filter& f = filters_[i];
    sink.u64(both(static_cast<std::uint32_t>(places_[i]), moved_.test(i) ? 1u : 0u));
    if (places_[i] == TreeKind::none) continue;
    sink.u64(both(f.category, f.mask));
    sink.u64(both(f.owner, f.user));
    for (int axis = 0; axis < 3; ++axis) {
      sink.u64(both(std::bit_cast<std::uint32_t>(bounds_[i].lower[axis]),
                    std::bit_cast<std::uint32_t>(bounds_[i].upper[axis])));
    }
  }
  sink.u64(free_.size());
  for (const std::uint32_t i : free_) sink.u64(i);
  written_keys_.clear();
  pairs_.append_keys(written_keys_);
  sort_keys(written_keys_, key_scratch_);
  sink.u64(written_keys_.size());
  for (const std::uint64_t key : written_keys_) sink.u64(key);
}

template <class Reader>
void PairFinder::read_slot(Reader& in) {
  const std::uint64_t state = in.u64();
  in.check((state >> 32) <= static_cast<std::uint64_t>(TreeKind::none) &&
           (state & 0xfffffffeu) == 0);
  if (!in.ok()) return;
  const auto tree_kind = static_cast<TreeKind>(state >> 32);
  const auto index = static_cast<std::uint32_t>(incoming_.tree_kinds.size());
  const float limit = rounded_up(kFloatFar);
  FloatBounds b{Lanes4{}, Lanes4{}};
  Filter f;
  if (tree_kind != TreeKind::none) {
    const auto high = [](std::uint64_t w) { return static_cast<std::uint32_t>(w >> 32); };
    const auto low = [](std::uint64_t w) { return static_cast<std::uint32_t>(w); };
    const std::uint64_t filter = in.u64(), names = in.u64();
    f.category = high(filter), f.mask = low(filter);
    f.owner = high(names), f.user = low(names);
    for (int axis = 0; axis < 3; ++axis) {
      const std::uint64_t w = in.u64();
      const float lower = std::bit_cast<float>(high(w)), upper = std::bit_cast<float>(low(w));
      b.lower[axis] = lower;
      b.upper[axis] = upper;
      in.check(-lower <= limit && lower <= upper && upper <= limit);  // no NaN passes
    }
    in.check(tree_kind ==
             tree_kind_of(b, is_moving(tree_kind) ? Mobility::moving : Mobility::fixed));
  }
  if ((state & 1u) != 0) {
    in.check(tree_kind != TreeKind::none);
    incoming_.moved.push_back(index);
  }
  incoming_.bounds.push_back(b);
  incoming_.filters.push_back(f);
  incoming_.tree_kinds.push_back(tree_kind);
}

template <class Reader>
void PairFinder::read(Reader& in) {
  State& s = incoming_;
  s.bounds.clear(), s.filters.clear(), s.tree_kinds.clear(), s.free.clear(), s.moved.clear(),
      s.pairs.clear();
  // Memory grows with the bytes actually read, not with the announced count.
  const std::uint64_t proxies = in.u64();
  for (std::uint64_t i = 0; i < proxies && in.ok(); ++i) read_slot(in);
  const std::uint64_t free = in.u64();
  in.check(free == static_cast<std::uint64_t>(
                       std::count(s.tree_kinds.begin(), s.tree_kinds.end(), TreeKind::none)));
  seen_.resize(s.tree_kinds.size());
  seen_.clear();
  for (std::uint64_t i = 0; i < free && in.ok(); ++i) {
    const std::uint64_t w = in.u64();
    in.check(w < s.tree_kinds.size() &&
             s.tree_kinds[static_cast<std::size_t>(w)] == TreeKind::none);
    if (!in.ok()) return;
    const auto index = static_cast<std::uint32_t>(w);
    in.check(!seen_.test(index));
    seen_.set(index);
    s.free.push_back(index);
  }
  const std::uint64_t pairs = in.u64();
  for (std::uint64_t i = 0; i < pairs && in.ok(); ++i) {
    const std::uint64_t key = in.u64();
    const ProxyPair pair = ProxyPair::of_key(key);
    in.check(pair.a < pair.b && pair.b < s.tree_kinds.size() &&
             s.tree_kinds[pair.a] != TreeKind::none && s.tree_kinds[pair.b] != TreeKind::none &&
             (s.pairs.empty() || s.pairs.back() < key));
    s.pairs.push_back(key);
  }
}

}  // namespace vp::collide
