// A body as the world stores it: a free body or a link of an articulation.
#pragma once

#include <cstdint>
#include <vector>

#include "collide/bounds.h"
#include "solve/contact_graph.h"
#include "vphysics/world.h"
#include "world/slots.h"

namespace vp {

inline constexpr std::uint32_t kNone = 0xffffffffu;

struct Velocity {
  Vec3 w, v;  // world frame
  bool operator==(const Velocity&) const = default;
};

// A link's position in its articulation, which decides its neighbours. Values are link numbers,
// kWorld if fixed to the world. All are kWorld if links do not collide with each other.
struct LinkNeighbours {
  int leader = kWorld;  // of a group of links fixed together: the one that a joint moves
  int head = kWorld;    // of a chain of joints that rotate about one point: the leader of the first
  int base = kWorld;    // leader of the parent of that joint
};

// Data that a step reads of every body come first.
struct alignas(64) Body {
  bool alive = false;
  bool is_link = false;
  bool continuous = false;
  bool isotropic = false;  // rotational inertia the same about every axis: no gyroscopic term
  Motion motion = Motion::fixed;
  bool supported = false;  // something supported it in the last step
  bool on_link =
      false;  // in this step: close to a link, its solver state moves it (link_contacts.cpp)
  // posed and bounded are updated from the pose on demand. A link's T, w and v are refreshed only
  // if is_followed(); otherwise its articulation has them.
  bool asleep = false;
  bool is_being_posed = false;  // by one of several workers
  bool posed = false;           // the colliders' poses and bounds match T
  bool bounded = false;         // `bounds` matches T
  bool untouched = false;       // nothing changed its rotation in this step: it has rotated freely
  bool advanced = false;   // within a step: has its pose of the present sub-step (find_again.cpp)
  bool precesses = false;  // in this step: rotates freely within sub-steps (precession.h)
  bool is_top = false;     // it precesses and has its contacts renewed within the step
  bool bounced = false;    // in this step: off something, by restitution
  bool shortened = false;  // its motion in this step ended at an impact (fast_rotation.h)
  bool allow_sleep = true;
  bool mass_from_colliders = false;   // updated as colliders are added and removed
  bool requested_continuous = false;  // when it is dynamic
  bool remote = false;                // a link of a remote articulation (remote.cpp)
  bool has_sensor = false;
  bool unbounded = false;                       // carries a half-space
  std::uint16_t region = solve::kSharedRegion;  // regions.cpp
  std::uint16_t rotation_locks = 0;             // number of its joints that lock a rotation
  std::uint16_t row_joints = 0;                 // number of its joints in rows
  std::uint32_t contact_slots = 0;              // number of its contact slots in the solver
  std::uint32_t first_joint = kNone, first_collider = kNone;
  std::uint32_t load = kNone;  // index into the world's loads; kNone for links
  // bounding_radius: from the reference point to the farthest point of its bounded colliders [m].
  // min_size: half of the smallest extent of one of them [m].
  double bounding_radius = 0.0, min_size = 1e9;
  // State and constants.
  Vec3 w, v;  // world frame; v of the reference point (centre of mass; a link's origin)
  double inverse_mass = 0.0;
  double gravity_scale = 1.0;
  SE3 T;                          // T_world_body
  Vec3 centre;                    // of mass, body frame
  Sym3 inverse_central, central;  // rotational inertia about it, body frame
  double linear_damping = 0.0, angular_damping = 0.0;
  float bounded_at[6] = {};  // displacement of its state when its proxies' bounds were last set
  // Time since it was last faster than desc.sleep_speed [s]. Of a sleep candidate: sleep_after and
  // the time since it became one (sleep.cpp).
  double rest_time = 0.0;

  std::uint64_t pose_number = 1;  // version of T: incremented with each move

