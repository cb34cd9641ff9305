// A world of rigid bodies and articulations, stepped deterministically.
//
// Units: SI. Right-handed frames. Generalized velocities V = (w, v) are in the body's own frame,
// about the body's origin (paper, section 4.2). Everything a call needs to be refused is checked:
// NaN, infinities, sizes and masses out of range and stale ids give an Error and change nothing.
// Not checked: that an id is of this world (ids.h).
//
// Threads: a World is used by one thread at a time; different worlds are independent.
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
  double restitution_threshold = 0.05;  // slower approaches than this [m/s] do not bounce
  double contact_slop = 1e-4;           // penetration left alone [m]; also the contact margin
  int velocity_iterations = 12;         // of the contact solver, per solve
  // Of the contact solver; 0: 2 at 1 kHz, 5 at 240 Hz, 9 at 60 Hz of things of a metre.
  int sub_steps = 0;
  int max_impacts_per_step = 32;  // times of impact resolved within one step
  // Bodies that hang together by contacts and joints fall asleep when none has been faster, at any
  // of its points, than sleep_speed [m/s] for so long [s]; 0: never. Asleep they cost nothing. What
  // touches them with a speed of its own, and every call that changes them, wakes them.
  double sleep_after = 0.0;
  double sleep_speed = 0.02;
  // Where more bodies move than this they are divided into regions of at most so many, or into
  // 4096, that lie together. The solver goes over one region after the other, or several workers
  // over several, and has each in a processor's second-level cache meanwhile: 1000 boxes and their
  // contacts take a megabyte. From 1 to 1,000,000. The order of solving follows from it, so results
  // do too.
  int region_bodies = 2048;
  // The size of typical things [m]. contact_slop is that of things of a metre and counts so many
  // times. What falls by its own size is faster and takes longer by the root of that: so many times
  // count restitution_threshold, sleep_speed and the speeds at which overlaps and open joints are
  // taken out, and sub-steps that the step's length decides follow. From 1e-6 to 1e6. Towers of
  // cubes of 1 cm at 60 Hz want 0.01.
  double length_unit = 1.0;
};

enum class Motion : std::uint8_t {
  fixed,      // never moves
  kinematic,  // moves with the velocity it is given; nothing pushes it
  dynamic,    // moved by forces and contacts
};

struct BodyDesc {
  Motion motion = Motion::dynamic;
  SE3 T_world_body;
  se3 velocity;  // body frame [rad/s, m/s]
  // About the body's origin. None, as here: a dynamic body has the mass of its colliders, by their
  // shapes and densities, as they are added and removed; until one has a volume, 1 kg and 1 kg m^2
  // about each axis. Of dynamic bodies: mass from 1e-15 to 1e9 kg, moments about the centre
  // of mass from 1e-30 kg m^2, a water drop of a micrometre, to 1e15, and those of a mass: none of
  // the three principal ones above the sum of the others, but by the 4 % of
  // rounded numbers.
  Inertia inertia;
  double linear_damping = 0.0;   // [1/s]
  double angular_damping = 0.0;  // [1/s]
  double gravity_scale = 1.0;    // of WorldDesc::gravity; at most 1e6 either way
  bool allow_sleep = true;       // false: nor does anything sleep that hangs together with it
  bool continuous = false;       // passes through nothing, however fast
  std::uint64_t user_data = 0;
};

// A tree of links with any joints (multibody/model.h). Each link is a body of the world, which
// takes colliders as others do, but is moved by its joints alone. Armature, damping, stops, springs
// and friction of the joints are the model's; stops, springs and friction are solved together with
// the contacts, springs implicitly.
//
// A tree whose root is a free joint without damping and armature keeps its momentum to rounding
// where nothing touches it. The forces that velocities make are integrated explicitly: a tree that
// swings by more than about half a radian a step gains energy.
struct ArticulationDesc {
  Model model;
  // Links meet each other as other bodies do, by their colliders' filters, but for neighbours: a
  // link and its parent. What hangs together by joints without degrees of freedom counts as one
  // link, what is fixed to the world as one with the world; revolute, universal and ball joints at
  // one point, as a hip of three hinges, count as one joint, and all its links as neighbours.
  // False: no two of its links meet.
  bool links_collide = false;
};

