// What a world owns.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "collide/bounds.h"
#include "collide/broad_phase.h"
#include "collide/sweep.h"
#include "solve/contact_solver.h"
#include "vphysics/world.h"
#include "world/articulation.h"

namespace vp {

inline constexpr std::uint32_t kNone = 0xffffffffu;

struct Body {
  std::uint32_t generation = 0;
  bool alive = false;
  bool is_link = false;
  bool continuous = false;
  bool isotropic = false;  // rotational inertia the same about every axis: no gyroscopic term
  Motion motion = Motion::fixed;
  std::uint32_t articulation = kNone;
  int link = 0;  // of it
  std::uint32_t first_collider = kNone, last_collider = kNone;
  std::uint32_t categories = 0, masks = 0;  // union over its colliders
  bool has_sensor = false;
  bool unbounded = false;  // carries a half-space
  std::uint64_t user_data = 0;
  // Constant.
  double mass = 0.0;
  Vec3 centre;                    // of mass, body frame
  Sym3 central, inverse_central;  // rotational inertia about it, body frame
  double linear_damping = 0.0, angular_damping = 0.0;
  collide::Bounds local;  // of its bounded colliders, body frame
  double reach = 0.0;     // to the farthest point of these from the reference point
  // State.
  SE3 T;           // T_world_body
  Vec3 w, v;       // world frame; v of the reference point (centre of mass; a link's origin)
  se3 prescribed;  // kinematic: body frame
  // Follow from the pose when they are needed. A link's T, w and v are refreshed only if it has
  // colliders; else ask its articulation.
  bool posed = false;    // the colliders' poses and bounds are those of T
  bool bounded = false;  // so are these
  collide::Bounds bounds;

  void moved() { posed = bounded = false; }
};

struct Collider {
  std::uint32_t generation = 0;
  bool alive = false;
  bool sensor = false;
  std::uint32_t body = kNone;
  std::uint32_t next = kNone;  // of the same body
  std::uint32_t serial = 0;    // order of creation
  Shape shape = HalfSpace{};   // owns what geometry points to
  collide::Geometry geometry;
  SE3 T_body_shape;
  Material material;
  CollisionFilter filter;
  std::uint64_t user_data = 0;
  // Follows from the body's pose; refreshed by the step (Body::posed).
  SE3 T;
  collide::Bounds bounds;
};

struct PairPoint {
  std::uint32_t feature;
  double normal_impulse;
  Vec3 friction;  // world frame
  Vec3 position;  // world frame
};

// What is remembered of a pair of colliders from step to step.
struct PairRecord {
  std::uint64_t key = 0;  // serials of both
  std::uint32_t a = 0, b = 0;
  std::uint32_t count = 0;
  bool touching = false;
  Vec3 rolling;
  PairPoint points[collide::kMaxPoints]{};
};

// A pair that touched when one of the two was destroyed; the next step reports its end. user_data
// is not kept: it is the user's and no snapshot carries it.
struct DestroyedPair {
  ColliderId a, b;
  bool sensor = false;
};

struct ColliderPair {
  std::uint64_t key;
  std::uint32_t a, b;
};

// A pair in which a sphere is swept; separation is that of now.
struct SweptPair {
  ColliderPair pair;
  bool sphere_is_a;
  bool sensor;
  double separation;
};

struct Velocity {
  Vec3 w, v;  // world frame
  bool operator==(const Velocity&) const = default;
};

struct World::Impl {
  WorldDesc desc;
  std::vector<Body> bodies;
  std::vector<Collider> colliders;
  std::vector<Articulation> articulations;
  std::vector<std::uint32_t> free_bodies, free_colliders;
  std::uint32_t next_serial = 1;
  std::uint64_t structure = 0;      // digest of all that was created and destroyed (structure.h)
  std::vector<PairRecord> records;  // sorted by key
  std::vector<DestroyedPair> destroyed_pairs;

  // --- of the last step
  std::vector<ContactEvent> events;
  StepCounters counters;

