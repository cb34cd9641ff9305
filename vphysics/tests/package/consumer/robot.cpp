// The same rod from URDF.
#include <cstdio>
#include <vector>

#include "vphysics/multibody/dynamics.h"
#include "vphysics/multibody/urdf.h"

int main() {
  const auto robot = vp::parse_urdf(R"(<robot name="pendulum">
    <link name="ceiling"/>
    <link name="rod">
      <inertial>
        <origin xyz="0.5 0 0"/>
        <mass value="2"/>
        <inertia ixx="0" ixy="0" ixz="0" iyy="0.16666666666666666" iyz="0" izz="0.16666666666666666"/>
      </inertial>
    </link>
    <joint name="hinge" type="continuous">
      <parent link="ceiling"/>
      <child link="rod"/>
      <axis xyz="0 1 0"/>
    </joint>
  </robot>)");
  if (!robot) {
    std::printf("%s\n", robot.error().message.c_str());
    return 1;
  }
  vp::Data data(robot->model);
  const std::vector<double> q{0.0}, v{0.0}, tau{0.0};
  std::vector<double> a(1);
  if (!vp::forward_dynamics<double>(robot->model, data, q, v, tau, {}, a)) return 1;
  std::printf("%s %.6f rad/s^2\n", robot->joints[0].name.c_str(), a[0]);
}
