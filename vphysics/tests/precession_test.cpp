// Bodies on joints that rotate fast: gyroscopes, tumbling bodies and wheels on axles keep energy
// and angular momentum at every step, and precess at the rate of the closed form.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "joints_rig.h"

namespace vp::test {
namespace {

const double kRates[] = {60.0, 240.0, 1000.0};

// Bodies and their energy and angular momentum about the origin.
class Mechanism {
 public:
  explicit Mechanism(double gravity) : gravity_(gravity), world_(described(gravity)) {}

  World& world() { return world_; }
  BodyId anchor() { return add_anchor(world_); }
  // Rotates about the origin at w, world axes.
  BodyId add(const Inertia& inertia, const SE3& pose, const Vec3& w) {
    const Vec3 v = cross(w, pose.position());
    bodies_.push_back(add_mass(world_, inertia, pose, {pose.unrotate(w), pose.unrotate(v)}));
    return bodies_.back();
  }
  double energy() const {
    double sum = 0.0;
    for (const BodyId body : bodies_) {
      const Inertia J = world_.inertia(body);
      const se3 V = world_.velocity(body);
      sum += 0.5 * (V * (J * V)) + J.mass() * gravity_ * world_.pose(body).position().z;
    }
    return sum;
  }
  Vec3 momentum() const {
    Vec3 sum{};
    for (const BodyId body : bodies_) {
      const SE3 T = world_.pose(body);
      const dse3 P = world_.inertia(body) * world_.velocity(body);
      sum += T.rotate(P.m) + cross(T.position(), T.rotate(P.f));
    }
    return sum;
  }