// What a pair of colliders did in a step. Bodies that meet in sub-steps tell at the end of the
// step, with time 0; continuous bodies and what links touch tell each impact with its own time. A
// pair has at most one hit from all sub-steps of a step, and one from each impact.
struct ContactEvent {
  enum class Kind : std::uint8_t {
    begin,  // they touch, and did not before
    // They closed faster than restitution_threshold, what the step's own forces add left out.
    // Follows the begin of the same time, if there is one: a pair that touches may hit again, as in
    // a last small bounce within one step, so that hits may be more than begins.
    hit,
    end,  // they touch no more, or one was destroyed: each begin is followed by one end
  };
  Kind kind;
  bool sensor;                             // one of the two is a sensor: no hits
  ColliderId a, b;                         // a < b by creation
  std::uint64_t user_data_a, user_data_b;  // 0 for a collider that was destroyed; its id is stale
  // World frame [m]; 0 in an end, as all numbers below. Where a sensor begins to see something: of
  // a continuous body its shape's origin, of a link a point of the overlap, of others 0.
  Vec3 point;
  Vec3 normal;            // world frame, from a to b; 0 for sensors, but of those that see a link
  double approach_speed;  // just before, along the normal [m/s], >= 0
  double impulse;         // normal impulse [N s]; 0 for sensors
  double time;            // within the step, [0, dt]: 0 but of impacts, and of sensors swept into
};

// In the world's axes.
struct VelocityWorld {
  Vec3 linear;   // [m/s]
  Vec3 angular;  // [rad/s]
};

// Where a collider of a body touches another, and what that did to the body in a step.
struct ContactPoint {
  ColliderId collider, other;  // the body's, and what it touches
  Vec3 point;                  // world frame [m]; to a hundredth of the shapes' size
  Vec3 normal;                 // unit, world frame, towards the body
  double normal_impulse;       // of the whole step, along the normal, >= 0 [N s]
  Vec3 friction_impulse;       // across the normal, world frame [N s]
};

class Recorder;

class World {
 public:
  // Of settings that come from a file or a user. Refused: numbers that are not finite, negative
  // ones, gravity or lengths beyond 1e9, no iterations or more than 1000, sub-steps beyond 1000,
  // more than 100000 impacts a step, regions of no bodies or of more than 1,000,000.
  [[nodiscard]] static Expected<World> create(const WorldDesc& desc);
  // Precondition: create() would take it.
  explicit World(const WorldDesc& desc = {});
  ~World();
  // Precondition of every call: not moved from. Such a world may be destroyed or assigned to.
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  // --- building ---------------------------------------------------------------------------------
  [[nodiscard]] Expected<BodyId> create_body(const BodyDesc& desc);
  // Its colliders go with it; the next step reports the end of what they touched. Refused for
  // links.
  [[nodiscard]] Expected<void> destroy_body(BodyId body);
  [[nodiscard]] Expected<ColliderId> add_collider(BodyId body,
                                                  const ColliderDesc& desc);  // links too
  // Mass, centre of mass and inertia of a dynamic body from its colliders' shapes and densities.
  // Sensors count for nothing; what two shapes both fill counts twice. The velocity stays that of
  // the body's origin. Refused: links, bodies that are not dynamic or have no collider with a mass,
  // and what create_body refuses as an inertia.
  [[nodiscard]] Expected<void> set_mass_from_colliders(BodyId body);
  // With every joint at zero, or at the stop next to it, at rest. Refused with Errc::singular: a
  // joint that moves no inertia.
  [[nodiscard]] Expected<ArticulationId> create_articulation(const ArticulationDesc& desc);
  BodyId link_body(ArticulationId articulation, int link) const;  // null if there is none

  // Destroying either body destroys the joint.
  [[nodiscard]] Expected<JointId> create_joint(BodyId a, BodyId b, const JointDesc& desc);
  [[nodiscard]] Expected<void> destroy_joint(JointId joint);

  // --- changes ----------------------------------------------------------------------------------
  // Of what the world is made of, while it runs. All wake what sleeps. A snapshot of before is
  // refused after one of them, as after other calls that build; they are recorded. Refused: stale
  // ids, links where a body is asked for, and values that create_body() and add_collider() refuse.

