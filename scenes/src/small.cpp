// Small scenes, each of one phenomenon.
#include <cmath>

#include "parts.h"
#include "scenes/catalogue.h"

namespace scenes {
namespace {

InPlace within(double distance) {
  InPlace rule;
  rule.rule = InPlace::Rule::near_start;
  rule.distance = distance;
  return rule;
}

// A card and its frames. The feet of a leaning pair are length sin from the centre. Its upper edges
// touch; two ridges at height length cos + thickness sin carry the cards above.
struct Card {
  double length = 0.09, width = 0.06, thickness = 0.003;  // [m]
  double lean = 0.35;                                     // from the vertical [rad]
  double sine = vp::sin_cos(lean).sin, cosine = vp::sin_cos(lean).cos;

  Box box() const { return {{0.5 * thickness, 0.5 * width, 0.5 * length}}; }
  double storey() const { return length * cosine + thickness * sine; }
};
// Between neighbouring flat cards; smaller than the distance between the ridges of a pair [m].
constexpr double kCardGap = 0.001;

void add_leaning_pair(Scene& scene, const Card& card, const Material& paper, double x, double z) {
  const double across = 0.5 * (card.thickness * card.cosine + card.length * card.sine);
  for (const double side : {-1.0, 1.0}) {
    const Vec3 centre{x + side * across, 0.0, z + 0.5 * card.storey()};
    add(scene, body_of(card.box(), turned({0.0, -side * card.lean, 0.0}, centre), paper));
  }
}

}  // namespace

Scene card_house(int storeys) {
  const Card card;
  const Material paper{0.6, 0.0, 0.0};
  const double pitch = card.length + kCardGap;
  Scene scene;
  scene.in_place = within(0.01);
  add_floor(scene, paper);
  double z = 0.0;
  for (int level = 0; level < storeys; ++level) {
    const int pairs = storeys - level;
    const auto x_of = [&](double i) { return pitch * (i - 0.5 * (pairs - 1)); };
    for (int i = 0; i < pairs; ++i) add_leaning_pair(scene, card, paper, x_of(i), z);
    z += card.storey();
    const Vec3 quarter_turn{0.0, 0.5 * vp::kPi, 0.0};
    for (int i = 0; i + 1 < pairs; ++i) {
      const Vec3 centre{x_of(i + 0.5), 0.0, z + 0.5 * card.thickness};
      add(scene, body_of(card.box(), turned(quarter_turn, centre), paper));
    }
    z += card.thickness;
  }
  return scene;
}

Scene dominoes(int count) {
  const Vec3 half{0.0375, 0.12, 0.24};                         // [m]
  constexpr double kPitch = 0.24, kRadius = 3.0, kTip = 0.25;  // [m], [m], [rad]
  Scene scene;
  add_floor(scene);
  for (int i = 0; i < count; ++i) {
    const double angle = kPitch / kRadius * i;
    const auto [s, c] = vp::sin_cos(angle);
    const SE3 foot = turned({0, 0, angle + 0.5 * vp::kPi}, {kRadius * c, kRadius * s, 0.0});
    // The first domino leans over its front edge, beyond its centre of mass.
    const Vec3 edge{half.x, 0.0, 0.0};
    const SE3 lean = turned({0.0, i == 0 ? kTip : 0.0, 0.0}, edge);
    add(scene, body_of(Box{half}, foot * lean * SE3(Vec3{-half.x, 0.0, half.z})));
  }
  return scene;
}

Scene heavy_on_light(double ratio) {
  const Box crate{{0.5, 0.5, 0.5}};
  Scene scene;
  scene.in_place = within(0.1);
  add_floor(scene);
  add(scene, body_of(crate, SE3(Vec3{0, 0, 0.5}), {}, 100.0));
  add(scene, body_of(crate, SE3(Vec3{0, 0, 1.5}), {}, 100.0 * ratio));
  return scene;
}

Scene t_handle() {
  constexpr double kAluminium = 2700.0;
  const Box bar{{0.1, 0.015, 0.015}}, stem{{0.015, 0.015, 0.05}};
  // The centre of mass is between the two parts, weighted by their masses.
  const double separation = bar.half_extents.z + stem.half_extents.z;
  const double fraction =
      mass_of(stem, 1.0).mass / (mass_of(stem, 1.0).mass + mass_of(bar, 1.0).mass);
  Body handle;
  handle.parts.push_back({bar, SE3(Vec3{0, 0, -fraction * separation}), kAluminium, {}});
  handle.parts.push_back({stem, SE3(Vec3{0, 0, (1.0 - fraction) * separation}), kAluminium, {}});
  handle.spin = {0.2, 0.0, 8.0};  // nearly about the intermediate axis
  Scene scene;
  scene.gravity = {};
  scene.seconds = 20.0;
  add(scene, std::move(handle));
  return scene;
}

Scene ramp() {
  constexpr double kTangent = 0.5, kPitch = 0.6;
  const double c = 1.0 / std::sqrt(1.0 + kTangent * kTangent), s = kTangent * c;
  const vp::Mat3 R{{c, 0, -s}, {0, 1, 0}, {s, 0, c}};  // downhill is +x
  const Box slope{{3.0, 0.25, 0.1}}, crate{{0.15, 0.15, 0.1}};
  Scene scene;
  scene.seconds = 1.0;
  constexpr double kFrictions[] = {0.40, 0.44, 0.48, 0.495, 0.505, 0.52, 0.56, 0.60};
  int i = 0;
  for (const double friction : kFrictions) {
    const Material surface{friction, 0.0, 0.0};
    const SE3 lane(R, Vec3{0.0, kPitch * (i++ - 3.5), 3.0});
    add(scene, fixed_body(slope, lane, surface));
    const double above = slope.half_extents.z + crate.half_extents.z;
    add(scene, body_of(crate, lane * SE3(Vec3{-2.5, 0.0, above}), surface));
  }
  return scene;
}

Scene bounce() {
  constexpr double kRadius = 0.1, kDrop = 1.0;
  Scene scene;
  scene.seconds = 4.0;
  add_floor(scene);
  for (int i = 0; i <= 10; ++i) {
    add(scene, body_of(Sphere{kRadius}, SE3(Vec3{0.3 * (i - 5), 0.0, kRadius + kDrop}),
                       {0.6, 0.1 * i, 0.0}));
  }
  return scene;
}

Scene conveyor() {
  constexpr double kRadius = 0.1, kPitch = 0.25, kHeight = 1.0, kSpeed = 1.0;  // [m], [m/s]
  constexpr int kRollers = 20;
  Scene scene;
  add_floor(scene);
  const Vec3 along_y{-0.5 * vp::kPi, 0.0, 0.0};
  for (int i = 0; i < kRollers; ++i) {
    Body roller = body_of(Capsule{kRadius, 0.5}, turned(along_y, {kPitch * i, 0.0, kHeight}));
    roller.motion = Motion::kinematic;
    roller.spin = {0.0, kSpeed / kRadius, 0.0};
    add(scene, std::move(roller));
  }
  for (int i = 0; i < 4; ++i) {
    const double half_height = 0.1 + 0.05 * i;
    add(scene, body_of(Box{{0.3, 0.3, half_height}},
                       SE3(Vec3{0.3 + 0.8 * i, 0.0, kHeight + kRadius + half_height}), {}, 200.0));
  }
  // Beside it are spheres of increasing rolling friction on a slope. They stay if the lever arm is
  // larger than the radius times the slope's tangent.
  const double tangent = 0.2, c = 1.0 / std::sqrt(1.0 + tangent * tangent), s = tangent * c;
  const SE3 slope(vp::Mat3{{c, 0, -s}, {0, 1, 0}, {s, 0, c}}, {2.5, 3.0, 0.8});
  const Box board{{2.5, 1.0, 0.05}};
  add(scene, fixed_body(board, slope));
  for (int i = 0; i < 5; ++i) {
    const Vec3 position{-2.0, 0.35 * (i - 2), board.half_extents.z + kRadius};
    add(scene, body_of(Sphere{kRadius}, slope * SE3(position), {0.6, 0.0, 0.0075 * i}));
  }
  return scene;
}

}  // namespace scenes
