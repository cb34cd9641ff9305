// Distances between states of trees, and energies and momenta summed over links, for the tests of
// the integrators.
#pragma once

#include "trees.h"
#include "vphysics/multibody/configuration.h"
#include "vphysics/multibody/integrators.h"

namespace vp::test {

using Numbers = std::vector<double>;

// Kinetic energy and momentum about the world's origin, and potential energy in gravity.
struct Mechanics {
  double kinetic = 0.0, potential = 0.0;
  dse3 momentum;
  double energy() const { return kinetic + potential; }
};
inline Mechanics mechanics(const Model& model, Data& data, const Numbers& q, const Numbers& v,
                           const Vec3& gravity) {
  forward_kinematics<double>(model, data, q, v);
  Mechanics m;
  for (int link = 0; link < model.links(); ++link) {
    const Inertia& J = model.link(link).inertia;
    const SE3 T = T_world_link<double>(model, data, link);
    const se3 V = link_velocity<double>(model, data, link);
    m.kinetic += 0.5 * (V * (J * V));
    m.potential -= dot(gravity, J.mass() * T.position() + T.rotate(J.first_moment()));
    m.momentum = m.momentum + InvdAd(T, J * V);
    for (int k = 0; k < velocities_of(model.link(link).joint); ++k) {
      const double rate = v[static_cast<std::size_t>(model.first_velocity(link) + k)];
      m.kinetic += 0.5 * model.link(link).armature * rate * rate;
    }
  }
  return m;
}
inline double size_of(const dse3& F) {
  return std::sqrt(dot(F.m, F.m) + dot(F.f, F.f));
}

// Distance between two states, measured on the Lie group.
inline double distance(const Model& model, const Numbers& q0, const Numbers& v0, const Numbers& q1,
                       const Numbers& v1) {
  Numbers delta(v0.size());
  difference<double>(model, q0, q1, delta);
  return std::max(largest_of(delta), largest_difference(v0, v1));
}

// One body on a joint at the world's origin.
inline Model one_body(const Joint& joint, const Inertia& J) {
  ModelBuilder builder;
  must_build(builder.add({.name = "body", .joint = joint, .inertia = J}));
  return must_build(builder.build());
}

}  // namespace vp::test