 private:
  static WorldDesc described(double gravity) {
    WorldDesc desc;
    desc.gravity = {0, 0, -gravity};
    return desc;
  }
  double gravity_;
  World world_;
  std::vector<BodyId> bodies_;
};

struct Drift {
  double least = 1.0, most = 1.0;  // energy, of that at the start
  double momentum = 0.0;           // change, of that at the start
};
Drift drift_over(Mechanism& mechanism, double seconds, double dt) {
  const double start = mechanism.energy();
  const Vec3 momentum = mechanism.momentum();
  Drift drift;
  for (int i = 0; i < std::lround(seconds / dt); ++i) {
    must(mechanism.world().step(dt));
    const double energy = mechanism.energy() / start;
    drift.least = std::min(drift.least, energy);
    drift.most = std::max(drift.most, energy);
  }
  drift.momentum = norm(mechanism.momentum() - momentum) / norm(momentum);
  return drift;
}

const Mat3 kAlongX{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}};  // the z axis is the world's x axis

// Angle [rad] by which the body's position has gone round the z axis in a time.
double angle_gone(World& world, BodyId body, double seconds, double dt) {
  double sum = 0.0, last = 0.0;
  for (int i = 0; i < std::lround(seconds / dt); ++i) {
    must(world.step(dt));
    const Vec3 at = world.pose(body).position();
    const double angle = std::atan2(at.y, at.x);
    sum += std::remainder(angle - last, 2 * kPi);
    last = angle;
  }
  return sum;
}

// A disc on a ball joint at the end of its horizontal axis precesses at m g l / (I spin).
TEST(Precession, OfAGyroscopeHasTheRateOfTheClosedForm) {
  for (const double spin : {20.0, 60.0, 300.0}) {
    for (const double rate : kRates) {
      Mechanism mechanism(kG);
      const Inertia disc = solid_inertia(Cylinder{0.5, 0.05}, 1000.0);
      const double precession = kG / (0.5 * 0.25 * spin);
      const SE3 pose(kAlongX, Vec3{1, 0, 0});
      const BodyId body = mechanism.add(disc, pose, {spin, 0, precession});
      join(mechanism.world(), mechanism.anchor(), body, BallSocket{}, SE3{});
      const double energy = mechanism.energy();
      const double angle = angle_gone(mechanism.world(), body, 3.0, 1.0 / rate);
      const double spun = mechanism.world().velocity(body).w.z;
      std::printf("%3.0f rad/s, %4.0f Hz: precession %.5f of the closed form, spin %.5f\n", spin,
                  rate, angle / (3.0 * precession), spun / spin);
      EXPECT_NEAR(angle, 3.0 * precession, 3e-3 * 3.0 * precession);
      EXPECT_NEAR(spun, spin, 1e-3 * spin);
      EXPECT_NEAR(mechanism.world().pose(body).position().z, 0.0, 0.01);
      EXPECT_NEAR(mechanism.energy(), energy, 2e-3 * energy);
    }
  }
}

// The same with a wheel on an axle.
TEST(Precession, OfAWheelOnAHingeHasTheRateOfTheClosedForm) {
  constexpr double kSpin = 60.0, kArm = 0.8;
  for (const double rate : kRates) {
    Mechanism mechanism(kG);
    const Inertia axle = solid_inertia(Box{{0.5, 0.02, 0.02}}, 500.0),
                  wheel = solid_inertia(Cylinder{0.3, 0.02}, 2000.0);
    const double moment = kG * (wheel.mass() * kArm + axle.mass() * 0.5);
    const double precession = moment / (0.5 * wheel.mass() * 0.09 * kSpin);
    const SE3 at(kAlongX, Vec3{kArm, 0, 0});
    World& world = mechanism.world();
    const BodyId rod = mechanism.add(axle, SE3(Vec3{0.5, 0, 0}), {0, 0, precession});
    const BodyId disc = mechanism.add(wheel, at, {kSpin, 0, precession});
    join(world, mechanism.anchor(), rod, BallSocket{}, SE3{});
    join(world, rod, disc, Hinge{}, at);
    const double angle = angle_gone(world, disc, 3.0, 1.0 / rate);
    std::printf("%4.0f Hz: precession %.5f of the closed form\n", rate, angle / (3.0 * precession));
    EXPECT_NEAR(angle, 3.0 * precession, 5e-3 * 3.0 * precession);
    EXPECT_NEAR(world.velocity(disc).w.z, kSpin, 1e-3 * kSpin);
    EXPECT_NEAR(world.pose(disc).position().z, 0.0, 0.015);
  }
}

TEST(Precession, OfATumblingBodyOnASlackRopeIsThatOfAFreeOne) {
  for (const double rate : kRates) {
    Mechanism mechanism(0.0);
    const BodyId body =
        mechanism.add(solid_inertia(Box{{0.5, 0.3, 0.1}}, 1000.0), SE3{}, {0.2, 4.0, 0.3});
    JointDesc rope;
    rope.kind = Distance{0.0, 100.0};
    must(mechanism.world().create_joint(mechanism.anchor(), body, rope));
    const Drift drift = drift_over(mechanism, 10.0, 1.0 / rate);
    EXPECT_LT(drift.momentum, 1e-3) << rate;
    EXPECT_GT(drift.least, 0.999) << rate;
    EXPECT_LT(drift.most, 1.001) << rate;
  }
}

// Far faster than its sub-steps resolve.
TEST(Precession, AtAnySpeedGainsNoEnergy) {
  for (const double spin : {1000.0, 5000.0}) {
    for (const double rate : kRates) {
      Mechanism mechanism(0.0);
      const BodyId body = mechanism.add(solid_inertia(Box{{0.5, 0.3, 0.1}}, 1000.0), SE3{},
                                        spin * Vec3{0.05, 1.0, 0.1});
      JointDesc rope;
      rope.kind = Distance{0.0, 100.0};
      must(mechanism.world().create_joint(mechanism.anchor(), body, rope));
      const Drift drift = drift_over(mechanism, 2.0, 1.0 / rate);
      std::printf("%4.0f rad/s, %4.0f Hz: energy %.4f to %.4f, momentum %.1e\n", spin, rate,
                  drift.least, drift.most, drift.momentum);
      EXPECT_LT(drift.most, 1.001);
    }
  }
}

TEST(Precession, OfAPlateOnABallJointKeepsItsEnergy) {
  for (const double rate : kRates) {
    Mechanism mechanism(kG);
    const BodyId plate = mechanism.add(solid_inertia(Box{{0.3, 0.4, 0.03}}, 1000.0),
                                       SE3(Vec3{0.3, 0, 0}), {3, 15, 7});
    join(mechanism.world(), mechanism.anchor(), plate, BallSocket{}, SE3{});
    const Drift drift = drift_over(mechanism, 5.0, 1.0 / rate);
    std::printf("%4.0f Hz: energy %.4f to %.4f\n", rate, drift.least, drift.most);
    EXPECT_GT(drift.least, 1.0 - 5.0 / rate);
    EXPECT_LT(drift.most, 1.003);
  }
}

TEST(Precession, OfTwoJoinedBodiesKeepsMomentumAndEnergy) {
  for (const bool welded : {false, true}) {
    for (const double rate : kRates) {
      Mechanism mechanism(0.0);
      const Vec3 w = welded ? Vec3{0.02, 12, 0.03} : Vec3{2, 9, 5};
      const BodyId a =
          mechanism.add(solid_inertia(Box{{0.4, 0.1, 0.05}}, 1000.0), SE3(Vec3{-0.4, 0, 0}), w);
      const BodyId b = mechanism.add(solid_inertia(Box{{0.1, 0.4, 0.05}}, 1000.0),
                                     SE3(Vec3{0.1, 0, 0}), welded ? w : Vec3{-4, 3, 8});
      welded ? join(mechanism.world(), a, b, Weld{}, SE3{})
             : join(mechanism.world(), a, b, BallSocket{}, SE3{});
      const Drift drift = drift_over(mechanism, 10.0, 1.0 / rate);
      std::printf("%s, %4.0f Hz: energy %.4f to %.4f, momentum %.1e\n",
                  welded ? "welded" : "on a ball joint", rate, drift.least, drift.most,
                  drift.momentum);
      EXPECT_LT(drift.momentum, 1e-3);
      EXPECT_GT(drift.least, 1.0 - 0.6 / rate);
      EXPECT_LT(drift.most, 1.001);
    }
  }
}

// On a link the joint is solved in rows, with the inertia of the start of the step: it must not
// gain energy.
TEST(Precession, OfAGyroscopeOnALinkGainsNoEnergy) {
  for (const double spin : {20.0, 60.0}) {
    Mechanism mechanism(kG);
    World& world = mechanism.world();
    ModelBuilder builder;
    LinkSpec post;
    post.name = "post";
    post.joint = RevoluteJoint{{0, 0, 1}};
    post.inertia = solid_inertia(Box{{0.2, 0.2, 0.2}}, 5000.0);
    must(builder.add(post));
    const ArticulationId id = must(world.create_articulation({must(builder.build())}));
    must(world.set_drives(id, std::vector<JointDrive>{{0.0, 0.0, 1e6, 1e4, 1e9}}));
    const BodyId body =
        mechanism.add(solid_inertia(Cylinder{0.5, 0.05}, 1000.0), SE3(kAlongX, Vec3{1, 0, 0}),
                      {spin, 0, kG / (0.5 * 0.25 * spin)});
    join(world, world.link_body(id, 0), body, BallSocket{}, SE3{});
    EXPECT_LT(drift_over(mechanism, 5.0, 1.0 / 60.0).most, 1.01) << spin;
  }
}

// A top on the floor, on a round tip. It tilts by 0.15 rad, and falls if it loses its spin.
struct Top {
  World world;
  BodyId body;

