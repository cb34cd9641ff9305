// Links as bodies of a world: copies of the poses and velocities of their articulations.
#include "world/step_context.h"

namespace vp {

void follow(Articulation& art, Bodies& bodies, BodyLists& lists) {
  if (art.remote) {
    art.remote = false;
    art.refresh();
    for (const std::uint32_t b : art.bodies) bodies[b].remote = false;
    lists.invalidate_impacts();
  }
  follow_poses(art, bodies);
  follow_velocities(art, bodies);
}
void follow_poses(const Articulation& art, Bodies& bodies) {
  for (const std::uint32_t b : art.bodies) {
    Body& body = bodies[b];
    if (!body.is_followed()) continue;
    body.T = art.T_world_link(body.link);
    body.moved();
  }
}
void follow_velocities(const Articulation& art, Bodies& bodies) {
  follow_velocities(art, bodies, [](std::uint32_t, const se3&) {});
}

void stop_at_start(const StepContext& s, Articulation& art) {
  s.status.non_finite = true;
  art.return_to_start();
  follow(art, s.bodies, s.lists);
}

bool in_sub_steps(const std::vector<Articulation>& articulations, const Body& a, const Body& b) {
  return (a.is_link && articulations[a.articulation].sub_stepped) ||
         (b.is_link && articulations[b.articulation].sub_stepped);
}

}  // namespace vp
