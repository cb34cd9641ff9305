// What the parts of a step work on. World::Impl owns all of it.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "collide/manifolds.h"
#include "collide/pair_finder.h"
#include "collide/shape_query.h"
#include "collide/sweep.h"
#include "parallel.h"
#include "solve/passes.h"
#include "world/approach.h"
#include "world/articulation.h"
#include "world/body_states.h"
#include "world/contact_store.h"
#include "world/events.h"
#include "world/observed_stage.h"
#include "world/sleep_islands.h"
#include "world/solver_limits.h"

namespace vp {

// Scratch memory of all shape tests, and what they have met in the step.
struct ShapeScratch {
  std::vector<collide::SubManifold> manifolds;
  collide::ManifoldScratch manifold_scratch;
  collide::PartsScratch parts_scratch;
};

// A contact point of an impact of the step, or of a link in its sub-steps.
struct StepContact {
  ColliderId a, b;
  Vec3 point, normal;  // from a to b
  double impulse = 0.0;
  Vec3 friction;  // on b
};

// The stores of a world.
struct Stores {
  const WorldDesc& desc;     // in metres and metres per second
  const double& speed_unit;  // factor of speeds
  const double& dt;          // of the current step [s]; 0: no step is running
  const Workers& workers;
  Bodies& bodies;
  Colliders& colliders;
  std::vector<Articulation>& articulations;
  Joints& joints;
  solve::LargeVector<solve::BodyState>& body_states;  // 0: the world; i + 1: body i
  const BodySet& body_set;
  // Of each body: displacement of its state when the step began; its motion in the last search.
  std::vector<solve::StartDisplacement>& start_displacements;
  solve::LargeVector<solve::SearchedMotion>& searched;
  ContactStore& contact_store;
  collide::PairFinder& finder;
  BodyLoads& loads;
  BodyLists& lists;
  SleepIslands& sleep_islands;
  ShapeScratch& shapes;

  Velocity acceleration_of(const Body& body) const {
    return loads.acceleration(body, desc.gravity);
  }
  Approach approach_in(double h) const { return {bodies, loads, desc, speed_unit, h}; }
  BodyStates states_in(double h) const {
    return {body_states,
            start_displacements,
            searched,
            loads,
            desc,
            h,
            sub_steps_in(desc, speed_unit, h)};
  }
  IslandGraph island_graph() const { return {bodies, colliders, contact_store, joints}; }
};

// The stores, and what a step puts out.
struct StepContext : Stores {
  const std::shared_ptr<StageObserver>& observer;  // or null
  StepStatus& status;
  StepCounters& counters;
  Events& events;
  std::vector<StepContact>& step_contacts;  // except those in contact slots
  bool& position_error;                     // of contacts or joints, so far

  InStage in(Stage stage) const { return {observer.get(), stage}; }
};

// --- bodies (bodies.cpp, sleep.cpp)

// Wakes the body and its island.
void wake(const Stores& stores, std::uint32_t body);
// Passes the bounds of colliders that may leave their enlarged ones within h to the broad phase.
void update_bounds(const Stores& stores, std::uint32_t body, double h, bool is_solver_driven);
// Whether no collider may leave its enlarged bounds within h, even if no margin is left then.
bool has_bounds_for(const Stores& stores, std::uint32_t body, double h);
// Moves the body for h. freely: as a tumbling body without contact at the mean angular velocity
// w + more_w, instead of at the constant twist.
void advance_body(Body& body, const collide::Motion& motion, double h, bool freely,
                  const Vec3& more_w);
// A body out of the range of numbers stops at `start`. Not for links.
bool stop_if_out_of_range(const StepContext& context, std::uint32_t body, const SE3& start);

// --- links (links.cpp)

// Links are bodies for collision detection; their poses and velocities are copies. Copies both, and
// ends the remote state (remote.cpp).
void follow(Articulation& articulation, Bodies& bodies, BodyLists& lists);
void follow_poses(const Articulation& articulation, Bodies& bodies);
// Calls before(body, velocity) with each new velocity.
template <class F>
void follow_velocities(const Articulation& articulation, Bodies& bodies, const F& before) {
  for (const std::uint32_t b : articulation.bodies) {
    Body& body = bodies[b];
    if (!body.is_followed()) continue;
    const se3 now = articulation.link_velocity(body.link, body.T.position());
    before(b, now);
    body.w = now.w;
    body.v = now.v;
  }
}
void follow_velocities(const Articulation& articulation, Bodies& bodies);
// An articulation out of the range of numbers stops where it was at the start of the step.
void stop_at_start(const StepContext& context, Articulation& articulation);
inline bool stop_if_out_of_range(const StepContext& context, Articulation& articulation) {
  if (articulation.in_range()) return false;
  stop_at_start(context, articulation);
  return true;
}
// Whether a contact or joint of the two is solved in the sub-steps.
bool in_sub_steps(const std::vector<Articulation>& articulations, const Body& a, const Body& b);

}  // namespace vp
