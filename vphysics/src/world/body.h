// A body, as the world keeps it: free bodies and the links of articulations alike.
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

// Where a link is among those of its articulation, by which it knows its neighbours: links'
// numbers, kWorld of what is fixed to the world. All are kWorld where links do not meet each other.
struct LinkNeighbours {
  int leader = kWorld;  // of all that is fixed together: the one that a joint moves
  int head = kWorld;    // of joints that turn about one point: the leader of the first
  int base = kWorld;    // the leader of what that joint hangs on
};

// What a step reads of every body comes first.
struct alignas(64) Body {
  bool alive = false;
  bool is_link = false;
  bool continuous = false;
  bool isotropic = false;  // rotational inertia the same about every axis: no gyroscopic term
  Motion motion = Motion::fixed;
  bool rested = false;   // something carried it in the last step
  bool on_link = false;  // in this step: near a link, its row leads it (link_contacts.cpp)
  // Follow from the pose when they are needed. A link's T, w and v are refreshed only if it has
  // colliders; else ask its articulation.
  bool asleep = false;
  bool target = false;     // its colliders' poses are about to be computed
  bool posed = false;      // the colliders' poses and bounds are those of T
  bool bounded = false;    // so are `bounds`
  bool untouched = false;  // by what its row met in this step, so it has turned freely
  bool allow_sleep = true;
  bool mass_from_colliders = false;        // as they come and go
  bool wants_continuous = false;           // as a dynamic body
  std::uint16_t region = solve::kBetween;  // regions.cpp
  std::uint32_t lanes = 0;                 // of the solver that hold it
  std::uint32_t first_joint = kNone, first_collider = kNone;
  std::uint32_t load = kNone;  // its entry in the world's loads; of a link none
  float bounded_at[6] = {};    // its way when its proxies' bounds were last set
  // To the farthest point of its bounded colliders from the reference point; half of the least
  // extent of one [m].
  double bounding_radius = 0.0, min_size = 1e9;
  // State, with what is constant of it.
  Vec3 w, v;  // world frame; v of the reference point (centre of mass; a link's origin)
  double inverse_mass = 0.0;
  SE3 T;                          // T_world_body
  Vec3 centre;                    // of mass, body frame
  Sym3 inverse_central, central;  // rotational inertia about it, body frame
  double linear_damping = 0.0, angular_damping = 0.0;
  double gravity_scale = 1.0;
  // Since it was last faster than desc.sleep_speed; once a candidate for sleep, sleep_after and the
  // time since it asked (sleep.cpp) [s].
  double rest_time = 0.0;

  std::uint64_t pose_number = 1;  // of T: how often it has moved

  std::uint64_t island = 0;  // the last that it was found in (sleep.cpp)
  double mass = 0.0;
  se3 prescribed;         // kinematic: body frame
  collide::Bounds local;  // of its bounded colliders, body frame
  // Of a link that moves along and about a line alone: of its bounded colliders, wherever it turns,
  // about its origin in the world's axes. Empty for all else.
  collide::Bounds around_line;
  collide::Bounds bounds;
  std::uint32_t generation = 0;
  std::uint32_t articulation = kNone;
  int link = 0;  // of it
  LinkNeighbours neighbours;
  std::uint32_t last_collider = kNone;
  std::uint32_t first_edge = kNone;         // of its contacts
  std::uint32_t categories = 0, masks = 0;  // union over its colliders
  bool has_sensor = false;
  bool unbounded = false;  // carries a half-space
  std::uint64_t user_data = 0;

  // Of a link: T and the velocities are its own.
  bool is_followed() const { return first_collider != kNone || first_joint != kNone; }
  // Its row of the solver tells how it goes; else it falls freely.
  bool by_rows() const { return lanes > 0 || first_joint != kNone || on_link; }
  bool tumbles() const { return motion == Motion::dynamic && !is_link && !isotropic; }
  bool rotates_freely() const { return !by_rows() || untouched; }
  void moved() {
    posed = bounded = false;
    ++pose_number;
  }
};

using Bodies = Slots<Body, BodyId>;

// Which bodies a step goes through, ascending.
class BodyLists {
 public:
  std::vector<std::uint32_t> awake_bodies;  // that are awake and not fixed, but links
  std::vector<std::uint32_t> links;         // with colliders
  bool some_continuous = false, some_sub_stepped = false;  // of the movers
  bool some_sleep = false;

  // Bodies or colliders have come or gone, fallen asleep or woken.
  void invalidate() { dirty_ = true; }
  // False: they are as before.
  bool refresh(const Bodies& bodies);

 private:
  bool dirty_ = true;
};

// Whether it takes part in the sub-stepped solver.
inline bool joins_sub_steps(const Body& body) {
  return body.alive && !body.is_link && !body.continuous && body.motion != Motion::fixed;
}
inline bool is_still(const Body& body) {
  return body.asleep || body.motion == Motion::fixed;
}
// Links of one articulation that never meet: neighbours, or all of it (ArticulationDesc).
bool never_collide(const Body& a, const Body& b);
// Whether any collider of the one may meet any of the other.
bool may_overlap(const Body& a, const Body& b);
// What the solver wants to know of a body that a contact or a joint holds.
solve::ContactGraph::End end_of(const Bodies& bodies, std::uint32_t body);

inline Vec3 reference_point(const Body& body) {
  return body.motion == Motion::dynamic && !body.is_link ? body.T * body.centre : body.T.position();
}
// Puts a body's reference point there.
void place(Body& body, const Vec3& reference, const Mat3& R);

// Distance from the body's reference point to the farthest point of its local bounds.
double bounding_radius_of(const Body& body);
// Of a dynamic body; its velocities are not those of the new centre of mass.
void set_mass(Body& body, const Inertia& inertia);

// Where a body comes to in h, and its rate there, if nothing touches it; world frame.
struct Rotated {
  Mat3 R;
  Vec3 w;
};
// With more_w: it turns as at the rate w + more_w, and ends with the angular momentum of w.
Rotated rotated_freely(const Body& body, double h, const Vec3& more_w = {});
// The rate of a body that is turned to R at a rate of its contacts' choice: as seen from the body
// where its energy would grow else.
Vec3 rate_at(const Body& body, const Mat3& R);
// The rotation R after a small turn, a vector of the outer frame.
Mat3 rotated(const Mat3& R, const Vec3& rotation);

}  // namespace vp
