// Articulations with self-collision, for several tests.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tree_scenes.h"
#include "vphysics/multibody/quantities.h"

namespace vp::test {

inline constexpr Vec3 kY{0, 1, 0};

// A rotation whose z axis is a given unit vector.
inline Mat3 facing(const Vec3& z) {
  const Vec3 across = cross(z, std::fabs(z.x) < 0.9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0});
  const Vec3 x = (1.0 / norm(across)) * across;
  return {x, cross(z, x), z};
}
inline JointForces locked() {
  JointForces forces;
  forces.friction = std::numeric_limits<double>::infinity();
  return forces;
}
inline LinkSpec link_of(int parent, const Joint& joint, const Vec3& at, const Inertia& inertia) {
  LinkSpec link;
  link.parent = parent;
  link.joint = joint;
  link.T_parent_joint = SE3(at);
  link.inertia = inertia;
  return link;
}
inline double energy_of(const World& world, ArticulationId id,
                        const Vec3& gravity = {0, 0, -9.81}) {
  const Model& model = *world.model(id);
  Data data(model);
  forward_kinematics<double>(model, data, world.coordinates(id), world.velocities(id));
  return kinetic_energy(model, data) + potential_energy(model, data, gravity);
}
inline double fastest(const World& world, ArticulationId id) {
  double most = 0.0;
  for (const double v : world.velocities(id)) most = std::max(most, std::fabs(v));
  return most;
}
inline long begins(const World& world) {
  return std::count_if(world.contact_events().begin(), world.contact_events().end(),
                       [](const ContactEvent& e) { return e.kind == ContactEvent::Kind::begin; });
}

// A locked table, a locked post on it, and an arm that swings about the top of the post down onto
// the table. The tip of the arm is a ball, 0.8 m from its joint.
struct Folded {
  static constexpr double kRadius = 0.05;
  ArticulationId id;
  BodyId table, arm;
  ColliderId table_collider, tip_collider;
};
inline Folded add_folded(World& world, const Material& material, bool collide = true,
                         const CollisionFilter& filter = {}, bool sensor = false,
                         double angle = 1.0) {
  std::vector<LinkSpec> links;
  links.push_back(link_of(kWorld, PrismaticJoint{{0, 0, 1}}, {0, 0, -0.05},
                          solid_inertia(Box{{0.6, 0.2, 0.05}}, 1000.0)));
  links.push_back(link_of(0, RevoluteJoint{kY}, {0.5, 0, 0.05},
                          solid_inertia(Box{{0.05, 0.05, 0.15}}, 1000.0)));
  links.push_back(link_of(1, RevoluteJoint{kY}, {0, 0, 0.3},
                          Inertia(1.0, Vec3{0.01, 0.06, 0.06}).InvXform(SE3(Vec3{-0.4, 0, 0}))));
  links[0].forces = links[1].forces = {locked()};
  Folded out;
  out.id = must(world.create_articulation({model_of(links), collide}));
  out.table = world.link_body(out.id, 0);
  out.arm = world.link_body(out.id, 2);
  out.table_collider =
      must(world.add_collider(out.table, collider_of(Box{{0.6, 0.2, 0.05}}, material)));
  must(world.add_collider(world.link_body(out.id, 1),
                          collider_of(Box{{0.05, 0.05, 0.3}}, material)));
  ColliderDesc tip = collider_of(Sphere{Folded::kRadius}, material, SE3(Vec3{-0.8, 0, 0}));
  tip.filter = filter;
  tip.sensor = sensor;
  out.tip_collider = must(world.add_collider(out.arm, tip));
  must(world.set_joint_state(out.id, 2, 0, angle, 0.0));
  return out;
}
// Separation of the tip from the table [m].
inline double gap(const World& world, const Folded& arm) {
  return (world.pose(arm.arm) * Vec3{-0.8, 0, 0}).z - Folded::kRadius;
}

}  // namespace vp::test
