// Friction, stops, springs and motors within a step: closed forms for one joint; on trees, the
// forces that inverse dynamics finds, against each force law.
#include "vphysics/multibody/constrained_step.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "trees.h"

namespace vp::test {
namespace {

using Numbers = std::vector<double>;
constexpr double kNever = JointForces::kNever;
constexpr double kH = 1e-3;

struct OneSlide {
  Model model;
  ConstrainedData data;
  Numbers q{0.0}, v{0.0}, tau{0.0};
  std::vector<Motor> motors;

  // Two kilograms along x.
  explicit OneSlide(const JointForces& forces, double damping = 0.0)
      : model(build(forces, damping)), data(model, ConstraintSet()) {}

  static Model build(const JointForces& forces, double damping) {
    ModelBuilder builder;
    must_build(builder.add({.joint = PrismaticJoint{{1, 0, 0}},
                            .inertia = Inertia(2.0, Vec3{0.1, 0.1, 0.1}),
                            .damping = damping,
                            .forces = {forces}}));
    return must_build(builder.build());
  }
  void step(double h = kH) {
    const auto done = constrained_step(model, data, q, v, tau, motors, {.gravity = {}}, h);
    ASSERT_TRUE(done) << done.error().message;
    ASSERT_TRUE(done->converged);
  }
};

TEST(DryFriction, SticksBelowItsBoundAndSlidesAboveIt) {
  OneSlide stuck({.friction = 5.0});
  stuck.tau[0] = 4.99;
  for (int i = 0; i < 1000; ++i) stuck.step();
  EXPECT_EQ(stuck.v[0], 0.0);
  EXPECT_EQ(stuck.q[0], 0.0);  // no creep
  EXPECT_NEAR(force_law_forces(stuck.data)[0], -4.99, 1e-12);

  OneSlide slides({.friction = 5.0});
  slides.tau[0] = 6.0;
  for (int i = 0; i < 1000; ++i) slides.step();
  EXPECT_NEAR(slides.v[0], (6.0 - 5.0) / 2.0 * 1.0, 1e-12);
}

TEST(DryFriction, BringsToRestInTimeAndLetsStay) {
  OneSlide slide({.friction = 5.0});
  slide.v[0] = 1.0;
  for (int i = 0; i < 400; ++i) {
    EXPECT_NEAR(slide.v[0], 1.0 - 2.5 * i * kH, 1e-12);
    slide.step();
  }
  EXPECT_NEAR(slide.q[0], 0.5 * 1.0 * 0.4, 1.0 * kH);  // v t / 2; the integrator is of first order
  slide.step();
  const double q = slide.q[0];
  for (int i = 0; i < 100; ++i) slide.step();
  EXPECT_EQ(slide.v[0], 0.0);
  EXPECT_EQ(slide.q[0], q);
}

TEST(DryFriction, OfInfiniteBoundLocksTheJoint) {
  OneSlide slide({.friction = kNever});
  slide.v[0] = 3.0;
  slide.tau[0] = 1e9;
  slide.step();
  EXPECT_EQ(slide.v[0], 0.0);
  EXPECT_EQ(slide.q[0], 0.0);
}

// A pendulum that falls onto a stop.
TEST(Stop, IsMetWithoutBounceAndCarriesTheWeight) {
  ModelBuilder builder;
  const Inertia bob = Inertia(1.5, Vec3{0.01, 0.01, 0.01}).InvXform(SE3(Vec3{0.4, 0, 0}));
  must_build(builder.add({.joint = RevoluteJoint{{0, 1, 0}},
                          .inertia = bob,
                          .forces = {{.lower = -1.0, .upper = 0.7}}}));
  const Model model = must_build(builder.build());
  ConstrainedData data(model, ConstraintSet());
  Numbers q{0.0}, v{0.0}, tau{0.0};  // horizontal at first; q grows as it falls
  bool met = false;
  for (int i = 0; i < 2000; ++i) {
    ASSERT_TRUE(constrained_step(model, data, q, v, tau, {}, {}, kH));
    ASSERT_LE(q[0], 0.7 + 1e-15);
    if (met) {
      ASSERT_EQ(q[0], 0.7);
      ASSERT_EQ(v[0], 0.0);
    }
    met = met || (q[0] == 0.7 && v[0] == 0.0);
  }
  EXPECT_TRUE(met);
  EXPECT_NEAR(force_law_forces(data)[0], -1.5 * 9.81 * 0.4 * std::cos(0.7), 1e-10);
}

TEST(Stop, LeadsBackWhatBeganBeyondItWithoutThrowingIt) {
  OneSlide slide({.lower = 0.0, .upper = 1.0});
  slide.q[0] = -0.5;
  for (int i = 0; i < 200; ++i) {
    slide.step();
    ASSERT_EQ(slide.v[0], 0.0);
  }
  EXPECT_NEAR(slide.q[0], 0.0, 1e-12);
  slide.q[0] = 1.0;
  slide.v[0] = 100.0;
  slide.step();
  EXPECT_EQ(slide.v[0], 0.0);
}

// m x'' = -k x - d x' beyond the limit: half a period of a damped oscillator in contact.
TEST(SoftLimit, IsASpringAndADamper) {
  const double k = 2e4, d = 40.0, m = 2.0;
  OneSlide slide({.upper = 0.0, .limit_stiffness = k, .limit_damping = d});
  slide.v[0] = 1.0;
  const double h = 1e-6, decay = d / (2 * m), rate = std::sqrt(k / m - decay * decay);
  double deepest = 0.0;
  while (slide.v[0] > 0.0) {
    slide.step(h);
    deepest = std::max(deepest, slide.q[0]);
  }
  const double t = std::atan2(rate, decay) / rate;
  EXPECT_NEAR(deepest, std::exp(-decay * t) / rate * std::sin(rate * t), 1e-5 * deepest + 1e-6);
  for (int i = 0; i < 40000 && slide.q[0] > 0.0; ++i) slide.step(h);
  EXPECT_LT(slide.v[0], 0.0);
  EXPECT_GT(slide.v[0], -1.0);
}

// Implicit integration: an oscillator whose period is far below the step comes to rest at its
// equilibrium.
TEST(Spring, OfAnyStiffnessIsStable) {
  for (const double k : {1.0, 1e4, 1e8, 1e15}) {
    OneSlide slide({.stiffness = k, .rest = 0.3}, 1.0);
    slide.tau[0] = 0.1;
    double farthest = 0.0;
    for (int i = 0; i < 30000; ++i) {
      slide.step();
      farthest = std::max(farthest, std::fabs(slide.q[0] - 0.3));
    }
    EXPECT_LT(farthest, 0.41) << k;
    EXPECT_NEAR(slide.q[0], 0.3 + 0.1 / k, 0.03 / std::sqrt(k)) << k;
  }
}

TEST(ViscousDamping, IsImplicit) {
  OneSlide slide({}, 10.0);
  slide.v[0] = 1.0;
  slide.step();
  EXPECT_NEAR(slide.v[0], 1.0 / (1.0 + kH * 10.0 / 2.0), 1e-15);
  OneSlide hard({}, 1e12);
  hard.v[0] = 1.0;
  hard.step();
  EXPECT_NEAR(hard.v[0], 0.0, 1e-8);
}

TEST(StepMotor, OfAnyStiffnessIsStableAndNeverExceedsItsForce) {
  for (const double k : {1.0, 1e2, 1e4, 1e8, 1e12, 1e15}) {
    OneSlide slide({});
    slide.motors = {{.stiffness = k, .damping = 10.0, .max_force = 3.0}};
    double farthest = 0.0;
    for (int i = 0; i < 3000; ++i) {
      slide.motors[0].position = i / 1000 % 2 ? 0.5 : -0.5;
      const double before = slide.v[0];
      slide.step();
      const double force = 2.0 * (slide.v[0] - before) / kH;
      ASSERT_LE(std::fabs(force), 3.0 * (1 + 1e-12)) << k;
      ASSERT_NEAR(force, motor_forces(slide.data)[0], 1e-9) << k;
      farthest = std::max(farthest, std::fabs(slide.q[0]));
    }
    EXPECT_LT(farthest, 2.5) << k;
  }
  for (const double k : {1.0, 1e4, 1e8, 1e15}) {  // with unlimited force
    OneSlide slide({});
    slide.motors = {{.position = 0.5, .stiffness = k, .damping = 2.0}};
    double farthest = 0.0;
    for (int i = 0; i < 20000; ++i) {
      slide.step();
      farthest = std::max(farthest, std::fabs(slide.q[0]));
    }
    EXPECT_LT(farthest, 1.01) << k;
    EXPECT_NEAR(slide.q[0], 0.5, k < 2.0 ? 1e-3 : 1e-6) << k;
  }
}

TEST(StepMotor, IsBoundedByItsJointToo) {
  OneSlide slide({.motor_limit = 1.0});
  slide.motors = {{.velocity = 100.0, .damping = 1e6, .max_force = 50.0}};
  slide.step();
  EXPECT_NEAR(slide.v[0], 1.0 * kH / 2.0, 1e-15);
  EXPECT_NEAR(motor_forces(slide.data)[0], 1.0, 1e-12);
}

// A motor too weak for the friction moves nothing. The reported force is its limit.
TEST(StepMotor, WorksAgainstFriction) {
  OneSlide slide({.friction = 5.0});
  slide.motors = {{.position = 1.0, .stiffness = 1e6, .max_force = 4.0}};
  for (int i = 0; i < 10; ++i) slide.step();
  EXPECT_EQ(slide.q[0], 0.0);
  EXPECT_NEAR(motor_forces(slide.data)[0], 4.0, 1e-12);
  slide.motors[0].max_force = 7.0;
  slide.step();
  EXPECT_NEAR(slide.v[0], (7.0 - 5.0) / 2.0 * kH, 1e-15);
  EXPECT_NEAR(motor_forces(slide.data)[0], 7.0, 1e-10);
}

// --- trees: joint forces by inverse dynamics, against each force law

JointForces random_forces(Random& random, bool by_coordinate) {
  JointForces f;
  if (random.word() % 2) f.friction = random.uniform(0.0, 3.0);
  if (!by_coordinate) return f;
  if (random.word() % 3 == 0) f.stiffness = random.uniform(1.0, 1e5);
  if (random.word() % 2) {
    f.lower = random.uniform(-1.6, -0.5);
    f.upper = random.uniform(0.5, 1.6);
  }
  if (random.word() % 3 == 0) {
    f.limit_stiffness = random.uniform(10.0, 1e6);
    f.limit_damping = random.uniform(0.0, 10.0);
  }
  return f;
}

Model random_tree_with_forces(Random& random, int links) {
  ModelBuilder builder;
  for (int i = 0; i < links; ++i) {
    LinkSpec link;
    link.parent = static_cast<int>(random.word() % static_cast<unsigned>(i + 1)) - 1;
    link.joint = random_joint(random, static_cast<int>(random.word() % 10));
    link.T_parent_joint = random.pose(0.5);
    link.inertia = random_body(random);
    link.armature = 0.05;
    link.damping = random.word() % 2 ? 0.0 : random.uniform(0.0, 20.0);
    const bool own = coordinates_of(link.joint) == velocities_of(link.joint);
    for (int k = 0; k < velocities_of(link.joint); ++k) {
      link.forces.push_back(random_forces(random, own));
    }
    must_build(builder.add(link));
  }
  return must_build(builder.build());
}

// The admissible range of a joint's friction, stops, spring, soft limits, damping and motor at the
// velocity w, after the coordinate was q: the definition, without ramps.
struct Range {
  double least = 0.0, most = 0.0;
  void add(double force) { least += force, most += force; }
};
Range allowed(const JointForces& f, double damping, const Motor* motor, double q, double w,
              double h) {
  Range r;
  const double end = q + h * w, slack = 1e-12 * (std::fabs(q) + 1);
  r.add(f.stiffness * (f.rest - end) - damping * w);
  if (motor != nullptr) {
    const double pull =
        motor->stiffness * (motor->position - end) + motor->damping * (motor->velocity - w);
    r.add(std::clamp(pull, -motor->max_force, motor->max_force));
  }
  if (w == 0.0) {
    r.least -= f.friction;
    r.most += f.friction;
  } else {
    r.add(w > 0.0 ? -f.friction : f.friction);
  }
  if (f.limit_stiffness == kNever) {
    EXPECT_GE(end, std::min(f.lower, q) - slack);
    EXPECT_LE(end, std::max(f.upper, q) + slack);
    if (end <= std::max(f.lower, q - (q < f.lower ? 0.0 : kNever)) + slack) r.most = kNever;
    if (end >= std::min(f.upper, q + (q > f.upper ? 0.0 : kNever)) - slack) r.least = -kNever;
  } else {
    if (end < f.lower) {
      const double speed = std::min(w, q > f.lower ? (end - f.lower) / h : w);
      r.add(std::max(0.0, f.limit_stiffness * (f.lower - end) - f.limit_damping * speed));
    }
    if (end > f.upper) {
      const double speed = std::max(w, q < f.upper ? (end - f.upper) / h : w);
      r.add(std::min(0.0, f.limit_stiffness * (f.upper - end) - f.limit_damping * speed));
    }
  }
  return r;
}

TEST(ConstrainedStep, ObeysEveryLawOfATree) {
  Random random(101);
  double worst = 0.0;
  int stuck = 0, at_stop = 0, clamped_impulse = 0, rounds = 0;
  for (int round = 0; round < 150; ++round) {
    const Model model = random_tree_with_forces(random, 10);
    ConstrainedData data(model, ConstraintSet());
    State s = random_state(random, model);
    const std::size_t n = s.v.size();
    if (round % 2) std::fill(s.v.begin(), s.v.end(), 0.0);
    std::vector<Motor> motors(n);
    for (Motor& m : motors) {
      if (random.word() % 2) continue;
      m = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0, 1e4),
           random.uniform(0, 100), random.uniform(0, 50)};
    }
    const Numbers q = s.q, v = s.v;
    const auto done = constrained_step(model, data, s.q, s.v, s.tau, motors, {}, kH);
    ASSERT_TRUE(done) << done.error().message;
    ASSERT_TRUE(done->converged);
    rounds = std::max(rounds, done->iterations);
    // M (v+ - v) / h + h(q, v) = tau + the forces of the force laws, viscous damping among them.
    Numbers a(n), force(n);
    for (std::size_t i = 0; i < n; ++i) a[i] = (s.v[i] - v[i]) / kH;
    Data links(model);
    inverse_dynamics<double>(model, links, q, v, a, {}, force);
    for (int l = 0; l < model.links(); ++l) {
      const LinkSpec& link = model.link(l);
      const bool own = coordinates_of(link.joint) == velocities_of(link.joint);
      for (std::size_t k = 0; k < link.forces.size(); ++k) {
        const std::size_t i = static_cast<std::size_t>(model.first_velocity(l)) + k;
        const double at = own ? q[static_cast<std::size_t>(model.first_coordinate(l)) + k] : 0.0;
        const double did = force[i] - link.damping * v[i] - s.tau[i];
        Motor motor = motors[i];
        if (!own) motor.stiffness = 0.0;
        const Range range = allowed(link.forces[k], link.damping, &motor, at, s.v[i], kH);
        const double beyond = std::max(range.least - did, did - range.most);
        const double hardness = link.forces[k].limit_stiffness;
        const double scale =
            1 + std::fabs(did) + largest_of(a) + (hardness < kNever ? hardness : 0.0);
        worst = std::max(worst, beyond / scale);
        stuck += s.v[i] == 0.0;
        at_stop += range.most == kNever || range.least == -kNever;
        clamped_impulse += std::fabs(motor_forces(data)[i]) >= motor.max_force * (1 - 1e-12) &&
                           motor.max_force > 0.0;
        EXPECT_NEAR(force_law_forces(data)[i], did, 1e-9 * scale);
      }
    }
  }
  std::printf("worst %.1e; %d stuck, %d at stops, %d motors at their bound; %d rounds\n", worst,
              stuck, at_stop, clamped_impulse, rounds);
  EXPECT_LT(worst, 1e-9);
  EXPECT_GT(stuck, 50);
  EXPECT_GT(at_stop, 20);
  EXPECT_GT(clamped_impulse, 50);
}

