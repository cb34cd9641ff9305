// A rod of 2 kg and 1 m on a hinge at its end, level at angle 0.
#pragma once

#include "vphysics/multibody/dynamics.h"

inline vp::Expected<vp::Model> make_rod() {
  vp::LinkSpec rod;
  rod.joint = vp::RevoluteJoint{{0, 1, 0}};
  rod.inertia = vp::Inertia(2.0, {1.0, 0, 0}, {0, 2.0 / 3, 2.0 / 3, 0, 0, 0});
  vp::ModelBuilder builder;
  if (const auto added = builder.add(rod); !added) return tl::make_unexpected(added.error());
  return builder.build();
}
