// Bodies with convex hulls: stones in a pile and in a yard, cubes in a drum. The numbers are those
// of the scenes of the same names in Box3D's benchmark, with z up instead of y.
#include <cmath>

#include "parts.h"
#include "scenes/catalogue.h"

namespace scenes {
namespace {

Vec3 z_up(double x, double y, double z) {
  return {x, -z, y};
}

Body stone(std::vector<Vec3> points) {
  Body body = body_of(hull_of(std::move(points)), SE3{});
  make_principal(body);
  return body;
}
// Copies a body to a position, with its points oriented as they were given.
Body at(const Body& made, const Vec3& position) {
  Body body = made;
  body.T_world_body = SE3(position) * made.T_world_body;
  return body;
}

// Random points on a sphere. The generator and its seed are the original's, so that the stone is
// the same.
std::vector<Vec3> random_points(int count, double radius) {
  std::uint32_t state = 42;
  const auto next = [&] {
    state = state * 2147001325u + 715136305u;
    return (state & 0xffff) / 65535.0 - 0.5;
  };
  std::vector<Vec3> points;
  while (static_cast<int>(points.size()) < count) {
    const double x = next(), y = next(), z = next();
    const double length = std::sqrt(x * x + y * y + z * z);
    if (length <= 0.5) points.push_back((radius / length) * z_up(x, y, z));
  }
  return points;
}

// Points spread evenly over a sphere: their angles about an axis grow by the golden ratio's
// fraction of a revolution (Fibonacci lattice).
std::vector<Vec3> lattice_points(int count, double radius) {
  const double angle = 2.0 * vp::kPi / (0.5 * (1.0 + std::sqrt(5.0)));
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    const double along = 1.0 - (2.0 * i + 1.0) / count, out = std::sqrt(1.0 - along * along);
    const auto [s, c] = vp::sin_cos(angle * i);
    points.push_back(radius * z_up(out * c, out * s, along));
  }
  return points;
}

// A sector of the drum, between two angles about its axis, y, and two radii.
Hull sector(double from, double to, double inner, double outer, double half_length) {
  std::vector<Vec3> points;
  for (const double angle : {from, to}) {
    const auto [s, c] = vp::sin_cos(angle);
    for (const double radius : {inner, outer}) {
      for (const double y : {-half_length, half_length}) {
        points.push_back({radius * c, y, radius * s});
      }
    }
  }
  return hull_of(std::move(points));
}

}  // namespace

Hull prism(double radius, double bottom, double height, int sides) {
  std::vector<Vec3> points;
  for (int i = 0; i < sides; ++i) {
    const auto [s, c] = vp::sin_cos(2.0 * vp::kPi * i / sides);
    points.push_back({radius * c, radius * s, bottom});
    points.push_back({radius * c, radius * s, bottom + height});
  }
  return hull_of(std::move(points));
}

Scene convex_pile(int along, int layers) {
  constexpr double kRadius = 2.0, kPitch = 2.0 * kRadius;  // [m]
  constexpr int kPoints = 32;
  Scene scene;
  scene.seconds = 500.0 / 60.0;
  add_floor(scene);
  const Body made = stone(random_points(kPoints, kRadius));
  for (int layer = 0; layer < layers; ++layer) {
    for (int j = 0; j < along; ++j) {
      for (int i = 0; i < along; ++i) {
        add(scene, at(made, {kPitch * (i - 0.5 * along), kPitch * (j - 0.5 * along),
                             kRadius + kPitch * layer}));
      }
    }
  }
  scene.in_place.lower.z = 0.0;
  return scene;
}

// The stones start half a metre higher than the original's, where some start inside the column.
Scene junkyard(int along, int layers) {
  constexpr double kRadius = 1.5, kPitch = 4.0, kLowest = 25.5;             // of the stones [m]
  constexpr double kHalf = 50.0, kThick = 1.0, kHigh = 8.0, kMiddle = 7.0;  // of the walls [m]
  constexpr double kPusher = 4.0, kPusherHeight = 24.0, kCircle = 35.0;     // [m]
  constexpr double kTurning = 6.0 * vp::kPi / 180.0;                        // [rad/s]
  Scene scene;
  scene.seconds = 500.0 / 60.0;
  add_floor(scene);
  for (const double s : {-1.0, 1.0}) {
    add(scene, fixed_body(Box{{kThick, kHalf, kHigh}}, SE3(Vec3{s * kHalf, 0.0, kMiddle})));
    add(scene, fixed_body(Box{{kHalf, kThick, kHigh}}, SE3(Vec3{0.0, s * kHalf, kMiddle})));
  }
  const Body made = stone(lattice_points(10, kRadius));
  for (int layer = 0; layer < layers; ++layer) {
    for (int i = 0; i < along; ++i) {
      for (int j = 0; j < along; ++j) {
        add(scene, at(made, {kPitch * (i - 0.5 * (along - 1)), kPitch * (j - 0.5 * (along - 1)),
                             kLowest + kPitch * layer}));
      }
    }
  }
  Body pusher = body_of(prism(kPusher, 0.0, kPusherHeight, 16), SE3(Vec3{kCircle, 0.0, 0.0}));
  pusher.motion = Motion::kinematic;
  follow(scene, add(scene, std::move(pusher)), [&](double t) {
    const auto [s, c] = vp::sin_cos(kTurning * t);
    return Vec3{kCircle * c, kCircle * s, 0.0};
  });
  scene.in_place.lower.z = 0.0;
  return scene;
}

Scene washer(int along) {
  constexpr double kHeight = 21.0, kHalfLength = 10.0;         // of the drum [m]
  constexpr double kFin = 14.0, kInner = 16.0, kOuter = 18.0;  // radii [m]
  constexpr double kStep = vp::kPi / 18.0, kOverlap = 0.1;     // [rad], of a step
  constexpr double kSpin = 25.0 * vp::kPi / 180.0;             // [rad/s]
  constexpr double kHalf = 0.2, kPitch = 4.0 * kHalf;          // of the cubes [m]
  Scene scene;
  scene.seconds = 1000.0 / 60.0;
  add_floor(scene);
  Body drum;
  drum.motion = Motion::kinematic;
  drum.T_world_body = SE3(Vec3{0.0, 0.0, kHeight});
  drum.spin = {0.0, -kSpin, 0.0};
  drum.as_one = true;
  for (int i = 0; i < 36; ++i) {
    const double from = kStep * i, to = kStep * (i + 1), over = kOverlap * kStep;
    drum.parts.push_back(
        {sector(from - over, to + over, kInner, kOuter, kHalfLength), SE3{}, 1000.0, {}});
    if (i % 9 != 0) continue;
    drum.parts.push_back({sector(from, to, kFin, kInner, kHalfLength), SE3{}, 1000.0, {}});
  }
  add(scene, std::move(drum));
  const double lowest = -0.5 * kPitch * along;
  for (int i = 0; i < along; ++i) {
    for (int j = 0; j < along; ++j) {
      for (int k = 0; k < along; ++k) {
        const Vec3 position{lowest + kPitch * i, lowest + kPitch * j, lowest + kPitch * k};
        add(scene, body_of(Box{{kHalf, kHalf, kHalf}}, SE3(position + Vec3{0.0, 0.0, kHeight})));
      }
    }
  }
  scene.in_place.lower.z = 0.0;
  return scene;
}

}  // namespace scenes