// Chains with stiff motors, friction, stops and springs at once, from difficult initial states:
// Newton's method must find the active piece of each force law.
TEST(ConstrainedStep, SettlesWhateverTheLaws) {
  Random random(102);
  int most = 0, sum = 0;
  for (int round = 0; round < 60; ++round) {
    ModelBuilder builder;
    const int links = 30;
    for (int i = 0; i < links; ++i) {
      LinkSpec link{.parent = i - 1, .joint = RevoluteJoint{random.direction()}};
      link.T_parent_joint = SE3(Vec3{0.2, 0, 0});
      link.inertia = random_body(random);
      link.damping = random.uniform(0.0, 5.0);
      link.forces = {{.lower = random.uniform(-0.5, 0.0),
                      .upper = random.uniform(0.0, 0.5),
                      .stiffness = std::pow(10.0, random.uniform(-3, 8)),
                      .friction = std::pow(10.0, random.uniform(-3, 4))}};
      must_build(builder.add(link));
    }
    const Model model = must_build(builder.build());
    ConstrainedData data(model, ConstraintSet());
    Numbers q(links), v(links), tau(links);
    std::vector<Motor> motors(links);
    for (std::size_t i = 0; i < motors.size(); ++i) {
      q[i] = 0.5 * random.uniform(-0.5, 0.5);
      v[i] = random.uniform(-20, 20);
      tau[i] = random.uniform(-500, 500);
      motors[i] = {random.uniform(-1, 1), 0.0, std::pow(10.0, random.uniform(0, 15)), 1.0,
                   std::pow(10.0, random.uniform(-1, 4))};
    }
    for (int i = 0; i < 10; ++i) {
      const auto done = constrained_step(model, data, q, v, tau, motors, {}, 0.01);
      ASSERT_TRUE(done) << done.error().message;
      ASSERT_TRUE(done->converged) << round << ' ' << i << ' ' << done->iterations;
      most = std::max(most, done->iterations);
      sum += done->iterations;
    }
  }
  std::printf("%.1f rounds, %d at most\n", sum / 600.0, most);  // 4.6 and 41; 48 among 9000
  EXPECT_LT(sum / 600.0, 6.0);
}