  // --- scratch of a step; kept for its capacity
  StepStatus status;
  collide::BroadPhase broad_phase;
  std::vector<collide::Bounds> bounds, discrete_bounds;
  std::vector<std::uint8_t> movable, held;
  std::vector<collide::Motion> motions;
  std::vector<Velocity> forced;  // what the step's forces added
  std::vector<solve::SolverBody> solver_bodies;
  std::vector<collide::IndexPair> body_pairs;
  std::vector<ColliderPair> discrete_pairs;
  std::vector<SweptPair> swept_pairs;
  std::vector<solve::ContactConstraint> discrete_contacts, contacts;
  std::vector<solve::JointRow> joint_rows;
  std::vector<solve::SolverArticulation> solver_articulations;
  std::vector<double> link_rows;
  std::vector<PairRecord> next_records;
  std::vector<SE3> start_poses;

  // world.cpp
  Body* find(BodyId id);
  const Body* find(BodyId id) const;
  Articulation* find(ArticulationId id);
  const Articulation* find(ArticulationId id) const;
  Vec3 reference_point(const Body& body) const;
  void place(Body& body, const Vec3& reference, const Mat3& R);
  void release_collider(std::uint32_t index);

  // articulations.cpp
  void reserve_link_rows();
  void follow(const Articulation& articulation);
  void follow_velocities(const Articulation& articulation, bool carrying);
  void integrate_articulations(double dt);
  void add_joint_rows(double h, double dt, bool first);
  void begin_solve_articulations();
  void end_solve_articulations(bool first);
  void advance_articulations(double h);
  bool stop_if_out_of_range(Articulation& articulation);
  void hold(std::uint32_t body);

  // step.cpp
  void begin_step(double dt);
  void integrate_forces(double dt);
  void refresh_solver_bodies();
  void refresh_motions(double h);
  void pose_colliders(std::uint32_t body);
  const collide::Bounds& bounds_at_pose(std::uint32_t body);
  bool stop_if_out_of_range(std::uint32_t body);
  void advance(double h);
  void advance_body(std::uint32_t index, double h);
  void apply_corrections();
  void finish_step();
  void run(double dt);
  double next_impact(double h);
  void hold_what_meets(double h);

  // pairs.cpp
  void refresh_bounds(double h);
  bool keep_discrete_bounds();
  void find_discrete_pairs(double h);
  void find_swept_pairs(double h);
  bool swept(const Collider& a, const Collider& b) const;
  void add_swept_pairs(std::uint32_t sphere, std::uint32_t other_body, double h);
  collide::SweepQuery sweep_query(const SweptPair& pair, double h) const;
  double discrete_margin(const ColliderPair& pair, double h) const;

  // contacts.cpp
  PairRecord& record_of(const ColliderPair& pair);
  void add_contact(const ColliderPair& pair, const collide::Manifold& manifold, bool swept,
                   bool warm, std::vector<solve::ContactConstraint>& out);
  void find_discrete_contacts(double h);
  void find_swept_contacts(bool warm);
  void solve_contacts(double h, double dt, bool first);
  void carry(std::uint32_t body, const Vec3& change_w, const Vec3& change_v);
  void report_contacts(double time);
  void remember_impulses();
  void report_ends();
  void report_ends_of_destroyed();
  void report_sensor(const ColliderPair& pair, const Vec3& point, const Vec3& normal, double time);
  void report_swept_sensors(double h, double time);
  void emit(ContactEvent::Kind kind, const ColliderPair& pair, const Vec3& point,
            const Vec3& normal, double approach, double impulse, double time);
  void add_event(const ContactEvent& event);

  // snapshot.cpp
  template <class Sink>
  void write(Sink& sink) const;
};

// Orders a pair by creation.
ColliderPair make_pair(const std::vector<Collider>& colliders, std::uint32_t i, std::uint32_t j);
bool should_meet(const Collider& a, const Collider& b);
BodyId body_id(const std::vector<Body>& bodies, std::uint32_t index);
ColliderId collider_id(const std::vector<Collider>& colliders, std::uint32_t index);
// Mixes a word into a digest.
std::uint64_t mixed(std::uint64_t digest, std::uint64_t word);

}  // namespace vp
