#include "collide/pair_finder.h"

#include <cmath>

#include "vphysics/assert.h"

namespace vp::collide {
namespace {

// If more than one proxy in this many has moved, a query per moved proxy costs more than a join of
// the trees.
constexpr std::size_t kRebuildFraction = 6;
// Of a join of trees by several workers: many more than workers, since their sizes differ.
constexpr std::size_t kJoinParts = 64;

[[maybe_unused]] bool is_ordered(const Bounds& b) {  // false for NaN
  return b.lower.x <= b.upper.x && b.lower.y <= b.upper.y && b.lower.z <= b.upper.z;
}

FloatBounds enlarged(const Bounds& b, double margin, const Vec3& displacement) {
  Bounds e = grown(b, margin);
  for (int axis = 0; axis < 3; ++axis) {
    e.lower[axis] += std::min(displacement[axis], 0.0);
    e.upper[axis] += std::max(displacement[axis], 0.0);
  }
  return rounded_outward(e);
}

}  // namespace

PairFinder::TreeKind PairFinder::tree_kind_of(const FloatBounds& enlarged, Mobility mobility) {
  bool far = false;
  for (int axis = 0; axis < 3; ++axis) {
    far = far || enlarged.lower[axis] < -kUnbounded || enlarged.upper[axis] > kUnbounded;
  }
  if (mobility == Mobility::fixed) return far ? TreeKind::unbounded_fixed : TreeKind::fixed;
  return far ? TreeKind::unbounded_moving : TreeKind::moving;
}

void PairFinder::resize(std::size_t proxies) {
  bounds_.resize(proxies);
  filters_.resize(proxies);
  places_.resize(proxies, TreeKind::none);
  pair_counts_.resize(proxies, 0);
  moved_.resize(proxies);
  pending_.resize(proxies);
  // So that the first busy step need not allocate.
  const std::size_t capacity = 64 + 2 * bounds_.capacity();
  for (auto* list : {&candidates_, &new_keys_, &key_scratch_}) list->reserve(capacity);
  join_parts_.reserve(kJoinParts + 64);
  for (auto* list : {&moved_list_, &pending_list_}) list->reserve(capacity);
}

std::uint32_t PairFinder::add(const ProxyDesc& desc) {
  VP_ASSERT(is_ordered(desc.bounds) && desc.margin >= 0.0);
  if (free_.empty()) {
    free_.push_back(static_cast<std::uint32_t>(places_.size()));
    resize(places_.size() + 1);
  }
  const std::uint32_t index = free_.back();
  free_.pop_back();
  filters_[index] = {desc.category, desc.mask, desc.owner, desc.user};
  put(index, enlarged(desc.bounds, desc.margin, {}), desc.mobility);
  return index;
}

void PairFinder::remove(std::uint32_t proxy) {
  VP_ASSERT(exists(proxy));
  if (pair_counts_[proxy] > 0) {
    written_keys_.clear();
    pairs_.append_keys(written_keys_);
    for (const std::uint64_t key : written_keys_) {
      const ProxyPair pair = ProxyPair::of_key(key);
      if (pair.a == proxy || pair.b == proxy) remove_pair(pair.a, pair.b);
    }
  }
  take_out(proxy);
  moved_.reset(proxy);
  free_.push_back(proxy);
}

void PairFinder::take_out(std::uint32_t proxy) {
  const TreeKind tree_kind = places_[proxy];
  if (tree_kind == TreeKind::unbounded_fixed || tree_kind == TreeKind::unbounded_moving) {
    unbounded_.erase(std::lower_bound(unbounded_.begin(), unbounded_.end(), proxy));
  } else if (tree_kind != TreeKind::none && tree(tree_kind).contains(proxy)) {
    tree(tree_kind).remove(proxy);
  }
  pending_.reset(proxy);
  places_[proxy] = TreeKind::none;
}

void PairFinder::put(std::uint32_t proxy, const FloatBounds& bounds, Mobility mobility) {
  const TreeKind tree_kind = tree_kind_of(bounds, mobility);
  bounds_[proxy] = bounds;
  moved_.set(proxy);
  if (tree_kind != places_[proxy]) {
    take_out(proxy);
    places_[proxy] = tree_kind;
    if (tree_kind == TreeKind::unbounded_fixed || tree_kind == TreeKind::unbounded_moving) {
      unbounded_.insert(std::lower_bound(unbounded_.begin(), unbounded_.end(), proxy), proxy);
    }
  }
  if (tree_kind == TreeKind::fixed || tree_kind == TreeKind::moving) pending_.set(proxy);
}

bool PairFinder::enlarge(std::uint32_t proxy, const Bounds& bounds, double margin,
                         const Vec3& displacement) {
  VP_ASSERT(exists(proxy) && is_ordered(bounds) && margin >= 0.0);
  const FloatBounds larger = enlarged(bounds, margin, displacement);
  if (larger == bounds_[proxy]) return false;  // unbounded bounds never fit
  put(proxy, larger, is_moving(places_[proxy]) ? Mobility::moving : Mobility::fixed);
  return true;
}

void PairFinder::set_filter(std::uint32_t proxy, std::uint32_t category, std::uint32_t mask) {
  VP_ASSERT(exists(proxy));
  filters_[proxy].category = category;
  filters_[proxy].mask = mask;
  moved_.set(proxy);
}

void PairFinder::count_pair(std::uint64_t key, std::uint32_t change) {
  const ProxyPair pair = ProxyPair::of_key(key);
  pair_counts_[pair.a] += change;
  pair_counts_[pair.b] += change;
}

bool PairFinder::remove_pair(std::uint32_t i, std::uint32_t j) {
  const std::uint64_t key = ProxyPair::ordered(i, j).key();
  if (!pairs_.erase(key)) return false;
  count_pair(key, ~0u);  // subtracts one
  return true;
}

void PairFinder::rebuild(TreeKind tree_kind) {
  items_.clear();
  for (std::uint32_t i = 0; i < places_.size(); ++i) {
    if (places_[i] == tree_kind) items_.push_back({bounds_[i], i});
  }
  tree(tree_kind).build(items_);
}

void PairFinder::refresh(TreeKind tree_kind, std::size_t pending) {
  BoundingTree& t = tree(tree_kind);
  // More than half of the tree has changed since it was built: further updates cost about as much
  // as a rebuild, and give a worse tree.
  bool anew = 2 * (t.changes() + pending) > t.size();
  for (std::size_t k = 0; k < pending_list_.size() && !anew; ++k) {
    const std::uint32_t i = pending_list_[k];
    if (places_[i] != tree_kind) continue;
    const FloatBounds& b = bounds_[i];
    anew = !(t.contains(i) ? t.move(i, b) : t.insert(i, b));
  }
  if (anew) rebuild(tree_kind);
}

void PairFinder::refresh() {
  pending_list_.clear();
  pending_.append_to(pending_list_);
  if (pending_list_.empty()) return;
  pending_.clear();
  std::size_t pending[2] = {0, 0};
  for (const std::uint32_t i : pending_list_) ++pending[static_cast<std::size_t>(places_[i])];
  for (const TreeKind tree_kind : {TreeKind::fixed, TreeKind::moving}) {
    if (pending[static_cast<std::size_t>(tree_kind)] > 0) {
      refresh(tree_kind, pending[static_cast<std::size_t>(tree_kind)]);
    }
  }
}

void PairFinder::consider(std::uint32_t i, std::uint32_t j,
                          std::vector<std::uint64_t>& candidates) const {
  if (agree(filters_[i], filters_[j])) candidates.push_back(ProxyPair::ordered(i, j).key());
}

// The set is far larger than the inner caches: prefetches the following entries.
void PairFinder::take_candidates() {
  constexpr std::size_t kAhead = 16;
  const std::size_t n = candidates_.size();
  for (std::size_t k = 0; k < n; ++k) {
    pairs_.prefetch(candidates_[std::min(k + kAhead, n - 1)]);
    if (!pairs_.insert(candidates_[k])) continue;
    count_pair(candidates_[k], 1);
    new_keys_.push_back(candidates_[k]);
  }
}

void PairFinder::find_by_queries() {
  for (const std::uint32_t i : moved_list_) {
    const auto found = [&](std::uint32_t j) {
      if (i != j) consider(i, j, candidates_);
    };
    const FloatBounds& b = bounds_[i];
    if (places_[i] == TreeKind::moving) tree(TreeKind::fixed).overlapping(b, found);
    if (places_[i] == TreeKind::moving || places_[i] == TreeKind::fixed) {
      tree(TreeKind::moving).overlapping(b, found);
    }
  }
}

void PairFinder::find_by_join(const Workers& workers) {
  join_moving_with(tree(TreeKind::moving), workers);
  join_moving_with(tree(TreeKind::fixed), workers);
}

// As much memory for each part as the largest has needed: which pairs one finds varies.
void PairFinder::reserve_join_parts() {
  if (candidates_of_parts_.size() < join_parts_.size())
    candidates_of_parts_.resize(std::max(join_parts_.size(), kJoinParts + 64));
  std::size_t most = 64 + bounds_.capacity() / 8;
  for (const auto& candidates : candidates_of_parts_) most = std::max(most, candidates.capacity());
  for (auto& candidates : candidates_of_parts_) candidates.reserve(most);
}

// The order of the candidates does not matter.
void PairFinder::join_moving_with(const BoundingTree& other, const Workers& workers) {
  const BoundingTree& moving = tree(TreeKind::moving);
  if (!workers.scheduler) {
    const auto found = moved_pairs(candidates_);
    return &moving == &other ? moving.overlapping_pairs(found)
                             : moving.overlapping_pairs(other, found);
  }
  moving.divide_overlapping_pairs(other, kJoinParts, join_parts_);
  reserve_join_parts();
  workers.in_parallel(join_parts_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      candidates_of_parts_[k].clear();
      moving.overlapping_pairs_of(join_parts_[k], other, moved_pairs(candidates_of_parts_[k]));
    }
  });
  for (std::size_t k = 0; k < join_parts_.size(); ++k)
    candidates_.insert(candidates_.end(), candidates_of_parts_[k].begin(),
                       candidates_of_parts_[k].end());
}