  // Its velocity stays, as far as the motion knows one: what becomes kinematic goes on at it. What
  // becomes dynamic has the inertia that it was created with or given, or that of its colliders.
  // Its contacts end, and those that still touch begin again in the next step. Refused:
  // half-spaces, meshes and height fields on what may not carry them, joints left without a dynamic
  // body.
  [[nodiscard]] Expected<void> set_motion(BodyId body, Motion motion);
  // Instead of what it had, its colliders' too. The velocity of its origin stays.
  [[nodiscard]] Expected<void> set_inertia(BodyId body, const Inertia& inertia);
  [[nodiscard]] Expected<void> set_damping(BodyId body, double linear, double angular);  // [1/s]
  [[nodiscard]] Expected<void> set_gravity_scale(BodyId body, double scale);
  [[nodiscard]] Expected<void> set_allow_sleep(BodyId body, bool allow);

  bool contains(ColliderId collider) const;
  BodyId body_of(ColliderId collider) const;  // null if there is none
  // Links' colliders too. Contacts have the new values from the next step on, and what no longer
  // meets by its filter ends.
  [[nodiscard]] Expected<void> set_material(ColliderId collider, const Material& material);
  [[nodiscard]] Expected<void> set_filter(ColliderId collider, const CollisionFilter& filter);
  [[nodiscard]] Expected<void> set_surface_velocity(ColliderId collider, const Vec3& velocity);
  // The next step reports the end of what it touched.
  [[nodiscard]] Expected<void> remove_collider(ColliderId collider);

  bool contains(ArticulationId articulation) const;
  // With its links and their colliders; the next step reports the end of what they touched.
  [[nodiscard]] Expected<void> destroy_articulation(ArticulationId articulation);

  // --- state ------------------------------------------------------------------------------------
  bool contains(BodyId body) const;
  SE3 pose(BodyId body) const;         // T_world_body; precondition: contains(body)
  se3 velocity(BodyId body) const;     // body frame; precondition: contains(body)
  Inertia inertia(BodyId body) const;  // about its origin, 0 if not dynamic; precondition: the same
  [[nodiscard]] Expected<void> set_pose(BodyId body, const SE3& T_world_body);  // refused for links
  [[nodiscard]] Expected<void> set_velocity(BodyId body, const se3& velocity);  // refused for links
  // The same in the world's axes, and of the centre of mass: of links too; of links without mass
  // and of bodies that are not dynamic, of the origin. Precondition: contains(body).
  VelocityWorld velocity_world(BodyId body) const;
  Vec3 velocity_at(BodyId body, const Vec3& point_world) const;  // of the body's point there [m/s]
  // Refused for links, and where set_velocity is.
  [[nodiscard]] Expected<void> set_velocity_world(BodyId body, const VelocityWorld& velocity);
  // Refused: what would make it faster than 1e9 m/s or rad/s.
  [[nodiscard]] Expected<void> apply_impulse(BodyId body, const Vec3& impulse_world,
                                             const Vec3& point_world);
  // Forces and torques act over the whole of the next step, constant in the world frame, and are
  // forgotten when it ends: apply them again before each. What is applied before the same step adds
  // up. Contacts, friction and joints meet them as they meet gravity, as a load and not as an
  // impact. Links too. What sleeps is woken. Refused: bodies that are not dynamic, and what would
  // make one faster than 1e9 m/s or rad/s within 0.1 s; of links, sums beyond 1e9 N or N m. Until
  // they are forgotten, masses and poses with which they would are refused too.
  // The moment about the centre of mass is that of the moment of the call; without a point the
  // force acts through the centre of mass.
  [[nodiscard]] Expected<void> apply_force(BodyId body, const Vec3& force_world,
                                           const Vec3& point_world);
  [[nodiscard]] Expected<void> apply_force(BodyId body, const Vec3& force_world);
  [[nodiscard]] Expected<void> apply_torque(BodyId body, const Vec3& torque_world);
  bool is_asleep(BodyId body) const;  // precondition: contains(body)
  // With all that hangs together with it; nothing if it is awake.
  [[nodiscard]] Expected<void> wake(BodyId body);

  const Model* model(ArticulationId articulation) const;  // what it was created of; null: no such
  // All coordinates and velocities of an articulation, as its model orders them; valid until the
  // next call that changes the world. Precondition: the articulation exists.
  std::span<const double> coordinates(ArticulationId articulation) const;
  std::span<const double> velocities(ArticulationId articulation) const;
  // Refused: other lengths, numbers that are not finite or beyond 1e9, coordinates beyond a limit,
  // a quaternion that is not of unit length.
  [[nodiscard]] Expected<void> set_joint_states(ArticulationId articulation,
                                                std::span<const double> coordinates,
                                                std::span<const double> velocities);

