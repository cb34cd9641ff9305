#include "system.h"

#include <cmath>

namespace vp::bench {
namespace {

// Models built here are valid by construction.
Model must_build(const ModelBuilder& builder) {
  return std::move(builder.build()).value();
}

}  // namespace

System tumbling_body() {
  const Vec3 I{0.2, 0.35, 0.5}, w{0.3, 3.0, 0.3};
  ModelBuilder builder;
  builder.add({.name = "body", .joint = FreeJoint{}, .inertia = Inertia(1.0, I)}).value();
  Model model = must_build(builder);
  const Vec3 L{I.x * w.x, I.y * w.y, I.z * w.z};
  State start{model.zero_coordinates(), {w.x, w.y, w.z, 0, 0, 0}};
  return {"tumbling", std::move(model), std::move(start), {}, 0.5 * dot(w, L), norm(L)};
}

System ten_link_pendulum() {
  constexpr int kLinks = 10;
  constexpr double kLength = 0.2, kMass = 1.0, kGravity = 9.81;
  // A thin rod along x, with a hinge about y at its first end and a small inertia about x.
  const double across = kMass * kLength * kLength / 12, along = 1e-4;
  const Inertia rod = Inertia(kMass, Vec3{along, across, across}).about({-0.5 * kLength, 0, 0});
  ModelBuilder builder;
  for (int i = 0; i < kLinks; ++i) {
    builder
        .add({.name = "rod" + std::to_string(i),
              .parent = i - 1,
              .joint = RevoluteJoint{{0, 1, 0}},
              .T_parent_joint = SE3(Vec3{i == 0 ? 0.0 : kLength, 0, 0}),
              .inertia = rod})
        .value();
  }
  Model model = must_build(builder);
  State start{model.zero_coordinates(), std::vector<double>(kLinks)};
  // Its potential energy above the lowest position: from horizontal to hanging.
  const double fall = kLinks * kMass * kGravity * 0.5 * kLinks * kLength;
  return {"pendulum", std::move(model), std::move(start), {0, 0, -kGravity}, fall, 0.0};
}

}  // namespace vp::bench
