// Articulations of more than one link, for several tests.
#pragma once

#include <vector>

#include "rig.h"

namespace vp::test {

inline ColliderDesc collider_of(const Shape& shape, const Material& material,
                                const SE3& T_body_shape = {}) {
  ColliderDesc desc;
  desc.shape = shape;
  desc.material = material;
  desc.T_body_shape = T_body_shape;
  return desc;
}

struct Plate {
  ArticulationId id;  // of one link
  BodyId body;
};

// A uniform bar along -z from the link's origin.
inline Inertia bar(double mass, double length) {
  const double across = mass * length * length / 12.0;
  return Inertia(mass, Vec3{across, across, 1e-3 * across}).InvXform(SE3(Vec3{0, 0, -length / 2}));
}

// A chain of bars that hangs from the origin of the world.
inline std::vector<LinkSpec> hanging_chain(int links, const Joint& joint, double length = 0.2,
                                           double mass = 0.5) {
  std::vector<LinkSpec> chain;
  for (int i = 0; i < links; ++i) {
    LinkSpec link;
    link.parent = i - 1;
    link.joint = joint;
    if (i > 0) link.T_parent_joint = SE3(Vec3{0, 0, -length});
    link.inertia = bar(mass, length);
    chain.push_back(link);
  }
  return chain;
}

// A floating trunk with four legs of thigh, shin and round foot: 6 + 8 degrees of freedom.
struct Walker {
  static constexpr double kThigh = 0.25, kShin = 0.25, kFoot = 0.03;
  static constexpr double kHeight = kThigh + kShin + kFoot;  // of the trunk above its feet
  ArticulationId id;
  std::vector<double> rest;  // coordinates
};
inline Walker add_walker(World& world, const Vec3& trunk, const Material& material) {
  std::vector<LinkSpec> links(1);
  links[0].joint = FreeJoint{};
  links[0].inertia = solid_inertia(Box{{0.3, 0.15, 0.08}}, 500.0);
  for (int leg = 0; leg < 4; ++leg) {
    LinkSpec thigh;
    thigh.parent = 0;
    thigh.joint = RevoluteJoint{{0, 1, 0}};
    thigh.T_parent_joint = SE3(Vec3{leg < 2 ? 0.25 : -0.25, leg % 2 == 0 ? 0.15 : -0.15, 0});
    thigh.inertia = bar(1.0, Walker::kThigh);
    links.push_back(thigh);
    LinkSpec shin = thigh;
    shin.parent = static_cast<int>(links.size()) - 1;
    shin.T_parent_joint = SE3(Vec3{0, 0, -Walker::kThigh});
    shin.inertia = bar(0.5, Walker::kShin);
    links.push_back(shin);
  }
  const Model model = model_of(links);
  Walker walker;
  walker.id = must(world.create_articulation({model}));
  must(world.add_collider(world.link_body(walker.id, 0),
                          collider_of(Box{{0.3, 0.15, 0.08}}, material)));
  for (int leg = 0; leg < 4; ++leg) {
    const int thigh = 1 + 2 * leg;
    must(world.add_collider(
        world.link_body(walker.id, thigh + 1),
        collider_of(Sphere{Walker::kFoot}, material, SE3(Vec3{0, 0, -Walker::kShin}))));
    for (const int link : {thigh, thigh + 1}) {
      must(world.set_drive(walker.id, link, 0, {0.0, 0.0, 2000.0, 40.0, 200.0}));
    }
  }
  walker.rest = model.zero_coordinates();
  for (int k = 0; k < 3; ++k) walker.rest[static_cast<std::size_t>(k)] = trunk[k];
  const std::vector<double> still(static_cast<std::size_t>(model.velocities()));
  must(world.set_joint_states(walker.id, walker.rest, still));
  return walker;
}

}  // namespace vp::test
