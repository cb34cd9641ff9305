// Drives and springs in series between bodies, from soft ones to ones far stiffer than a sub-step
// resolves: each must come to rest, at the displacement of statics if it is soft enough.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>
#include <vector>

#include "joints_rig.h"

namespace vp::test {
namespace {

constexpr double kSteps[] = {1.0 / 60.0, 1.0 / 240.0};

struct End {
  double speed;    // max of the last body in the last second [m/s]
  double fastest;  // max in the whole run [m/s]
  double sag;      // [m]
};

// Six seconds.
End settle(World& world, BodyId last, double dt) {
  const double start = world.pose(last).position().z;
  const int steps = static_cast<int>(std::lround(6.0 / dt));
  End end{};
  for (int i = 0; i < steps; ++i) {
    must(world.step(dt));
    const double speed = norm(world.velocity_world(last).linear);
    end.fastest = std::max(end.fastest, speed);
    if (i * dt > 5.0) end.speed = std::max(end.speed, speed);
  }
  end.sag = start - world.pose(last).position().z;
  return end;
}

// A horizontal arm: links of 0.4 m and 2 kg on hinges, 10 kg welded to the last.
End settle_arm(int links, const JointDrive& drive, double dt) {
  constexpr double kLength = 0.4;
  World world;
  BodyId last = add_anchor(world);
  for (int i = 0; i < links; ++i) {
    const BodyId link = add_mass(world, solid_inertia(Box{{0.2, 0.04, 0.04}}, 781.25),
                                 SE3(Vec3{kLength * (i + 0.5), 0, 0}));
    join(world, last, link, Hinge{-kNoLimit, kNoLimit, drive}, SE3(kAlongY, {kLength * i, 0, 0}));
    last = link;
  }
  const BodyId load = add_mass(world, solid_inertia(Box{{0.1, 0.1, 0.1}}, 1250.0),
                               SE3(Vec3{kLength * links + 0.1, 0, 0}));
  join(world, last, load, Weld{}, SE3(Vec3{kLength * links, 0, 0}));
  return settle(world, load, dt);
}

TEST(StiffDrives, OfHingesInSeriesComeToRest) {
  for (const double dt : kSteps) {
    for (const int links : {1, 2, 3}) {
      for (const double stiffness : {3e4, 1e5, 3e5, 1e6, 1e8, 1e15}) {
        for (const double seconds : {0.001, 0.01, 0.1}) {
          const JointDrive drive{0, 0, stiffness, seconds * stiffness, 1e6};
          const End end = settle_arm(links, drive, dt);
          SCOPED_TRACE(std::to_string(links) + " links, " + std::to_string(stiffness) + ", " +
                       std::to_string(seconds) + " s, step " + std::to_string(dt));
          EXPECT_LT(end.speed, 0.02);
          EXPECT_LT(end.fastest, 0.6);
          EXPECT_LT(end.sag, 0.03);
        }
      }
    }
  }
}

// To first order in the angles: each hinge carries the moment of what is beyond it.
TEST(StiffDrives, OfHingesInSeriesSagAsInStatics) {
  constexpr double kStiffness = 2e4;
  for (const int links : {1, 2, 3}) {
    const double tip = 0.4 * links + 0.1;
    double expected = 0.0;
    for (int i = 0; i < links; ++i) {
      const double at = 0.4 * i;
      double moment = 10.0 * (tip - at);
      for (int k = i; k < links; ++k) moment += 2.0 * (0.4 * (k + 0.5) - at);
      expected += kG * moment / kStiffness * (tip - at);
    }
    const double sag = settle_arm(links, {0, 0, kStiffness, 200.0, 1e6}, 0.001).sag;
    std::printf("%d links: sag %.6f m, expected %.6f m\n", links, sag, expected);
    EXPECT_NEAR(sag, expected, 0.03 * expected);
  }
}

// Blocks of 1 kg that slide along one line, the last of 50 kg.
TEST(StiffDrives, OfSlidersInSeriesComeToRest) {
  for (const double dt : kSteps) {
    for (const double stiffness : {1e5, 1e6, 1e8}) {
      World world;
      BodyId last = add_anchor(world);
      for (int i = 0; i < 5; ++i) {
        const double mass = i == 4 ? 50.0 : 1.0, moment = 0.01 * mass;
        const BodyId block = add_mass(world, Inertia(mass, Vec3{moment, moment, moment}),
                                      SE3(Vec3{0, 0, -0.3 * (i + 1)}));
        const JointDrive drive{0, 0, stiffness, 0.01 * stiffness, 1e6};
        join(world, last, block, Slider{-kNoLimit, kNoLimit, drive}, SE3(Vec3{0, 0, -0.3 * i}));
        last = block;
      }
      const End end = settle(world, last, dt);
      EXPECT_LT(end.speed, 1e-3) << stiffness;
      const double expected = kG * (5 * 50.0 + 4 + 3 + 2 + 1) / stiffness;
      if (stiffness == 1e5) {
        EXPECT_NEAR(end.sag, expected, 0.01 * expected);
      }
      EXPECT_LT(end.sag, 1.01 * kG * 260.0 / 1e5) << stiffness;
    }
  }
}

// A beam of boxes whose three rotations are driven at each joint.
TEST(StiffDrives, OfSixDofJointsInSeriesComeToRest) {
  for (const double dt : kSteps) {
    for (const double stiffness : {1e4, 1e6, 1e8}) {
      World world;
      BodyId last = add_anchor(world);
      SixDof joint;
      for (int axis = 0; axis < 3; ++axis) joint.axes[axis].motion = AxisMotion::locked;
      for (int axis = 3; axis < 6; ++axis) {
        joint.axes[axis].motion = AxisMotion::free;
        joint.axes[axis].drive = {0, 0, stiffness, 0.1 * stiffness, 1e6};
      }
      for (int i = 0; i < 4; ++i) {
        const BodyId box = add_mass(world, solid_inertia(Box{{0.1, 0.03, 0.03}}, 1389.0),
                                    SE3(Vec3{0.2 * (i + 0.5), 0, 0}));
        join(world, last, box, joint, SE3(Vec3{0.2 * i, 0, 0}));
        last = box;
      }
      const End end = settle(world, last, dt);
      EXPECT_LT(end.speed, 1e-3) << stiffness;
      EXPECT_LT(end.sag, 0.01) << stiffness;
    }
  }
}

// The target moves: an arm follows it, whatever the stiffness.
TEST(StiffDrives, FollowAMovingTarget) {
  for (const double stiffness : {1e5, 1e6, 1e8}) {
    World world;
    BodyId last = add_anchor(world);
    std::vector<JointId> hinges;
    for (int i = 0; i < 3; ++i) {
      const BodyId link = add_mass(world, solid_inertia(Box{{0.2, 0.04, 0.04}}, 781.25),
                                   SE3(Vec3{0.4 * (i + 0.5), 0, 0}));
      hinges.push_back(join(world, last, link, Hinge{}, SE3(kAlongY, {0.4 * i, 0, 0})));
      last = link;
    }
    double worst = 0.0;
    for (int i = 1; i <= 360; ++i) {
      const double t = i / 60.0;
      const JointDrive drive{0.5 * std::sin(3 * t), 1.5 * std::cos(3 * t), stiffness,
                             0.02 * stiffness, 1e6};
      for (const JointId hinge : hinges) must(world.set_drive(hinge, drive));
      must(world.step(1.0 / 60.0));
      if (i < 60) continue;
      for (const JointId hinge : hinges)
        worst = std::max(worst, std::fabs(world.joint_coordinate(hinge) - drive.position));
    }
    std::printf("stiffness %.0e: within %.4f rad\n", stiffness, worst);
    EXPECT_LT(worst, 0.025);
  }
}

}  // namespace
}  // namespace vp::test
