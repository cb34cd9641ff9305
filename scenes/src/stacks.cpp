// Boxes of 1 m and density 1000 in exact stacks, and bodies poured into a pit.
#include <cmath>

#include "parts.h"
#include "random.h"
#include "scenes/catalogue.h"

namespace scenes {
namespace {

constexpr Box kCrate{{0.5, 0.5, 0.5}};
constexpr double kTowerPitch = 2.0;    // between the axes of neighbouring towers [m]
constexpr double kPyramidPitch = 1.1;  // boxes of a row do not touch [m]

InPlace near_start() {
  InPlace rule;
  rule.rule = InPlace::Rule::near_start;
  return rule;
}

// The pit's floor is divided into cells, with one body of a layer above each. Each layer is shifted
// relative to the one below, so that falling bodies do not form columns.
constexpr double kPitCell = 1.25;                // [m]
constexpr double kPourPitch = 1.2;               // of the bodies, in all directions [m]
constexpr double kLayers = 10000.0 / (24 * 24);  // so that 10,000 need a pit of 30 m
constexpr double kPourHeight = 1.0;              // centre of the lowest layer [m]
constexpr double kTilt = 0.09;     // of a box, about each axis: it stays within the pitch [rad]
constexpr double kMaxShift = 0.3;  // [m]

int cells_of(int count) {
  return std::max(1, static_cast<int>(std::floor(std::sqrt(count / kLayers) + 0.5)));
}

Body poured(int kind, Random& random, const Vec3& position) {
  const Vec3 rotation = random.in_cube(1.0);
  if (kind == 1) return body_of(Sphere{0.5}, turned(vp::kPi * rotation, position));
  if (kind == 2) return body_of(Capsule{0.3, 0.3}, turned(vp::kPi * rotation, position));
  return body_of(kCrate, turned(kTilt * rotation, position));
}

// Rows of boxes in the xz plane, each one box shorter than the row below it.
void add_pyramid(Scene& scene, int base, double pitch, const Body& box) {
  const double side = 2.0 * std::get<Box>(box.parts[0].shape).half_extents.z;
  for (int row = 0; row < base; ++row) {
    const int boxes = base - row;
    for (int i = 0; i < boxes; ++i) {
      Body body = box;
      body.T_world_body = SE3(Vec3{pitch * (i - 0.5 * (boxes - 1)), 0.0, side * (row + 0.5)});
      add(scene, std::move(body));
    }
  }
}

Body kinematic_box(const Vec3& half_extents, const Vec3& position) {
  Body body = body_of(Box{half_extents}, SE3(position));
  body.motion = Motion::kinematic;
  return body;
}

}  // namespace

void add_pit(Scene& scene, double side, double height) {
  add_floor(scene);
  const double half = 0.5 * side, thick = 0.5;
  for (const double s : {-1.0, 1.0}) {
    const double at = s * (half + thick);
    add(scene, fixed_body(Box{{thick, half + 2.0 * thick, 0.5 * height}},
                          SE3(Vec3{at, 0.0, 0.5 * height})));
    add(scene, fixed_body(Box{{half, thick, 0.5 * height}}, SE3(Vec3{0.0, at, 0.5 * height})));
  }
  scene.in_place.lower = {-half, -half, 0.0};
  scene.in_place.upper = {half, half, 1e9};
}

Scene towers(int along_x, int along_y, int height) {
  Scene scene;
  scene.in_place = near_start();
  add_floor(scene);
  for (int i = 0; i < along_x; ++i) {
    for (int j = 0; j < along_y; ++j) {
      for (int k = 0; k < height; ++k) {
        add(scene, body_of(kCrate, SE3(Vec3{kTowerPitch * (i - 0.5 * (along_x - 1)),
                                            kTowerPitch * (j - 0.5 * (along_y - 1)), k + 0.5})));
      }
    }
  }
  return scene;
}

Scene pyramid(int base) {
  Scene scene;
  scene.in_place = near_start();
  add_floor(scene);
  add_pyramid(scene, base, kPyramidPitch, body_of(kCrate, SE3{}));
  return scene;
}

Scene large_pyramid(int base) {
  constexpr double kDensity = 100.0;
  Scene scene;
  scene.seconds = 200.0 / 60.0;
  scene.in_place = near_start();
  add_floor(scene);
  add_pyramid(scene, base, 1.0, body_of(kCrate, SE3{}, {}, kDensity));
  return scene;
}

Scene shaken_pyramid(int base) {
  constexpr double kAmplitude = 0.005, kFrequency = 3.0;  // [m], [Hz]
  Scene scene;
  scene.in_place = near_start();
  const double half = 0.5 * kPyramidPitch * base + 2.0;
  const int table = add(scene, kinematic_box({half, 5.0, 0.5}, {0.0, 0.0, -0.5}));
  add_pyramid(scene, base, kPyramidPitch, body_of(kCrate, SE3{}));
  follow(scene, table, [&](double t) {
    return Vec3{kAmplitude * vp::sin_cos(2.0 * vp::kPi * kFrequency * t).sin, 0.0, 0.0};
  });
  return scene;
}

Scene wall(int base) {
  constexpr double kRadius = 1.0, kMass = 10000.0, kSpeed = 50.0;
  Scene scene = pyramid(base);
  scene.in_place = {};
  const double density = kMass / mass_of(Sphere{kRadius}, 1.0).mass;
  const int ball =
      add(scene, body_of(Sphere{kRadius}, SE3(Vec3{0.0, -20.0, kRadius}), {}, density));
  scene.launches.push_back({1.0, ball, {0.0, kSpeed, 0.0}, {}});
  return scene;
}

double pit_side(int count) {
  return kPitCell * cells_of(count);
}

namespace {

// `height`: centre of the lowest layer [m].
Scene poured_pile(int count, Pour what, double height) {
  Scene scene;
  if (what == Pour::boxes) scene.seconds = 4.0;  // the last layer has landed after 3
  const int cells = cells_of(count);
  const int layers = (count + cells * cells - 1) / (cells * cells);
  const double side = pit_side(count);
  add_pit(scene, side, height + kPourPitch * (layers + 1));
  const double shift = std::min(kMaxShift, 0.5 * (side - kPourPitch * cells));
  Random random(1120);
  for (int n = 0; n < count; ++n) {
    const int layer = n / (cells * cells), i = n % cells, j = n / cells % cells;
    const double sx = (layer & 1) != 0 ? shift : -shift, sy = (layer & 2) != 0 ? shift : -shift;
    const Vec3 position{kPourPitch * (i - 0.5 * (cells - 1)) + sx,
                        kPourPitch * (j - 0.5 * (cells - 1)) + sy, height + kPourPitch * layer};
    add(scene, poured(what == Pour::mixed ? n % 3 : 0, random, position));
  }
  return scene;
}

}  // namespace

Scene pile(int count, Pour what) {
  return poured_pile(count, what, kPourHeight);
}

// A body of 1 m fits between the paddle's ends and the walls; the paddle fits below the lowest
// layer.
Scene stirred_pile(int count) {
  constexpr double kHalfHeight = 1.0, kClear = 0.05, kHalfWidth = 0.2, kToWall = 2.5;  // [m]
  constexpr double kSpin = 0.5;                                                        // [rad/s]
  Scene scene = poured_pile(count, Pour::mixed, 2.0 * kHalfHeight + kClear + kPourHeight);
  Body paddle = kinematic_box({0.5 * pit_side(count) - kToWall, kHalfWidth, kHalfHeight},
                              {0.0, 0.0, kHalfHeight + kClear});
  paddle.spin = {0.0, 0.0, kSpin};
  add(scene, std::move(paddle));
  return scene;
}

}  // namespace scenes
