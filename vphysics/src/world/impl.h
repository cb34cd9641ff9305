// What a world owns: stores, the parts that work on them, and the order of the step (step.cpp).
//
// A part knows the stores and what the step puts out (step_context.h), or gets the data that it
// works on with each call; it does not know the world. The methods here connect the parts and help
// the public calls.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "collide/shape_query.h"
#include "world/contact_search.h"
#include "world/digest.h"
#include "world/impact_stage.h"
#include "world/joint_steps.h"
#include "world/link_contacts.h"
#include "world/regions.h"
#include "world/runs.h"
#include "world/step_context.h"

namespace vp {

struct RecordedCall;

struct ContactData;  // contact_state.h
struct Query;
struct QueryScratch {
  std::vector<std::uint32_t> strays;  // colliders outside their proxies' bounds
  collide::CastScratch cast;
};

// State of the sub-steps that persists between steps.
struct SubStepState {
  double length = 0.0;  // of the sub-step that the impulses in contact slots and joints are from,
                        // 0: none yet [s]
  double last_step_length = 0.0;  // sub-step length that scales the bias velocity [s]
  bool position_error = false;    // the last step ended with one, of contacts or joints
};

struct World::Impl {
  WorldDesc given_desc;
  WorldDesc desc;           // the same, in metres and metres per second
  double speed_unit = 1.0;  // factor of speeds, sqrt(length_unit)
  Workers workers;
  std::shared_ptr<StageObserver> observer;  // or null
  std::shared_ptr<Recorder> recorder;       // or null

  // --- stores
  Bodies bodies;
  Colliders colliders;
  std::vector<Articulation> articulations;
  std::vector<std::uint32_t> free_articulations;
  Joints joints;
  solve::LargeVector<solve::BodyState> body_states;  // 0: the world; i + 1: body i
  const BodySet body_set{bodies, colliders, body_states};
  ContactStore contact_store;
  std::uint32_t next_serial = 1;    // of colliders
  std::uint64_t topology_hash = 0;  // digest of all creations and destructions (topology_hash.h)

  // --- parts
  BodyLoads loads;
  BodyLists lists;
  collide::PairFinder finder;
  Regions regions;
  SleepIslands sleep_islands;
  ShapeScratch shapes;
  SubStepScratch sub_step;
  SubStepState sub_step_state;
  bool ready_for_queries = false;  // nothing has moved since find_strays()
  QueryScratch queries;
  struct Incoming;
  std::shared_ptr<Incoming> incoming;  // of restore(); null before the first

  // --- of the last step
  Events events;
  StepStatus status;
  StepCounters counters;
  int sub_steps_taken = 0;
  std::vector<StepContact> step_contacts;  // except those in contact slots

  // --- of the current step
  double dt_now = 0.0;  // 0: no step is running
  bool finds_contacts = false;
  bool position_error_now = false;         // of contacts or joints, so far
  std::vector<std::uint32_t> lost_bodies;  // bodies that left the range of numbers in the sub-steps

  const StepContext context{
      {desc, speed_unit, dt_now, workers, bodies, colliders, articulations, joints, body_states,
       body_set, sub_step.start_displacements, sub_step.searched, contact_store, finder, loads,
       lists, sleep_islands, shapes},
      observer,
      status,
      counters,
      events,
      step_contacts,
      position_error_now};

  // --- parts of the step, in their order
  ContactSearch contact_search{context};
  PairContacts pair_contacts{context};
  RowSolve row_solve{context};
  LinkContacts link_contacts{context, pair_contacts, row_solve};
  ImpactStage impacts{context, pair_contacts, row_solve};

  // recorder.cpp; precondition: there is a recorder.
  void log(const RecordedCall& call);
  void log_drive(ArticulationId articulation, int link, int dof, const JointDrive& drive);

  // world.cpp
  Body* find(BodyId id) { return bodies.find(id); }
  const Body* find(BodyId id) const { return bodies.find(id); }
  Collider* find(ColliderId id) { return colliders.find(id); }
  const Collider* find(ColliderId id) const { return colliders.find(id); }
  BodyJoint* find(JointId id) { return joints.find(id); }
  Articulation* find(ArticulationId id);
  const Articulation* find(ArticulationId id) const;
  // Links too; the origin of a body that is not dynamic.
  Vec3 centre_of_mass(const Body& body);
  void note_collider(std::uint32_t index);
  void drop_contacts(std::uint32_t collider);
  void release_collider(std::uint32_t index);
  void set_body_velocity(std::uint32_t body, const se3& V);

  // changes.cpp
  Body* find_body_to_change(BodyId id);
  tl::unexpected<Error> no_body_to_change(const char* call, BodyId id) const;
  std::optional<std::string> problem_with_mass(const Body& body, const se3& V,
                                               const Inertia& inertia) const;
  void change_mass(std::uint32_t body, const Inertia& inertia);
  void update_mass(std::uint32_t body);
  void change_motion(std::uint32_t body, Motion motion, const std::optional<Inertia>& inertia,
                     const se3& V);
  void wake_all_about(std::uint32_t body);
  void take_collider_off(std::uint32_t collider);
  void summarize_colliders(std::uint32_t body);

  // forces.cpp
  Expected<void> add_load(const char* call, BodyId id, const Vec3& force, const Vec3& torque);
  void clear_loads();

  // A link's pose and velocities are updated before they are read.
  void update_if_remote(Articulation& articulation) {
    if (articulation.remote) follow(articulation);
  }
  void update_all_remote() {
    for (Articulation& art : articulations) update_if_remote(art);
  }
  void follow(Articulation& articulation) {
    ready_for_queries = false;
    vp::follow(articulation, bodies, lists);
  }

  // step.cpp
  void begin_step(double dt);
  void divide_into_regions(double dt);
  void run(double dt);
  void find_contacts(double dt);
  SearchedAgain find_contacts_within_step(double left);
  void feel_forces(double dt);
  bool has_impact_stage() const;
  void advance_all(double dt);
  void count_contacts();
  void note_position_error();
  void finish_step();
  InStage in(Stage stage) const { return context.in(stage); }

  // bodies.cpp
  void list_bodies();
  void load_states(double dt);
  Velocity settle(const BodyStates& states, std::uint32_t body);
  void add_proxy(std::uint32_t collider);
  void forget_lost_bodies();
  void forget_contacts(std::uint32_t body);
  void jumped(std::uint32_t body);

  // joints.cpp
  void remove_joint(std::uint32_t joint);

  // sleep.cpp
  void send_to_sleep();
  void wake(std::uint32_t body) { vp::wake(context, body); }
  void wake_neighbours(std::uint32_t body);

  // sub_steps.cpp
  void run_sub_steps(double dt);
  void take_sub_steps(double dt, int count);
  ContactRuns contact_runs() {
    return {contact_store.graph, body_states.data(), workers, sub_step.blocks};
  }

  // touches.cpp
  void report_changes();

  class Drawing;  // debug_draw.cpp

  // queries.cpp
  void find_strays();
  Query query(const QueryFilter& filter);

  // snapshot.cpp, restore.cpp, contact_state.h
  ContactData contact_data();
  void adopt(Incoming& incoming);
  template <class Sink>
  void write(Sink& sink);
};

}  // namespace vp