  // One degree of freedom of a link's joint, counted from 0; not of a ball or a free joint.
  double joint_position(ArticulationId articulation, int link, int dof) const;
  double joint_velocity(ArticulationId articulation, int link, int dof) const;
  [[nodiscard]] Expected<void> set_joint_state(ArticulationId articulation, int link, int dof,
                                               double position, double velocity);
  // Of any joint.
  [[nodiscard]] Expected<void> set_drive(ArticulationId articulation, int link, int dof,
                                         const JointDrive& drive);
  // The same of all its degrees of freedom, in the order of velocities(): for many joints cheaper
  // than a call for each. Refused: another number of drives, or one refused; then all stay.
  [[nodiscard]] Expected<void> set_drives(ArticulationId articulation,
                                          std::span<const JointDrive> drives);

  // A force [N] or torque [N m] of one degree of freedom, dual to its velocity, over the next step
  // as apply_force() has it; beside the drive. Of any joint: of a ball or a free one it is in the
  // link's frame. Refused: sums beyond 1e9.
  [[nodiscard]] Expected<void> apply_joint_force(ArticulationId articulation, int link, int dof,
                                                 double force);

  // What a link's joint did to the link in the last step, on the average: force and torque in the
  // world frame, the torque about the link's origin. A force-torque sensor in the joint reads it;
  // the parent gets the opposite. Of fixed joints too. Motors, stops, friction, springs, the user's
  // joint forces and what holds the joint are in it, impacts within the step by impulse / dt. Found
  // from the momenta and from gravity, the user's forces and contacts, with rolling friction: exact
  // at rest, to the order of dt in motion. A free root without damping and armature has its
  // joint_effort() alone: what position corrections of contacts change of its momentum is in no
  // reaction. Joints hold what StepStatus::impact_limit holds. apply_impulse and states set between
  // steps are not in it. Zero before the first step, after restore() and after a step in which the
  // articulation left the range of numbers. The first question after a step costs O(links), the
  // first of all allocates. Precondition: the articulation has that link.
  JointForce joint_reaction(ArticulationId articulation, int link) const;
  // What acted along one degree of freedom in the last step, on the average [N] or [N m]: motor,
  // friction, spring, stops, damping, the user's joint force. The reaction along the same axis is
  // that less armature times its acceleration, to the order of dt. Zero as above. Of any
  // joint; precondition: it has that degree of freedom.
  double joint_effort(ArticulationId articulation, int link, int dof) const;
  // Of a link alone: the mean acceleration over the last step of its point that is there now, world
  // frame [m/s^2]. An accelerometer reads that less gravity, in its own axes. Zero as above.
  // Precondition: the body is a link; what is to carry such a sensor and hangs on nothing is an
  // articulation of one link with a free joint.
  Vec3 acceleration_at(BodyId link, const Vec3& point_world) const;

  bool contains(JointId joint) const;
  // As the world stands now. The first is of the joint's one coordinate; of a ball, a weld and six
  // degrees of freedom ask by axis, of a UserConstraint by row. Precondition: the joint exists and
  // has that coordinate, and a row's number is below rows().
  double joint_coordinate(JointId joint) const;
  double joint_coordinate(JointId joint, JointAxis axis) const;
  double joint_residual(JointId joint, int row) const;
  // Refused: joints that have no such coordinate, or hold it, as well as those without a drive.
  [[nodiscard]] Expected<void> set_drive(JointId joint, const JointDrive& drive);
  [[nodiscard]] Expected<void> set_drive(JointId joint, JointAxis axis, const JointDrive& drive);
  // Of the last step; zero before the first and after restore(). Precondition: the joint exists.
  JointForce joint_force(JointId joint) const;

  // --- time -------------------------------------------------------------------------------------
  // Who helps with the steps to come; null: nobody. The results are the same bits.
  void set_task_scheduler(std::shared_ptr<TaskScheduler> scheduler);
  // Who is told of the stages of the steps to come; null: nobody, which costs nothing. The results
  // are the same bits.
  void observe_stages(std::shared_ptr<StageObserver> observer);
  // Advances by dt seconds, 1e-7 <= dt <= 0.1 (else refused): what still shorter steps add to a
  // speed is lost in the solver's single precision. No heap allocation once warm.
  [[nodiscard]] Expected<StepStatus> step(double dt);
  // Of the last step, by time, of one time as they were found; none after restore().
  std::span<const ContactEvent> contact_events() const;
  const StepCounters& counters() const;  // of the last step
  // All points at which the body touches others that push it, with the impulses of the last step on
  // it, appended: divided by dt, the mean forces on a foot or a gripper. Links too. What is swept
  // or of a link has a point for each impact. Of what sleeps, as when it fell asleep; none before
  // the first step and after restore(). Not in it: rolling and spinning friction, and between
  // bodies in sub-steps the friction of a bounce. Precondition: contains(body).
  void contacts_of(BodyId body, std::vector<ContactPoint>& points) const;

