// A world of rigid bodies and articulations with a deterministic step.
//
// Units: SI. Right-handed frames. Generalized velocities V = (w, v) are in the body frame, about
// the body's origin (paper, section 4.2). Calls validate their arguments. NaN, infinities, sizes
// and masses out of range and stale ids return an Error and change nothing. One thing is not
// checked: that an id is of this world (ids.h).
//
// Threads: only one thread at a time may use a World. Different worlds are independent.
// Determinism: the same sequence of calls gives the same bits on g++ and clang++, at every
// optimisation level. Nothing in here reads a clock or a global generator.
//
// Source: paper, sections 4.1 to 4.5; docs/decisions/ for the contact and impact scheme.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "vphysics/debug_draw.h"
#include "vphysics/error.h"
#include "vphysics/ids.h"
#include "vphysics/lie.h"
#include "vphysics/multibody/model.h"
#include "vphysics/query.h"
#include "vphysics/shapes.h"
#include "vphysics/stages.h"
#include "vphysics/step_report.h"
#include "vphysics/task_scheduler.h"
#include "vphysics/world_joints.h"

namespace vp {

struct WorldDesc {
  Vec3 gravity{0.0, 0.0, -9.81};        // [m/s^2]
  double restitution_threshold = 0.05;  // minimum approach speed of a bounce [m/s]
  double contact_slop = 1e-4;           // allowed penetration [m]; also the contact margin
  int velocity_iterations = 12;         // contact solver iterations per solve
  // Sub-steps of the contact solver. 0: automatic, 2 at 1 kHz, 5 at 240 Hz, 9 at 60 Hz with
  // length_unit 1.
  int sub_steps = 0;
  int max_impacts_per_step = 32;  // maximum number of impact times resolved in a step
  // Bodies connected by contacts and joints form an island. It falls asleep when no point of its
  // bodies has moved faster than sleep_speed [m/s] for sleep_after [s]; 0: never. A sleeping body
  // costs nothing. It wakes when a moving body touches it, and in every call that changes it.
  double sleep_after = 0.0;
  double sleep_speed = 0.02;
  // With more moving bodies than this, the world divides them into regions of neighbouring bodies:
  // at most this many bodies in a region, and at most 4096 regions. The solver works on one region
  // after another, or several workers each on their own, so that a region stays in the second-level
  // cache: 1000 boxes and their contacts take a megabyte. From 1 to 1,000,000. The order of
  // solving, and so the results, depend on it.
  int region_bodies = 2048;
  // The typical size of the bodies [m]. It multiplies contact_slop. Its square root multiplies
  // restitution_threshold, sleep_speed and the maximum speeds at which penetrations and joint
  // errors are corrected: a body that falls by its own size reaches a speed proportional to that
  // root, and takes a time proportional to it. The automatic number of sub-steps depends on the
  // step length relative to that time. From 1e-6 to 1e6. Towers of 1 cm cubes at 60 Hz need 0.01.
  double length_unit = 1.0;
};

enum class Motion : std::uint8_t {
  fixed,      // never moves
  kinematic,  // moves at its prescribed velocity; contacts and joints do not change it
  dynamic,    // moved by forces and contacts
};

struct BodyDesc {
  Motion motion = Motion::dynamic;
  SE3 T_world_body;
  se3 velocity;  // body frame [rad/s, m/s]
  // About the body's origin. Default: none, and a dynamic body takes its mass from the shapes and
  // densities of its colliders, updated as they are added and removed. Until a collider has a
  // volume, the body has 1 kg and 1 kg m^2 about each axis. Limits for dynamic bodies: mass from
  // 1e-15 to 1e9 kg; moments about the centre of mass from 1e-30 (a water drop of a micrometre) to
  // 1e15 kg m^2. No principal moment may exceed the sum of the other two, with a tolerance of 4 %
  // for rounded numbers.
  Inertia inertia;
  double linear_damping = 0.0;   // [1/s]
  double angular_damping = 0.0;  // [1/s]
  double gravity_scale = 1.0;    // factor of WorldDesc::gravity, from -1e6 to 1e6
  bool allow_sleep = true;       // false: its whole island stays awake
  bool continuous = false;       // continuous collision detection (CCD): no tunneling at any speed
  std::uint64_t user_data = 0;
};

// A tree of links with any joints (multibody/model.h). Each link is a body of the world and takes
// colliders as other bodies do, but only its joints move it. The model defines armature, damping,
// stops, springs and friction of the joints. Stops, springs and friction are solved together with
// the contacts, springs implicitly.
//
// A tree whose root is a free joint without damping and armature conserves its momentum to rounding
// while nothing touches it. Velocity-dependent forces are integrated explicitly: a tree that
// rotates by more than about half a radian in a step gains energy.
struct ArticulationDesc {
  Model model;
  // True: links collide with each other by their colliders' filters, as other bodies do, except
  // neighbours: a link and its parent. Links connected by joints without degrees of freedom count
  // as one link; links fixed to the world count as part of the world. Revolute, universal and ball
  // joints at one point, such as a hip of three hinges, count as one joint, and all links of that
  // joint as neighbours. False: no two links of the articulation collide.
  bool links_collide = false;
};

// What happened to a pair of colliders in a step. Bodies in sub-steps report at the end of the
// step, with time 0. Continuous bodies, and bodies that touch links, report each impact with its
// own time. A pair has at most one hit from all sub-steps of a step, and one from each impact.
struct ContactEvent {
  enum class Kind : std::uint8_t {
    begin,  // they touch, and did not before
    // The approach speed exceeded restitution_threshold, not counting what the step's own forces
    // add. If a begin has the same time, the hit follows it. A pair that already touches may hit
    // again, as in a last small bounce within one step, so there may be more hits than begins.
    hit,
    end,  // they no longer touch, or one was destroyed: one end for each begin
  };
  Kind kind;
  bool sensor;                             // one of the two is a sensor: no hits
  ColliderId a, b;                         // a < b by creation
  std::uint64_t user_data_a, user_data_b;  // 0 if the collider was destroyed; its id is stale
  // World frame [m]. 0 in an end, as are all numbers below. When a sensor begins to overlap: the
  // origin of the shape for a continuous body, a point of the overlap for a link, else 0.
  Vec3 point;
  Vec3 normal;            // world frame, from a to b; 0 for sensors, except with a link
  double approach_speed;  // before the impact, along the normal [m/s], >= 0
  double impulse;         // normal impulse [N s]; 0 for sensors
  double time;            // within the step, [0, dt]; 0 except of impacts and swept sensors
};

// World axes.
struct VelocityWorld {
  Vec3 linear;   // [m/s]
  Vec3 angular;  // [rad/s]
};

// A contact point of a body, and the impulses on the body at that point in a step.
struct ContactPoint {
  ColliderId collider, other;  // the body's collider, and the other one
  Vec3 point;                  // world frame [m]; accurate to a hundredth of the shapes' size
  Vec3 normal;                 // unit, world frame, towards the body
  double normal_impulse;       // along the normal, sum over the step, >= 0 [N s]
  Vec3 friction_impulse;       // tangential, world frame [N s]
};

class Recorder;

class World {
 public:
  // Use it for settings from a file or a user. Rejected: non-finite or negative numbers, gravity or
  // lengths beyond 1e9, iterations below 1 or above 1000, more than 1000 sub-steps, more than
  // 100000 impacts a step, region_bodies below 1 or above 1,000,000.
  [[nodiscard]] static Expected<World> create(const WorldDesc& desc);
  // Precondition: create() accepts desc.
  explicit World(const WorldDesc& desc = {});
  ~World();
  // Precondition of every call: not moved from. A moved-from world may be destroyed or assigned to.
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  // --- building ---------------------------------------------------------------------------------
  [[nodiscard]] Expected<BodyId> create_body(const BodyDesc& desc);
  // Destroys its colliders too. The next step reports the end of its contacts. Rejected: links.
  [[nodiscard]] Expected<void> destroy_body(BodyId body);
  [[nodiscard]] Expected<ColliderId> add_collider(BodyId body,
                                                  const ColliderDesc& desc);  // links too
  // Computes mass, centre of mass and inertia of a dynamic body from its colliders' shapes and
  // densities. Sensors do not count; a volume inside two shapes counts twice. The velocity of the
  // body's origin does not change. Rejected: links, bodies that are not dynamic or have no collider
  // with a mass, and an inertia that create_body() rejects.
  [[nodiscard]] Expected<void> set_mass_from_colliders(BodyId body);
  // Starts at rest with every joint at zero, clamped to its stops. Errc::singular: a joint moves no
  // inertia.
  [[nodiscard]] Expected<ArticulationId> create_articulation(const ArticulationDesc& desc);
  BodyId link_body(ArticulationId articulation, int link) const;  // null: no such link