  static constexpr double kTip = 0.01, kHeight = 0.06, kRadius = 0.06;
  explicit Top(double spin) {
    const Material material{.friction = 0.4};
    add_fixed(world, HalfSpace{}, material);
    const SE3 tilted(Exp(Vec3{0, 0.15, 0}), {});
    const Vec3 up = tilted.rotation().cz;
    BodyDesc desc;
    desc.T_world_body = SE3(tilted.rotation(), Vec3{0, 0, kTip} + kHeight * up);
    body = must(world.create_body(desc));
    ColliderDesc tip, disc;
    tip.shape = Sphere{kTip};
    tip.T_body_shape = SE3(Vec3{0, 0, -kHeight});
    tip.density = 0.001;
    disc.shape = Cylinder{kRadius, 0.01};
    tip.material = disc.material = material;
    must(world.add_collider(body, tip));
    must(world.add_collider(body, disc));
    const double precession = kG * kHeight / (0.5 * kRadius * kRadius * spin);
    must(world.set_velocity_world(body, {{}, spin * up + Vec3{0, 0, precession}}));
  }
  double tilt() const { return std::acos(std::min(1.0, world.pose(body).rotation().cz.z)); }
  double energy() const {
    const se3 V = world.velocity(body);
    const Inertia J = world.inertia(body);
    return 0.5 * (V * (J * V)) + J.mass() * kG * world.pose(body).position().z;
  }
};

TEST(Precession, OfATopOnTheFloorGoesOn) {
  for (const double spin : {60.0, 150.0}) {
    for (const double rate : kRates) {
      Top top(spin);
      const double start = top.energy();
      double steepest = 0.0, most = 1.0;
      for (int i = 0; i < std::lround(10.0 * rate); ++i) {
        must(top.world.step(1.0 / rate));
        steepest = std::max(steepest, top.tilt());
        most = std::max(most, top.energy() / start);
      }
      std::printf("%3.0f rad/s, %4.0f Hz: tilt up to %.3f, at the end %.3f, energy up to %.4f\n",
                  spin, rate, steepest, top.tilt(), most);
      EXPECT_LT(steepest, 0.35);
      EXPECT_LT(most, 1.0 + 4.0 / rate);
    }
  }
}

// Its contact has a second point, on the rim of the base, which carries no load: friction acts at
// the apex.
TEST(Precession, OfAConeOnItsApexGoesOn) {
  for (const double spin : {80.0, 150.0}) {
    for (const double rate : kRates) {
      World world;
      add_ground(world, {.friction = 0.5});
      Part part;
      part.shape = Cone{0.1, 0.05};
      part.pose = SE3(Exp(Vec3{kPi - 0.1, 0, 0}).matrix(), Vec3{0, 0, 0.051});
      part.velocity = {{0, 0, spin}, {}};
      const BodyId cone = add_dynamic(world, part);
      double steepest = 0.0;
      for (int i = 0; i < std::lround(10.0 * rate); ++i) {
        must(world.step(1.0 / rate));
        steepest = std::max(steepest, kPi - std::acos(world.pose(cone).rotation().cz.z));
      }
      EXPECT_LT(steepest, 0.3) << spin << " rad/s, " << rate << " Hz";
      EXPECT_NEAR(world.velocity(cone).w.z, spin, 0.02 * spin) << rate << " Hz";
    }
  }
}

// On a hinge about no principal axis the joint turns the gyroscopic torque back.
TEST(Precession, OnAHingeAboutAnyAxisKeepsMostOfTheSpin) {
  for (const double rate : kRates) {
    Mechanism mechanism(0.0);
    const SE3 tilted{Exp(Vec3{0, 0.6, 0}), Vec3{}};
    const BodyId rod =
        mechanism.add(solid_inertia(Box{{0.5, 0.02, 0.02}}, 1000.0), tilted, {0, 0, 20});
    join(mechanism.world(), mechanism.anchor(), rod, Hinge{}, SE3{});
    run(mechanism.world(), 5.0, 1.0 / rate);
    const double spin = mechanism.world().velocity_world(rod).angular.z;
    std::printf("%4.0f Hz: %.3f of 20 rad/s after 5 s\n", rate, spin);
    EXPECT_GT(spin, 20.0 - 180.0 / rate);
    EXPECT_LT(spin, 20.001);
  }
}

}  // namespace
}  // namespace vp::test
