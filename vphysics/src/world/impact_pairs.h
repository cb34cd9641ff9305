// Broad phase of the impact stage: pairs with a swept body, and discrete pairs. Times of impact of
// the colliders in swept pairs.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "collide/broad_phase.h"
#include "collide/manifolds.h"
#include "collide/shape_query.h"
#include "collide/sweep.h"
#include "world/collider.h"

namespace vp {

// Upper bound of the displacement of any point of the body within h.
double travel(const Body& body, const collide::Motion& motion, double h);
// The same for the body's bounds. Ignores rotation if the bounds contain the body in all its
// rotations (around_line).
double travel_of_bounds(const Body& body, const collide::Motion& motion, double h);

// Of each body: its motion for the rest of the step, and its swept bounds for it.
struct BodyMotions {
  const Bodies& bodies;
  std::span<const collide::Motion> motions;
  std::span<const collide::Bounds> bounds;
};

// Pairs of bodies, one of them continuous, that may collide within the step while the bounds of
// both stay within their cached bounds. Pairs that filters exclude are left out. The pairs persist
// between steps but do not affect results: each iteration tests again which of them are close
// enough.
class SweptBodyPairs {
 public:
  // Bodies or colliders were added or removed, or a fixed body was moved: cached bounds of fixed
  // bodies are not updated otherwise.
  void invalidate() { dirty_ = true; }
  bool dirty() const { return dirty_; }
  void reserve(std::size_t bodies, std::size_t pairs);

  // moving: all bodies whose bounds may have changed, ascending.
  std::span<const collide::IndexPair> find(const BodyMotions& all,
                                           std::span<const std::uint32_t> moving, double slop,
                                           double h);
  // Calls f with the other body of each pair of the body. Their order depends on earlier steps.
  template <class F>
  void for_each_partner(std::uint32_t body, const F& f) const {
    for (std::uint32_t e = first_edges_[body]; e != kNone; e = edges_[e].next) f(edges_[e].other);
  }
  bool empty() const { return pairs_.empty(); }
  bool sweeps(std::uint32_t body) const { return sweeps_[body] != 0; }

 private:
  // Edges 2 k and 2 k + 1 are those of pair k, in the lists of its bodies a and b.
  struct Edge {
    std::uint32_t other;  // body
    std::uint32_t next, previous;
  };

  void keep_bounds(const BodyMotions& all, std::uint32_t body, double slop, double h);
  void find_all(const BodyMotions& all, double slop, double h);
  void find_of(const Bodies& bodies, std::uint32_t body);
  void link_edge(std::uint32_t body, std::uint32_t edge, std::uint32_t other);
  void unlink_edge(std::uint32_t body, std::uint32_t edge);
  void link_pair(std::uint32_t pair);
  void remove_pair(std::uint32_t pair);

  bool dirty_ = true;
  std::vector<collide::IndexPair> pairs_;
  std::vector<Edge> edges_;
  std::vector<std::uint32_t> first_edges_;  // of each body
  std::vector<collide::Bounds> cached_bounds_;
  std::vector<std::uint8_t> sweeps_;  // of each body: whether it is continuous
  collide::BroadPhase broad_phase_;
  std::vector<std::uint32_t> leavers_;  // bodies that left their cached bounds; scratch
};

// Pairs with a link, or with a continuous body that has a sensor.
class DiscreteBodyPairs {
 public:
  // Bodies or colliders were added or removed.
  void list_filters(const Bodies& bodies);
  void reserve(std::size_t bodies, std::size_t pairs);
  std::span<const collide::IndexPair> find(const BodyMotions& all);

 private:
  bool find_bounds(const BodyMotions& all);

  std::uint32_t categories_ = 0, masks_ = 0;  // union over all bodies that may be in a pair
  collide::BroadPhase broad_phase_;
  std::vector<collide::Bounds> bounds_;
  std::vector<std::uint8_t> movable_;
  std::vector<collide::IndexPair> pairs_;
};

// A pair in which one collider is swept against the other. separation: the current one.
struct SweptPair {
  ColliderPair pair;
  bool swept_is_a;
  bool sensor;
  double separation;
};

// Times of impact (pairs.cpp).
struct ImpactTimes {
  const Colliders& colliders;
  std::span<const collide::Motion> motions;  // of each body
  double slop;
  collide::PartsScratch& parts;

  double tolerance() const { return 0.05 * slop; }
  // Time until the separation decreases to target; negative: not within h.
  double until(const SweptPair& pair, double target, double h) const;
  // Shapes with parts: exact only up to the contact slop; larger separations return margin.
  double separation(const Collider& moving, const Collider& other, double margin,
                    collide::ManifoldScratch& scratch,
                    std::vector<collide::SubManifold>& manifolds) const;
  collide::SweepQuery sweep_query(const SweptPair& pair, double h) const;
};

}  // namespace vp