void PairFinder::find_unbounded() {
  for (const std::uint32_t u : unbounded_) {
    const auto found = [&](std::uint32_t i) {
      const bool moves = is_moving(places_[i]) || is_moving(places_[u]);
      if (i != u && moves && enlarged_overlap(i, u)) consider(i, u, candidates_);
    };
    if (!moved_.test(u)) {
      for (const std::uint32_t i : moved_list_) found(i);
      continue;
    }
    for (std::uint32_t i = 0; i < places_.size(); ++i) {
      if (places_[i] != TreeKind::none) found(i);
    }
  }
}

void PairFinder::update(std::vector<ProxyPair>& found, const Workers& workers) {
  refresh();
  moved_list_.clear();
  moved_.append_to(moved_list_);
  if (moved_list_.empty()) return;
  candidates_.clear();
  new_keys_.clear();
  if (kRebuildFraction * moved_list_.size() > tree(TreeKind::moving).size()) {
    find_by_join(workers);
  } else {
    find_by_queries();
  }
  find_unbounded();
  take_candidates();
  moved_.clear();
  sort_keys(new_keys_, key_scratch_);
  for (const std::uint64_t key : new_keys_) found.push_back(ProxyPair::of_key(key));
}

void PairFinder::overlapping(const Bounds& box, std::vector<std::uint32_t>& found) const {
  const FloatBounds b = rounded_outward(box);
  const auto first = static_cast<std::ptrdiff_t>(found.size());
  const auto append = [&](std::uint32_t i) { found.push_back(i); };
  for (const std::uint32_t u : unbounded_) {
    if (overlap(bounds_[u], b)) append(u);
  }
  for (const BoundingTree& t : trees_) t.overlapping(b, append);
  std::sort(found.begin() + first, found.end());
}