  // Destroying either body destroys the joint.
  [[nodiscard]] Expected<JointId> create_joint(BodyId a, BodyId b, const JointDesc& desc);
  [[nodiscard]] Expected<void> destroy_joint(JointId joint);

  // --- changes ----------------------------------------------------------------------------------
  // Changes to the properties of existing objects. Each call wakes the affected bodies and is
  // recorded. As after other building calls, restore() rejects snapshots from before it. Rejected:
  // stale ids, links where a body is expected, and values that create_body() and add_collider()
  // reject.

  // Keeps the velocity where the new motion has one: a body that becomes kinematic continues at its
  // velocity. A body that becomes dynamic has the inertia that it was created with or given, or
  // that of its colliders. Its contacts end; those that still touch begin again in the next step.
  // Rejected: half-spaces, meshes and height fields on a body that may not carry them, and joints
  // left without a dynamic body.
  [[nodiscard]] Expected<void> set_motion(BodyId body, Motion motion);
  // Replaces the inertia, also one from colliders. The velocity of the origin does not change.
  [[nodiscard]] Expected<void> set_inertia(BodyId body, const Inertia& inertia);
  [[nodiscard]] Expected<void> set_damping(BodyId body, double linear, double angular);  // [1/s]
  [[nodiscard]] Expected<void> set_gravity_scale(BodyId body, double scale);
  [[nodiscard]] Expected<void> set_allow_sleep(BodyId body, bool allow);

