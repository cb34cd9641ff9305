// What a step tells of itself: where it had to degrade, and what it had to do.
#pragma once

#include <array>
#include <cstdint>

namespace vp {

// Set when a step had to degrade; the step is finished all the same. Nothing is left out of a step
// without one of these.
struct StepStatus {
  bool impact_limit = false;    // Limit::impacts
  bool non_finite = false;      // Limit::range
  bool bounce_limit = false;    // Limit::bounces
  bool manifold_limit = false;  // Limit::manifolds
  bool distance_limit = false;  // Limit::distances
  bool colour_limit = false;    // Limit::colours
  bool position_error = false;  // Limit::positions
  double time_lost = 0.0;       // the part of dt lost to impact_limit [s]

  StepStatus& operator|=(const StepStatus& other);  // what either has met; times add up
};

enum class Limit : std::uint8_t {
  impacts,  // a continuous body met more impacts than max_impacts_per_step: it and what it touches
            // were held for the rest of the step
  range,    // a body or an articulation left the range of numbers, or a joint moved no inertia,
            // and it was stopped where it was
  bounces,  // bounces still ran through bodies that touch when a sub-step's 64 rounds were over:
            // what closes then is stopped, as if its restitution were 0
  manifolds,  // something convex touched a mesh or a height field at more than 12 slopes at once:
              // those past the twelfth count as that of the twelve which is most like them
  distances,  // shapes overlap, and how deep they do is known to no more than a thousandth of the
              // smaller one's size when the rounds of the search are over: the best is taken
  colours,    // a body has more contacts than there are colours for, 40 with what moves and 23 with
              // what does not: the rest are solved one after the other, with nothing lost but time
  positions,  // this step and the one before ended with shapes that overlap by more than half
              // of the smaller one's least half extent, or with a hard joint that is open by more
              // than half of the smaller body's radius or by 0.2 rad: loads, masses or joints ask
              // for more than a step can do. Links and what is continuous as they were when the
              // step began; not of gears and users' constraints
};
inline constexpr std::array kLimits{Limit::impacts,   Limit::range,     Limit::bounces,
                                    Limit::manifolds, Limit::distances, Limit::colours,
                                    Limit::positions};

bool reached(const StepStatus& status, Limit limit);
// For whoever watches: what happened, and what helps.
const char* sentence(Limit limit);

struct StepCounters {
  std::uint32_t pairs = 0;  // of colliders, or of parts of them, that are near one another
  std::uint32_t narrow_phase_pairs = 0;  // of them, given to the narrow phase; the others have not
                                         // moved by enough against one another
  std::uint32_t triangles = 0;  // of meshes and height fields, that it looked at
  std::uint32_t manifolds = 0;  // contacts in the solver of sub-steps, with one normal each
  std::uint32_t recycled = 0;   // of them, those of the last step, as they were
  std::uint32_t contacts = 0;   // contact points solved, summed over the solves of the step
  std::uint32_t colours = 0;    // sets of contacts that share no body
  std::uint32_t regions = 0;    // that a large world is solved in; 0: in one piece
  std::uint32_t sub_steps = 0;  // 0: nothing takes part in them
  std::uint32_t restitution_iterations =
      0;                      // in which something bounced, summed over the sub-steps
  std::uint32_t impacts = 0;  // times of impact found
  std::uint32_t awake = 0;    // bodies that move, those asleep left out; links are not counted
  std::uint32_t events = 0;   // contact_events()
};

}  // namespace vp
