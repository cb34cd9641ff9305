// Joints between bodies: each kind against closed forms and equivalents.
#include <gtest/gtest.h>

#include <cstdio>

#include "joints_rig.h"

namespace vp::test {
namespace {

// --- constraints

// The first passage through the bottom takes a quarter of the period, an elliptic integral by the
// arithmetic-geometric mean.
TEST(BallSocket, APendulumHasThePeriodOfItsAmplitude) {
  constexpr double kLength = 0.7, kAmplitude = 1.2, kRadius = 0.1;
  World world;
  const BodyId anchor = add_anchor(world);
  const double m = 3.0, own = 0.4 * m * kRadius * kRadius;
  const Vec3 start = kLength * Vec3{std::sin(kAmplitude), 0, -std::cos(kAmplitude)};
  const BodyId bob = add_mass(world, Inertia(m, Vec3{own, own, own}), SE3(start));
  join(world, anchor, bob, BallSocket{}, SE3{});
  double a = 1.0, b = std::cos(0.5 * kAmplitude);
  for (int i = 0; i < 10; ++i) {
    const double mean = 0.5 * (a + b);
    b = std::sqrt(a * b);
    a = mean;
  }
  // A physical pendulum, with its inertia about the pivot.
  const double period = 2 * kPi / a * std::sqrt((own + m * kLength * kLength) / (m * kG * kLength));
  double time = 0.0, last = start.x, crossed = 0.0, highest = -1.0;
  int crossings = 0;
  while (crossings < 5) {
    must(world.step(0.001));
    time += 0.001;
    const Vec3 p = world.pose(bob).position();
    highest = std::max(highest, p.z);
    if ((p.x > 0) != (last > 0)) {
      crossed = time - 0.001 * p.x / (p.x - last);
      ++crossings;
    }
    last = p.x;
    EXPECT_NEAR(norm(p), kLength, 2e-4);
  }
  std::printf("period %.6f s, expected %.6f s\n", crossed / 2.25, period);
  EXPECT_NEAR(crossed / 2.25, period, 2e-3 * period);
  EXPECT_NEAR(highest, start.z, 5e-3 * kLength);
}

// The same pendulum as an articulation, whose joint has no drift.
TEST(Hinge, MovesAsARevoluteJointOfAnArticulation) {
  const Inertia bar = solid_inertia(Box{{0.5, 0.05, 0.02}}, 800.0);
  World free, tree;
  const BodyId anchor = add_anchor(free);
  const BodyId first = add_mass(free, bar, SE3(Vec3{0.5, 0, 0}));
  const BodyId second = add_mass(free, bar, SE3(Vec3{1.5, 0, 0}));
  const JointId h1 = join(free, anchor, first, Hinge{}, SE3(kAlongY, {}));
  const JointId h2 = join(free, first, second, Hinge{}, SE3(kAlongY, {1, 0, 0}));
  std::vector<LinkSpec> links(2);
  for (int i = 0; i < 2; ++i) {
    links[i].parent = i - 1;
    links[i].joint = RevoluteJoint{{0, 1, 0}};
    links[i].T_parent_joint = SE3(Vec3{1.0 * i, 0, 0});
    links[i].inertia = bar.InvXform(SE3(Vec3{0.5, 0, 0}));
  }
  const ArticulationId id = must(tree.create_articulation({model_of(links)}));
  double worst = 0.0;
  for (int i = 0; i < 1000; ++i) {
    must(free.step(0.001));
    must(tree.step(0.001));
    worst = std::max({worst, std::fabs(free.joint_coordinate(h1) - tree.joint_position(id, 0, 0)),
                      std::fabs(free.joint_coordinate(h2) - tree.joint_position(id, 1, 0))});
  }
  EXPECT_GT(free.joint_coordinate(h1), 1.0);  // they swing
  std::printf("two hinges and two revolute joints differ by %.2g rad after 1 s\n", worst);
  EXPECT_LT(worst, 0.02);
}

TEST(Hinge, TurnsAboutItsAxisAlone) {
  World world;
  const BodyId anchor = add_anchor(world);
  const BodyId door = add_mass(world, solid_inertia(Box{{0.4, 0.02, 1.0}}, 500.0),
                               SE3(Vec3{0.4, 0, 0}), {{0.3, 0.2, 2.0}, {0, 0.8, 0}});
  const JointId hinge = join(world, anchor, door, Hinge{}, SE3{});
  run(world, 5.0);
  const SE3 T = world.pose(door);
  EXPECT_LT(norm(T * Vec3{-0.4, 0, 0}), 1e-5);
  EXPECT_LT(norm(T.rotation().cz - Vec3{0, 0, 1}), 1e-5);
  EXPECT_GT(world.joint_coordinate(hinge), 2 * kPi);  // counts beyond full revolutions
}

TEST(Slider, SlidesAsOnAnIncline) {
  World world;
  const BodyId anchor = add_anchor(world);
  const BodyId block = add_mass(world, solid_inertia(Box{{0.1, 0.1, 0.1}}, 700.0), SE3{});
  const double slope = 0.4;
  const SE3 frame(Exp(Vec3{0, kPi / 2 + slope, 0}).matrix(), {});  // z down the slope
  const JointId slider = join(world, anchor, block, Slider{}, frame);
  run(world, 1.0);
  const double expected = 0.5 * kG * std::sin(slope);
  EXPECT_NEAR(world.joint_coordinate(slider), expected, 1e-3 * expected);
  EXPECT_LT(norm(world.pose(block).rotation().cx - Vec3{1, 0, 0}), 1e-6);
  // The slider carries the rest of the weight.
  const double m = 700.0 * 0.008;
  EXPECT_NEAR(norm(world.joint_force(slider).force), m * kG * std::cos(slope), 1e-3 * m * kG);
}

TEST(Weld, HoldsACantileverAndTellsItsMoment) {
  World world;
  const BodyId wall = add_anchor(world);
  const BodyId beam =
      add_mass(world, solid_inertia(Box{{0.5, 0.05, 0.05}}, 1000.0), SE3(Vec3{0.5, 0, 0}));
  const JointId weld = join(world, wall, beam, Weld{}, SE3{});
  run(world, 1.0);
  EXPECT_LT(norm(world.pose(beam).position() - Vec3{0.5, 0, 0}), 1e-4);
  const JointForce load = world.joint_force(weld);
  EXPECT_NEAR(load.force.z, 10.0 * kG, 1e-3 * 10.0 * kG);
  EXPECT_NEAR(load.torque.y, -10.0 * kG * 0.5, 1e-3 * 10.0 * kG);
}

TEST(Distance, ARodKeepsItsLengthAndARopeOnlyItsMost) {
  for (const bool rope : {false, true}) {
    World world;
    const BodyId anchor = add_anchor(world);
    const BodyId bob = add_mass(world, solid_inertia(Sphere{0.05}, 1000.0), SE3(Vec3{0.6, 0, 0}));
    JointDesc desc;
    desc.kind = rope ? Distance{0.0, 1.0} : Distance{0.6, 0.6};
    const JointId joint = must(world.create_joint(anchor, bob, desc));
    double longest = 0.0, shortest = 1.0;
    for (int i = 0; i < 3000; ++i) {
      must(world.step(0.001));
      longest = std::max(longest, world.joint_coordinate(joint));
      shortest = std::min(shortest, world.joint_coordinate(joint));
    }
    EXPECT_LT(longest, (rope ? 1.0 : 0.6) + 1e-3);
    EXPECT_GT(longest, (rope ? 1.0 : 0.6) - 1e-3);
    EXPECT_GT(shortest, rope ? 0.0 : 0.6 - 1e-4);
  }
}

// Without external forces, a free pair rotates about its common centre of mass.
TEST(Joints, KeepMomentumAndAngularMomentum) {
  const Inertia bar = solid_inertia(Box{{0.3, 0.1, 0.05}}, 900.0);
  const JointKind kinds[] = {BallSocket{},
                             Hinge{},
                             Slider{},
                             Weld{},
                             Distance{0.6, 0.6},
                             Spring{0.5, 2000.0, 1.0},
                             ConeTwist{0.3, 0.5, -0.2, 0.2, {}}};
  for (const JointKind& kind : kinds) {
    World world(weightless());
    const BodyId a = add_mass(world, bar, SE3(Vec3{0, 0, 0}), {{0.5, 2, 1}, {0.3, 0, 0.2}});
    const BodyId b = add_mass(world, bar, SE3(Vec3{0.6, 0, 0}), {{-1, 0.5, 2}, {0, 0.5, -0.1}});
    JointDesc desc = joint_at(world, a, b, kind, SE3(Vec3{0.3, 0, 0}));
    if (std::holds_alternative<Distance>(kind) || std::holds_alternative<Spring>(kind))
      desc.T_a_joint = desc.T_b_joint = SE3{};
    must(world.create_joint(a, b, desc));
    const auto momentum = [&](Vec3& linear, Vec3& angular) {
      linear = angular = {};
      for (const BodyId id : {a, b}) {
        const SE3 T = world.pose(id);
        const se3 V = world.velocity(id);
        const Vec3 p = bar.mass() * T.rotate(V.v);
        linear += p;
        angular += T.rotate(bar.central() * V.w) + cross(T.position(), p);
      }
    };
    Vec3 p0, L0, p1, L1;
    momentum(p0, L0);
    run(world, 2.0);
    momentum(p1, L1);
    std::printf("kind %zu: momentum off by %.2g of %.2g, angular by %.2g of %.2g\n", kind.index(),
                norm(p1 - p0), norm(p0), norm(L1 - L0), norm(L0));
    EXPECT_LT(norm(p1 - p0), 1e-4 * norm(p0)) << kind.index();
    EXPECT_LT(norm(L1 - L0), 0.02 * norm(L0)) << kind.index();
  }
}

TEST(Joints, AHeavyWeightHangsFromALightLink) {
  World world;
  const BodyId anchor = add_anchor(world);
  const BodyId link = add_mass(world, Inertia(1.0, Vec3{0.01, 0.01, 0.01}), SE3(Vec3{0, 0, -0.1}));
  const BodyId weight = add_mass(world, Inertia(1000.0, Vec3{40, 40, 40}), SE3(Vec3{0, 0, -0.5}));
  const JointId top = join(world, anchor, link, BallSocket{}, SE3{});
  const JointId low = join(world, link, weight, BallSocket{}, SE3(Vec3{0, 0, -0.2}));
  run(world, 3.0);
  EXPECT_NEAR(world.joint_force(top).force.z, 1001.0 * kG, 0.01 * 1001.0 * kG);
  for (const JointId joint : {top, low}) {
    Vec3 gap;
    for (int i = 0; i < 3; ++i) gap[i] = world.joint_coordinate(joint, static_cast<JointAxis>(i));
    EXPECT_LT(norm(gap), 1e-3);
  }
}

// --- limits, motors, springs

TEST(Hinge, StopsAtItsLimits) {
  for (const double side : {-1.0, 1.0}) {
    World world;
    const BodyId anchor = add_anchor(world);
    const BodyId bar =
        add_mass(world, solid_inertia(Box{{0.5, 0.05, 0.05}}, 1000.0), SE3(Vec3{0.5, 0, 0}));
    const SE3 frame(side > 0 ? kAlongY : Mat3{{1, 0, 0}, {0, 0, 1}, {0, -1, 0}}, {});
    const JointId hinge = join(world, anchor, bar, Hinge{-0.5, 0.5, {}}, frame);
    double farthest = 0.0;
    for (int i = 0; i < 2000; ++i) {
      must(world.step(0.001));
      farthest = std::max(farthest, side * world.joint_coordinate(hinge));
    }
    EXPECT_LT(farthest, 0.505);
    EXPECT_NEAR(world.joint_coordinate(hinge), 0.5 * side, 2e-3);
    EXPECT_LT(norm(world.velocity(bar).w), 1e-3);
  }
}

TEST(Hinge, LimitsMayBeTurnsAway) {
  World world(weightless());
  const BodyId anchor = add_anchor(world);
  const BodyId wheel =
      add_mass(world, solid_inertia(Cylinder{0.2, 0.05}, 1000.0), SE3{}, {{0, 0, 10}, {}});
  const JointId hinge = join(world, anchor, wheel, Hinge{-kNoLimit, 20.0, {}}, SE3{});
  run(world, 4.0);
  EXPECT_NEAR(world.joint_coordinate(hinge), 20.0, 1e-2);
  EXPECT_LT(norm(world.velocity(wheel).w), 1e-3);
}

TEST(Hinge, AMotorReachesItsSpeedWithItsTorqueAndNoMore) {
  World world(weightless());
  const BodyId anchor = add_anchor(world);
  const Inertia inertia = solid_inertia(Cylinder{0.2, 0.05}, 1000.0);
  const BodyId wheel = add_mass(world, inertia, SE3{});
  const JointDrive motor{0, 20.0, 0, 1e6, 2.0};
  const JointId hinge = join(world, anchor, wheel, Hinge{-kNoLimit, kNoLimit, motor}, SE3{});
  const double acceleration = 2.0 / inertia.central().zz;
  run(world, 0.5);
  EXPECT_NEAR(world.velocity(wheel).w.z, 0.5 * acceleration, 1e-4 * acceleration);
  EXPECT_NEAR(world.joint_force(hinge).torque.z, 2.0, 1e-6);
  run(world, 20.0 / acceleration);
  EXPECT_NEAR(world.velocity(wheel).w.z, 20.0, 1e-3);
  must(world.set_drive(hinge, JointDrive{}));
  must(world.set_velocity(wheel, {{0, 0, 3}, {}}));
  run(world, 0.1);
  EXPECT_NEAR(world.velocity(wheel).w.z, 3.0, 1e-5);
}

TEST(Slider, ADriveHoldsAPositionAgainstALoad) {
  World world;
  const BodyId anchor = add_anchor(world);
  const BodyId load = add_mass(world, Inertia(2.0, Vec3{0.1, 0.1, 0.1}), SE3{});
  const JointId lift =
      join(world, anchor, load, Slider{-1.0, 1.0, {0.3, 0, 1000.0, 80.0, 1e4}}, SE3{});
  run(world, 3.0);
  EXPECT_NEAR(world.joint_coordinate(lift), 0.3 - 2.0 * kG / 1000.0, 1e-5);
  must(world.set_drive(lift, {0.3, 0, 1000.0, 80.0, 10.0}));  // weaker than the weight
  run(world, 3.0);
  EXPECT_NEAR(world.joint_coordinate(lift), -1.0, 1e-3);
}

TEST(Spring, SwingsAtItsFrequencyAndDecaysAsItsDamperSays) {
  constexpr double kMass = 2.0, kStiffness = 800.0;
  for (const double ratio : {0.0, 0.05}) {
    World world(weightless());
    const BodyId anchor = add_anchor(world);
    const BodyId bob = add_mass(world, Inertia(kMass, Vec3{0.1, 0.1, 0.1}), SE3(Vec3{1.1, 0, 0}));
    const double omega = std::sqrt(kStiffness / kMass);
    JointDesc desc;
    desc.kind = Spring{1.0, kStiffness, 2 * ratio * omega * kMass};
    must(world.create_joint(anchor, bob, desc));
    const double damped = omega * std::sqrt(1 - ratio * ratio);
    const int periods = 10;
    double last = 0.1, crossed = 0.0, peak = 0.0;
    int crossings = 0;
    for (int i = 1; crossings < 2 * periods; ++i) {
      ASSERT_LT(i, 100000);
      must(world.step(0.001));
      const double x = world.pose(bob).position().x - 1.0;
      if (crossings >= 2 * periods - 1) peak = std::max(peak, -x);
      if ((x > 0) != (last > 0)) {
        crossed = 0.001 * (i - x / (x - last));
        ++crossings;
      }
      last = x;
    }
    const double quarter = (kPi / 2 + std::asin(ratio)) / damped;  // until the first passage
    const double expected = quarter + (2 * periods - 1) * kPi / damped;
    EXPECT_NEAR(crossed, expected, 2e-3 * expected);
    const double half_turns = 2 * periods - 1;
    const double decayed = 0.1 * std::exp(-ratio * omega * half_turns * kPi / damped);
    std::printf("damping ratio %.2f: peak %.5f m, expected %.5f m\n", ratio, peak, decayed);
    EXPECT_NEAR(peak, decayed, 0.02 * decayed);
  }
}

TEST(Spring, ThatIsTooStiffForTheStepStaysStable) {
  World world;
  const BodyId anchor = add_anchor(world);
  const BodyId bob = add_mass(world, Inertia(1.0, Vec3{0.1, 0.1, 0.1}), SE3(Vec3{0, 0, -1.1}));
  JointDesc desc;
  desc.kind = Spring{1.0, 1e9, 0.0};
  const JointId spring = must(world.create_joint(anchor, bob, desc));
  run(world, 2.0, 1.0 / 60.0);
  EXPECT_NEAR(world.joint_coordinate(spring), 1.0, 1e-4);
}

TEST(ConeTwist, StaysWithinConeAndTwist) {
  constexpr double kSwingX = 0.3, kSwingY = 0.6;
  for (int direction = 0; direction < 8; ++direction) {
    const double about = direction * kPi / 4;
    WorldDesc settings = weightless();
    const Vec3 axis{std::cos(about), std::sin(about), 0};
    settings.gravity = 9.81 * cross(axis, Vec3{0, 0, 1});  // swings about the axis
    World world(settings);
    const BodyId anchor = add_anchor(world);
    const BodyId bar = add_mass(world, solid_inertia(Capsule{0.05, 0.4}, 1000.0),
                                SE3(Vec3{0, 0, 0.5}), {{0, 0, 3.0}, {}});
    const JointId joint =
        join(world, anchor, bar, ConeTwist{kSwingX, kSwingY, -0.4, 0.4, {}}, SE3{});
    double worst = 0.0;
    for (int i = 0; i < 4000; ++i) {
      must(world.step(0.001));
      const double x = world.joint_coordinate(joint, JointAxis::rotation_x) / kSwingX;
      const double y = world.joint_coordinate(joint, JointAxis::rotation_y) / kSwingY;
      worst = std::max(worst, std::sqrt(x * x + y * y));
      EXPECT_LT(std::fabs(world.joint_coordinate(joint)), 0.41);
    }
    EXPECT_LT(worst, 1.03);
    const double x = world.joint_coordinate(joint, JointAxis::rotation_x) / kSwingX;
    const double y = world.joint_coordinate(joint, JointAxis::rotation_y) / kSwingY;
    EXPECT_NEAR(std::sqrt(x * x + y * y), 1.0, 0.02) << direction;
  }
}

TEST(Gear, TurnsTheOtherWheelByItsRatio) {
  World world(weightless());
  const BodyId anchor = add_anchor(world);
  const Inertia small = solid_inertia(Cylinder{0.1, 0.02}, 1000.0);
  const Inertia large = solid_inertia(Cylinder{0.3, 0.02}, 1000.0);
  const BodyId a = add_mass(world, small, SE3{}, {{0, 0, 12}, {}});
  const BodyId b = add_mass(world, large, SE3(Vec3{0.4, 0, 0}));
  const JointId axle_a = join(world, anchor, a, Hinge{}, SE3{});
  const JointId axle_b = join(world, anchor, b, Hinge{}, SE3(Vec3{0.4, 0, 0}));
  JointDesc gear;
  gear.kind = Gear{-1.0 / 3.0};
  const JointId mesh = must(world.create_joint(a, b, gear));
  run(world, 5.0);
  EXPECT_NEAR(world.joint_coordinate(axle_b), -world.joint_coordinate(axle_a) / 3.0, 2e-3);
  EXPECT_NEAR(world.joint_coordinate(mesh), 0.0, 2e-3);
  // An impulse between the teeth: both bodies rotate as one inertia.
  const double ia = small.central().zz, ib = large.central().zz;
  EXPECT_NEAR(world.velocity(a).w.z, 12.0 * ia / (ia + ib / 9.0), 1e-2);
}

TEST(Gear, ARackSlidesAsItsPinionTurns) {
  World world(weightless());
  const BodyId anchor = add_anchor(world);
  const BodyId pinion = add_mass(world, solid_inertia(Cylinder{0.1, 0.02}, 1000.0), SE3{});
  const BodyId rack =
      add_mass(world, solid_inertia(Box{{0.5, 0.02, 0.02}}, 1000.0), SE3(Vec3{0, 0.12, 0}));
  join(world, anchor, pinion, Hinge{-kNoLimit, kNoLimit, {0, 2.0, 0, 1e5, 50.0}}, SE3{});
  const SE3 along_x(Mat3{{0, 0, -1}, {0, 1, 0}, {1, 0, 0}}, {0, 0.12, 0});
  const JointId slide = join(world, anchor, rack, Slider{}, along_x);
  JointDesc mesh;
  mesh.kind = Gear{0.1, false, true};
  mesh.T_b_joint = SE3(along_x.rotation(), {});
  must(world.create_joint(pinion, rack, mesh));
  run(world, 2.0);
  EXPECT_NEAR(world.joint_coordinate(slide), 0.1 * 2.0 * 2.0, 0.01);
  EXPECT_NEAR(world.velocity(rack).v.x, 0.2, 1e-4);
}

// --- six degrees of freedom and user-defined constraints

double distance_between(World& one, BodyId a, World& two, BodyId b) {
  return norm(one.pose(a).position() - two.pose(b).position()) +
         norm(one.pose(a).rotation().cx - two.pose(b).rotation().cx);
}

TEST(SixDof, WithFiveAxesLockedIsAHinge) {
  World one, two;
  BodyId bars[2];
  SixDof six;
  for (int i = 0; i < 5; ++i) six.axes[i].motion = AxisMotion::locked;
  six.axes[5] = {AxisMotion::limited, -0.3, 0.7, {}};
  const JointKind kinds[] = {six, Hinge{-0.3, 0.7, {}}};
  World* worlds[] = {&one, &two};
  for (int i = 0; i < 2; ++i) {
    const BodyId anchor = add_anchor(*worlds[i]);
    bars[i] =
        add_mass(*worlds[i], solid_inertia(Box{{0.5, 0.05, 0.05}}, 1000.0), SE3(Vec3{0.5, 0, 0}));
    join(*worlds[i], anchor, bars[i], kinds[i], SE3(kAlongY, {}));
    run(*worlds[i], 1.0);
  }
  EXPECT_EQ(distance_between(one, bars[0], two, bars[1]), 0.0);
}

TEST(SixDof, LimitsAndDrivesEachAxis) {
  World world;
  const BodyId anchor = add_anchor(world);
  const BodyId box = add_mass(world, Inertia(1.0, Vec3{0.1, 0.1, 0.1}), SE3{});
  SixDof six;
  six.axes[0] = {AxisMotion::free, 0, 0, {0.2, 0, 500, 40, 1e4}};
  six.axes[1].motion = AxisMotion::locked;
  six.axes[2] = {AxisMotion::limited, -0.1, 0.1, {}};
  six.axes[3] = {AxisMotion::limited, -0.3, 0.3, {0.5, 0, 100, 10, 1e3}};
  six.axes[4] = {AxisMotion::free, 0, 0, {-0.4, 0, 100, 10, 1e3}};
  six.axes[5].motion = AxisMotion::locked;
  const JointId joint = join(world, anchor, box, six, SE3{});
  run(world, 4.0);
  const double expected[6] = {0.2, 0, -0.1, 0.3, -0.4, 0};
  for (int i = 0; i < 6; ++i)
    EXPECT_NEAR(world.joint_coordinate(joint, static_cast<JointAxis>(i)), expected[i], 2e-3) << i;
}

// A user-defined ball and socket: two points coincide.
class OwnBall : public PairConstraint {
 public:
  OwnBall(const Vec3& on_a, const Vec3& on_b) : on_a_(on_a), on_b_(on_b) {}
  int rows() const override { return 3; }
  void evaluate(const SE3& T_a, const SE3& T_b, std::span<double> residual,
                std::span<PairRow> jacobian) const override {
    const Vec3 d = T_b * on_b_ - T_a * on_a_;
    const Vec3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (std::size_t i = 0; i < 3; ++i) {
      residual[i] = dot(axes[i], d);
      const Vec3 n_a = T_a.unrotate(axes[i]), n_b = T_b.unrotate(axes[i]);
      jacobian[i].a = {-cross(on_a_, n_a), -n_a};
      jacobian[i].b = {cross(on_b_, n_b), n_b};
    }
  }

