#include "robots.h"

#include <cmath>

namespace robots {
namespace {

using vp::Inertia;
using vp::SE3;
using vp::Vec3;

constexpr double kDensity = 1000.0;  // [kg/m^3]
constexpr Vec3 kX{1, 0, 0}, kY{0, 1, 0}, kZ{0, 0, 1};

Inertia inertia_of(const RoundShape& shape) {
  const Vec3 along = shape.to - shape.from, middle = 0.5 * (shape.from + shape.to);
  const double length = norm(along), r = shape.radius;
  const double ball = kDensity * 4.0 / 3.0 * vp::kPi * r * r * r;
  const double rod = kDensity * vp::kPi * r * r * length;
  const double about = 0.4 * ball * r * r + 0.5 * rod * r * r;
  const double across = ball * (0.4 * r * r + 0.25 * length * length + 0.375 * r * length) +
                        rod * (0.25 * r * r + length * length / 12.0);
  const vp::Mat3 R = length > 0.0 ? facing((1.0 / length) * along) : vp::Mat3::identity();
  return Inertia(ball + rod, Vec3{across, across, about}).InvXform(SE3(R, middle));
}

class Builder {
 public:
  Builder(std::string name, const SE3& start) {
    robot_.name = std::move(name);
    robot_.start = start;
  }
  int base(std::vector<RoundShape> shapes) {
    return add({.spec = {.name = "base", .joint = vp::FreeJoint{}}, .shapes = std::move(shapes)});
  }
  Link& hinge(int parent, const Vec3& at, const Vec3& axis, double lower, double upper,
              std::vector<RoundShape> shapes = {}) {
    Link link;
    link.spec.name = "link" + std::to_string(robot_.links.size());
    link.spec.parent = parent;
    link.spec.joint = vp::RevoluteJoint{axis};
    link.spec.T_parent_joint = SE3(vp::Mat3::identity(), at);
    link.spec.armature = armature;
    link.spec.damping = damping;
    vp::JointForces limits;
    limits.lower = lower;
    limits.upper = upper;
    link.spec.forces = {limits};
    link.shapes = std::move(shapes);
    return robot_.links[static_cast<std::size_t>(add(std::move(link)))];
  }
  int last() const { return static_cast<int>(robot_.links.size()) - 1; }
  Robot take() { return std::move(robot_); }

  double armature = 0.01, damping = 1.0;