  bool contains(ColliderId collider) const;
  BodyId body_of(ColliderId collider) const;  // null: no such collider
  // Also for colliders of links. Contacts use the new values from the next step on; pairs that the
  // filters no longer allow end.
  [[nodiscard]] Expected<void> set_material(ColliderId collider, const Material& material);
  [[nodiscard]] Expected<void> set_filter(ColliderId collider, const CollisionFilter& filter);
  [[nodiscard]] Expected<void> set_surface_velocity(ColliderId collider, const Vec3& velocity);
  // The next step reports the end of its contacts.
  [[nodiscard]] Expected<void> remove_collider(ColliderId collider);

  bool contains(ArticulationId articulation) const;
  // Destroys its links and their colliders too. The next step reports the end of their contacts.
  [[nodiscard]] Expected<void> destroy_articulation(ArticulationId articulation);

  // --- state ------------------------------------------------------------------------------------
  bool contains(BodyId body) const;
  SE3 pose(BodyId body) const;         // T_world_body; precondition: contains(body)
  se3 velocity(BodyId body) const;     // body frame; precondition: contains(body)
  Inertia inertia(BodyId body) const;  // about its origin, 0 if not dynamic; precondition: the same
  [[nodiscard]] Expected<void> set_pose(BodyId body, const SE3& T_world_body);  // rejected: links
  [[nodiscard]] Expected<void> set_velocity(BodyId body, const se3& velocity);  // rejected: links
  // Velocity of the centre of mass in world axes; works for links. For links without mass and
  // bodies that are not dynamic: of the origin. Precondition: contains(body).
  VelocityWorld velocity_world(BodyId body) const;
  Vec3 velocity_at(BodyId body, const Vec3& point_world) const;  // of the body's point there [m/s]
  // Rejected: links, and what set_velocity() rejects.
  [[nodiscard]] Expected<void> set_velocity_world(BodyId body, const VelocityWorld& velocity);
  // Rejected: an impulse that would make it faster than 1e9 m/s or rad/s.
  [[nodiscard]] Expected<void> apply_impulse(BodyId body, const Vec3& impulse_world,
                                             const Vec3& point_world);
  // Forces and torques act during the next step, constant in the world frame, and are cleared at
  // its end: apply them again before each step. Calls before the same step add up. Contacts,
  // friction and joints respond to them as to gravity: a load, not an impact. Links are allowed. A
  // sleeping body wakes. Rejected: bodies that are not dynamic, and loads that would make a body
  // faster than 1e9 m/s or rad/s within 0.1 s; for links, sums beyond 1e9 N or N m. While a load is
  // pending, masses and poses with which it would exceed these limits are rejected too. The moment
  // about the centre of mass is computed at the time of the call. Without a point the force acts at
  // the centre of mass.
  [[nodiscard]] Expected<void> apply_force(BodyId body, const Vec3& force_world,
                                           const Vec3& point_world);
  [[nodiscard]] Expected<void> apply_force(BodyId body, const Vec3& force_world);
  [[nodiscard]] Expected<void> apply_torque(BodyId body, const Vec3& torque_world);
  bool is_asleep(BodyId body) const;  // precondition: contains(body)
  // Wakes its whole island; does nothing if the body is awake.
  [[nodiscard]] Expected<void> wake(BodyId body);

