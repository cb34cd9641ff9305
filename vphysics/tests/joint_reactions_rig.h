// The momentum balance of links, from public queries of a world.
#pragma once

#include <algorithm>
#include <vector>

#include "tree_scenes.h"

namespace vp::test {

inline void step(World& world, double dt, int count = 1) {
  for (int i = 0; i < count; ++i) must(world.step(dt));
}
inline std::vector<double> copied(std::span<const double> x) {
  return {x.begin(), x.end()};
}

// A link's centre of mass, momentum and angular momentum about the world's origin.
struct Momentum {
  Vec3 centre, linear, angular;
};
inline Momentum momentum_of(const World& world, BodyId link, const Inertia& J) {
  const SE3 T = world.pose(link);
  const dse3 P = J * world.velocity(link);
  const Vec3 linear = T.rotate(P.f);
  return {T * J.centre_of_mass(), linear, T.rotate(P.m) + cross(T.position(), linear)};
}
inline std::vector<Momentum> momenta(const World& world, ArticulationId id) {
  std::vector<Momentum> all;
  for (int l = 0; l < world.model(id)->links(); ++l) {
    all.push_back(momentum_of(world, world.link_body(id, l), world.model(id)->link(l).inertia));
  }
  return all;
}
inline Vec3 contact_impulse(const World& world, BodyId body) {
  std::vector<ContactPoint> points;
  world.contacts_of(body, points);
  Vec3 sum;
  for (const ContactPoint& p : points) sum += p.normal_impulse * p.normal + p.friction_impulse;
  return sum;
}

// Residual of Newton's second law over all links: mass times acceleration minus the sum of gravity,
// contact, user and joint forces. `size` is the largest of these forces.
struct Balance {
  double off = 0.0, size = 0.0, contact = 0.0;
};
inline Balance balance_of(const World& world, ArticulationId id,
                          const std::vector<Momentum>& before, const std::vector<Vec3>& user,
                          double dt, bool with_roots = true) {
  const Model& model = *world.model(id);
  const std::vector<Momentum> now = momenta(world, id);
  std::vector<Vec3> force(now.size());
  Balance balance;
  for (int l = 0; l < model.links(); ++l) {
    const auto i = static_cast<std::size_t>(l);
    const Vec3 contact = (1.0 / dt) * contact_impulse(world, world.link_body(id, l));
    const Vec3 joint = world.joint_reaction(id, l).force;
    const Vec3 weight = model.link(l).inertia.mass() * kGravity;
    force[i] += contact + joint + weight + user[i];
    const int parent = model.link(l).parent;
    if (parent != kWorld) force[static_cast<std::size_t>(parent)] -= joint;
    for (const Vec3& f : {contact, joint, weight, user[i]}) {
      balance.size = std::max(balance.size, norm(f));
    }
    balance.contact = std::max(balance.contact, norm(contact));
  }
  for (int l = 0; l < model.links(); ++l) {
    const auto i = static_cast<std::size_t>(l);
    if (!with_roots && model.link(l).parent == kWorld) continue;
    const Vec3 changed = (1.0 / dt) * (now[i].linear - before[i].linear);
    balance.off = std::max(balance.off, norm(changed - force[i]));
  }
  return balance;
}

}  // namespace vp::test