// --- closed loops

// A parallelogram linkage that hangs in its plane under gravity, with friction in the crank.
struct Swing {
  Model model;
  ConstrainedData data;
  Numbers q{0.5, -0.5, 0.5}, v{0.0, 0.0, 0.0}, tau{0.0, 0.0, 0.0};

  explicit Swing(const JointForces& crank) : model(build(crank)), data(model, loop(model)) {}

  static Model build(const JointForces& crank) {
    ModelBuilder builder;
    const auto bar = [](double mass, double length) {
      return Inertia(mass, Vec3{1e-4, 0.01, 0.01}).InvXform(SE3(Vec3{0.5 * length, 0, 0}));
    };
    const Joint hinge = RevoluteJoint{};
    must_build(builder.add({"crank", kWorld, hinge, {}, bar(1.0, 0.5), 0, 0, {crank}}));
    must_build(builder.add({"coupler", 0, hinge, SE3(Vec3{0.5, 0, 0}), bar(2.0, 1.0)}));
    must_build(builder.add({"rocker", kWorld, hinge, SE3(Vec3{1, 0, 0}), bar(1.0, 0.5)}));
    return must_build(builder.build());
  }
  static ConstraintSet loop(const Model& model) {
    return must_build(ConstraintSet::make(
        model, {close_hinge({1, SE3(Vec3{1, 0, 0})}, {2, SE3(Vec3{0.5, 0, 0})})}));
  }
  // About the crank: the weights of the bars and the coupler times their lever arms.
  double weight_moment() const { return -9.81 * std::cos(q[0]) * (0.25 + 2.0 * 0.5 + 0.25); }
  double inertia() const { return 2 * (0.01 + 1.0 * 0.25 * 0.25) + 2.0 * 0.5 * 0.5; }
  void step(std::span<const Motor> motors = {}) {
    const auto done =
        constrained_step(model, data, q, v, tau, motors, {.gravity = {0, -9.81, 0}}, kH);
    ASSERT_TRUE(done) << done.error().message;
  }
};

