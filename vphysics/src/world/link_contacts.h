// Contacts between links and sub-stepped bodies, in the sub-steps.
//
// An articulation that supports a body takes part in the sub-steps, together with everything that
// it touches. So does one that turns far in a step and has no colliders. In each sub-step its
// forces are integrated; its joint rows and contacts are solved in iterations, alternating with the
// contact blocks and the joints of bodies; and it moves. It responds to impulses through its own
// joints (solve/link_side.h), so no joint separates under a load. Afterwards it returns to its pose
// at the start of the step. The impact stage then moves it, with everything else, along its mean
// velocities, so that swept bodies collide with it on its path.
//
// Other articulations are left to the impact stage, with their contacts.
//
//   find_bodies       after the broad phase: bodies near links, articulations that take part
//   find_fast         afterwards: articulations without colliders that turn far
//   begin_sub_steps   contacts of the links
//   begin_sub_step, iterate, move, relax   in each sub-step
//   end_sub_steps     events, warm starts; the articulations return to their start
//
// Reads the contact store and the joints in rows. Writes the bodies' solver states, the
// articulations and their links. Wakes bodies near links.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "world/pair_contacts.h"
#include "world/row_solve.h"

namespace vp {

class LinkContacts {
 public:
  LinkContacts(const StepContext& context, PairContacts& pair_contacts, RowSolve& rows)
      : s_(context), pair_contacts_(pair_contacts), rows_(rows) {}

  // Reserves memory for a number of contacts.
  void begin_step(std::size_t contacts);
  void find_bodies();
  // Adds the articulations without colliders and joints to bodies that turn far in a step dt.
  void find_fast(double dt);
  // No articulation takes part.
  bool empty() const { return is_empty_; }
  void begin_sub_steps(double dt, int sub_steps);
  // Integrates the forces of the sub-step and prepares the solver's data.
  void begin_sub_step(double h);
  void iterate(double h);
  // Advances the contacts' separations with their bodies. The articulations are not relaxed yet.
  void move(double h);
  void relax(double h);
  // drift: of each body; sets that of the links: mean velocity over the step less that at its end.
  void end_sub_steps(double dt, int sub_steps, std::span<Velocity> drift);

 private:
  void find_joined_bodies();
  void put_on_link(std::uint32_t body, Articulation& articulation);
  solve::StepContext context(double h);
  RowJointStep row_joint_step(double h) const;
  void load_body(std::uint32_t body, double h);
  void load_bodies();
  void store_bodies();

  const StepContext s_;
  PairContacts& pair_contacts_;
  RowSolve& rows_;
  bool is_empty_ = true;
  std::vector<std::uint32_t> bodies_;  // on links: in contact with or joined to one
  std::vector<solve::ContactConstraint> contacts_;
  std::vector<Velocity> forced_;     // of links: change from a sub-step's forces
  std::size_t reserved_ = 0;         // number of contacts
  std::vector<ColliderPair> pairs_;  // scratch
};

}  // namespace vp
