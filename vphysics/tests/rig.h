// Small worlds that several tests build.
#pragma once

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "vphysics/world.h"

namespace vp::test {

inline constexpr double kG = 9.81;
inline constexpr Vec3 kGravity{0, 0, -kG};
inline constexpr double kDt = 0.001, kLongDt = 0.005;      // steps [s]
inline constexpr double kRates[] = {60.0, 240.0, 1000.0};  // of steps [Hz]
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr Material kRough{0.6, 0.0, 0.0}, kSmooth{0.0, 0.0, 0.0};
inline const Shape kBox = Box{{0.5, 0.5, 0.5}};

// Returns the value of a call that must succeed.
template <class T>
T must(const Expected<T>& result) {
  if (!result) ADD_FAILURE() << result.error().message;
  return result.value();
}
inline void must(const Expected<void>& result) {
  if (!result) ADD_FAILURE() << result.error().message;
}

// A body with one collider.
inline BodyId add_body(World& world, const BodyDesc& desc, const Shape& shape,
                       const Material& material) {
  const BodyId body = must(world.create_body(desc));
  ColliderDesc collider;
  collider.shape = shape;
  collider.material = material;
  must(world.add_collider(body, collider));
  return body;
}

inline BodyId add_fixed(World& world, const Shape& shape, const Material& material,
                        const SE3& pose = {}) {
  BodyDesc desc;
  desc.motion = Motion::fixed;
  desc.T_world_body = pose;
  return add_body(world, desc, shape, material);
}

inline BodyId add_ground(World& world, const Material& material, const Vec3& normal = {0, 0, 1}) {
  const Vec3 n = (1.0 / norm(normal)) * normal;
  const Vec3 t = std::fabs(n.x) < 0.9 ? cross(n, Vec3{1, 0, 0}) : cross(n, Vec3{0, 1, 0});
  const Vec3 x = (1.0 / norm(t)) * t;
  const Mat3 R = n == Vec3{0, 0, 1} ? Mat3::identity() : Mat3{x, cross(n, x), n};
  return add_fixed(world, HalfSpace{}, material, SE3(R, {}));
}

// Six walls around a cube of the half extent `half`.
inline void add_walls(World& world, double half, double half_thickness, const Material& material) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const double wide = half + 2.0 * half_thickness;
      Vec3 extent{wide, wide, wide}, at;
      extent[axis] = half_thickness;
      at[axis] = side * (half + half_thickness);
      add_fixed(world, Box{extent}, material, SE3(at));
    }
  }
}

// A kinematic body with a velocity in the body frame.
inline BodyId add_kinematic(World& world, const Shape& shape, const se3& velocity,
                            const Material& material = {}, const SE3& pose = {}) {
  BodyDesc desc;
  desc.motion = Motion::kinematic;
  desc.T_world_body = pose;
  desc.velocity = velocity;
  return add_body(world, desc, shape, material);
}

struct Part {
  Shape shape = Sphere{0.1};
  Material material{};
  double density = 1000.0;
  SE3 pose{};
  se3 velocity{};
  bool continuous = false;
};
inline BodyId add_dynamic(World& world, const Part& part) {
  BodyDesc desc;
  desc.T_world_body = part.pose;
  desc.velocity = part.velocity;
  desc.inertia = solid_inertia(part.shape, part.density);
  desc.continuous = part.continuous;
  const BodyId body = must(world.create_body(desc));
  ColliderDesc collider;
  collider.shape = part.shape;
  collider.material = part.material;
  must(world.add_collider(body, collider));
  return body;
}

inline double kinetic_energy(const World& world, BodyId body, const Inertia& J) {
  const se3 V = world.velocity(body);
  return 0.5 * (V * (J * V));
}

inline JointForces stops(double lower, double upper) {
  JointForces forces;
  forces.lower = lower;
  forces.upper = upper;
  return forces;
}
inline Model model_of(const std::vector<LinkSpec>& links) {
  ModelBuilder builder;
  for (const LinkSpec& link : links) must(builder.add(link));
  return must(builder.build());
}

// A foosball rod along y with its axis at the given height: a cylindrical joint whose joint frame
// has its z axis along the world's y.
inline LinkSpec rod_link(double x, double height) {
  LinkSpec link;
  link.joint = CylindricalJoint{};
  link.T_parent_joint = SE3(Mat3{{-1, 0, 0}, {0, 0, 1}, {0, 1, 0}}, {x, 0, height});
  link.inertia = Inertia(1.5, Vec3{0.2, 0.2, 0.0015});
  link.forces = {stops(-0.12, 0.12), {}};
  return link;
}
inline ArticulationDesc rod_desc(double x, double height) {
  return {model_of({rod_link(x, height)})};
}

// The boxes of a man in the rod's frame (z along the rod, y up, x forward): foot, leg, torso, head.
struct ManPart {
  Vec3 centre, half;
};
inline constexpr ManPart kMan[4] = {{{0, -0.0665, 0}, {0.011, 0.0095, 0.011}},
                                    {{0, -0.04, 0}, {0.007, 0.02, 0.008}},
                                    {{0, 0.0, 0}, {0.010, 0.022, 0.013}},
                                    {{0, 0.033, 0}, {0.009, 0.011, 0.009}}};

struct Rod {
  ArticulationId articulation;
  BodyId body;
};
inline Rod add_rod(World& world, double x, double height, int men, double spacing,
                   const Material& material) {
  const ArticulationId articulation = must(world.create_articulation(rod_desc(x, height)));
  const BodyId body = world.link_body(articulation, 0);
  for (int man = 0; man < men; ++man) {
    const double along = spacing * (man - 0.5 * (men - 1));
    for (const ManPart& part : kMan) {
      ColliderDesc collider;
      collider.shape = Box{part.half};
      collider.T_body_shape = SE3(part.centre + Vec3{0, 0, along});
      collider.material = material;
      collider.filter = {2, 1};
      must(world.add_collider(body, collider));
    }
  }
  return {articulation, body};
}

inline constexpr double kBallRadius = 0.01727;
inline constexpr double kBallDensity = 1100.0;  // 24 g

inline BodyId add_ball(World& world, const Vec3& position, const Vec3& velocity,
                       const Material& material) {
  Part part;
  part.shape = Sphere{kBallRadius};
  part.density = kBallDensity;
  part.material = material;
  part.pose = SE3(position);
  part.velocity = {{}, velocity};
  part.continuous = true;
  return add_dynamic(world, part);
}

}  // namespace vp::test
