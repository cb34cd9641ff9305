// Remote articulations: nothing can collide with them, so a step skips their links.
//
// A step advances the coordinates of a remote articulation. Poses, velocities and AABBs of its
// links are updated when a body comes close or when they are requested (follow()). Each iteration
// finds the colliding pairs again from the AABBs. So remoteness changes the cost of a step, but not
// its results.
//
// Only for articulations whose links all translate along and rotate about one line, and whose
// motors need no solver. Their rotation does not change any AABB (Body::around_line), and their
// translation follows from few coordinates.
#include <algorithm>
#include <cmath>

#include "world/impact_stage.h"

namespace vp {
namespace {

// With more moving bodies than this, the test of each articulation would cost more than it saves.
constexpr std::size_t kFewMovingBodies = 8;
// Max translation of a remote articulation before it is updated [m]. And the min distance of bodies
// from its enlarged AABB for it to become remote, so that it does not alternate between both
// states.
constexpr double kRemoteSlide = 0.03, kClear = 0.01;

// Valid until a body or a collider is added or removed.
bool can_be_remote(const Articulation& art, const Bodies& bodies) {
  if (!art.keeps_twists() || !art.is_decoupled()) return false;
  for (const std::uint32_t b : art.bodies) {
    if (bodies[b].first_joint != kNone) return false;
    if (bodies[b].first_collider == kNone) continue;
    for (const Body& other : bodies) {
      const bool tested = !other.is_link && other.motion != Motion::fixed;  // as awake bodies
      if (other.alive && !tested && may_overlap(bodies[b], other)) return false;
    }
  }
  return true;
}

}  // namespace

void ImpactStage::list_bodies() {
  swept_body_pairs_.invalidate();
  discrete_body_pairs_.list_filters(s_.bodies);
  const bool few = !s_.lists.some_sub_stepped && s_.desc.sleep_after <= 0.0 &&
                   s_.lists.awake_bodies.size() <= kFewMovingBodies;
  scratch_is_dirty_ = true;
  for (Articulation& art : s_.articulations) {
    if (!art.alive) continue;
    if (art.remote) follow(art, s_.bodies, s_.lists);
    art.can_be_remote = few && can_be_remote(art, s_.bodies);
  }
}

bool ImpactStage::is_near_awake_body(const collide::Bounds& box) const {
  return std::any_of(s_.lists.awake_bodies.begin(), s_.lists.awake_bodies.end(),
                     [&](std::uint32_t m) { return overlap(box, bounds_[m]); });
}

// Call it after the AABBs of the other articulations are updated. Articulations that an awake body
// may collide with within h, or that have translated far, stop being remote.
void ImpactStage::collide_remote(double h) {
  const double slop = s_.desc.contact_slop;
  for (Articulation& art : s_.articulations) {
    if (!art.remote) continue;
    if (art.slides_since_remote(h) + slop < kRemoteSlide && !is_near_awake_body(art.remote_box))
      continue;
    follow(art, s_.bodies, s_.lists);
    for (const std::uint32_t b : art.bodies) {
      refresh_motion_of(b, h);
      refresh_bounds_of(b, h);
    }
  }
}

// Called at the start of the impact stage.
void ImpactStage::make_remote() {
  for (Articulation& art : s_.articulations) {
    if (art.remote || !art.can_be_remote || art.sub_stepped) continue;
    collide::Bounds box;
    Vec3 line;
    for (const std::uint32_t b : art.bodies) {
      if (s_.bodies[b].first_collider == kNone) continue;
      box = merged(box, bounds_at_pose(s_.bodies[b], s_.colliders));
      line = art.line_of(s_.bodies[b].link);
    }
    const Vec3 along = kRemoteSlide * Vec3{std::fabs(line.x), std::fabs(line.y), std::fabs(line.z)};
    box = collide::grown({box.lower - along, box.upper + along}, s_.desc.contact_slop);
    if (is_near_awake_body(collide::grown(box, kClear))) continue;
    art.set_remote(box);
    for (const std::uint32_t b : art.bodies) {
      s_.bodies[b].remote = true;
      bounds_[b] = {};
    }
    s_.lists.invalidate_impacts();
  }
}

}  // namespace vp
