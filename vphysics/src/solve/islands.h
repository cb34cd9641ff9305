// Groups the contacts and joint rows of an instant into islands. No movable body belongs to two
// islands, so islands do not affect one another.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "solve/contact_solver.h"

namespace vp::solve {

// A unit that responds to impulses: a body, or a complete articulation.
using MovingBodyKey = std::uint64_t;
inline MovingBodyKey key_of_articulation(std::uint32_t articulation) {
  return (MovingBodyKey{1} << 32) | articulation;
}

// Calls f(key) for each body or articulation that an impulse of a contact, or of a row of a joint
// between bodies, moves.
template <class F>
void for_moving_bodies_of(const StepContext& s, std::uint32_t body, bool moves,
                          const LinkSide& side, const F& f) {
  if (moves) f(MovingBodyKey{body});
  if (side.depth == 0) return;
  f(key_of_articulation(static_cast<std::uint32_t>(s.bodies[body].articulation)));
}
template <class F>
void for_moving_bodies(const StepContext& s, const ContactConstraint& c, const F& f) {
  for_moving_bodies_of(s, c.a, c.moves_a, c.side_a, f);
  for_moving_bodies_of(s, c.b, c.moves_b, c.side_b, f);
}
template <class F>
void for_moving_bodies(const StepContext& s, const JointPair& pair, const F& f) {
  for (const PairEnd* end : {&pair.a, &pair.b}) {
    for_moving_bodies_of(s, end->body, end->moves, end->side, f);
  }
}

struct Island {
  std::uint32_t first_contact, end_contact;  // of Islands::contacts
  std::uint32_t first_joint, end_joint;      // of Islands::joints
  std::uint32_t rows;
};

class Islands {
 public:
  void reserve(std::size_t contacts, std::size_t joints) {
    islands_.reserve(contacts);
    contacts_.reserve(contacts);
    joints_.reserve(joints);
    ends_.reserve(2 * (contacts + joints));
    parent_.reserve(contacts + joints);
    island_of_.reserve(contacts + joints);
    island_of_joint_.reserve(joints);
  }
  // Finds the islands of contacts and of rows of joints between bodies, and of the rows of the
  // articulations that they move. Precondition: the contacts and these rows are prepared.
  void find(const StepContext& context);

  std::span<Island> all() { return islands_; }
  std::span<const Island> all() const { return islands_; }
  // Indices into the context, ascending.
  std::span<const std::uint32_t> contacts(const Island& island) const {
    return std::span(contacts_).subspan(island.first_contact,
                                        island.end_contact - island.first_contact);
  }
  std::span<const std::uint32_t> joints(const Island& island) const {
    return std::span(joints_).subspan(island.first_joint, island.end_joint - island.first_joint);
  }

 private:
  std::uint32_t root_of(std::uint32_t node);
  void join_nodes(const StepContext& context);
  void number_islands(const StepContext& context);
  void add_joints(const StepContext& context);

  std::vector<Island> islands_;
  std::vector<std::uint32_t> contacts_, joints_;
  // Nodes are the contacts, then the rows of joints between bodies.
  std::vector<std::pair<MovingBodyKey, std::uint32_t>> ends_;  // a unit, and a node on it
  std::vector<std::uint32_t> parent_;                          // of each node: union-find
  std::vector<std::uint32_t> island_of_;                       // of each node
  std::vector<std::uint32_t> island_of_joint_;
};

}  // namespace vp::solve