 private:
  Vec3 on_a_, on_b_;
};

TEST(UserConstraint, MovesAsTheBuiltInOneItIsEqualTo) {
  World one, two;
  World* worlds[] = {&one, &two};
  BodyId ends[2];
  for (int i = 0; i < 2; ++i) {
    World& world = *worlds[i];
    const BodyId anchor = add_anchor(world, SE3(Exp(Vec3{0.1, 0.2, 0.3}).matrix(), {0, 0, 1}));
    // With a centre of mass away from its origin.
    const Inertia odd = solid_inertia(Box{{0.2, 0.1, 0.05}}, 1000.0).InvXform(SE3(Vec3{0.1, 0, 0}));
    const BodyId first = add_mass(world, odd, SE3(Vec3{0.3, 0, 1}));
    ends[i] = add_mass(world, odd, SE3(Vec3{0.9, 0, 1}), {{0, 1, 2}, {0, 1, 0}});
    const BodyId chain[] = {anchor, first, ends[i]};
    for (int k = 0; k < 2; ++k) {
      const JointDesc ball =
          joint_at(world, chain[k], chain[k + 1], BallSocket{}, SE3(Vec3{0.6 * k, 0, 1}));
      JointDesc own;
      own.kind = UserConstraint{
          std::make_shared<OwnBall>(ball.T_a_joint.position(), ball.T_b_joint.position())};
      must(world.create_joint(chain[k], chain[k + 1], i == 0 ? ball : own));
    }
    run(world, 1.0);
  }
  EXPECT_GT(norm(one.pose(ends[0]).position() - Vec3{0.9, 0, 1}), 0.3);  // it moved
  const double off = distance_between(one, ends[0], two, ends[1]);
  std::printf("a ball of one's own differs by %.2g\n", off);
  EXPECT_LT(off, 1e-3);
}

// Keeps a body above a plane: a row with a unilateral impulse.
class Above : public PairConstraint {
 public:
  int rows() const override { return 1; }
  ConstraintRowDesc row_desc(int) const override { return {0, 1, 0, kNoLimit}; }
  void evaluate(const SE3&, const SE3& T_b, std::span<double> residual,
                std::span<PairRow> jacobian) const override {
    residual[0] = T_b.position().z;
    jacobian[0].b = {{}, T_b.unrotate({0, 0, 1})};
  }
};

TEST(UserConstraint, OneSidedRowsPushAndDoNotPull) {
  World world;
  const BodyId anchor = add_anchor(world);
  const BodyId ball = add_mass(world, Inertia(1.0, Vec3{0.1, 0.1, 0.1}), SE3(Vec3{0, 0, 0.5}));
  JointDesc desc;
  desc.kind = UserConstraint{std::make_shared<Above>()};
  const JointId joint = must(world.create_joint(anchor, ball, desc));
  run(world, 0.3);  // before it reaches the plane
  EXPECT_NEAR(world.pose(ball).position().z, 0.5 - 0.5 * kG * 0.09, 2e-3);
  EXPECT_EQ(world.joint_force(joint).force.z, 0.0);
  run(world, 1.0);
  EXPECT_NEAR(world.joint_residual(joint, 0), 0.0, 1e-3);
  EXPECT_NEAR(world.joint_force(joint).force.z, kG, 1e-2);
  must(world.set_velocity(ball, {{}, {0, 0, 2}}));
  run(world, 0.1);
  EXPECT_NEAR(world.velocity(ball).v.z, 2 - 0.1 * kG, 1e-3);
}

// A hinge, and a cone joint with unlimited twist: more than half a revolution in each step.
TEST(Joints, TurnsAreCountedHoweverFastATwistIs) {
  ConeTwist cone;
  for (const JointKind& kind : {JointKind(Hinge{}), JointKind(cone)}) {
    for (const double rate : {200.0, 400.0}) {
      World world(weightless());
      const BodyId anchor = add_anchor(world);
      const BodyId wheel = add_mass(world, Inertia(1.0, Vec3{1, 1, 2}), {}, {{0, 0, rate}, {}});
      const JointId joint = join(world, anchor, wheel, kind, SE3{});
      run(world, 2.0, 1.0 / 60);
      EXPECT_NEAR(world.joint_coordinate(joint), 2.0 * rate, 0.01 * rate);
    }
  }
}

// A spring so soft that its force vanishes, and a user's row with a minute force.
TEST(Joints, WhatHoldsNothingLeavesABodyToFall) {
  for (const double frequency : {1e-40, 1e-18, 1e-6}) {
    for (const double damping_ratio : {0.0, 1.0}) {
      World world;
      const BodyId anchor = add_anchor(world);
      const BodyId ball = add_mass(world, Inertia(1.0, Vec3{1, 1, 1}), {});
      JointDesc desc;
      desc.kind = Weld{};
      desc.frequency = frequency;
      desc.damping_ratio = damping_ratio;
      must(world.create_joint(anchor, ball, desc));
      for (int i = 0; i < 500; ++i) EXPECT_FALSE(must(world.step(0.001)).non_finite);
      EXPECT_NEAR(world.pose(ball).position().z, -0.5 * kG * 0.25, 0.01) << frequency;
    }
  }
}

// A sleeping body keeps the force of its joint, also to a kinematic body, which never sleeps.
TEST(Joints, ASleepingBodyKeepsItsForce) {
  for (const Motion motion : {Motion::fixed, Motion::kinematic}) {
    WorldDesc settings;
    settings.sleep_after = 0.5;
    World world(settings);
    BodyDesc desc;
    desc.motion = motion;
    const BodyId hook = must(world.create_body(desc));
    const BodyId ball = add_mass(world, Inertia(2.0, Vec3{1, 1, 1}), SE3(Vec3{0, 0, -0.5}));
    const JointId joint = join(world, hook, ball, BallSocket{}, SE3{});
    for (int i = 0; i < 600; ++i) must(world.step(1.0 / 60));
    ASSERT_TRUE(world.is_asleep(ball));
    EXPECT_NEAR(norm(world.joint_force(joint).force), 2.0 * 9.81, 0.01);
  }
}

// More joints than there are colours.
TEST(Joints, AHubHoldsAHundredBalls) {
  World world;
  const BodyId hub = add_anchor(world);
  BodyDesc desc;
  desc.inertia = Inertia(10.0, Vec3{1, 1, 1});
  const BodyId wheel = must(world.create_body(desc));
  join(world, hub, wheel, Weld{}, SE3{});
  std::vector<BodyId> balls;
  for (int i = 0; i < 100; ++i) {
    const Vec3 at = Exp(Vec3{0.0, 0.0, 0.02 * kPi * i}) * Vec3{1, 0, 0};
    balls.push_back(add_mass(world, Inertia(0.1, 1e-3 * Vec3{1, 1, 1}), SE3(at)));
    join(world, wheel, balls.back(), i % 2 == 0 ? JointKind(BallSocket{}) : JointKind(Weld{}),
         SE3(at));
  }
  run(world, 1.0);
  for (int i = 0; i < 100; ++i) {
    const Vec3 at = Exp(Vec3{0.0, 0.0, 0.02 * kPi * i}) * Vec3{1, 0, 0};
    EXPECT_LT(norm(world.pose(balls[static_cast<std::size_t>(i)]).position() - at), 2e-3) << i;
  }
}

}  // namespace
}  // namespace vp::test
