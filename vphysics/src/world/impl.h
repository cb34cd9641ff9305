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
  // State.
  SE3 T;           // T_world_body
  Vec3 w, v;       // world frame; v of the reference point (centre of mass; a link's origin)
  se3 prescribed;  // kinematic: body frame
};

struct Collider {
  std::uint32_t generation = 0;
  bool alive = false;
  bool sensor = false;
  std::uint32_t body = kNone;
  std::uint32_t next = kNone;  // of the same body
  std::uint32_t serial = 0;    // order of creation
  collide::Geometry geometry;
  SE3 T_body_shape;
  Material material;
  CollisionFilter filter;
  std::uint64_t user_data = 0;
  // Follows from the body's pose; refreshed by the step.
  SE3 T;
  collide::Bounds bounds;
};

// A joint coordinate, inside always (slide, angle), whichever of them the kind has.
struct JointAxis {
  bool free = false;
  double inertia = 0.0;  // with armature
  double damping = 0.0;
  JointLimit limit;
  JointDrive drive;
  double q = 0.0;
  double drive_impulse = 0.0;  // warm start
};
inline constexpr int kSlide = 0, kAngle = 1;

struct Articulation {
  JointKind kind = JointKind::fixed;
  std::uint32_t body = kNone;
  SE3 T_world_joint;
  Vec3 axis;  // world frame
  double mass = 0.0;
  Vec3 first_moment;  // link frame
  JointAxis axes[2];

  // The inside index of a user's dof, or -1.
  int axis_index(int dof) const {
    if (dof < 0 || dof >= degrees_of_freedom(kind)) return -1;
    return kind == JointKind::revolute ? kAngle : dof;
  }
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
  std::vector<collide::Bounds> bounds;
  std::vector<std::uint8_t> movable, posed, held;
  std::vector<collide::Motion> motions;
  std::vector<Velocity> forced;  // what the step's forces added
  std::vector<solve::SolverBody> solver_bodies;
  std::vector<collide::IndexPair> body_pairs;
  std::vector<ColliderPair> discrete_pairs;
  std::vector<SweptPair> swept_pairs;
  std::vector<solve::ContactConstraint> discrete_contacts, contacts;
  std::vector<solve::JointRow> joint_rows;
  std::vector<PairRecord> next_records;
  std::vector<SE3> start_poses;
  std::vector<double> start_q;

  // world.cpp
  Body* find(BodyId id);
  const Body* find(BodyId id) const;
  Articulation* find(ArticulationId id);
  const Articulation* find(ArticulationId id) const;
  Vec3 reference_point(const Body& body) const;
  void place(Body& body, const Vec3& reference, const Mat3& R);
  void place_link(const Articulation& articulation);
  void release_collider(std::uint32_t index);

  // step.cpp
  void begin_step(double dt);
  void integrate_forces(double dt);
  void refresh_solver_bodies();
  void refresh_motions(double h);
  void pose_colliders(std::uint32_t body);
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
  void add_joint_rows(double h, bool first);
  void solve_contacts(double h, double dt, bool first);
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
