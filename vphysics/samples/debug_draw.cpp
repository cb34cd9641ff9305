// Draws a stack of boxes as an SVG picture, in front view: shapes, contacts, and the contact
// impulses of the last step. Public headers only.
//
//   vphysics_sample_debug_draw > stack.svg
#include <cmath>
#include <cstdio>

#include "vphysics/world.h"

namespace {

// begin: drawing
class Svg : public vp::DebugDraw {
 public:
  double upwards = 0.0;  // sum of the heights of the impulse lines [m]

  void line(const vp::Vec3& from, const vp::Vec3& to, vp::DebugCategory category) override {
    std::printf("<path d='M%.4f %.4f L%.4f %.4f' stroke='#%06x' stroke-width='0.01'/>\n", from.x,
                -from.z, to.x, -to.z, vp::default_colour(category));
    if (category == vp::DebugCategory::impulse) upwards += to.z - from.z;
  }
  void point(const vp::Vec3& at, vp::DebugCategory category) override {
    std::printf("<circle cx='%.4f' cy='%.4f' r='0.02' fill='#%06x'/>\n", at.x, -at.z,
                vp::default_colour(category));
  }
};
// end: drawing

bool add_box(vp::World& world, double height) {
  vp::ColliderDesc box;
  box.shape = vp::Box{{0.5, 0.5, 0.5}};
  vp::BodyDesc desc;
  desc.T_world_body = vp::SE3(vp::Vec3{0.0, 0.0, height});
  desc.inertia = vp::solid_inertia(box.shape, 1000.0);  // 1000 kg
  const auto body = world.create_body(desc);
  return body && world.add_collider(*body, box);
}

}  // namespace

int main() {
  vp::World world;
  vp::BodyDesc ground_desc;
  ground_desc.motion = vp::Motion::fixed;
  const auto ground = world.create_body(ground_desc);
  vp::ColliderDesc floor;
  floor.shape = vp::HalfSpace{};
  if (!ground || !world.add_collider(*ground, floor)) return 1;
  for (const double height : {0.5, 1.5, 2.5}) {
    if (!add_box(world, height)) return 1;
  }
  for (int tick = 0; tick < 1000; ++tick) {
    if (!world.step(0.001)) return 1;
  }
  std::printf("<svg xmlns='http://www.w3.org/2000/svg' viewBox='-2 -3.5 4 4'>\n");
  vp::DebugDrawOptions options;
  options.contacts = options.impulses = true;
  options.impulse_scale = 0.02;  // 2 cm for each N s
  options.half_space_size = 2.0;
  Svg picture;
  if (!world.debug_draw(options, picture)) return 1;
  std::printf("</svg>\n");
  // The three contacts support one, two and three boxes: 9.81 N s each in a step of 1 ms.
  const double carried = picture.upwards / options.impulse_scale;
  return std::fabs(carried - 6 * 9.81) < 0.1 ? 0 : 1;
}
