// Drops a ball from 1 m and measures the height of its rebound. Public headers only.
#include <algorithm>
#include <cstdio>

#include "vphysics/world.h"

int main() {
  // begin: bounce
  vp::World world;

  vp::BodyDesc ground_desc;
  ground_desc.motion = vp::Motion::fixed;
  const auto ground = world.create_body(ground_desc);
  vp::ColliderDesc floor;
  floor.shape = vp::HalfSpace{};
  if (!ground || !world.add_collider(*ground, floor)) return 1;

  vp::ColliderDesc sphere;
  sphere.shape = vp::Sphere{.radius = 0.0175};
  sphere.material.restitution = 0.6;
  vp::BodyDesc ball_desc;
  ball_desc.T_world_body = vp::SE3(vp::Vec3{0.0, 0.0, 1.0});
  ball_desc.inertia = vp::solid_inertia(sphere.shape, 1100.0);
  ball_desc.continuous = true;  // CCD: swept, no tunneling at any speed
  const auto ball = world.create_body(ball_desc);
  if (!ball || !world.add_collider(*ball, sphere)) return 1;

  double height = 0.0;
  bool bounced = false;
  for (int tick = 0; tick < 1000; ++tick) {
    if (!world.step(0.001)) return 1;
    bounced = bounced || !world.contact_events().empty();
    if (bounced) height = std::max(height, world.pose(*ball).position().z - 0.0175);
  }
  std::printf("back at %.3f m\n", height);
  // end: bounce
  return height > 0.3 && height < 0.4 ? 0 : 1;  // 0.6^2 of the drop height of 0.98 m
}