  const Model* model(ArticulationId articulation) const;  // as created; null: no such articulation
  // All coordinates and velocities of an articulation, in the model's order; valid until the next
  // call that changes the world. Precondition: the articulation exists.
  std::span<const double> coordinates(ArticulationId articulation) const;
  std::span<const double> velocities(ArticulationId articulation) const;
  // Rejected: other lengths, numbers that are not finite or beyond 1e9, coordinates beyond a limit,
  // a quaternion that is not of unit length.
  [[nodiscard]] Expected<void> set_joint_states(ArticulationId articulation,
                                                std::span<const double> coordinates,
                                                std::span<const double> velocities);

  // One degree of freedom of a link's joint, counted from 0; not for ball and free joints.
  double joint_position(ArticulationId articulation, int link, int dof) const;
  double joint_velocity(ArticulationId articulation, int link, int dof) const;
  [[nodiscard]] Expected<void> set_joint_state(ArticulationId articulation, int link, int dof,
                                               double position, double velocity);
  // For any joint.
  [[nodiscard]] Expected<void> set_drive(ArticulationId articulation, int link, int dof,
                                         const JointDrive& drive);
  // Sets the drives of all degrees of freedom, in the order of velocities(). Cheaper than one call
  // for each. Rejected: another number of drives, or any drive that set_drive() rejects; then none
  // changes.
  [[nodiscard]] Expected<void> set_drives(ArticulationId articulation,
                                          std::span<const JointDrive> drives);

  // A force [N] or torque [N m] of one degree of freedom, dual to its velocity, during the next
  // step as with apply_force(). It adds to the drive. For any joint; for a ball or a free joint in
  // the link's frame. Rejected: sums beyond 1e9.
  [[nodiscard]] Expected<void> apply_joint_force(ArticulationId articulation, int link, int dof,
                                                 double force);

  // The mean wrench that a link's joint applied to the link in the last step: force and torque in
  // the world frame, the torque about the link's origin. A force-torque sensor in the joint
  // measures it; the parent receives the opposite wrench. Fixed joints have one too. It contains
  // motors, stops, friction, springs, the user's joint forces and the constraint forces of the
  // joint; impacts within the step count as impulse / dt. It does not contain apply_impulse() and
  // states set between steps.
  //
  // It is computed from the momenta, gravity, the user's forces and the contacts, rolling friction
  // included: exact at rest, to the order of dt in motion. A free root without damping and armature
  // has only its joint_effort(): the momentum that position corrections of contacts change is in no
  // reaction. If StepStatus::impact_limit stops the articulation, the joints' reactions include the
  // stop. Zero before the first step, after restore() and after a step in which the
  // articulation left the range of numbers. The first query after a step costs O(links); the first
  // of all allocates. Precondition: the articulation has that link.
  JointForce joint_reaction(ArticulationId articulation, int link) const;
  // The mean force [N] or torque [N m] along one degree of freedom in the last step: motor,
  // friction, spring, stops, damping and the user's joint force. The reaction along the same axis
  // is this effort less armature times the joint acceleration, to the order of dt. Zero when
  // joint_reaction() is. For any joint. Precondition: the joint has that degree of freedom.
  double joint_effort(ArticulationId articulation, int link, int dof) const;
  // Of a link: the mean acceleration, over the last step, of its point that is at point_world now,
  // world frame [m/s^2]. An accelerometer measures this less gravity, in its own axes. Zero when
  // joint_reaction() is. Precondition: the body is a link. To give a free body such a sensor, make
  // it an articulation of one link with a free joint.
  Vec3 acceleration_at(BodyId link, const Vec3& point_world) const;

  bool contains(JointId joint) const;
  // In the current state. The first is for joints with one coordinate. Ball, weld and
  // six-degree-of-freedom joints take an axis; a UserConstraint takes a row. Precondition: the
  // joint exists and has that coordinate; row is below rows().
  double joint_coordinate(JointId joint) const;
  double joint_coordinate(JointId joint, JointAxis axis) const;
  double joint_residual(JointId joint, int row) const;
  // Rejected: joints without that coordinate, with that coordinate locked, or without a drive.
  [[nodiscard]] Expected<void> set_drive(JointId joint, const JointDrive& drive);
  [[nodiscard]] Expected<void> set_drive(JointId joint, JointAxis axis, const JointDrive& drive);
  // In the last step; zero before the first step and after restore(). Precondition: the joint
  // exists.
  JointForce joint_force(JointId joint) const;

