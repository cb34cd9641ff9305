// Gyroscopic torque within a step.
//
// With the torque of the start of the step (body_states.cpp), a top that precesses would lose its
// spin, in proportion to the square of the angle by which it precesses in a step. Instead, such
// bodies rotate in each sub-step as free bodies do between impulses. Joints in blocks follow their
// rotation; bodies with joints in rows keep the torque of the start. Contacts do not follow, so
// those of a top are searched for again before each sub-step: otherwise the arms of the start of
// the step would spin it up. This costs much more than a contact of other bodies, so it is for
// tops, not for what tumbles down: for bodies that rotate about an axis of symmetry, with several
// times the energy that it takes to lift them by their own radius.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "solve/body_state.h"
#include "solve/contact_graph.h"
#include "solve/passes.h"
#include "world/body.h"
#include "world/regions.h"

namespace vp {

// Whether a body precesses in a step dt that is about to begin. gyroscopic: its angular
// acceleration without torques; weight: the magnitude of gravity on it [m/s^2].
bool precesses(const Body& body, const Vec3& gyroscopic, double weight, double dt, int sub_steps);

// Whether its contacts must follow it. Precondition: it precesses.
bool is_top(const Body& body, double weight, double dt);

class Precession {
 public:
  void reserve(std::size_t bodies);
  // Lists the bodies with Body::precesses. regions: with kSharedRegion.
  void list(const Bodies& bodies, const Regions& regions, std::size_t count);
  bool empty() const { return bodies_.empty(); }
  // Those that are tops.
  std::span<const std::uint32_t> on_contacts() const { return on_contacts_; }
  // Whether joints in the region may be of bodies that precess.
  bool concerns(std::size_t region) const {
    return region == solve::kSharedRegion ? !empty() : !in(region).empty();
  }
  // After the states of a region have moved by a sub-step h. Adds the changes of angular velocity
  // to `before`: to the velocities before the contacts of the sub-step, of each body.
  void rotate(std::size_t region, std::span<solve::BodyState> states,
              std::span<const solve::StartDisplacement> start_displacements,
              std::span<solve::VelocityChange> before, double h) const;

 private:
  std::span<const std::uint32_t> in(std::size_t region) const {
    return std::span(bodies_).subspan(first_[region], first_[region + 1] - first_[region]);
  }

  std::vector<std::uint32_t> bodies_;  // by region
  std::vector<std::uint32_t> on_contacts_;
  std::vector<solve::BodyInertia> inertias_;
  std::vector<std::size_t> first_;
};

}  // namespace vp
