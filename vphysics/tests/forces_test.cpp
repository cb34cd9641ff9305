// User forces and torques: constant loads over a step, on bodies, links and joints.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "random.h"
#include "tree_scenes.h"
#include "vphysics/multibody/dynamics.h"
#include "vphysics/multibody/quantities.h"

namespace vp::test {
namespace {

// --- a crate on a floor, under a horizontal force

enum class Carrier { body, swept, link, on_link };
constexpr Carrier kCarriers[] = {Carrier::body, Carrier::swept, Carrier::link, Carrier::on_link};
constexpr double kHalf = 0.5, kMass = 100.0, kFriction = 0.4;
const Shape kCrate = Box{{kHalf, kHalf, kHalf}};

struct Crate {
  World world;
  BodyId body;
};
void make(Crate& c, Carrier kind) {
  const Material m{kFriction, 0.0, 0.0};
  const Inertia inertia = solid_inertia(kCrate, kMass / (8 * kHalf * kHalf * kHalf));
  const SE3 at(Vec3{0, 0, kHalf});
  if (kind == Carrier::on_link) {
    // The floor is a link on a stiff joint.
    LinkSpec link;
    link.joint = PrismaticJoint{{0, 0, 1}};
    link.T_parent_joint = SE3(Vec3{0, 0, -0.5});
    link.inertia = solid_inertia(Box{{5, 5, 0.5}}, 1000.0);
    link.forces = {stops(0.0, 0.0)};
    const auto floor = must(c.world.create_articulation({model_of({link})}));
    must(c.world.add_collider(c.world.link_body(floor, 0), collider_of(Box{{5, 5, 0.5}}, m)));
  } else {
    add_ground(c.world, m);
  }
  if (kind == Carrier::link) {
    LinkSpec link;
    link.joint = FreeJoint{};
    link.T_parent_joint = at;
    link.inertia = inertia;
    const auto tree = must(c.world.create_articulation({model_of({link})}));
    c.body = c.world.link_body(tree, 0);
    must(c.world.add_collider(c.body, collider_of(kCrate, m)));
    return;
  }
  BodyDesc desc;
  desc.T_world_body = at;
  desc.inertia = inertia;
  desc.continuous = kind == Carrier::swept;
  c.body = must(c.world.create_body(desc));
  must(c.world.add_collider(c.body, collider_of(kCrate, m)));
}
void push(World& world, BodyId body, const Vec3& force, double seconds, double rate) {
  for (int i = 0; i < std::lround(seconds * rate); ++i) {
    must(world.apply_force(body, force));
    must(world.step(1.0 / rate));
  }
}

TEST(Force, MovesACrateFromTheLimitOfFrictionOn) {
  for (const Carrier kind : kCarriers) {
    for (const double rate : kRates) {
      for (const double share : {0.9, 0.99, 1.01, 1.1}) {
        Crate c;
        make(c, kind);
        const double force = share * kFriction * kMass * kG;
        push(c.world, c.body, {0, 0, 0}, 0.5, rate);
        const double start = c.world.pose(c.body).position().x;
        push(c.world, c.body, {force, 0, 0}, 2.0, rate);
        const double way = c.world.pose(c.body).position().x - start;
        const double speed = c.world.velocity(c.body).v.x;
        const double excess = (share - 1.0) * kFriction * kG;
        std::printf("kind %d, %4.0f Hz, %.2f: way %.2e m, speed %.4e m/s (free %.4e)\n",
                    static_cast<int>(kind), rate, share, way, speed, 2.0 * excess);
        if (share < 1.0) {
          EXPECT_LT(std::fabs(way), 1e-4);
          EXPECT_LT(std::fabs(speed), 1e-4);
        } else {
          EXPECT_NEAR(speed, 2.0 * excess, 0.02 * 2.0 * excess);
          EXPECT_NEAR(way, 2.0 * excess, 0.04 * 2.0 * excess);
        }
      }
    }
  }
}

// A force acts on the lowest of four crates. Friction between them is high, so the ground's
// friction acts on the weight of all four.
TEST(Force, MovesTheLowestOfAStackWithAllThatItCarries) {
  for (const double rate : kRates) {
    for (const double share : {0.99, 1.01}) {
      World world;
      add_ground(world, {0.2, 0.0, 0.0});
      std::vector<BodyId> stack;
      for (int i = 0; i < 4; ++i) {
        stack.push_back(add_dynamic(world, {.shape = kCrate,
                                            .material = {0.8, 0.0, 0.0},
                                            .density = 100.0,
                                            .pose = SE3(Vec3{0, 0, kHalf * (2 * i + 1)})}));
      }
      const double friction = std::sqrt(0.2 * 0.8), mass = 4 * 100.0;
      push(world, stack[0], {0, 0, 0}, 1.0, rate);
      const Vec3 start = world.pose(stack[0]).position();
      push(world, stack[0], {share * friction * mass * kG, 0, 0}, 2.0, rate);
      const double excess = (share - 1.0) * friction * kG;
      for (const BodyId body : stack) {
        const double way = world.pose(body).position().x - start.x;
        const double speed = world.velocity(body).v.x;
        std::printf("stack, %4.0f Hz, %.2f: way %.2e m, speed %.4e m/s (free %.4e)\n", rate, share,
                    way, speed, 2.0 * excess);
        if (share < 1.0) {
          EXPECT_LT(std::fabs(way), 1e-3);
        } else {
          EXPECT_NEAR(speed, 2.0 * excess, 0.15 * 2.0 * excess);
        }
      }
    }
  }
}

// Only the force beyond the friction limit accelerates: a crate lifted by 0.9 of its weight slides
// at 0.1 of the limit.
TEST(Force, ThatLiftsTakesFrictionAway) {
  for (const double rate : kRates) {
    for (const double share : {0.97, 1.03}) {
      Crate c;
      make(c, Carrier::body);
      push(c.world, c.body, {0, 0, 0}, 0.5, rate);
      const double start = c.world.pose(c.body).position().x;
      const double weight = kMass * kG;
      push(c.world, c.body, {share * kFriction * 0.1 * weight, 0, 0.9 * weight}, 2.0, rate);
      const double way = c.world.pose(c.body).position().x - start;
      const double free = 2.0 * (share - 1.0) * kFriction * 0.1 * kG;
      EXPECT_NEAR(way, share < 1.0 ? 0.0 : free, share < 1.0 ? 1e-4 : 0.1 * free);
    }
  }
}

TEST(Force, IsFeltAsALoadAndMakesNoHits) {
  for (const Carrier kind : kCarriers) {
    Crate c;
    make(c, kind);
    push(c.world, c.body, {0, 0, 0}, 0.2, 60.0);
    int hits = 0;
    for (int i = 0; i < 60; ++i) {
      must(c.world.apply_force(c.body, {0, 0, -5.0 * kMass * kG}));
      must(c.world.step(1.0 / 60.0));
      hits += static_cast<int>(c.world.contact_events().size());
    }
    EXPECT_EQ(hits, 0) << static_cast<int>(kind);
    EXPECT_NEAR(c.world.pose(c.body).position().z, kHalf, 2e-3) << static_cast<int>(kind);
  }
}

// --- bodies without contacts

Vec3 rotation_bound(const Mat3& R) {
  return Log(to_quaternion(R));
}

struct Free {
  World world{WorldDesc{.gravity = {}, .sub_steps = 2}};
  BodyId body;
};
void make_free(Free& f, const Inertia& inertia, const Vec3& w = {}, bool continuous = false) {
  BodyDesc desc;
  desc.inertia = inertia;
  desc.velocity.w = w;
  desc.continuous = continuous;
  f.body = must(f.world.create_body(desc));
}

TEST(Force, GivesTheClosedFormToTheOrderOfTheStep) {
  for (const bool continuous : {false, true}) {
    double before = 0.0;
    for (const int steps : {50, 100, 200}) {
      Free f;
      make_free(f, Inertia(2.0, Vec3{0.3, 0.3, 0.3}), {}, continuous);
      const Vec3 force{3.0, -1.0, 0.5}, torque{0.0, 0.6, 0.0};
      for (int i = 0; i < steps; ++i) {
        must(f.world.apply_force(f.body, force, f.world.pose(f.body).position()));
        must(f.world.apply_torque(f.body, torque));
        must(f.world.step(1.0 / steps));
      }
      // v = F t / m, x = F t^2 / (2 m), w = M t / I, angle = M t^2 / (2 I)
      const SE3 T = f.world.pose(f.body);
      const se3 V = f.world.velocity(f.body);
      EXPECT_LT(norm(T.rotate(V.v) - 0.5 * force), 1e-12);
      EXPECT_LT(norm(T.rotate(V.w) - (1.0 / 0.3) * torque), 1e-12);
      const double error = norm(T.position() - 0.25 * force);
      const double turn = norm(rotation_bound(T.rotation()) - (0.5 / 0.3) * torque);
      std::printf("%d steps: %.3e m, %.3e rad off\n", steps, error, turn);
      if (before > 0.0) {
        EXPECT_NEAR(before / error, 2.0, 0.5);
      }
      EXPECT_LT(error, 2.0 / steps);
      EXPECT_LT(turn, 2.0 / steps);
      before = error;
    }
  }
}

// A torque changes the angular momentum of a tumbling body by torque times time, to rounding. A
// wrench without power leaves its energy.
TEST(Torque, AddsToTheAngularMomentumOfATumblingBody) {
  for (const bool continuous : {false, true}) {
    Free f;
    const Inertia J(2.0, Vec3{0.1, 0.2, 0.25});
    make_free(f, J, {3.0, -2.0, 5.0}, continuous);
    const auto momentum = [&] {
      const se3 V = f.world.velocity(f.body);
      return f.world.pose(f.body).rotate((J * V).m);
    };
    const Vec3 start = momentum(), torque{0.2, -0.1, 0.3};
    for (int i = 0; i < 400; ++i) {
      must(f.world.apply_torque(f.body, torque));
      must(f.world.step(0.005));
    }
    EXPECT_LT(norm(momentum() - start - 2.0 * torque), 1e-9);
  }
}

// The rotation of a tumbling body under a torque converges with the first order of the step.
TEST(Torque, TurnsATumblingBodyToTheOrderOfTheStep) {
  for (const bool continuous : {false, true}) {
    const auto after = [&](int steps) {
      Free f;
      make_free(f, Inertia(2.0, Vec3{0.1, 0.2, 0.25}), {3.0, -2.0, 5.0}, continuous);
      for (int i = 0; i < steps; ++i) {
        must(f.world.apply_torque(f.body, {2.0, -1.0, 3.0}));
        must(f.world.step(1.0 / steps));
      }
      return f.world.pose(f.body).rotation();
    };
    const Mat3 fine = after(20000);
    const double coarse = norm(rotation_bound(transpose(fine) * after(200)));
    const double half = norm(rotation_bound(transpose(fine) * after(400)));
    std::printf("tumbling: %.3e, %.3e rad off\n", coarse, half);
    EXPECT_NEAR(coarse / half, 2.0, 0.3);
  }
}

TEST(Force, ActsAtItsPointAndAddsUp) {
  Free one, other;
  for (Free* f : {&one, &other}) {
    make_free(*f, Inertia(2.0, {0.4, 0, 0}, Sym3{0.5, 0.7, 0.9, 0, 0, 0}));
  }
  must(one.world.apply_force(one.body, {0, 0, 3}, {1, 2, 0}));
  must(one.world.apply_force(one.body, {1, 0, 0}, {0, 0, 0}));
  // The same wrench at the centre of mass, (0.2, 0, 0): the force, and the moment about it.
  must(other.world.apply_force(other.body, {1, 0, 3}));
  must(other.world.apply_torque(other.body, cross(Vec3{0.8, 2, 0}, Vec3{0, 0, 3})));
  for (Free* f : {&one, &other}) must(f->world.step(0.01));
  EXPECT_LT(norm(one.world.velocity(one.body).w - other.world.velocity(other.body).w), 1e-15);
  EXPECT_LT(norm(one.world.velocity(one.body).v - other.world.velocity(other.body).v), 1e-15);
}

TEST(Force, IsForgottenWhenTheStepEnds) {
  Free f;
  make_free(f, Inertia(2.0, Vec3{1, 1, 1}));
  const std::uint64_t before = f.world.state_hash();
  must(f.world.apply_force(f.body, {4, 0, 0}));
  EXPECT_NE(f.world.state_hash(), before) << "it is state";
  must(f.world.step(0.01));
  EXPECT_DOUBLE_EQ(f.world.velocity(f.body).v.x, 0.02);
  for (int i = 0; i < 10; ++i) must(f.world.step(0.01));
  EXPECT_DOUBLE_EQ(f.world.velocity(f.body).v.x, 0.02);
}

TEST(Force, WakesWhatSleeps) {
  WorldDesc desc;
  desc.sleep_after = 0.1;
  World world(desc);
  add_ground(world, {});
  const BodyId box = add_dynamic(world, {.shape = kCrate, .pose = SE3(Vec3{0, 0, kHalf})});
  const auto rest = [&] {
    for (int i = 0; i < 100; ++i) must(world.step(0.01));
    ASSERT_TRUE(world.is_asleep(box));
  };
  rest();
  must(world.apply_force(box, {1, 0, 0}));
  EXPECT_FALSE(world.is_asleep(box));
  rest();
  must(world.apply_torque(box, {1, 0, 0}));
  EXPECT_FALSE(world.is_asleep(box));
}

// --- articulations

// The error of a step's velocity change against the accelerations of forward dynamics.
double error_of_accelerations(const Model& model, Random& random, double dt) {
  World world;
  const auto id = must(world.create_articulation({model}));
  std::vector<double> q(world.coordinates(id).begin(), world.coordinates(id).end());
  const auto n = static_cast<std::size_t>(model.velocities());
  std::vector<double> v(n, 0.0), tau(n), a(n);
  const bool floats = std::holds_alternative<FreeJoint>(model.link(0).joint);
  for (std::size_t i = floats ? 7 : 0; i < q.size(); ++i) q[i] = random.uniform(-0.1, 0.1);
  must(world.set_joint_states(id, q, v));
  std::vector<dse3> external(static_cast<std::size_t>(model.links()));
  for (int l = 0; l < model.links(); ++l) {
    const BodyId body = world.link_body(id, l);
    const SE3 T = world.pose(body);
    const Vec3 force = random.in_cube(3.0), torque = random.in_cube(1.0);
    const Vec3 point = T.position() + random.in_cube(0.5);
    must(world.apply_force(body, force, point));
    must(world.apply_torque(body, torque));
    const Vec3 moment = torque + cross(point - T.position(), force);
    external[static_cast<std::size_t>(l)] = {T.unrotate(moment), T.unrotate(force)};
    for (int k = 0; k < velocities_of(model.link(l).joint); ++k) {
      const double f = random.uniform(-1, 1);
      must(world.apply_joint_force(id, l, k, f));
      tau[static_cast<std::size_t>(model.first_velocity(l) + k)] = f;
    }
  }
  Data data(model);
  const Loads loads{.external = external};
  must(forward_dynamics<double>(model, data, q, v, tau, loads, a));
  must(world.step(dt));
  double error = 0.0, size = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    error = std::max(error, std::fabs(world.velocities(id)[i] / dt - a[i]));
    size = std::max(size, std::fabs(a[i]));
  }
  return error / size;
}

TEST(Force, OnLinksAndJointsIsThatOfForwardDynamics) {
  Random random(71);
  std::vector<LinkSpec> floating = hanging_chain(4, RevoluteJoint{{0, 1, 0}});
  floating[0].joint = FreeJoint{};
  LinkSpec slider;
  slider.joint = PrismaticJoint{{0, 1, 1}};
  slider.inertia = Inertia(0.7, Vec3{0.1, 0.2, 0.15});
  slider.parent = 1;
  floating.push_back(slider);
  LinkSpec rider = rod_link(0, 0.1);
  rider.parent = 0;
  rider.T_parent_joint = SE3(Vec3{0, 0, 0.1});
  const struct {
    const char* name;
    Model model;
  } models[] = {{"a chain", model_of(hanging_chain(5, RevoluteJoint{{0, 1, 0}}))},
                {"a chain of universal joints", model_of(hanging_chain(4, UniversalJoint{}))},
                {"a floating tree", model_of(floating)},
                {"a rod", model_of({rod_link(0, 0.1)})},
                {"a rod on a rod", model_of({rod_link(0, 0.1), rider})}};
  for (const auto& [name, model] : models) {
    const double error = error_of_accelerations(model, random, 1e-6);
    std::printf("%s: %.2e of the accelerations\n", name, error);
    EXPECT_LT(error, 1e-5) << name;
  }
}

// The momentum is exact to rounding. Joint forces between the links add nothing to it. What turns
// far in a step takes part in the sub-steps, in which forces follow their points: its angular
// momentum is not tested.
TEST(Force, AddsToTheMomentumOfAFloatingTree) {
  for (const double scale : {0.003, 1.0}) {
    World world(WorldDesc{.gravity = {}});
    std::vector<LinkSpec> links = hanging_chain(4, RevoluteJoint{{0, 1, 0}});
    links[0].joint = FreeJoint{};
    const Model model = model_of(links);
    const auto id = must(world.create_articulation({model}));
    const Vec3 force{1, 2, -1}, torque = scale * Vec3{0.1, 0.0, -0.2};
    Data data(model);
    const auto momentum_now = [&] {
      forward_kinematics<double>(model, data, world.coordinates(id), world.velocities(id));
      return momentum<double>(model, data, {});  // about the world's origin
    };
    Vec3 linear;
    double worst = 0.0, fastest = 0.0;
    for (int i = 0; i < 200; ++i) {
      const BodyId body = world.link_body(id, i % 4);
      const Vec3 at = world.pose(body).position();
      must(world.apply_force(body, scale * force, at));
      must(world.apply_torque(body, torque));
      must(world.apply_joint_force(id, 2, 0, scale * 0.01));
      const dse3 before = momentum_now();
      must(world.step(0.005));
      const dse3 P = momentum_now();
      linear += 0.005 * scale * force;
      worst = std::max(worst, norm(P.f - linear));
      fastest = std::max(fastest, norm(world.velocity(body).w));
      if (scale == 1.0) continue;
      // The tree moves by P dt / m with its new momentum, so its angular momentum about the centre
      // of mass has no error.
      const auto about_centre = [&](const dse3& F, const Vec3& c) { return F.m - cross(c, F.f); };
      const Vec3 c = centre_of_mass<double>(model, data);
      const double mass = 2.0;
      const Vec3 c_before = c - (0.005 / mass) * P.f;
      const Vec3 gained = about_centre(P, c) - about_centre(before, c_before);
      worst =
          std::max(worst, norm(gained - 0.005 * (cross(at - c_before, scale * force) + torque)));
    }
    std::printf("momentum of a floating tree at up to %.1f rad/s: %.2e off\n", fastest, worst);
    EXPECT_LT(worst, 1e-13);
    EXPECT_EQ(fastest * 0.005 > 0.15, scale == 1.0);
  }
}

// Also for remote rods, too far from any body for contacts.
TEST(Force, OfAJointMovesARod) {
  World world(WorldDesc{.gravity = {}});
  add_ground(world, {});
  const Rod rod = add_rod(world, 0, 0.5, 1, 0.1, {});
  add_ball(world, {3, 0, 0.5}, {}, {});
  for (int i = 0; i < 100; ++i) {
    must(world.apply_joint_force(rod.articulation, 0, 0, 0.15));
    must(world.apply_joint_force(rod.articulation, 0, 1, 0.003));
    must(world.step(0.001));
  }
  EXPECT_NEAR(world.joint_velocity(rod.articulation, 0, 0), 0.15 / 1.5 * 0.1, 1e-12);
  EXPECT_NEAR(world.joint_velocity(rod.articulation, 0, 1), 0.003 / 0.0015 * 0.1, 1e-12);
}

// A link driven by a joint force transmits exactly that force to a crate.
TEST(Force, OfAJointIsFeltByWhatItsLinkPushes) {
  for (const double rate : kRates) {
    for (const double share : {0.98, 1.02}) {
      Crate c;
      make(c, Carrier::body);
      LinkSpec link;
      link.joint = PrismaticJoint{{1, 0, 0}};
      link.T_parent_joint = SE3(Vec3{-kHalf - 0.1, 0, kHalf});
      link.inertia = solid_inertia(Box{{0.1, 0.1, 0.1}}, 1000.0);
      const auto pusher = must(c.world.create_articulation({model_of({link})}));
      must(c.world.add_collider(c.world.link_body(pusher, 0),
                                collider_of(Box{{0.1, 0.1, 0.1}}, {0.0, 0.0, 0.0})));
      for (int i = 0; i < static_cast<int>(2.0 * rate); ++i) {
        must(c.world.apply_joint_force(pusher, 0, 0, share * kFriction * kMass * kG));
        must(c.world.step(1.0 / rate));
      }
      const double way = c.world.pose(c.body).position().x;
      const double free = 2.0 * (share - 1.0) * kFriction * kG * kMass / (kMass + 8.0);
      std::printf("pushed by a link, %4.0f Hz, %.2f: %.2e m (free %.2e)\n", rate, share, way, free);
      EXPECT_NEAR(way, share < 1.0 ? 0.0 : free, share < 1.0 ? 1e-3 : 0.1 * free);
    }
  }
}

// --- state

TEST(Force, IsPartOfTheState) {
  const auto build = [](World& world) {
    add_ground(world, {});
    add_dynamic(world, {.shape = kCrate, .pose = SE3(Vec3{0, 0, 2})});
    add_dynamic(world, {.shape = kCrate, .pose = SE3(Vec3{3, 0, kHalf})});
    must(world.create_articulation({model_of(hanging_chain(3, RevoluteJoint{{0, 1, 0}}))}));
    add_rod(world, 2.0, 2.0, 1, 0.1, {});
  };
  World a, b;
  build(a);
  build(b);
  must(a.apply_force({3, 1}, {1, 2, 3}, {0, 0, 2}));
  must(a.apply_force({2, 1}, {100, 0, 0}));
  must(a.apply_force({5, 1}, {1, 0, 0}));
  must(a.apply_joint_force({2, 1}, 0, 1, 0.5));
  std::vector<std::byte> bytes;
  a.snapshot(bytes);
  must(b.apply_torque({2, 1}, {9, 9, 9}));
  must(b.apply_joint_force({1, 1}, 0, 0, 0.5));
  must(b.restore(bytes));
  EXPECT_EQ(a.state_hash(), b.state_hash());
  for (int i = 0; i < 10; ++i) {
    must(a.step(0.01));
    must(b.step(0.01));
    EXPECT_EQ(a.state_hash(), b.state_hash());
  }
  must(a.restore(bytes));
  must(a.step(0.01));
  EXPECT_NE(a.state_hash(), b.state_hash());
  // Each damaged value is rejected.
  for (std::size_t k = bytes.size() - 400; k + 8 < bytes.size(); k += 8) {
    std::vector<std::byte> damaged = bytes;
    damaged[k + 6] ^= std::byte{0xff};
    EXPECT_FALSE(b.restore(damaged)) << k;
  }
}

TEST(Force, GoesWithABodyThatIsDestroyed) {
  Free f;
  make_free(f, Inertia(2.0, Vec3{1, 1, 1}));
  BodyDesc desc;
  desc.inertia = Inertia(1.0, Vec3{1, 1, 1});
  const BodyId other = must(f.world.create_body(desc));
  must(f.world.apply_force(f.body, {4, 0, 0}));
  must(f.world.apply_force(other, {1, 0, 0}));
  must(f.world.destroy_body(f.body));
  const BodyId heir = must(f.world.create_body(desc));
  must(f.world.step(0.01));
  EXPECT_EQ(f.world.velocity(heir).v.x, 0.0);
  EXPECT_DOUBLE_EQ(f.world.velocity(other).v.x, 0.01);
}

}  // namespace
}  // namespace vp::test
