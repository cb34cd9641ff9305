// What a world owns: stores, the parts that work on them, and the order of the step (step.cpp).
//
// A part gets the data that it works on with each call and does not know the world. The methods
// here connect the parts, such as waking, which touches most of them, and help the public calls.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "collide/shape_query.h"
#include "collide/sweep.h"
#include "solve/contact_slot.h"
#include "world/articulation.h"
#include "world/body.h"
#include "world/collider.h"
#include "world/contact_search.h"
#include "world/contact_store.h"
#include "world/digest.h"
#include "world/events.h"
#include "world/impact_stage.h"
#include "world/joint.h"
#include "world/joint_steps.h"
#include "world/loads.h"
#include "world/parallel.h"
#include "world/regions.h"
#include "world/row_joints.h"
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
  solve::LargeVector<solve::BodyRow> body_rows;  // 0: the world; i + 1: body i
  const BodySet body_set{bodies, colliders, body_rows};
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
  ImpactStage impacts;
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
      {desc, speed_unit, dt_now, workers, bodies, colliders, articulations, joints, body_rows,
       body_set, sub_step.start_displacements, sub_step.searched, contact_store, finder, loads,
       lists, sleep_islands, shapes},
      observer,
      status,
      counters,
      events,
      step_contacts,
      position_error_now};
  ContactSearch contact_search{context};

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

  // articulations.cpp
  void reserve_link_rows();
  void follow(Articulation& articulation) {
    ready_for_queries = false;
    vp::follow(articulation, bodies, lists);
  }
  void integrate_articulations(double dt);
  void add_joint_rows(double h, double dt, RowsOf of);
  void integrate_forces_of(Articulation& art, double dt);
  bool integrate_saturated_again(double dt, bool solved, bool all_become_rows);
  RowJointStep row_joint_step(double h, double dt, bool first) const;
  void store_implicit_impulses();
  void load_warm_start(std::uint64_t key, std::uint32_t part, bool warm,
                       solve::ContactConstraint& c) const;
  void restore_warm_starts();
  bool solve_instant(std::span<const std::uint32_t> solved, double h, double dt, bool first);
  void begin_solve_articulations(bool first);
  void end_solve_articulations(bool first);
  void advance_articulations(double h);
  void hold(std::uint32_t body);

  // remote.cpp
  bool can_be_remote(const Articulation& articulation) const;
  void list_remote_articulations();
  bool is_near_awake_body(const collide::Bounds& box) const;
  void collide_remote(double h);
  void make_remote();
  void update_if_remote(Articulation& articulation);
  void update_all_remote();

  // step.cpp
  void begin_step(double dt);
  void divide_into_regions(double dt);
  void rescale_impacts(double dt);
  void begin_impact_stage(double dt);
  void integrate_forces(double dt);
  solve::SolverBody solver_body(std::uint32_t body, const Vec3& at) const;
  void refresh_solver_bodies(std::span<const std::uint32_t> of);
  void note_touched_articulations();
  void refresh_motions(double h);
  void refresh_motion_of(std::uint32_t body, double h);
  void refresh_displacements(double h);
  collide::Motion motion_of(const Body& body, const Velocity& drift, double h) const;
  void advance_discrete_contacts(double h);
  void advance_body(Body& body, const collide::Motion& motion, double h, bool freely,
                    const Vec3& more_w);
  void advance_all(double dt);
  void apply_corrections(std::span<const std::uint32_t> of);
  void note_position_error();
  void finish_step();
  InStage in(Stage stage) const { return context.in(stage); }
  void count_contacts();
  void run(double dt);
  void find_contacts(double dt);
  SearchedAgain find_contacts_within_step(double left);
  void feel_forces(double dt);
  void take_back_forces(double h);

  // impacts.cpp
  void queue_swept_pairs(double now, double h);
  double time_of(const SweptPair& swept, double h);
  void look_at_waiting(std::uint32_t pair, const Instant& now);
  bool next_impact(const Instant& now, Instant& next);
  void report_reached_sensors();
  void bring(std::uint32_t body, const Instant& now);
  void bring_concerned(std::uint32_t body, const Instant& now);
  void move_within_step(std::uint32_t body, double h, bool freely);
  void concern(std::uint32_t body);
  void advance_links(const Instant& previous, const Instant& now);
  void refresh_links(double h);
  void concern_bodies_that_meet(const Instant& now);
  bool touches_at(const QueuedPair& pair, const Instant& now);
  void concern_what_touches(const Instant& now);
  void find_swept_pairs_of(std::uint32_t body, const Instant& now, double h);
  void find_swept_pairs_of_concerned(const Instant& now);
  void solve_impact(const Instant& previous, const Instant& now);
  void stop_swept_pairs(const Instant& now, double h);
  void stop_what_would_hit(const Instant& now);
  void advance_to_end(const Instant& now);
  void run_impacts(double dt);

  // bodies.cpp
  void list_bodies();
  void load_rows(double dt);
  Velocity settle(const BodyRows& rows, std::uint32_t body);
  void add_proxy(std::uint32_t collider);
  void forget_lost_bodies();
  void forget_contacts(std::uint32_t body);
  void jumped(std::uint32_t body);

  // joints.cpp
  void remove_joint(std::uint32_t joint);

  // link_joints.cpp
  void list_row_joints();
  void find_bodies_joined_to_links();
  bool is_in_sub_steps(const BodyJoint& joint) const;
  void note_joined_bodies();
  RowEnd row_end(std::uint32_t body, const RowJointStep& step) const;
  void find_next_poses(double h);
  void add_row_joints(const RowJointStep& step);
  void take_back_row_joints(const RowJointStep& step);
  void note_open_row_joints();

  // link_contacts.cpp
  void find_bodies_on_links();
  void put_on_link(std::uint32_t body, Articulation& articulation);
  void find_link_contacts(double dt, int sub_steps);
  solve::StepContext link_context(double h);
  void begin_links(double h);
  void solve_links(double h);
  void move_links(double h);
  void relax_links(double h);
  void end_links(double dt, int sub_steps);
  solve::SolverBody solver_body_in_sub_step(std::uint32_t body, double h) const;
  void load_bodies_on_links();
  void store_bodies_on_links();

  // sleep.cpp
  void send_to_sleep();
  void wake(std::uint32_t body) { vp::wake(context, body); }
  void wake_neighbours(std::uint32_t body);

  // sub_steps.cpp
  void run_sub_steps(double dt);
  void take_sub_steps(double dt, int count);
  ContactRuns contact_runs() {
    return {contact_store.graph, body_rows.data(), workers, sub_step.blocks};
  }

  // touches.cpp
  void report_changes();

  // pairs.cpp
  BodyMotions body_motions() const { return {bodies, impacts.motions, impacts.bounds}; }
  ImpactTimes impact_times() {
    return {colliders, impacts.motions, desc.contact_slop, shapes.parts_scratch};
  }
  void refresh_bounds(double h);
  void refresh_bounds_of(std::uint32_t body, double h);
  void find_discrete_pairs(double h);
  void find_touching_pairs(double h);
  void find_swept_pairs(double h);
  void add_swept_pairs_of(const collide::IndexPair& pair, double h);
  void add_swept_pairs(std::uint32_t swept_body, std::uint32_t other_body, double h);
  void sort_swept_pairs();
  double discrete_margin(const ColliderPair& pair, double h) const;

  // joint_reactions.cpp
  void note_link_impulses(std::span<const solve::ContactConstraint> solved);

  // contacts.cpp
  PairRecord& record_of(const ColliderPair& pair, std::uint32_t part = 0);
  std::span<const collide::SubManifold> manifolds_of(const ColliderPair& pair, double margin);
  void add_contact(const ColliderPair& pair, const collide::Manifold& manifold, std::uint32_t part,
                   bool swept, bool warm, std::vector<solve::ContactConstraint>& out);
  void find_discrete_contacts(double h);
  void find_swept_contacts(bool warm);
  void solve_contacts(double h, double dt, bool first);
  void carry(std::uint32_t body, const Vec3& change_w, const Vec3& change_v);
  void report_contacts(std::span<const solve::ContactConstraint> solved, double time);
  bool has_impact_stage() const;
  void note_contacts(std::span<const solve::ContactConstraint> solved);
  void remember_impulses(std::span<const solve::ContactConstraint> solved, double scale);
  void report_ends();
  void report_sensor(const ColliderPair& pair, const Vec3& point, const Vec3& normal, double time);

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