bool PairFinder::incoming_fits() const {
  const State& s = incoming_;
  if (s.tree_kinds.size() != places_.size() || s.free != free_) return false;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    if ((s.tree_kinds[i] == TreeKind::none) != (places_[i] == TreeKind::none)) return false;
    if (places_[i] == TreeKind::none) continue;
    if (is_moving(s.tree_kinds[i]) != is_moving(places_[i]) || s.filters[i] != filters_[i])
      return false;
  }
  return true;
}

// A rollback of a few steps changes few bounds: then the trees are updated, not rebuilt.
void PairFinder::adopt() {
  State& s = incoming_;
  const bool same = s.tree_kinds == places_;
  if (!same) {
    for (BoundingTree& t : trees_) t.clear();
    unbounded_.clear();
    places_.clear();  // resize() then sets all to none
    resize(s.tree_kinds.size());
    pending_.clear();
  }
  for (std::uint32_t i = 0; i < s.tree_kinds.size(); ++i) {
    const bool bounded = s.tree_kinds[i] == TreeKind::fixed || s.tree_kinds[i] == TreeKind::moving;
    if (bounded && !(same && s.bounds[i] == bounds_[i])) pending_.set(i);
    if (!same && !bounded && s.tree_kinds[i] != TreeKind::none) unbounded_.push_back(i);
  }
  bounds_.swap(s.bounds);
  filters_.swap(s.filters);
  places_.swap(s.tree_kinds);
  free_.swap(s.free);
  moved_.clear();
  for (const std::uint32_t i : s.moved) moved_.set(i);
  std::fill(pair_counts_.begin(), pair_counts_.end(), 0);
  pairs_.clear();
  for (const std::uint64_t key : s.pairs) {
    pairs_.insert(key);
    count_pair(key, 1);
  }
  moved_list_.clear();
  refresh();
}

}  // namespace vp::collide
