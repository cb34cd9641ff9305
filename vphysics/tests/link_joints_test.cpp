// Joints between links or continuous bodies: against the same joints between free bodies, against
// closed forms, and where they close loops of one tree.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include "joints_rig.h"
#include "tree_scenes.h"
#include "vphysics/multibody/constrained_step.h"
#include "vphysics/recording.h"

namespace vp::test {
namespace {

Plate add_hinged_plate(World& world) {
  const Box box{{0.5, 0.5, 0.05}};
  LinkSpec link;
  link.joint = RevoluteJoint{};
  link.inertia = solid_inertia(box, 1000.0);
  const ArticulationId id = must(world.create_articulation({model_of({link})}));
  must(world.add_collider(world.link_body(id, 0), collider_of(box, {})));
  return {id, world.link_body(id, 0)};
}

enum class Ends : std::uint8_t { bodies, links, a_link, continuous };

// A box as a body, or as the only link of a floating tree.
BodyId add_box(World& world, const Inertia& inertia, const SE3& pose, const se3& V, Ends ends,
               bool second) {
  const bool is_link = ends == Ends::links || (ends == Ends::a_link && second);
  if (!is_link) {
    BodyDesc desc;
    desc.T_world_body = pose;
    desc.velocity = V;
    desc.inertia = inertia;
    desc.continuous = ends == Ends::continuous;
    return must(world.create_body(desc));
  }
  LinkSpec link;
  link.joint = FreeJoint{};
  link.inertia = inertia;
  const ArticulationId id = must(world.create_articulation({model_of({link})}));
  std::vector<double> q(world.coordinates(id).begin(), world.coordinates(id).end());

  EXPECT_EQ(pose.rotation(), Mat3::identity());
  const Vec3 x = pose.position();
  q = {x.x, x.y, x.z, 0, 0, 0, 1};
  must(
      world.set_joint_states(id, q, std::vector<double>{V.w.x, V.w.y, V.w.z, V.v.x, V.v.y, V.v.z}));
  const BodyId body = world.link_body(id, 0);
  EXPECT_LT(norm(world.pose(body).position() - x), 1e-12);
  return body;
}

class Level : public PairConstraint {  // b's origin at a's height
 public:
  int rows() const override { return 1; }
  void evaluate(const SE3& T_a, const SE3& T_b, std::span<double> residual,
                std::span<PairRow> jacobian) const override {
    residual[0] = T_b.position().z - T_a.position().z;
    jacobian[0] = {{{}, -1.0 * T_a.unrotate({0, 0, 1})}, {{}, T_b.unrotate({0, 0, 1})}};
  }
};

struct JointCase {
  const char* name;
  JointKind kind;
  double frequency = 0.0;
};
std::vector<JointCase> kinds() {
  const JointDrive motor{0.0, 3.0, 0.0, 1e6, 2.0}, servo{0.5, 0.0, 200.0, 20.0, 50.0};
  SixDof six;
  six.axes[0].motion = six.axes[1].motion = AxisMotion::locked;
  six.axes[2] = {AxisMotion::limited, -0.02, 0.05, {}};
  six.axes[3].motion = AxisMotion::locked;
  six.axes[4] = {AxisMotion::limited, -0.3, 0.3, {}};
  six.axes[5] = {AxisMotion::free, 0, 0, servo};
  return {{"ball", BallSocket{}},
          {"soft ball", BallSocket{}, 4.0},
          {"hinge", Hinge{}},
          {"hinge with stops", Hinge{-0.1, 0.2, {}}},
          {"driven hinge", Hinge{-kNoLimit, kNoLimit, motor}},
          {"servo", Hinge{-2.0, 2.0, servo}},
          {"slider", Slider{-0.05, 0.1, {}}},
          {"weld", Weld{}},
          {"rope", Distance{0.0, 0.25}},
          {"rod", Distance{0.2, 0.2}},
          {"spring", Spring{0.3, 300.0, 3.0}},
          {"cone", ConeTwist{0.4, 0.2, -0.3, 0.3, {}}},
          {"six", six},
          {"gear", Gear{-1.5}},
          {"own", UserConstraint{std::make_shared<Level>()}}};
}

struct JoinedBoxes {
  World world;
  BodyId a, b;
  JointId joint;
  explicit JoinedBoxes(const JointCase& kind, Ends ends) {
    const Inertia inertia = solid_inertia(Box{{0.2, 0.1, 0.05}}, 1000.0);
    const BodyId anchor = add_anchor(world);
    a = add_box(world, inertia, SE3(Vec3{0.3, 0, 0}), {{0, 0, 1}, {0, 0.3, 0}}, ends, false);
    b = add_box(world, inertia, SE3(Vec3{0.8, 0, 0}), {{0, 1, 2}, {0, 1, 0}}, ends, true);
    join(world, anchor, a, BallSocket{}, SE3(kAlongY, {}));
    JointDesc desc;
    desc.kind = kind.kind;
    desc.frequency = kind.frequency;
    desc.T_a_joint = SE3(kAlongY, {0.25, 0, 0});
    desc.T_b_joint = SE3(kAlongY, {-0.25, 0, 0});
    if (std::holds_alternative<Distance>(kind.kind) || std::holds_alternative<Spring>(kind.kind)) {
      desc.T_b_joint = SE3(kAlongY, {-0.05, 0, 0});
    }
    joint = must(world.create_joint(a, b, desc));
  }
};

// Joints of free bodies are solved in SIMD lanes, in single precision, in sub-steps. Joints of
// links and continuous bodies are rows of the solver of the impact stage. Both converge to the
// result of steps a hundred times shorter.
TEST(LinkJoint, EveryKindMovesAsItDoesBetweenBodies) {
  for (const JointCase& kind : kinds()) {
    JoinedBoxes fine(kind, Ends::bodies);
    run(fine.world, 0.3, 1e-4);
    const Vec3 expected = fine.world.pose(fine.b).position();
    double off[4];
    for (const Ends ends : {Ends::bodies, Ends::links, Ends::a_link, Ends::continuous}) {
      JoinedBoxes pair(kind, ends);
      run(pair.world, 0.3, 1e-3);
      off[static_cast<int>(ends)] = norm(pair.world.pose(pair.b).position() - expected);
    }
    std::printf("%-18s off by %.2g (bodies), %.2g (links), %.2g (a link), %.2g m (continuous)\n",
                kind.name, off[0], off[1], off[2], off[3]);
    for (int i = 1; i < 4; ++i) EXPECT_LT(off[i], 0.004) << kind.name << ' ' << i;
  }
}

// --- loops of one tree

// A four-bar linkage in the xz plane with rotations about y: crank, coupler, rocker; ground from
// (0, 0) to (d, 0). A joint of the world closes its loop.
struct FourBarWorld {
  static constexpr double kCrank = 0.3, kCoupler = 0.8, kRocker = 0.6, kGround = 0.7;
  static constexpr double kAngle = 1.2;  // initial crank angle from the ground
  static Inertia bar_along_x(double mass, double length) {
    const double across = mass * length * length / 12.0;
    return Inertia(mass, Vec3{0.1 * across, across, across}).InvXform(SE3(Vec3{length / 2, 0, 0}));
  }
  static Model model() {
    const RevoluteJoint about_y{{0, -1, 0}};  // positive from x to z
    const auto link = [&](int parent, double at, double mass, double length) {
      LinkSpec spec;
      spec.parent = parent;
      spec.joint = about_y;
      spec.T_parent_joint = SE3(Vec3{at, 0, 0});
      spec.inertia = bar_along_x(mass, length);
      return spec;
    };
    return model_of({link(kWorld, 0.0, 0.7, kCrank), link(0, kCrank, 1.1, kCoupler),
                     link(kWorld, kGround, 0.9, kRocker)});
  }
  static std::vector<double> start() {
    const double x = kCrank * std::cos(kAngle), z = kCrank * std::sin(kAngle);
    const double dx = kGround - x, dz = -z, d = std::hypot(dx, dz);
    // The upper intersection of circles about both ends.
    const double along = (d * d + kCoupler * kCoupler - kRocker * kRocker) / (2 * d);
    const double across = std::sqrt(kCoupler * kCoupler - along * along);
    const double ex = x + (along * dx - across * dz) / d, ez = z + (along * dz + across * dx) / d;
    return {kAngle, std::atan2(ez - z, ex - x) - kAngle, std::atan2(ez, ex - kGround)};
  }