 private:
  int add(Link link) {
    for (const RoundShape& shape : link.shapes) {
      link.spec.inertia = link.spec.inertia + inertia_of(shape);
    }
    robot_.links.push_back(std::move(link));
    return last();
  }
  Robot robot_;
};

// 27 velocities, 19 capsules and spheres. It is dropped on its back and stays there; its joints are
// damped and move freely within their limits.
Robot humanoid() {
  Builder b("humanoid", SE3(Exp(Vec3{0, -0.5 * vp::kPi, 0}), {0, 0, 0.4}));
  const int chest = b.base({{{0, -0.07, 0}, {0, 0.07, 0}, 0.07},
                            {{0, 0, 0.19}, {0, 0, 0.19}, 0.09},
                            {{-0.01, -0.06, -0.12}, {-0.01, 0.06, -0.12}, 0.06}});
  b.damping = 5.0;
  b.armature = 0.02;
  b.hinge(chest, {-0.01, 0, -0.2}, kZ, -0.8, 0.8);
  b.hinge(b.last(), {0, 0, 0}, kY, -1.3, 0.5, {{{0, -0.06, 0}, {0, 0.06, 0}, 0.06}});
  b.hinge(b.last(), {0, 0, -0.16}, kX, -0.6, 0.6, {{{-0.02, -0.07, 0}, {-0.02, 0.07, 0}, 0.09}});
  const int pelvis = b.last();
  for (const double side : {1.0, -1.0}) {
    b.hinge(pelvis, {0, 0.1 * side, -0.04}, kX, -0.4, 0.4);
    b.hinge(b.last(), {0, 0, 0}, kZ, -1.0, 0.6);
    b.hinge(b.last(), {0, 0, 0}, kY, -1.9, 0.3, {{{0, 0, 0}, {0, 0.01 * side, -0.34}, 0.06}});
    b.damping = 1.0;
    b.armature = 0.008;
    b.hinge(b.last(), {0, 0.01 * side, -0.4}, kY, -2.7, 0.0, {{{0, 0, 0}, {0, 0, -0.3}, 0.049}});
    b.hinge(b.last(), {0, 0, -0.39}, kY, -0.8, 0.8);
    b.hinge(
        b.last(), {0, 0, 0}, kX, -0.8, 0.8,
        {{{-0.07, 0.01, 0}, {0.14, 0.03, 0}, 0.027}, {{-0.07, -0.01, 0}, {0.14, -0.03, 0}, 0.027}});
    b.damping = 5.0;
    b.armature = 0.02;
  }
  b.damping = 0.5;
  b.armature = 0.005;
  for (const double side : {1.0, -1.0}) {
    b.hinge(chest, {0, 0.17 * side, 0.06}, kX, -1.4, 1.4);
    b.hinge(b.last(), {0, 0, 0}, kY, -1.4, 1.4, {{{0, 0, 0}, {0.1, 0.12 * side, -0.14}, 0.04}});
    b.hinge(b.last(), {0.12, 0.16 * side, -0.17}, kY, -1.5, 0.9,
            {{{0.01, 0, 0.01}, {0.15, -0.12 * side, 0.15}, 0.031},
             {{0.18, -0.15 * side, 0.18}, {0.18, -0.15 * side, 0.18}, 0.04}});
  }
  return b.take();
}

// 18 velocities: a trunk on four legs of three joints; stiff motors keep its posture.
Robot quadruped() {
  Builder b("quadruped", SE3(vp::Mat3::identity(), {0, 0, 0.42}));
  const int trunk =
      b.base({{{-0.2, 0.07, 0}, {0.2, 0.07, 0}, 0.07}, {{-0.2, -0.07, 0}, {0.2, -0.07, 0}, 0.07}});
  b.damping = 0.2;
  const auto motor = [](Link& link, double position) {
    link.position = position;
    link.stiffness = 150.0;
    link.damping = 4.0;
  };
  for (const double front : {1.0, -1.0}) {
    for (const double left : {1.0, -1.0}) {
      motor(b.hinge(trunk, {0.24 * front, 0.06 * left, 0}, kX, -0.8, 0.8,
                    {{{0, 0, 0}, {0, 0.06 * left, 0}, 0.045}}),
            0.0);
      motor(
          b.hinge(b.last(), {0, 0.09 * left, 0}, kY, -1.5, 2.5, {{{0, 0, 0}, {0, 0, -0.22}, 0.03}}),
          0.7);
      motor(b.hinge(b.last(), {0, 0, -0.24}, kY, -2.7, -0.3,
                    {{{0, 0, 0}, {0, 0, -0.22}, 0.018}, {{0, 0, -0.23}, {0, 0, -0.23}, 0.025}}),
            -1.4);
    }
  }
  return b.take();
}

// 14 velocities: a ball on four legs of two joints, driven by random torques.
Robot ant() {
  Builder b("ant", SE3(vp::Mat3::identity(), {0, 0, 0.6}));
  const int torso = b.base({{{0, 0, 0}, {0, 0, 0}, 0.25}});
  b.armature = 1.0;
  constexpr double kHalf = 0.7;  // approximately sin(45 degrees) = cos(45 degrees)
  const Vec3 ways[] = {
      {kHalf, kHalf, 0}, {-kHalf, kHalf, 0}, {-kHalf, -kHalf, 0}, {kHalf, -kHalf, 0}};
  for (const Vec3& way : ways) {
    const Vec3 across{-way.y, way.x, 0};
    b.hinge(torso, 0.28 * way, kZ, -0.6, 0.6, {{{0, 0, 0}, 0.28 * way, 0.08}}).random_torque = 60.0;
    Link& shin = b.hinge(b.last(), 0.28 * way, across, -0.2, 1.3, {{{0, 0, 0}, 0.56 * way, 0.08}});
    shin.position = 0.9;
    shin.random_torque = 60.0;
  }
  return b.take();
}

}  // namespace

vp::Mat3 facing(const Vec3& z) {
  const Vec3 other = std::fabs(z.x) < 0.6 ? kX : kY;
  const Vec3 x = cross(other, z), unit = (1.0 / norm(x)) * x;
  return {unit, cross(z, unit), z};
}

bool Robot::is_random() const {
  for (const Link& link : links) {
    if (link.random_torque > 0.0) return true;
  }
  return false;
}

const std::vector<std::string>& robot_names() {
  static const std::vector<std::string> kNames = {"humanoid", "quadruped", "ant"};
  return kNames;
}

Robot make_robot(std::string_view name) {
  if (name == "humanoid") return humanoid();
  if (name == "quadruped") return quadruped();
  return ant();
}

}  // namespace robots
