// Bodies that fall on triangle meshes: trees on waves, ragdolls on fields and rings. The numbers
// are those of the scenes of the same names in Box3D's benchmark, with z up instead of y.
#include <cmath>

#include "parts.h"
#include "scenes/catalogue.h"

namespace scenes {
namespace {

// A grid of columns x rows cells about the origin, each split along the diagonal from its lower
// corner.
template <class Height>
Mesh grid_mesh(int columns, int rows, double cell, const Height& height) {
  Triangles out;
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= columns; ++i) {
      const double x = cell * i, y = cell * j;
      out.vertices.push_back({x - 0.5 * cell * columns, y - 0.5 * cell * rows, height(x, y)});
    }
  }
  const auto vertex = [&](int i, int j) {
    return static_cast<std::uint32_t>(j * (columns + 1) + i);
  };
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const std::uint32_t low = vertex(i, j), high = vertex(i + 1, j + 1);
      out.corners.push_back({low, vertex(i + 1, j), high});
      out.corners.push_back({low, high, vertex(i, j + 1)});
    }
  }
  return {std::make_shared<const Triangles>(std::move(out))};
}

// A torus about the y axis: `around` pieces of a tube of `across` sides.
Mesh ring_mesh(int around, int across, double radius, double thickness) {
  Triangles out;
  for (int i = 0; i < around; ++i) {
    const auto u = vp::sin_cos(2.0 * vp::kPi * i / around);
    for (int j = 0; j < across; ++j) {
      const auto v = vp::sin_cos(2.0 * vp::kPi * j / across);
      const double out_by = radius + thickness * v.cos;
      out.vertices.push_back({out_by * u.cos, -thickness * v.sin, out_by * u.sin});
    }
  }
  const auto vertex = [&](int i, int j) {
    return static_cast<std::uint32_t>((i % around) * across + j % across);
  };
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      const std::uint32_t low = vertex(i, j), high = vertex(i + 1, j + 1);
      out.corners.push_back({low, vertex(i + 1, j), high});
      out.corners.push_back({low, high, vertex(i, j + 1)});
    }
  }
  return {std::make_shared<const Triangles>(std::move(out))};
}

// A stem of prisms, each thinner than the one below, with its foot at the origin.
Body tree() {
  constexpr int kPieces = 22, kSides = 6;
  constexpr double kThick = 0.75, kLong = 1.5, kThinner = 0.95;  // [m], [m], per piece
  constexpr double kDensity = 1.0;
  // Box3D's is 0.05 of the radius of each piece's largest inscribed sphere; here all have the mean.
  const Material bark{0.9, 0.0, 0.02};
  Body body;
  double centre = 1.0, radius = kThick;
  for (int i = 0; i < kPieces; ++i) {
    const double height = kLong + 2.0 * radius;
    body.parts.push_back({prism(radius, centre - radius, height, kSides), SE3{}, kDensity, bark});
    centre += height;
    radius *= kThinner;
  }
  body.as_one = true;
  make_principal(body);
  return body;
}

}  // namespace

Scene trees(int count, int cells_per_metre) {
  constexpr int kAlongX = 150, kAlongY = 200;                    // of the ground [m]
  constexpr double kAmplitude = 0.4, kPerX = 0.1, kPerY = 0.05;  // [m], waves per metre
  constexpr double kFirst = 70.0, kPitch = 3.0, kFoot = 1.0;     // [m]
  constexpr double kSpin = 0.5;                                  // [rad/s], of the fastest
  Scene scene;
  scene.seconds = 500.0 / 60.0;
  const auto wave = [](double x, double per_metre) {
    return vp::sin_cos(2.0 * vp::kPi * per_metre * x).sin;
  };
  add(scene, fixed_body(grid_mesh(kAlongX * cells_per_metre, kAlongY * cells_per_metre,
                                  1.0 / cells_per_metre,
                                  [&](double x, double y) {
                                    return kAmplitude * wave(x, kPerX) * wave(y, kPerY);
                                  }),
                        SE3{}));
  const Body made = tree();
  for (int i = 0; i < count; ++i) {
    const Vec3 foot{0.0, kFirst - kPitch * i, kFoot};
    Body body = made;
    body.T_world_body = SE3(foot) * made.T_world_body;
    const double side = i % 2 == 0 ? 1.0 : -1.0;
    body.spin = {0.0, side * kSpin * (0.5 + 0.5 * i / count), 0.0};
    body.velocity = cross(body.spin, body.T_world_body.position() - foot);
    add(scene, std::move(body));
  }
  scene.in_place.lower = {-0.5 * kAlongX, -0.5 * kAlongY, -kAmplitude};
  scene.in_place.upper = {0.5 * kAlongX, 0.5 * kAlongY, 1e9};
  return scene;
}

Scene rain(int along, int group) {
  constexpr double kField = 15.0, kRing = 0.25 * kField, kTube = 1.0;  // [m]
  constexpr int kCells = 8, kSides = 16;
  constexpr double kHeight = 20.0, kPitch = 0.75;  // of a group [m]
  constexpr double kEvery = 0.8;                   // between two columns [s]
  Scene scene;
  scene.seconds = 12.0;
  const Mesh field = grid_mesh(kCells, kCells, kField / kCells, [](double, double) { return 0.0; });
  const Mesh ring = ring_mesh(kSides, kSides, kRing, kTube);
  const auto centre = [&](int i) { return kField * (i - 0.5 * (along - 1)); };
  for (int i = 0; i < along; ++i) {
    for (int j = 0; j < along; ++j) {
      Body ground = fixed_body(field, SE3(Vec3{centre(i), centre(j), 0.0}));
      ground.parts.push_back({ring, SE3{}, 1000.0, {}});
      add(scene, std::move(ground));
    }
  }
  // A column's figures exist until the column is created again.
  const double life = kEvery * along;
  for (int n = 0; kEvery * n < scene.seconds; ++n) {
    const std::size_t first = scene.bodies.size();
    for (int j = 0; j < along; ++j) {
      for (int k = 0; k < group; ++k) {
        const Vec3 at{centre(n % along) + kPitch * k, centre(j), kHeight};
        add_ragdoll(scene, turned({0.0, 0.0, -0.5 * vp::kPi}, at));
      }
    }
    for (std::size_t i = first; i < scene.bodies.size(); ++i) {
      scene.bodies[i].from = kEvery * n;
      scene.bodies[i].until = kEvery * n + life;
    }
  }
  scene.in_place.lower.z = 0.0;
  return scene;
}

}  // namespace scenes
