#include "world/impact_pairs.h"

#include <algorithm>
#include <utility>

namespace vp {
namespace {

// Margin of the cached bounds beyond a body's swept bounds, so that they remain valid for some
// steps: contact slops, for bodies that move a little, and displacements of a step. Each candidate
// costs a comparison in every iteration.
constexpr double kCandidateSlops = 10.0, kCandidateSteps = 2.0;
// Up to this many, plus a fraction of all bodies, each searches among all bodies on its own. If
// more bodies have left their bounds, one broad phase over all bodies finds all pairs.
constexpr std::size_t kFewLeavers = 6;

bool collides_discretely(const Body& body) {
  return body.alive && body.first_collider != kNone && (!body.continuous || body.has_sensor);
}

}  // namespace

double travel(const Body& body, const collide::Motion& m, double h) {
  if (body.motion == Motion::fixed) return 0.0;
  return (norm(m.v) + norm(m.w) * body.bounding_radius) * h;
}
double travel_of_bounds(const Body& body, const collide::Motion& m, double h) {
  return collide::empty(body.around_line) ? travel(body, m, h) : norm(m.v) * h;
}

// --- swept ---------------------------------------------------------------------------------------

void SweptBodyPairs::reserve(std::size_t bodies, std::size_t pairs) {
  pairs_.reserve(pairs);
  edges_.reserve(2 * pairs);
  leavers_.reserve(bodies);
}

void SweptBodyPairs::keep_bounds(const BodyMotions& all, std::uint32_t index, double slop,
                                 double h) {
  const collide::Bounds& now = all.bounds[index];
  const double margin =
      kCandidateSlops * slop +
      kCandidateSteps * travel_of_bounds(all.bodies[index], all.motions[index], h);
  cached_bounds_[index] = collide::empty(now) ? now : grown(now, margin);
}

void SweptBodyPairs::find_all(const BodyMotions& all, double slop, double h) {
  const Bodies& bodies = all.bodies;
  dirty_ = false;
  cached_bounds_.resize(bodies.size());
  sweeps_.resize(bodies.size());
  for (std::uint32_t i = 0; i < bodies.size(); ++i) {
    sweeps_[i] = bodies[i].alive && bodies[i].continuous;
    keep_bounds(all, i, slop, h);
  }
  pairs_.clear();
  broad_phase_.find_pairs(cached_bounds_, sweeps_, pairs_);
  std::erase_if(pairs_, [&bodies](const collide::IndexPair& p) {
    return !may_overlap(bodies[p.a], bodies[p.b]);
  });
  first_edges_.assign(bodies.size(), kNone);
  edges_.resize(2 * pairs_.size());
  for (std::uint32_t k = 0; k < pairs_.size(); ++k) link_pair(k);
}

void SweptBodyPairs::link_edge(std::uint32_t body, std::uint32_t edge, std::uint32_t other) {
  const std::uint32_t next = std::exchange(first_edges_[body], edge);
  edges_[edge] = {other, next, kNone};
  if (next != kNone) edges_[next].previous = edge;
}
void SweptBodyPairs::unlink_edge(std::uint32_t body, std::uint32_t edge) {
  const Edge& e = edges_[edge];
  (e.previous == kNone ? first_edges_[body] : edges_[e.previous].next) = e.next;
  if (e.next != kNone) edges_[e.next].previous = e.previous;
}
void SweptBodyPairs::link_pair(std::uint32_t pair) {
  const auto [a, b] = pairs_[pair];
  link_edge(a, 2 * pair, b);
  link_edge(b, 2 * pair + 1, a);
}

// Moves the last pair to its index.
void SweptBodyPairs::remove_pair(std::uint32_t pair) {
  const auto unlink = [this](std::uint32_t k) {
    unlink_edge(pairs_[k].a, 2 * k);
    unlink_edge(pairs_[k].b, 2 * k + 1);
  };
  unlink(pair);
  const auto last = static_cast<std::uint32_t>(pairs_.size() - 1);
  if (pair != last) {
    unlink(last);
    pairs_[pair] = pairs_[last];
    link_pair(pair);
  }
  pairs_.pop_back();
  edges_.resize(2 * pairs_.size());
}

void SweptBodyPairs::find_of(const Bodies& bodies, std::uint32_t index) {
  while (first_edges_[index] != kNone) remove_pair(first_edges_[index] / 2);
  for (std::uint32_t j = 0; j < bodies.size(); ++j) {
    if (j == index || !(sweeps_[index] || sweeps_[j]) || collide::empty(cached_bounds_[j]))
      continue;
    if (!overlap(cached_bounds_[index], cached_bounds_[j]) ||
        !may_overlap(bodies[index], bodies[j]))
      continue;
    pairs_.push_back({std::min(index, j), std::max(index, j)});
    edges_.resize(2 * pairs_.size());
    link_pair(static_cast<std::uint32_t>(pairs_.size() - 1));
  }
}

// Bodies that left their cached bounds search again: one by one, or, if they are many, all
// together.
std::span<const collide::IndexPair> SweptBodyPairs::find(const BodyMotions& all,
                                                         std::span<const std::uint32_t> moving,
                                                         double slop, double h) {
  leavers_.clear();
  if (!dirty_) {
    for (const std::uint32_t i : moving) {
      if (!holds(cached_bounds_[i], all.bounds[i])) leavers_.push_back(i);
    }
  }
  if (dirty_ || leavers_.size() > kFewLeavers + all.bodies.size() / 64) {
    find_all(all, slop, h);
    return pairs_;
  }
  for (const std::uint32_t i : leavers_) keep_bounds(all, i, slop, h);
  for (const std::uint32_t i : leavers_) find_of(all.bodies, i);
  return pairs_;
}

// --- discrete ------------------------------------------------------------------------------------

void DiscreteBodyPairs::list_filters(const Bodies& bodies) {
  categories_ = masks_ = 0;
  for (const Body& body : bodies) {
    if (!collides_discretely(body)) continue;
    categories_ |= body.categories;
    masks_ |= body.masks;
  }
}

void DiscreteBodyPairs::reserve(std::size_t bodies, std::size_t pairs) {
  pairs_.reserve(pairs);
  bounds_.resize(bodies);
  movable_.resize(bodies);
}

// Bounds of bodies that may be in a pair, empty for the others; false if there are fewer than two.
bool DiscreteBodyPairs::find_bounds(const BodyMotions& all) {
  if ((categories_ & masks_) == 0) return false;
  const Bodies& bodies = all.bodies;
  collide::Bounds around;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Body& body = bodies[i];
    if (collides_discretely(body) && (body.is_link || body.continuous))
      around = merged(around, all.bounds[i]);
  }
  int meeting = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Body& body = bodies[i];
    const bool collides = collides_discretely(body) && (body.categories & masks_) &&
                          (body.masks & categories_) && overlap(all.bounds[i], around);
    bounds_[i] = collides ? all.bounds[i] : collide::Bounds{};
    movable_[i] = body.alive && body.motion != Motion::fixed;
    meeting += collides ? 1 : 0;
  }
  return meeting > 1;
}

std::span<const collide::IndexPair> DiscreteBodyPairs::find(const BodyMotions& all) {
  pairs_.clear();
  if (find_bounds(all)) broad_phase_.find_pairs(bounds_, movable_, pairs_);
  return pairs_;
}

}  // namespace vp
