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

#include "world/impl.h"

namespace vp {
namespace {

// With more moving bodies than this, the test of each articulation would cost more than it saves.
constexpr std::size_t kFewMovingBodies = 8;
// Max translation of a remote articulation before it is updated [m]. And the min distance of bodies
// from its enlarged AABB for it to become remote, so that it does not alternate between both
// states.
constexpr double kRemoteSlide = 0.03, kClear = 0.01;

}  // namespace

// Valid until a body or a collider is added or removed.
bool World::Impl::can_be_remote(const Articulation& art) const {
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

void World::Impl::list_remote_articulations() {
  const bool few = !lists.some_sub_stepped && desc.sleep_after <= 0.0 &&
                   lists.awake_bodies.size() <= kFewMovingBodies;
  impacts.scratch_is_dirty = true;
  for (Articulation& art : articulations) {
    if (!art.alive) continue;
    update_if_remote(art);
    art.can_be_remote = few && can_be_remote(art);
  }
}

bool World::Impl::is_near_awake_body(const collide::Bounds& box) const {
  return std::any_of(lists.awake_bodies.begin(), lists.awake_bodies.end(),
                     [&](std::uint32_t m) { return overlap(box, impacts.bounds[m]); });
}

// Call it after the AABBs of the other articulations are updated. Articulations that an awake body
// may collide with within h, or that have translated far, stop being remote.
void World::Impl::collide_remote(double h) {
  for (Articulation& art : articulations) {
    if (!art.remote) continue;
    if (art.slides_since_remote(h) + desc.contact_slop < kRemoteSlide &&
        !is_near_awake_body(art.remote_box))
      continue;
    follow(art);
    for (const std::uint32_t b : art.bodies) {
      refresh_motion_of(b, h);
      refresh_bounds_of(b, h);
    }
  }
}

// Called at the start of the impact stage.
void World::Impl::make_remote() {
  for (Articulation& art : articulations) {
    if (art.remote || !art.can_be_remote || art.sub_stepped) continue;
    collide::Bounds box;
    Vec3 line;
    for (const std::uint32_t b : art.bodies) {
      if (bodies[b].first_collider == kNone) continue;
      box = merged(box, bounds_at_pose(bodies[b], colliders));
      line = art.line_of(bodies[b].link);
    }
    const Vec3 along = kRemoteSlide * Vec3{std::fabs(line.x), std::fabs(line.y), std::fabs(line.z)};
    box = collide::grown({box.lower - along, box.upper + along}, desc.contact_slop);
    if (is_near_awake_body(collide::grown(box, kClear))) continue;
    art.set_remote(box);
    for (const std::uint32_t b : art.bodies) {
      bodies[b].remote = true;
      impacts.bounds[b] = {};
    }
    lists.invalidate_impacts();
  }
}

// Updates a remote articulation before its links are read.
void World::Impl::update_if_remote(Articulation& art) {
  if (art.remote) follow(art);
}
void World::Impl::update_all_remote() {
  for (Articulation& art : articulations) update_if_remote(art);
}

}  // namespace vp
