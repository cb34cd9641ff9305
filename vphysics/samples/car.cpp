// A car pulls a trailer over ground with bumps. Wheels, springs by frequency, motors, and a
// coupling that breaks. Public headers only.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "vphysics/world.h"

namespace {

// begin: car
// A spring and damper that carries a mass [kg] at a natural frequency [Hz], hung at `position`.
vp::JointDrive spring(double position, double mass, double frequency, double damping_ratio) {
  const double omega = 2.0 * std::numbers::pi * frequency;
  return {.position = position,
          .stiffness = mass * omega * omega,
          .damping = 2.0 * damping_ratio * mass * omega,
          .max_force = 1e6};
}

// z is the axle, y the direction of the suspension. `motor` acts about the axle.
vp::SixDof wheel_joint(double carried_mass, const vp::JointDrive& motor) {
  vp::SixDof joint;
  for (vp::AxisDesc& axis : joint.axes) axis.motion = vp::AxisMotion::locked;
  vp::AxisDesc& suspension = joint.axes[static_cast<int>(vp::JointAxis::y)];
  suspension = {vp::AxisMotion::limited, -0.1, 0.1, spring(0.0, carried_mass, 2.0, 0.7)};
  vp::AxisDesc& axle = joint.axes[static_cast<int>(vp::JointAxis::rotation_z)];
  axle = {vp::AxisMotion::free, 0.0, 0.0, motor};
  return joint;
}

// A speed that the motor keeps while its torque suffices: no stiffness, much damping.
vp::JointDrive speed_motor(double speed, double max_torque) {
  return {.velocity = speed, .damping = 1e9, .max_force = max_torque};
}
// end: car

class Road {
 public:
  Road() {
    vp::BodyDesc desc;
    desc.motion = vp::Motion::fixed;
    ground_ = add(desc, vp::HalfSpace{}, 0.0);
    for (int i = 0; i < 6; ++i) {
      desc.T_world_body = vp::SE3(vp::Vec3{6.0 + 4.0 * i, 0.0, -0.24});
      add(desc, vp::Sphere{0.3}, 0.0);
    }
  }
  vp::World& world() { return world_; }
  bool ok() const { return ok_; }

  // A box with two axles, which is at x and drives along x.
  struct Vehicle {
    vp::BodyId chassis;
    std::vector<vp::JointId> wheels;
  };
  Vehicle add_vehicle(double x, double mass, const vp::JointDrive& motor) {
    const vp::Vec3 half{1.0, 0.5, 0.2};
    const double radius = 0.3, track = 0.7;
    vp::BodyDesc desc;
    desc.T_world_body = vp::SE3(vp::Vec3{x, 0.0, 0.66});
    Vehicle vehicle;
    vehicle.chassis = add(desc, vp::Box{half}, mass / (8.0 * half.x * half.y * half.z));
    for (const double front : {-0.7, 0.7}) {
      for (const double side : {-track, track}) {
        const vp::Vec3 at{x + front, side, 0.3};
        // Columns: the axle is z, along the world's y, so that it rolls along x as it turns by +z.
        const vp::Mat3 axle{{-1.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, {0.0, 1.0, 0.0}};
        desc.T_world_body = vp::SE3(axle, at);
        const vp::BodyId wheel = add(desc, vp::Cylinder{radius, 0.1}, 300.0);
        vp::JointDesc joint;
        joint.kind = wheel_joint(mass / 4.0, motor);
        joint.T_a_joint = vp::Inv(world_.pose(vehicle.chassis)) * vp::SE3(axle, at);
        const auto made = world_.create_joint(vehicle.chassis, wheel, joint);
        ok_ = ok_ && made.has_value();
        if (made) vehicle.wheels.push_back(*made);
      }
    }
    return vehicle;
  }
  // A ball joint half-way between two vehicles.
  vp::JointId couple(const Vehicle& puller, const Vehicle& pulled, double x) {
    vp::JointDesc joint;
    joint.kind = vp::BallSocket{};
    const vp::SE3 at(vp::Vec3{x, 0.0, 0.5});
    joint.T_a_joint = vp::Inv(world_.pose(puller.chassis)) * at;
    joint.T_b_joint = vp::Inv(world_.pose(pulled.chassis)) * at;
    const auto made = world_.create_joint(puller.chassis, pulled.chassis, joint);
    ok_ = ok_ && made.has_value();
    return made ? *made : vp::JointId{};
  }

 private:
  vp::BodyId add(const vp::BodyDesc& desc, const vp::Shape& shape, double density) {
    vp::ColliderDesc collider;
    collider.shape = shape;
    collider.density = density > 0.0 ? density : 1000.0;
    collider.material.friction = 0.9;
    const auto body = world_.create_body(desc);
    ok_ = ok_ && body && world_.add_collider(*body, collider);
    return body ? *body : vp::BodyId{};
  }

  vp::World world_;
  vp::BodyId ground_;
  bool ok_ = true;
};

}  // namespace

int main() {
  Road road;
  vp::World& world = road.world();
  const auto car = road.add_vehicle(0.0, 800.0, speed_motor(0.0, 400.0));
  const auto trailer = road.add_vehicle(-2.6, 300.0, {});
  const vp::JointId coupling = road.couple(car, trailer, -1.3);
  if (!road.ok()) return 1;

  // From 1 s on it gathers speed up to 4 m/s, over the bumps; at 9 s it brakes with all its force.
  constexpr double kStrength = 1000.0;  // of the coupling [N]
  double strongest = 0.0, broke = 0.0;
  for (int tick = 0; tick < 60 * 12; ++tick) {
    const double time = tick / 60.0;
    const double speed = time > 9.0 ? 0.0 : std::clamp(2.0 * (time - 1.0), 0.0, 4.0) / 0.3;
    for (const vp::JointId wheel : car.wheels) {
      if (!world.set_drive(wheel, vp::JointAxis::rotation_z, speed_motor(speed, 400.0))) return 1;
    }
    if (!world.step(1.0 / 60.0)) return 1;
    if (broke > 0.0) continue;
    // begin: break
    const double load = vp::norm(world.joint_force(coupling).force);  // of the last step [N]
    if (load > kStrength && !world.destroy_joint(coupling)) return 1;
    // end: break
    if (load > kStrength) broke = time;
    if (load <= kStrength) strongest = std::max(strongest, load);
  }
  const double x = world.pose(car.chassis).position().x;
  const double height = world.pose(car.chassis).position().z;
  std::printf(
      "the car stands at %.1f m, its chassis %.2f m high; the coupling, with at most %.0f N\n"
      "until then, broke at %.2f s, when it braked\n",
      x, height, strongest, broke);
  // A spring of frequency f under a weight sags by g / (2 pi f)^2.
  const double expected = 0.66 - 9.81 / std::pow(2.0 * std::numbers::pi * 2.0, 2);
  const bool stands = vp::norm(world.velocity(car.chassis).v) < 0.05;
  return x > 25.0 && std::fabs(height - expected) < 0.005 && broke > 9.0 && stands ? 0 : 1;
}