TEST(ConstrainedStep, FrictionHoldsALinkageBelowItsBoundOnly) {
  Swing held({.friction = 1.001 * 9.81 * 1.5 * std::cos(0.5)});
  for (int i = 0; i < 1000; ++i) held.step();
  EXPECT_EQ(held.q[0], 0.5);
  EXPECT_NEAR(held.q[1], -0.5, 1e-12);
  EXPECT_NEAR(force_law_forces(held.data)[0], -held.weight_moment(), 1e-9);

  Swing slips({.friction = 5.0});
  const double expected = (slips.weight_moment() + 5.0) / slips.inertia() * kH;
  slips.step();
  EXPECT_NEAR(slips.v[0], expected, 1e-12);
}

TEST(ConstrainedStep, StopsAndLocksHoldALinkageInMotion) {
  Swing swing({.lower = -0.4});
  for (int i = 0; i < 2000; ++i) {
    swing.step();
    ASSERT_GE(swing.q[0], -0.4 - 1e-12);
  }
  EXPECT_EQ(swing.q[0], -0.4);
  EXPECT_NEAR(swing.q[2], -0.4, 1e-11);
  for (const double x : swing.v) EXPECT_NEAR(x, 0.0, 1e-12);
  EXPECT_NEAR(force_law_forces(swing.data)[0], -swing.weight_moment(), 1e-9);

  Swing locked({.friction = kNever});
  locked.v = {4.0, -4.0, 4.0};
  locked.step();
  EXPECT_EQ(locked.q[0], 0.5);
  for (const double x : locked.v) EXPECT_NEAR(x, 0.0, 1e-9);
}

