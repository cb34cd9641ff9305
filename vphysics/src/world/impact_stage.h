// The impact stage: moves continuous bodies and links through a step in the order of time.
//
//   begin_step          pairs, warm starts for the length of the step
//   integrate_forces    of the bodies that no sub-step moves
//   note_sub_steps_of   the other bodies: how the sub-steps have moved them
//   run                 repeat   solve the current contacts
//                                advance everything at constant twists to the next impact of a
//                                continuous body
//                       until the end of the step; after max_impacts_per_step impacts, bodies that
//                       would collide stop
//
// Reads colliders, joints and loads. Writes poses and velocities of bodies and articulations, the
// records of pairs, events, status and counters. Wakes bodies that a moving one may meet.
//
// See docs/decisions/0002-impacts-and-contacts.md.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "collide/sweep.h"
#include "world/impact_pairs.h"
#include "world/impact_queue.h"
#include "world/pair_contacts.h"
#include "world/row_solve.h"

namespace vp {

class ImpactStage {
 public:
  ImpactStage(const StepContext& context, PairContacts& pair_contacts, RowSolve& rows)
      : s_(context), pair_contacts_(pair_contacts), rows_(rows) {}

  // The lists of bodies have changed.
  void list_bodies();
  // A fixed body was moved.
  void invalidate_pairs() { swept_body_pairs_.invalidate(); }

  // Reserves memory for a number of pairs.
  void begin_step(double dt, std::size_t pairs);
  // Stores the poses at the start of the step: before the sub-steps, and when bodies have woken
  // within one, since poses change only after them.
  void note_start();
  void integrate_forces(double dt);
  // drift: mean velocity over the step less that at its end.
  void note_sub_steps_of(std::uint32_t body, const Velocity& drift);
  std::span<Velocity> drift() { return drift_; }
  void run(double dt);

  // State: the length of the step that impulses in rows and records are from, 0: none yet [s].
  double step_length() const { return step_length_; }
  void set_step_length(double length) { step_length_ = length; }

 private:
  // Whether the current impact affects a body.
  enum class Affected : std::uint8_t { none, listed, searched };

  // impact_motions.cpp
  const std::vector<std::uint32_t>& moving_bodies() const { return s_.lists.of_impacts(s_.bodies); }
  void rescale_impulses(double dt);
  void reserve(std::size_t pairs);
  void load_bodies(std::span<const std::uint32_t> of);
  void refresh_motions(double h);
  void refresh_motion_of(std::uint32_t body, double h);
  void refresh_displacements(double h);
  void advance_discrete_contacts(double h);
  void apply_corrections(std::span<const std::uint32_t> of);
  void take_back_forces(double h);

  // remote.cpp
  bool is_near_awake_body(const collide::Bounds& box) const;
  void collide_remote(double h);
  void make_remote();

  // pairs.cpp
  BodyMotions body_motions() const { return {s_.bodies, motions_, bounds_}; }
  ImpactTimes impact_times() {
    return {s_.colliders, motions_, s_.desc.contact_slop, s_.shapes.parts_scratch};
  }
  void refresh_bounds(double h);
  void refresh_bounds_of(std::uint32_t body, double h);
  double discrete_margin(const ColliderPair& pair, double h) const;
  void find_discrete_pairs(double h);
  void find_touching_pairs(double h);
  void find_swept_pairs(double h);
  void add_swept_pairs_of(const collide::IndexPair& pair, double h);
  void add_swept_pairs(std::uint32_t swept_body, std::uint32_t other_body, double h);
  void sort_swept_pairs();

  // impact_contacts.cpp
  void find_discrete_contacts(double h);
  void find_swept_contacts(bool warm);
  void note_touched_articulations();
  RowJointStep row_joint_step(double h, double dt, bool first) const;
  bool solve_instant(std::span<const std::uint32_t> solved, double h, double dt, bool first);
  void solve_contacts(double h, double dt, bool first);
  void remove_cancelled_forces(std::uint32_t body, const Vec3& change_w, const Vec3& change_v);

  // impact_articulations.cpp
  void integrate_articulations(double dt);
  bool integrate_saturated_again(double dt, bool solved, bool all_become_rows);
  void begin_solve_articulations(bool first);
  void end_solve_articulations(bool first);
  void store_implicit_impulses();
  void advance_articulations(double h);
  void stop_body(std::uint32_t body);

  // impacts.cpp
  void queue_swept_pairs(double now, double h);
  double time_of(const SweptPair& swept, double h);
  void update_waiting(std::uint32_t pair, const Instant& now);
  bool next_impact(const Instant& now, Instant& next);
  void report_reached_sensors();
  void advance_to(std::uint32_t body, const Instant& now);
  void advance_affected(std::uint32_t body, const Instant& now);
  void move_within_step(std::uint32_t body, double h, bool freely);
  void mark_affected(std::uint32_t body);
  void advance_links(const Instant& previous, const Instant& now);
  void refresh_links(double h);
  void mark_colliding_bodies_affected(const Instant& now);
  bool touches_at(const QueuedPair& pair, const Instant& now);
  void mark_touching_bodies_affected(const Instant& now);
  void find_swept_pairs_of(std::uint32_t body, const Instant& now, double h);
  void find_swept_pairs_of_affected(const Instant& now);
  void solve_impact(const Instant& previous, const Instant& now);
  void stop_swept_pairs(const Instant& now, double h);
  void stop_colliding_bodies(const Instant& now);
  void advance_to_end(const Instant& now);

  const StepContext s_;
  PairContacts& pair_contacts_;
  RowSolve& rows_;
  double step_length_ = 0.0;
  std::size_t reserved_ = 0;  // number of pairs
  // Bodies were added or removed: drift and forced of bodies outside the list may not be 0.
  bool scratch_is_dirty_ = true;
  SweptBodyPairs swept_body_pairs_;
  DiscreteBodyPairs discrete_body_pairs_;

  // --- of each body
  std::vector<SE3> start_poses_;
  std::vector<collide::Motion> motions_;     // for the rest of the step
  std::vector<collide::Bounds> bounds_;      // swept bounds for the rest of the step
  std::vector<Velocity> drift_;              // mean velocity over the step less that at its end
  std::vector<Velocity> forced_;             // velocity change from the step's forces
  std::vector<std::uint8_t> stopped_;        // at rest for the rest of the step
  std::vector<std::uint8_t> in_contact_;     // in a swept contact of the last solve
  std::vector<std::uint8_t> moves_rigidly_;  // moves to its next impact at the twist of its sweep
  // Of a free body: the time within the step of its pose. Links are at the last impact.
  std::vector<double> times_;
  std::vector<std::uint8_t> advanced_;  // has advanced within the step
  std::vector<Affected> affected_flags_;
  std::vector<double> first_impacts_;  // among the pairs that are being queued [s]

  // --- of an impact
  std::vector<std::uint32_t> affected_, moved_;  // bodies
  std::vector<std::uint32_t> reached_sensors_;   // pairs of the queue
  std::vector<ColliderPair> discrete_pairs_;
  std::vector<SweptPair> swept_pairs_;
  std::vector<solve::ContactConstraint> discrete_contacts_, contacts_;

  ImpactQueue queue_;  // of a step
};

}  // namespace vp
