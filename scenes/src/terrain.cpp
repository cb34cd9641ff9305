// Height fields, and bodies released on them.
#include <algorithm>
#include <cmath>

#include "parts.h"
#include "random.h"
#include "scenes/catalogue.h"

namespace scenes {
namespace {

// A bowl with hills in it: rolling bodies stay inside.
double bowl(double x, double y) {
  const double hills = vp::sin_cos(0.9 * x).sin * vp::sin_cos(0.8 * y + 0.4).sin +
                       0.4 * vp::sin_cos(2.1 * x + 1.3 * y).sin;
  return 0.35 * hills + 0.02 * (x * x + y * y);
}

}  // namespace

Terrain::Below Terrain::below(double x, double y) const {
  const double u = std::clamp(x / spacing, 0.0, columns - 1.0);
  const double v = std::clamp(y / spacing, 0.0, rows - 1.0);
  const int i = std::min(static_cast<int>(u), columns - 2),
            j = std::min(static_cast<int>(v), rows - 2);
  const auto at = [&](int column, int row) {
    return (*heights)[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                      static_cast<std::size_t>(column)];
  };
  const double s = u - i, t = v - j, low = at(i, j), high = at(i + 1, j + 1);
  const double third = s >= t ? at(i + 1, j) : at(i, j + 1);
  const double along_x = s >= t ? third - low : high - third;
  const double along_y = s >= t ? high - third : third - low;
  const Vec3 n{-along_x / spacing, -along_y / spacing, 1.0};
  return {low + s * along_x + t * along_y, (1.0 / norm(n)) * n};
}

bool has_terrain(const Scene& scene) {
  return std::any_of(scene.bodies.begin(), scene.bodies.end(), [](const Body& body) {
    return std::any_of(body.parts.begin(), body.parts.end(), [](const Part& part) {
      return std::holds_alternative<Terrain>(part.shape);
    });
  });
}

Scene hills(int count) {
  constexpr int kSamples = 129;
  constexpr double kSpacing = 0.15, kSide = kSpacing * (kSamples - 1);  // [m]
  std::vector<double> heights;
  for (int j = 0; j < kSamples; ++j) {
    for (int i = 0; i < kSamples; ++i) {
      heights.push_back(bowl(kSpacing * i - 0.5 * kSide, kSpacing * j - 0.5 * kSide));
    }
  }
  const Terrain ground{kSamples, kSamples, kSpacing,
                       std::make_shared<const std::vector<double>>(std::move(heights))};
  Scene scene;
  add(scene, fixed_body(ground, SE3(Vec3{-0.5 * kSide, -0.5 * kSide, 0.0})));
  scene.in_place.lower = {-0.5 * kSide, -0.5 * kSide, -1.0};
  scene.in_place.upper = {0.5 * kSide, 0.5 * kSide, 1e9};
  // On the slopes of a square, well separated from one another.
  Random random(29);
  constexpr double kPitch = 1.3;
  const int along = static_cast<int>(std::ceil(std::sqrt(count)));
  for (int k = 0; k < count; ++k) {
    const int column = k % along, row = k / along;
    const double x = kPitch * (column - 0.5 * (along - 1));
    const double y = kPitch * (row - 0.5 * (along - 1));
    const Vec3 rotation = vp::kPi * random.in_cube(1.0), position{x, y, bowl(x, y) + 1.2};
    const Material material{0.6, 0.2, 0.002};
    const Shape shapes[] = {Sphere{0.3}, Capsule{0.2, 0.25}, Box{{0.3, 0.25, 0.2}}};
    Body body = body_of(shapes[k % 3], turned(rotation, position), material);
    add(scene, std::move(body));
  }
  return scene;
}

namespace {

// A body with its centre of mass, which is on the z axis, at the origin.
Body centred(std::vector<Part> parts) {
  double mass = 0.0, moment = 0.0;
  for (const Part& part : parts) {
    const double m = mass_of(part.shape, part.density).mass;
    mass += m;
    moment += m * part.T_body_shape.position().z;
  }
  Body body;
  for (Part& part : parts) {
    const SE3& T = part.T_body_shape;
    part.T_body_shape = SE3(T.rotation(), T.position() - Vec3{0.0, 0.0, moment / mass});
  }
  body.parts = std::move(parts);
  body.as_one = true;
  return body;
}

Body table() {
  std::vector<Part> parts{{Box{{0.4, 0.3, 0.03}}, SE3(Vec3{0, 0, 0.53}), 600.0, {}}};
  for (const double x : {-0.35, 0.35}) {
    for (const double y : {-0.25, 0.25}) {
      parts.push_back({Box{{0.04, 0.04, 0.25}}, SE3(Vec3{x, y, 0.25}), 600.0, {}});
    }
  }
  return centred(std::move(parts));
}
Body jack() {
  return centred({{Box{{0.4, 0.07, 0.07}}, {}, 1000.0, {}},
                  {Box{{0.07, 0.4, 0.07}}, {}, 1000.0, {}},
                  {Box{{0.07, 0.07, 0.4}}, {}, 1000.0, {}}});
}
Body dumbbell() {
  return centred({{Capsule{0.06, 0.3}, {}, 1000.0, {}},
                  {Sphere{0.18}, SE3(Vec3{0, 0, -0.35}), 1000.0, {}},
                  {Sphere{0.18}, SE3(Vec3{0, 0, 0.35}), 1000.0, {}}});
}

}  // namespace

Scene furniture(int along, int layers) {
  constexpr double kPitch = 1.15;  // no two can collide in any orientation [m]
  Scene scene;
  add_pit(scene, kPitch * (along + 1), 3.0);
  Random random(31);
  for (int layer = 0; layer < layers; ++layer) {
    for (int k = 0; k < along * along; ++k) {
      Body body = k % 3 == 0 ? table() : k % 3 == 1 ? jack() : dumbbell();
      const int column = k % along, row = k / along;
      const Vec3 position{kPitch * (column - 0.5 * (along - 1)), kPitch * (row - 0.5 * (along - 1)),
                          0.8 + kPitch * layer};
      body.T_world_body = turned(vp::kPi * random.in_cube(1.0), position);
      add(scene, std::move(body));
    }
  }
  return scene;
}

}  // namespace scenes