  std::uint64_t island = 0;  // the island that it was last found in (sleep.cpp)
  double mass = 0.0;
  se3 prescribed;              // kinematic: body frame
  Velocity last_acceleration;  // kinematic: from one step's mean velocity to the next one's
  collide::Bounds local;       // of its bounded colliders, body frame
  // Of a link that only slides along and rotates about a line: bounds of its bounded colliders for
  // all rotations, about its origin in world axes. Otherwise empty.
  collide::Bounds around_line;
  collide::Bounds bounds;
  std::uint32_t generation = 0;
  std::uint32_t articulation = kNone;
  int link = 0;  // number within the articulation
  LinkNeighbours neighbours;
  std::uint32_t last_collider = kNone;
  std::uint32_t first_edge = kNone;         // head of its list of contacts
  std::uint32_t categories = 0, masks = 0;  // union over its colliders
  std::uint64_t user_data = 0;

  // Of a link: T, w and v are kept up to date.
  bool is_followed() const { return first_collider != kNone || first_joint != kNone; }
  // Its solver state moves it; otherwise it falls freely.
  bool is_solver_driven() const { return contact_slots > 0 || first_joint != kNone || on_link; }
  bool tumbles() const { return motion == Motion::dynamic && !is_link && !isotropic; }
  // Between the impulses that it gets. Those of a continuous body, of its joints too, act at the
  // start of a step and at its impacts. What a joint keeps from rotating follows its solved rate.
  bool rotates_freely() const {
    return !is_solver_driven() || untouched || (continuous && rotation_locks == 0);
  }
  void moved() {
    posed = bounded = false;
    ++pose_number;
  }
};

using Bodies = Slots<Body, BodyId>;

// The bodies that a step processes, in ascending order.
class BodyLists {
 public:
  std::vector<std::uint32_t> awake_bodies;                 // awake, not fixed, not links
  std::vector<std::uint32_t> links;                        // with colliders
  bool some_continuous = false, some_sub_stepped = false;  // of the awake bodies
  bool some_sleep = false;

  // Bodies or colliders were added or removed, fell asleep or woke.
  void invalidate() { dirty_ = true; }
  // False: the lists have not changed.
  bool refresh(const Bodies& bodies);
  // The bodies of the impact stage, ascending: all that are not fixed, and links with colliders
  // except those of remote articulations.
  const std::vector<std::uint32_t>& of_impacts(const Bodies& bodies);
  void invalidate_impacts() { impacts_are_dirty_ = true; }

 private:
  bool dirty_ = true, impacts_are_dirty_ = true;
  std::vector<std::uint32_t> of_impacts_;
};

// Whether it takes part in the sub-stepped solver.
inline bool joins_sub_steps(const Body& body) {
  return body.alive && !body.is_link && !body.continuous && body.motion != Motion::fixed;
}
inline bool is_still(const Body& body) {
  return body.asleep || body.motion == Motion::fixed;
}
// Links of one articulation that never collide: neighbours, or all of them (ArticulationDesc).
bool never_collide(const Body& a, const Body& b);
// Whether any collider of one may collide with any collider of the other.
bool may_overlap(const Body& a, const Body& b);
// The solver's data of a body in a contact or a joint.
solve::ContactGraph::End end_of(const Bodies& bodies, std::uint32_t body);

inline Vec3 reference_point(const Body& body) {
  return body.motion == Motion::dynamic && !body.is_link ? body.T * body.centre : body.T.position();
}
// Moves the body so that its reference point is at `reference`.
void set_pose(Body& body, const Vec3& reference, const Mat3& R);

// Distance from the body's reference point to the farthest point of its local bounds.
double bounding_radius_of(const Body& body);
// Of a dynamic body. Does not adapt v to the new centre of mass.
void set_mass(Body& body, const Inertia& inertia);

// Rotation and angular velocity after torque-free motion for h; world frame.
struct Rotated {
  Mat3 R;
  Vec3 w;
};
// With more_w: rotates at the angular velocity w + more_w, and ends with the angular momentum of w.
Rotated rotated_freely(const Body& body, double h, const Vec3& more_w = {});
// The angular velocity of a body that its contacts rotate to R: w, or, if that would increase the
// energy, w constant in the body frame. What bounced keeps the energy of its bounce, which the
// solver has computed at the orientation before: by the size of w, or, if that is far off, by w
// constant in the body frame.
Vec3 rate_at(const Body& body, const Mat3& R);
// R after a small rotation, a vector in the outer frame.
Mat3 rotated(const Mat3& R, const Vec3& rotation);

}  // namespace vp