// A motor of 1e12 N m/rad drives the linkage to its folding position and back.
TEST(ConstrainedStep, MotorDrivesALinkageAndStaysClosed) {
  Swing swing({});
  std::vector<Motor> motors(3);
  double most = 0.0, open = 0.0;
  for (int i = 0; i < 2000; ++i) {
    motors[0] = {.position = 0.5 + 0.5 * std::sin(3.0 * (i + 1) * kH),
                 .stiffness = 1e12,
                 .max_force = 200.0};
    swing.step(motors);
    most = std::max(most, std::fabs(motor_forces(swing.data)[0]));
    for (const double x : swing.data.residual()) open = std::max(open, std::fabs(x));
    // At 0 all bars are collinear, and J loses rank: the linkage passes through, with less
    // accuracy.
    if (i > 100 && std::fabs(swing.q[0]) > 0.1) {
      ASSERT_NEAR(swing.q[0], motors[0].position, 1e-7);
    } else if (i > 100) {
      ASSERT_NEAR(swing.q[0], motors[0].position, 1e-4);
    }
  }
  EXPECT_LE(most, 200.0 * (1 + 1e-12));
  EXPECT_LT(open, 1.1e-12);
}

// The step is of first order: the error of a falling linkage halves with the step. The reference is
// its equation with one degree of freedom, I q'' = weight moment.
TEST(ConstrainedStep, ConvergesInTheFirstOrder) {
  const double duration = 0.4;
  const Swing still({});
  const auto slope = [&](double angle) { return -9.81 * std::cos(angle) * 1.5 / still.inertia(); };
  double angle = 0.5, rate = 0.0;  // Verlet integration, in steps of a microsecond
  for (int i = 0; i < 400000; ++i) {
    rate += 0.5e-6 * slope(angle);
    angle += 1e-6 * rate;
    rate += 0.5e-6 * slope(angle);
  }
  double off[2];
  const int steps[2] = {400, 800};
  for (std::size_t k = 0; k < 2; ++k) {
    Swing swing({});
    for (int i = 0; i < steps[k]; ++i) {
      ASSERT_TRUE(constrained_step(swing.model, swing.data, swing.q, swing.v, swing.tau, {},
                                   {.gravity = {0, -9.81, 0}}, duration / steps[k]));
    }
    off[k] = std::fabs(swing.q[0] - angle);
  }
  std::printf("off by %.1e and %.1e rad\n", off[0], off[1]);
  EXPECT_LT(off[1], 5e-3);
  EXPECT_NEAR(off[0] / off[1], 2.0, 0.1);
}