  World world;
  ArticulationId id;
  JointId loop;
  explicit FourBarWorld(const JointKind& kind) : id(must(world.create_articulation({model()}))) {
    must(world.set_joint_states(id, start(), std::vector<double>(3)));
    JointDesc desc;
    desc.kind = kind;
    desc.T_a_joint = SE3(kAlongY, {kCoupler, 0, 0});
    desc.T_b_joint = SE3(kAlongY, {kRocker, 0, 0});
    loop = must(world.create_joint(world.link_body(id, 1), world.link_body(id, 2), desc));
  }
  Vec3 end_of(int link, double length) const {
    return world.pose(world.link_body(id, link)) * Vec3{length, 0, 0};
  }
  double gap() const { return norm(end_of(1, kCoupler) - end_of(2, kRocker)); }
};

// The crank's angle after a second, by the constrained dynamics of a tree.
double swung(double dt) {
  const Model model = FourBarWorld::model();
  ConstrainedData data(
      model, must(ConstraintSet::make(
                 model, {close_hinge({1, SE3(kAlongY, {FourBarWorld::kCoupler, 0, 0})},
                                     {2, SE3(kAlongY, {FourBarWorld::kRocker, 0, 0})})})));
  std::vector<double> q = FourBarWorld::start(), v(3), tau(3);
  Loads loads;
  loads.gravity = {0, 0, -kG};
  for (int i = 0; i < static_cast<int>(std::lround(1.0 / dt)); ++i) {
    EXPECT_TRUE(constrained_step(model, data, q, v, tau, {}, loads, dt));
  }
  return q[0];
}

// As accurate as a step of that dynamics, which is of first order.
TEST(LinkJoint, AFourBarSwingsAsItsEquationsOfMotionSay) {
  const double expected = swung(2e-5), theirs = std::fabs(swung(1e-3) - expected);
  for (const JointKind& kind : {JointKind{Hinge{}}, JointKind{BallSocket{}}}) {
    double off[2], gap = 0.0;
    for (int k = 0; k < 2; ++k) {
      FourBarWorld f(kind);
      const double dt = k == 0 ? 1e-3 : 2.5e-4;
      for (int i = 0; i < static_cast<int>(std::lround(1.0 / dt)); ++i) {
        must(f.world.step(dt));
        if (k == 0) gap = std::max(gap, f.gap());
      }
      off[k] = std::fabs(f.world.joint_position(f.id, 0, 0) - expected);
    }
    std::printf(
        "crank off by %.2g rad at 1 kHz (theirs %.2g), %.2g at 4 kHz; loop open by %.2g m\n",
        off[0], theirs, off[1], gap);
    EXPECT_LT(off[0], theirs);
    EXPECT_LT(off[1], 0.35 * off[0]);
    EXPECT_LT(gap, 2e-6);
  }
}

// An impact acts on the entire loop at once.
TEST(LinkJoint, ALoopStaysClosedWhenItIsStruck) {
  FourBarWorld f(Hinge{});
  ColliderDesc rod = collider_of(Capsule{0.02, 0.5 * FourBarWorld::kRocker}, {0.0, 0.5, 0.0});
  rod.T_body_shape = SE3(Exp(Vec3{0, kPi / 2, 0}).matrix(), {0.5 * FourBarWorld::kRocker, 0, 0});
  must(f.world.add_collider(f.world.link_body(f.id, 2), rod));
  Part ball;
  ball.shape = Sphere{0.05};
  ball.material = {0.0, 0.5, 0.0};
  ball.pose = SE3(f.end_of(2, 0.4) + Vec3{0.5, 0, 0});
  ball.velocity = {{}, {-20, 0, 0}};
  ball.continuous = true;
  const BodyId body = add_dynamic(f.world, ball);
  bool struck = false;
  double gap = 0.0, speed = 0.0;
  for (int i = 0; i < 200; ++i) {
    must(f.world.step(1e-3));
    for (const ContactEvent& e : f.world.contact_events()) {
      struck |= e.kind == ContactEvent::Kind::hit;
    }
    gap = std::max(gap, f.gap());
    const Vec3 x = f.end_of(1, FourBarWorld::kCoupler);
    speed = std::max(speed, norm(f.world.velocity_at(f.world.link_body(f.id, 1), x) -
                                 f.world.velocity_at(f.world.link_body(f.id, 2), x)));
  }
  EXPECT_TRUE(struck);
  EXPECT_GT(f.world.velocity(body).v.x, -15.0);
  std::printf("open by %.2g m, apart at %.2g m/s\n", gap, speed);
  EXPECT_LT(gap, 1e-3);
  EXPECT_LT(speed, 0.4);  // 0.02 rad a step times 10 m/s; 0.21
}

// Bodies that swing on a row joint lose no speed: they move along the chord, not the tangent.
TEST(LinkJoint, AHammerKeepsItsSpeed) {
  for (const Ends ends : {Ends::links, Ends::continuous}) {
    for (const double rate : {1000.0, 240.0}) {
      World world(weightless());
      const BodyId anchor = add_anchor(world);
      const BodyId head = add_box(world, Inertia(1.0, Vec3{0.01, 0.01, 0.01}), SE3(Vec3{1, 0, 0}),
                                  {{}, {0, 5, 0}}, ends, false);
      JointDesc rod;
      rod.kind = Distance{1.0, 1.0};
      must(world.create_joint(anchor, head, rod));
      run(world, 10.0, 1.0 / rate);
      EXPECT_NEAR(norm(world.velocity_world(head).linear), 5.0, 2e-3) << rate;
      EXPECT_NEAR(norm(world.pose(head).position()), 1.0, 1e-5) << rate;
    }
  }
}

// A hanging chain is pulled beyond its length, also by joints of one row. The joints open, and no
// link is thrown.
TEST(LinkJoint, AStretchedChainIsNotThrownAbout) {
  SixDof along_z;
  along_z.axes[2].motion = AxisMotion::locked;
  for (const JointKind& kind :
       {JointKind{BallSocket{}}, JointKind{Distance{0.0, 0.001}}, JointKind{Distance{0.001, 0.001}},
        JointKind{along_z}, JointKind{UserConstraint{std::make_shared<Level>()}}}) {
    for (const double rate : {1000.0, 240.0}) {
      World world;
      const ArticulationId chain =
          must(world.create_articulation({model_of(hanging_chain(3, BallJoint{}))}));
      BodyDesc desc;
      desc.motion = Motion::kinematic;
      desc.T_world_body = SE3(Vec3{0, 0, -0.6});
      desc.velocity = {{}, {0.05, 0, -0.36}};
      const BodyId hand = must(world.create_body(desc));
      JointDesc joint;
      joint.kind = kind;
      joint.T_b_joint = SE3(Vec3{0, 0, -0.2});
      must(world.create_joint(hand, world.link_body(chain, 2), joint));
      double fastest = 0.0;
      for (int i = 0; i < static_cast<int>(rate); ++i) {
        must(world.step(1.0 / rate));
        for (const double v : world.velocities(chain)) fastest = std::max(fastest, std::fabs(v));
      }
      std::printf("pulled by kind %zu at %g Hz: %.3g rad/s\n", kind.index(), rate, fastest);
      EXPECT_LT(fastest, 500.0);  // 1e6 before the fix
    }
  }
}

// The bounds of a user's row limit its force: a larger load moves the body.
TEST(LinkJoint, ABoundedRowLetsGo) {
  class Weak : public Level {
   public:
    ConstraintRowDesc row_desc(int) const override { return {0.0, 1.0, -5.0, 5.0}; }
  };
  for (const Ends ends : {Ends::links, Ends::continuous}) {
    World world;
    const BodyId anchor = add_anchor(world);
    const BodyId body = add_box(world, Inertia(8.0, Vec3{0.1, 0.1, 0.1}), SE3{}, {}, ends, false);
    JointDesc desc;
    desc.kind = UserConstraint{std::make_shared<Weak>()};
    must(world.create_joint(anchor, body, desc));
    run(world, 1.0);
    EXPECT_NEAR(world.pose(body).position().z, -0.5 * (kG - 5.0 / 8.0), 0.01);
  }
}

// An impact takes no time, so the row's force bound gives no impulse there. Over a step the row
// applies its bound only once.
TEST(LinkJoint, ABoundedRowGivesNoMoreInStepsWithImpacts) {
  class Weak : public Level {
   public:
    ConstraintRowDesc row_desc(int) const override { return {0.0, 1.0, -5.0, 5.0}; }
  };
  World world;
  add_ground(world, {0.5, 0.8, 0.0});
  const BodyId anchor = add_anchor(world, SE3(Vec3{0, 0, 1}));
  const BodyId ball = add_dynamic(
      world, {.material = {0.5, 0.8, 0.0}, .pose = SE3(Vec3{0, 0, 1}), .continuous = true});
  JointDesc desc;
  desc.kind = UserConstraint{std::make_shared<Weak>()};
  const JointId joint = must(world.create_joint(anchor, ball, desc));
  std::uint32_t impacts = 0;
  for (int i = 0; i < 500; ++i) {
    must(world.step(0.01));
    impacts += world.counters().impacts;
    ASSERT_LE(std::fabs(world.joint_force(joint).force.z), 5.0 + 1e-9) << i;
  }
  EXPECT_GT(impacts, 5u);
}

// A coordinate between narrow limits, with a velocity that would pass both within a step.
TEST(LinkJoint, BothLimitsStopWhatIsFast) {
  for (const Ends ends : {Ends::links, Ends::continuous}) {
    World world(weightless());
    const BodyId anchor = add_anchor(world);
    const BodyId body =
        add_box(world, Inertia(1.0, Vec3{0.1, 0.1, 0.1}), SE3{}, {{}, {0, 0, 10}}, ends, false);
    JointDesc desc;
    desc.kind = Slider{-0.005, 0.005, {}};
    must(world.create_joint(anchor, body, desc));
    for (int i = 0; i < 60; ++i) {
      must(world.step(1.0 / 60));
      EXPECT_LT(std::fabs(world.pose(body).position().z), 0.0052);
    }
  }
}

// --- links and free bodies

// An arm of two links, held by motors, with a box welded to its hand.
struct Gripper {
  static constexpr double kMass = 3.0, kArm = 0.5;
  World world;
  ArticulationId arm;
  BodyId box;
  JointId weld;
  Gripper() {
    std::vector<LinkSpec> links(2);
    for (int i = 0; i < 2; ++i) {
      links[static_cast<std::size_t>(i)].parent = i - 1;
      links[static_cast<std::size_t>(i)].joint = RevoluteJoint{{0, 1, 0}};
      links[static_cast<std::size_t>(i)].inertia = FourBarWorld::bar_along_x(1.0, kArm);
      if (i > 0) links[1].T_parent_joint = SE3(Vec3{kArm, 0, 0});
    }
    arm = must(world.create_articulation({model_of(links)}));
    for (int i = 0; i < 2; ++i) must(world.set_drive(arm, i, 0, {0.0, 0.0, 5e4, 500.0, 1e4}));
    const Shape shape = Box{{0.1, 0.1, 0.1}};
    box = add_dynamic(world,
                      {.shape = shape, .density = kMass / 0.008, .pose = SE3(Vec3{1.1, 0, 0})});
    weld = join(world, world.link_body(arm, 1), box, Weld{}, SE3(Vec3{1.0, 0, 0}));
  }
};

TEST(LinkJoint, AWeldCarriesABoxAndTellsItsWeight) {
  for (const double dt : {0.001, 1.0 / 60}) {
    Gripper g;
    run(g.world, 2.0, dt);
    const JointForce force = g.world.joint_force(g.weld);
    EXPECT_LT(norm(force.force - Vec3{0, 0, Gripper::kMass * kG}), 0.01 * Gripper::kMass * kG);
    EXPECT_NEAR(force.torque.y, -0.1 * Gripper::kMass * kG, 0.03);
    const SE3 hand = g.world.pose(g.world.link_body(g.arm, 1));
    const double gap = norm(g.world.pose(g.box) * Vec3{-0.1, 0, 0} - hand * Vec3{0.5, 0, 0});
    std::printf("%g s: gap %.2g m, force %.4f N of %.4f\n", dt, gap, force.force.z,
                Gripper::kMass * kG);
    EXPECT_LT(gap, dt > 0.01 ? 1e-3 : 1e-4);
    EXPECT_FALSE(must(g.world.step(dt)).position_error);
  }
}

TEST(LinkJoint, LetGoABoxFallsAsAFreeOne) {
  Gripper g;
  run(g.world, 0.5);
  const double z = g.world.pose(g.box).position().z;
  must(g.world.destroy_joint(g.weld));
  run(g.world, 0.2);
  EXPECT_NEAR(g.world.pose(g.box).position().z, z - 0.5 * kG * 0.04, 2e-3);
}

// The weight of a crate that is welded to the hand acts on every joint of the arm.
TEST(LinkJoint, ReactionsOfAnArmCarryWhatItsHandHolds) {
  Gripper g;
  run(g.world, 3.0);
  for (int link = 0; link < 2; ++link) {
    const double arm = 2 - link, load = Gripper::kMass;
    const JointForce reaction = g.world.joint_reaction(g.arm, link);
    EXPECT_NEAR(reaction.force.z, (arm + load) * kG, 1e-3);
    // Moments about y of weights on the x side: bars of half a metre and the crate's centre.
    const double x = g.world.pose(g.world.link_body(g.arm, link)).position().x;
    double moment = load * (g.world.pose(g.box).position().x - x);
    for (int i = link; i < 2; ++i) {
      moment += (g.world.pose(g.world.link_body(g.arm, i)) * Vec3{0.25, 0, 0}).x - x;
    }
    EXPECT_NEAR(reaction.torque.y, -kG * moment, 1e-3 * kG * moment);
  }
}

// Two trees and a free body, connected by joints only, without external forces.
TEST(LinkJoint, KeepMomentumAndAngularMomentum) {
  World world(weightless());
  const Inertia inertia = solid_inertia(Box{{0.2, 0.1, 0.05}}, 1000.0);
  const BodyId a = add_box(world, inertia, SE3{}, {{1, 2, 3}, {0, 0.3, 0}}, Ends::links, false);
  const BodyId b =
      add_box(world, inertia, SE3(Vec3{0.6, 0, 0}), {{0, 1, 2}, {0, 1, 0}}, Ends::links, false);
  const BodyId c = add_mass(world, inertia, SE3(Vec3{1.2, 0, 0}), {{2, 0, 1}, {0, 0, 1}});
  join(world, a, b, Hinge{}, SE3(Vec3{0.3, 0, 0}));
  join(world, b, c, BallSocket{}, SE3(Vec3{0.9, 0, 0}));
  const auto momentum = [&] {
    dse3 sum;
    for (const BodyId id : {a, b, c}) {
      const VelocityWorld v = world.velocity_world(id);
      const SE3 T = world.pose(id);
      const Vec3 p = inertia.mass() * v.linear;
      const Vec3 w = T.unrotate(v.angular);
      const Vec3 spin = (inertia * se3{w, {}}).m;
      sum.f += p;
      sum.m += T.rotate(spin) + cross(T.position(), p);
    }
    return sum;
  };
  const dse3 before = momentum();
  run(world, 1.0);
  const dse3 after = momentum();
  std::printf("momentum off by %.2g, angular by %.2g\n", norm(after.f - before.f),
              norm(after.m - before.m));
  EXPECT_LT(norm(after.f - before.f), 1e-3 * norm(before.f));
  EXPECT_LT(norm(after.m - before.m), 5e-3 * norm(before.m));
}

TEST(LinkJoint, JoinedOnesDoNotMeetUnlessAsked) {
  for (const bool collide : {false, true}) {
    World world(weightless());
    const Plate plate = add_hinged_plate(world);
    const BodyId box =
        add_dynamic(world, {.shape = Box{{0.1, 0.1, 0.1}}, .pose = SE3(Vec3{0, 0, 0.05})});
    JointDesc desc = joint_at(world, plate.body, box, Weld{}, SE3{});
    desc.collide = collide;
    must(world.create_joint(plate.body, box, desc));
    run(world, 0.1);
    EXPECT_EQ(world.contact_events().size() + world.counters().contacts > 0, collide);
  }
}

// --- state and calls

TEST(LinkJoint, ARestoredWorldGoesOnToTheSameBits) {
  FourBarWorld one(Hinge{});
  Gripper two;
  for (World* world : {&one.world, &two.world}) {
    run(*world, 0.3);
    std::vector<std::byte> bytes;
    world->snapshot(bytes);
    run(*world, 0.2);
    const std::uint64_t hash = world->state_hash();
    must(world->restore(bytes));
    run(*world, 0.2);
    EXPECT_EQ(world->state_hash(), hash);
  }
}

// A change of motion type is rejected if the joint could not be solved afterwards.
TEST(LinkJoint, AChangeOfMotionIsRefusedWhereTheJointWouldBe) {
  for (const bool continuous : {false, true}) {
    World world;
    BodyDesc desc;
    desc.continuous = continuous;
    const BodyId moves = must(world.create_body(desc));
    desc.motion = Motion::kinematic;
    desc.continuous = !continuous;
    const BodyId led = must(world.create_body(desc));
    join(world, led, moves, Weld{}, SE3{});
    const Expected<void> changed = world.set_motion(led, Motion::dynamic);
    ASSERT_FALSE(changed);
    EXPECT_EQ(changed.error().code, Errc::unsupported);
    desc.continuous = continuous;
    const BodyId like = must(world.create_body(desc));
    join(world, like, moves, Weld{}, SE3{});
    must(world.set_motion(like, Motion::dynamic));
    run(world, 0.05);
    EXPECT_LT(norm(world.pose(moves).position()), 1e-3);  // supported by `led`
  }
}

TEST(LinkJoint, AnArticulationTakesItsJointsWithIt) {
  Gripper g;
  run(g.world, 0.1);
  must(g.world.destroy_articulation(g.arm));
  EXPECT_FALSE(g.world.contains(g.weld));
  run(g.world, 0.1);
  EXPECT_LT(g.world.velocity(g.box).v.z, -0.9);
}

TEST(LinkJoint, ARecordingGoesToTheSameHashes) {
  World world;
  const auto recorder = std::make_shared<Recorder>();
  must(world.record(recorder));
  const ArticulationId id = must(world.create_articulation({FourBarWorld::model()}));
  must(world.set_joint_states(id, FourBarWorld::start(), std::vector<double>(3)));
  JointDesc desc;
  desc.kind = Hinge{-2.0, 2.0, {0.3, 0, 20, 2, 5}};
  desc.T_a_joint = SE3(kAlongY, {FourBarWorld::kCoupler, 0, 0});
  desc.T_b_joint = SE3(kAlongY, {FourBarWorld::kRocker, 0, 0});
  must(world.create_joint(world.link_body(id, 1), world.link_body(id, 2), desc));
  run(world, 0.3);
  must(world.record(nullptr));
  const std::span<const std::byte> bytes = recorder->bytes();
  Expected<Replay> replay = Replay::open({bytes.begin(), bytes.end()});
  ASSERT_TRUE(replay);
  ReplayState state = ReplayState::same;
  while (state == ReplayState::same) state = must(replay->step());
  EXPECT_EQ(state, ReplayState::end);
  EXPECT_EQ(replay->world().state_hash(), world.state_hash());
}

// Welds that contradict each other: motions stay bounded, and the status reports it.
TEST(LinkJoint, ContradictionsStayBoundedAndAreTold) {
  for (const Ends ends : {Ends::links, Ends::a_link, Ends::continuous}) {
    World world;
    const Inertia inertia = solid_inertia(Box{{0.1, 0.1, 0.1}}, 1000.0);
    const BodyId anchor = add_anchor(world);
    const BodyId a = add_box(world, inertia, SE3(Vec3{0.3, 0, 0}), {}, ends, false);
    const BodyId b = add_box(world, inertia, SE3(Vec3{0.6, 0, 0}), {}, ends, true);
    join(world, anchor, a, Weld{}, SE3{});
    join(world, a, b, Weld{}, SE3(Vec3{0.4, 0, 0}));
    JointDesc wrong;  // offset by half a metre
    wrong.kind = BallSocket{};
    wrong.T_b_joint = SE3(Vec3{-0.1, 0, 0});
    must(world.create_joint(anchor, b, wrong));
    bool told = false;
    double fastest = 0.0;
    for (int i = 0; i < 2000; ++i) {
      const StepStatus status = must(world.step(1e-3));
      if (i > 1000) told |= status.position_error;
      EXPECT_FALSE(status.non_finite);
      for (const BodyId body : {a, b})
        fastest = std::max(fastest, norm(world.velocity_world(body).linear));
    }
    std::printf("fastest %.2g m/s\n", fastest);
    EXPECT_TRUE(told) << static_cast<int>(ends);
    EXPECT_LT(fastest, 5.0);
  }
}

}  // namespace
}  // namespace vp::test