  // --- queries ----------------------------------------------------------------------------------
  // Against every shape, through trees of bounds, at the poses of now. Nothing is changed, not even
  // the hash; no heap allocation once warm. Of what is equally far the older collider comes first.
  // Meshes and height fields are where their triangles are, without an inside; one-sided triangles
  // let rays and casts pass from behind. Refused: numbers that are not finite or beyond 1e9,
  // directions of zero, negative distances, shapes that are not proper; with Errc::unsupported
  // half-spaces, meshes and height fields as the shape that is asked about.

  // The first collider along a ray of max_distance [m]; the direction is of any length but zero.
  [[nodiscard]] Expected<std::optional<RayHit>> ray_cast(const Vec3& origin, const Vec3& direction,
                                                         double max_distance,
                                                         const QueryFilter& filter = {}) const;
  // Each collider where the ray enters it first, in order of distance, appended to hits.
  [[nodiscard]] Expected<void> ray_cast_all(const Vec3& origin, const Vec3& direction,
                                            double max_distance, std::vector<RayHit>& hits,
                                            const QueryFilter& filter = {}) const;
  // The first collider that a shape meets on its way.
  [[nodiscard]] Expected<std::optional<ShapeHit>> shape_cast(const Shape& shape,
                                                             const SE3& T_world_shape,
                                                             const CastMotion& motion,
                                                             const QueryFilter& filter = {}) const;
  // Each collider where the shape, were the others not there, would meet it first, in order of
  // fraction, appended to hits.
  [[nodiscard]] Expected<void> shape_cast_all(const Shape& shape, const SE3& T_world_shape,
                                              const CastMotion& motion, std::vector<ShapeHit>& hits,
                                              const QueryFilter& filter = {}) const;
  // Colliders that the shape touches, in order of creation, appended to found.
  [[nodiscard]] Expected<void> overlapping(const Shape& shape, const SE3& T_world_shape,
                                           std::vector<ColliderId>& found,
                                           const QueryFilter& filter = {}) const;
  // The collider that is nearest, or in which the shape is deepest, no farther than max_distance.
  [[nodiscard]] Expected<std::optional<NearestHit>> nearest(const Shape& shape,
                                                            const SE3& T_world_shape,
                                                            double max_distance,
                                                            const QueryFilter& filter = {}) const;
  [[nodiscard]] Expected<std::optional<NearestHit>> nearest(const Vec3& point, double max_distance,
                                                            const QueryFilter& filter = {}) const;

  // Tells draw what the options ask for; a callback must not change the world. Refused: sizes that
  // are not in (0, 1e6].
  [[nodiscard]] Expected<void> debug_draw(const DebugDrawOptions& options, DebugDraw& draw) const;

  // --- rollback ---------------------------------------------------------------------------------
  // The whole mutable state, warm starts and ids included, appended to bytes. A world made by the
  // same sequence of calls to create, add and destroy, with descriptions the same bit for bit,
  // restores it and then steps to the same bits. Poses, velocities, joint states and drives are in
  // it; user_data is not, nor compared: it stays what the world that restores was given.
  void snapshot(std::vector<std::byte>& bytes) const;
  // Refuses truncated or corrupt bytes and those of a world made otherwise with Errc::bad_data; the
  // world is then unchanged.
  [[nodiscard]] Expected<void> restore(std::span<const std::byte> bytes);
  std::uint64_t state_hash() const;  // of the same bytes as snapshot()

  // --- recording --------------------------------------------------------------------------------
  // From now on the recorder notes every call that changes the world, of this object or of the one
  // it is moved to; nullptr ends the recording. vphysics/recording.h. Refused: a recorder that has
  // been used, settings with numbers that no simulation has.
  [[nodiscard]] Expected<void> record(std::shared_ptr<Recorder> recorder);

 private:
  friend class Replay;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vp
