// Robots on flat ground, described once: Virtual Physics and MuJoCo are built from the same list.
#pragma once

#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "vphysics/multibody/model.h"

namespace robots {

// A capsule; a sphere if both ends coincide. In the link's frame.
struct RoundShape {
  vp::Vec3 from, to;
  double radius;
};

// All joints are revolute, except the first link's, which is free. A link without mass shares its
// origin and axes with its only child: together they are a joint of two or three axes.
struct Link {
  vp::LinkSpec spec;
  std::vector<RoundShape> shapes;
  // Of its joint: the initial angle and the motor's target, or the maximum random torque.
  double position = 0.0;
  double stiffness = 0.0, damping = 0.0;
  double random_torque = 0.0;
};

struct Robot {
  std::string name;
  std::vector<Link> links;
  vp::SE3 start;           // T_world_base
  bool is_random() const;  // some joint has random torques
};

const std::vector<std::string>& robot_names();
// Precondition: a name of robot_names().
Robot make_robot(std::string_view name);

inline constexpr double kFriction = 0.8;

// A rotation that maps the z axis to this unit vector.
vp::Mat3 facing(const vp::Vec3& z);

// In [-1, 1]: one value for each joint with random torques, joint after joint, and new ones after
// every kHeldSteps. The same in both engines.
inline constexpr int kHeldSteps = 10;
class Torques {
 public:
  double next() { return static_cast<double>(numbers_() >> 11) * 0x1p-52 - 1.0; }

 private:
  std::mt19937_64 numbers_;
};

// One robot in one engine.
class Simulation {
 public:
  virtual ~Simulation() = default;
  virtual void step() = 0;
  virtual vp::SE3 pose(int link) const = 0;  // of a link with mass
  virtual double speed() const = 0;          // the maximum of all its velocities
};

}  // namespace robots