// --- joint_forces, for other integrators

TEST(JointForces, AreSpringsSoftLimitsAndMotorsInEveryScalar) {
  ModelBuilder builder;
  LinkSpec link{.joint = CylindricalJoint{}, .inertia = Inertia(1.0, Vec3{1, 1, 1})};
  link.forces = {{.stiffness = 100.0, .rest = 0.5, .motor_limit = 6.0},
                 {.lower = -1.0, .upper = 1.0, .limit_stiffness = 50.0, .limit_damping = 10.0}};
  must_build(builder.add(link));
  const Model model = must_build(builder.build());
  const std::vector<Motor> motors = {{0.0, 0.0, 10.0, 1.0, 8.0}, {0.0, 2.0, 0.0, 3.0, 1.5}};
  const struct {
    Numbers q, v, tau;
  } cases[] = {
      {{0.2, 0.0}, {0.0, 0.0}, {100 * 0.3 - 2.0, 1.5}},
      {{0.9, 1.2}, {0.5, 0.1}, {-40.0 - 6.0, -(50 * 0.2 + 1.0) + 1.5}},
      {{0.5, -1.5}, {0.0, 4.0}, {-5.0, 0.0 - 1.5}},  // a motion that separates: no adhesion
  };
  for (const auto& c : cases) {
    Numbers tau = {1.0, 2.0};
    joint_forces<double>(model, c.q, c.v, motors, tau);
    EXPECT_NEAR(tau[0], 1.0 + c.tau[0], 1e-13);
    EXPECT_NEAR(tau[1], 2.0 + c.tau[1], 1e-13);
    using Lanes = PackT<double, 4>;
    std::vector<Lanes> q(2), v(2), f(2);
    std::vector<MotorT<Lanes>> m(2);
    for (std::size_t i = 0; i < 2; ++i) {
      q[i] = Lanes(c.q[i]);
      v[i] = Lanes(c.v[i]);
      m[i] = {Lanes(motors[i].position), Lanes(motors[i].velocity), Lanes(motors[i].stiffness),
              Lanes(motors[i].damping), Lanes(motors[i].max_force)};
    }
    joint_forces<Lanes>(model, q, v, m, f);
    for (int lane = 0; lane < 4; ++lane) {
      EXPECT_NEAR(f[0][lane], c.tau[0], 1e-13);
      EXPECT_NEAR(f[1][lane], c.tau[1], 1e-13);
    }
  }
}

