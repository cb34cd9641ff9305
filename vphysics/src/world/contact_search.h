// Finds the contacts of the sub-stepped bodies and updates their manifolds.
//
//   find_pairs   new pairs of the broad phase become contacts
//   update       removes the dirty contacts whose enlarged bounds have separated and tests the
//                others; dirty are those that may have moved by more than a small amount since the
//                last test. All other contacts keep their slots, whose separations follow the
//                bodies' displacements (contact_block.h)
//   find_again   before a sub-step: the same for bodies whose velocity has changed since
//
// Reads the bodies, their colliders and solver states. Writes the contact store, and reports the
// events of contacts that end and of sensors. Wakes bodies that a manifold connects.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "world/manifold_writer.h"
#include "world/runs.h"
#include "world/step_context.h"

namespace vp {

// The result of the narrow phase for one contact.
struct NarrowPhaseResult {
  std::uint32_t contact;
  collide::Manifold manifold;
  double margin, margin_at_rest;  // search distances, with motion and at rest [m]
  Clearance clearance;
  collide::MotionToImpact to_impact;
  bool taken_over = false;  // the contact had no points and gets none: its clearance is set
  // Of a contact with parts: `count` manifolds of a PartSearch from `first` on.
  std::uint32_t search = 0, first = 0, count = 0;
};

// Memory of the narrow phase of contacts with parts, for those that one worker tests together.
struct PartSearch {
  std::vector<collide::KnownPart> known;  // of the present contact
  collide::ManifoldScratch scratch;
  collide::CastScratch cast;
  std::vector<collide::SubManifold> manifolds;  // of all contacts
};

// What find_again() has changed.
struct SearchedAgain {
  bool has_new_slots = false;  // contact slots, new or with other points
  bool has_old_slots = false;  // of those that had impulses before, or woken bodies
  bool has_woken = false;      // bodies, whose slots have no inertias yet
};

class ContactSearch {
 public:
  explicit ContactSearch(const StepContext& context) : s_(context), writer_(context) {}

  // Reserves memory for a number of contacts.
  void begin_step(std::size_t contacts);
  // Swept bodies and links collide only in the impact stage. A sleeping body collides with bodies
  // that were created or moved by the user since the last step, and with links.
  bool is_needed() const;
  void find_pairs();
  void update(double dt, const ContactRuns& runs);
  // left: remaining time of the step. has_woken is left to the caller, who updates the body lists.
  // precessing: bodies whose touching contacts are renewed in any case.
  SearchedAgain find_again(double left, std::span<const std::uint32_t> precessing);
  // Removes a contact and its pair of the broad phase.
  void drop(std::uint32_t contact);
  // Manifolds put into contact slots in this step.
  std::uint32_t renewed() const { return renewed_; }

 private:
  // The state at the start of the step of a body in its pose of a sub-step.
  struct BodyAtStart {
    std::uint32_t body;
    SE3 T;
    Vec3 w, v;
  };

  // What becomes of a dirty contact.
  enum class Verdict : std::uint8_t { skip, separated, test };

  // find_contacts.cpp
  void find_new_contacts();
  void drop_separated_link_contacts();
  bool has_separated(const Contact& contact) const;
  void add_contact_pair(std::uint32_t collider_i, std::uint32_t collider_j);
  void find_dirty_contacts(double dt, const ContactRuns& runs);
  void list_dirty_contacts(const ContactRuns& runs);
  Verdict judge(const Contact& contact) const;
  void find_manifolds_of(std::span<const std::uint32_t> contacts, double dt);
  void find_manifold_of(Contact& contact, NarrowPhaseResult& found, const Approach& approach,
                        PartSearch& search) const;
  void find_convex(Contact& contact, NarrowPhaseResult& found, const Approach& approach) const;
  bool stays_without_points(const Contact& contact, const NarrowPhaseResult& found) const;
  // within_step: contact slots that have impulses in this step are kept.
  void take_over(const NarrowPhaseResult& found, bool within_step);
  void assign_slot(std::uint32_t contact, const collide::Manifold& manifold,
                   const collide::MotionToImpact& to_impact);
  // part_contacts.cpp
  void find_parts(const Contact& contact, NarrowPhaseResult& found, const Approach& approach,
                  PartSearch& search) const;
  std::span<collide::SubManifold> parts_of(const NarrowPhaseResult& found);
  void note_part_searches();
  void reserve_part_searches();
  void take_over_parts(const NarrowPhaseResult& found, bool within_step);
  // find_again.cpp
  void load_inertias_of(const Contact& contact);
  bool list_deviating_bodies(double left);
  void advance_within_step(std::uint32_t body, const BodyStates& states);
  void list_contacts_of_deviating(double left, const BodyStates& states);
  void list_contacts_of_precessing(std::span<const std::uint32_t> precessing);
  void take_contacts_to_test(const BodyStates& states);

  const StepContext s_;
  ManifoldWriter writer_;
  std::uint32_t renewed_ = 0;
  // Contacts without a slot that the next step must test: sensors, and those that have to wait.
  std::vector<std::uint32_t> dirty_next_step_;

  // --- scratch; keeps its capacity between steps
  std::vector<collide::ProxyPair> new_pairs_;
  std::vector<std::uint32_t> dirty_;  // contacts of this iteration
  std::vector<Verdict> verdicts_;     // of each of them
  std::vector<NarrowPhaseResult> results_;
  std::vector<PartSearch> part_searches_;
  std::vector<std::uint32_t> old_parts_, claimed_parts_;  // of a contact with parts
  std::vector<std::uint8_t> deviates_;                    // of each awake body
  std::vector<std::uint32_t> deviating_;                  // bodies
  std::vector<BodyAtStart> advanced_;
};

}  // namespace vp