  // --- time -------------------------------------------------------------------------------------
  // The scheduler that shares the work of later steps; null: none. The results are the same bits.
  void set_task_scheduler(std::shared_ptr<TaskScheduler> scheduler);
  // The observer that is notified of the stages of later steps; null: none, at no cost. The results
  // are the same bits.
  void observe_stages(std::shared_ptr<StageObserver> observer);
  // Advances by dt seconds. Rejected: dt outside 1e-7 <= dt <= 0.1; the solver's single precision
  // would lose the velocity changes of shorter steps. No heap allocation once warm.
  [[nodiscard]] Expected<StepStatus> step(double dt);
  // Of the last step, by time; events of one time in the order they were found. None after
  // restore().
  std::span<const ContactEvent> contact_events() const;
  const StepCounters& counters() const;  // of the last step
  // Appends all contact points at which the body receives an impulse, with the impulses on it in
  // the last step. Divided by dt they are the mean forces, for instance on a foot or a gripper.
  // Links are allowed. Continuous bodies and links have a point for each impact. A sleeping body
  // has the points from when it fell asleep. None before the first step and after restore(). Not
  // included: rolling and spinning friction, and, between bodies in sub-steps, the friction of a
  // bounce. Precondition: contains(body).
  void contacts_of(BodyId body, std::vector<ContactPoint>& points) const;

  // --- queries ----------------------------------------------------------------------------------
  // Queries test every shape, through bounding volume trees, at the current poses. They change
  // nothing, not even the hash; no heap allocation once warm. At equal distance the older collider
  // comes first. Meshes and height fields are surfaces without an inside; rays and casts pass
  // one-sided triangles from behind. Rejected: numbers that are not finite or beyond 1e9,
  // directions of zero, negative distances, invalid shapes; with Errc::unsupported half-spaces,
  // meshes and height fields as the query shape.

  // The first collider along a ray of max_distance [m]; direction: any length but zero.
  [[nodiscard]] Expected<std::optional<RayHit>> ray_cast(const Vec3& origin, const Vec3& direction,
                                                         double max_distance,
                                                         const QueryFilter& filter = {}) const;
  // Appends to hits each collider with the ray's entry point, in order of distance.
  [[nodiscard]] Expected<void> ray_cast_all(const Vec3& origin, const Vec3& direction,
                                            double max_distance, std::vector<RayHit>& hits,
                                            const QueryFilter& filter = {}) const;
  // The first collider that the moving shape hits.
  [[nodiscard]] Expected<std::optional<ShapeHit>> shape_cast(const Shape& shape,
                                                             const SE3& T_world_shape,
                                                             const CastMotion& motion,
                                                             const QueryFilter& filter = {}) const;
  // Appends to hits each collider where the shape first hits it, ignoring all others, in order of
  // fraction.
  [[nodiscard]] Expected<void> shape_cast_all(const Shape& shape, const SE3& T_world_shape,
                                              const CastMotion& motion, std::vector<ShapeHit>& hits,
                                              const QueryFilter& filter = {}) const;
  // Appends to found the colliders that the shape overlaps, in order of creation.
  [[nodiscard]] Expected<void> overlapping(const Shape& shape, const SE3& T_world_shape,
                                           std::vector<ColliderId>& found,
                                           const QueryFilter& filter = {}) const;
  // The nearest collider, or the one the shape penetrates deepest, within max_distance.
  [[nodiscard]] Expected<std::optional<NearestHit>> nearest(const Shape& shape,
                                                            const SE3& T_world_shape,
                                                            double max_distance,
                                                            const QueryFilter& filter = {}) const;
  [[nodiscard]] Expected<std::optional<NearestHit>> nearest(const Vec3& point, double max_distance,
                                                            const QueryFilter& filter = {}) const;

  // Calls draw for everything that the options select. A callback must not change the world.
  // Rejected: sizes outside (0, 1e6].
  [[nodiscard]] Expected<void> debug_draw(const DebugDrawOptions& options, DebugDraw& draw) const;

  // --- rollback ---------------------------------------------------------------------------------
  // Appends to bytes the complete mutable state, warm starts and ids included: poses, velocities,
  // joint states, drives. A world made by the same sequence of calls to create, add and destroy,
  // with descriptions that are the same bit for bit, restores it and then steps to the same bits.
  // user_data is neither stored nor compared: the restoring world keeps its own.
  void snapshot(std::vector<std::byte>& bytes) const;
  // Errc::bad_data: truncated or corrupt bytes, or those of a world made by other calls. The world
  // is then unchanged.
  [[nodiscard]] Expected<void> restore(std::span<const std::byte> bytes);
  std::uint64_t state_hash() const;  // of the same bytes as snapshot()

  // --- recording --------------------------------------------------------------------------------
  // From now on the recorder stores every call that changes the world, of this object or the one it
  // is moved to; nullptr stops recording. See vphysics/recording.h. Rejected: a recorder that was
  // used before, and settings with numbers that no simulation has.
  [[nodiscard]] Expected<void> record(std::shared_ptr<Recorder> recorder);

 private:
  friend class Replay;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vp