// --- rejected arguments

TEST(Model, RefusesForcesThatNoJointHas) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [](const Joint& joint, std::vector<JointForces> forces) {
    LinkSpec link{.name = "arm", .joint = joint, .inertia = Inertia(1.0, Vec3{1, 1, 1})};
    link.forces = std::move(forces);
    const auto made = ModelBuilder().add(link);
    return !made && made.error().message.find("\"arm\"") != std::string::npos;
  };
  const Joint turn = RevoluteJoint{};
  EXPECT_TRUE(refused(turn, {{}, {}}));
  EXPECT_TRUE(refused(FixedJoint{}, {{}}));
  EXPECT_TRUE(refused(turn, {{.lower = 1.0, .upper = 0.0}}));
  EXPECT_TRUE(refused(turn, {{.lower = nan}}));
  EXPECT_TRUE(refused(turn, {{.lower = kNever}}));
  EXPECT_TRUE(refused(turn, {{.limit_stiffness = 0.0}}));
  EXPECT_TRUE(refused(turn, {{.limit_damping = -1.0}}));
  EXPECT_TRUE(refused(turn, {{.stiffness = kNever}}));
  EXPECT_TRUE(refused(turn, {{.stiffness = 1.0, .rest = nan}}));
  EXPECT_TRUE(refused(turn, {{.friction = -1.0}}));
  EXPECT_TRUE(refused(turn, {{.motor_limit = nan}}));
  EXPECT_TRUE(refused(BallJoint{}, {{.lower = 0.0}, {}, {}}));
  EXPECT_TRUE(refused(FreeJoint{}, {{}, {}, {}, {.stiffness = 1.0}, {}, {}}));
  EXPECT_FALSE(refused(BallJoint{}, {{.friction = 1.0}, {}, {}}));
  EXPECT_FALSE(refused(turn, {{.lower = 0.0, .upper = 0.0, .friction = kNever}}));
}

TEST(ConstrainedStep, RefusesStepsAndMotorsThatAreNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  OneSlide slide({});
  const auto refused = [&](double h, const Motor& motor) {
    const auto done = constrained_step(slide.model, slide.data, slide.q, slide.v, slide.tau,
                                       std::vector{motor}, {}, h);
    return !done && done.error().code == Errc::invalid_argument;
  };
  EXPECT_TRUE(refused(0.0, {}));
  EXPECT_TRUE(refused(nan, {}));
  EXPECT_TRUE(refused(kH, {.position = nan}));
  EXPECT_TRUE(refused(kH, {.stiffness = -1.0}));
  EXPECT_TRUE(refused(kH, {.stiffness = kNever}));
  EXPECT_TRUE(refused(kH, {.max_force = -1.0}));
  EXPECT_FALSE(refused(kH, {}));
}

}  // namespace
}  // namespace vp::test
