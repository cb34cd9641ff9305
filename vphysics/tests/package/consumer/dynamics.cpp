// A rod let go while it is level, and a ball that falls for a second.
#include <cstdio>
#include <vector>

#include "rod.h"
#include "vphysics/world.h"

int main() {
  const auto model = make_rod();
  if (!model) return 1;
  vp::Data data(*model);
  const std::vector<double> q{0.0}, v{0.0}, tau{0.0};
  std::vector<double> a(1);
  if (!vp::forward_dynamics<double>(*model, data, q, v, tau, {}, a)) return 1;
  std::printf("rod %.6f rad/s^2\n", a[0]);

  vp::World world;
  vp::BodyDesc desc;
  desc.inertia = vp::solid_inertia(vp::Sphere{0.1}, 1000.0);
  const auto ball = world.create_body(desc);
  if (!ball) return 1;
  for (int tick = 0; tick < 1000; ++tick) {
    if (!world.step(0.001)) return 1;
  }
  std::printf("ball %.6f m/s\n", world.velocity(*ball).v.z);
}
