// Results of a step: its degradations and its statistics.
#pragma once

#include <array>
#include <cstdint>

namespace vp {

// Flags of a step that had to degrade. The step finishes all the same. A step omits nothing without
// setting one of them.
struct StepStatus {
  bool impact_limit = false;    // Limit::impacts
  bool non_finite = false;      // Limit::range
  bool bounce_limit = false;    // Limit::bounces
  bool manifold_limit = false;  // Limit::manifolds
  bool distance_limit = false;  // Limit::distances
  bool colour_limit = false;    // Limit::colours
  bool position_error = false;  // Limit::positions
  double time_lost = 0.0;       // the part of dt lost to impact_limit [s]

  StepStatus& operator|=(const StepStatus& other);  // combines the flags and adds the times
};

enum class Limit : std::uint8_t {
  // The world had max_impacts_per_step impacts. Bodies that would have collided again, and those
  // that would have run into them, stopped for the rest of the step.
  impacts,
  // A body or an articulation left the range of numbers, or a joint moved no inertia. It was
  // stopped in place.
  range,
  // Restitution still propagated through touching bodies after the 64 iterations of a sub-step. The
  // remaining approach speeds were stopped, as if the restitution were 0.
  bounces,
  // A convex shape touched a mesh or a height field with more than 12 different normals. Each one
  // past the twelfth was merged into the most similar of the twelve.
  manifolds,
  // Shapes overlap, and the search for their penetration depth reached its iteration limit with an
  // error above a thousandth of the smaller one's size. The step used the best result.
  distances,
  // A body has more contacts than there are colours: 64 with moving bodies and 63 with others. The
  // rest were solved sequentially, which costs time only.
  colours,
  // This step and the one before ended with shapes that overlap by more than half of the smaller
  // one's min half extent, or with a hard joint that is open by more than half of the smaller
  // body's radius or by 0.2 rad. Loads, masses or joints demand more than a step can do. For links
  // and continuous bodies: as they were at the start of the step. Gears and user constraints are
  // not checked.
  positions,
};
inline constexpr std::array kLimits{Limit::impacts,   Limit::range,     Limit::bounces,
                                    Limit::manifolds, Limit::distances, Limit::colours,
                                    Limit::positions};

bool reached(const StepStatus& status, Limit limit);
// A message for the user: what happened, and what to do.
const char* sentence(Limit limit);

struct StepCounters {
  // Pairs of colliders, or of parts of them, that are close to each other.
  std::uint32_t pairs = 0;
  // Pairs that the narrow phase processed. The others have not moved enough relative to each other.
  std::uint32_t narrow_phase_pairs = 0;
  std::uint32_t triangles = 0;  // of meshes and height fields, tested by the narrow phase
  std::uint32_t manifolds = 0;  // contacts in the sub-stepped solver, with one normal each
  std::uint32_t recycled = 0;   // manifolds reused unchanged from the last step
  std::uint32_t contacts = 0;   // contact points solved, summed over the solves of the step
  std::uint32_t colours = 0;    // sets of contacts that share no body
  std::uint32_t regions = 0;    // groups of bodies in a large world; 0: not divided
  std::uint32_t sub_steps = 0;  // 0: nothing takes part in sub-steps
  std::uint32_t restitution_iterations = 0;  // with a bounce, summed over the sub-steps
  std::uint32_t impacts = 0;                 // times of impact found
  std::uint32_t awake = 0;                   // moving bodies that are awake, without links
  std::uint32_t events = 0;                  // contact_events()
};

}  // namespace vp
