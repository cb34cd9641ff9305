// Contact points with their impulses: what a foot or a gripper measures.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <vector>

#include "tree_scenes.h"

namespace vp::test {
namespace {

constexpr double kSlowAndFast[] = {60.0, 1000.0};  // rates of steps [Hz]

struct Sum {
  Vec3 impulse, moment;  // about the world's origin
  std::size_t count = 0;
};
Sum sum_of(const World& world, BodyId body) {
  std::vector<ContactPoint> points;
  world.contacts_of(body, points);
  Sum sum;
  for (const ContactPoint& p : points) {
    EXPECT_EQ(world.body_of(p.collider), body);
    EXPECT_NE(world.body_of(p.other), body);
    EXPECT_NEAR(norm(p.normal), 1.0, 1e-5);
    EXPECT_GE(p.normal_impulse, 0.0);
    EXPECT_NEAR(dot(p.normal, p.friction_impulse), 0.0, 1e-5 * (1.0 + p.normal_impulse));
    const Vec3 impulse = p.normal_impulse * p.normal + p.friction_impulse;
    sum.impulse += impulse;
    sum.moment += cross(p.point, impulse);
  }
  sum.count = points.size();
  return sum;
}

enum class CrateKind { body, swept, link };
BodyId add_crate(World& world, CrateKind kind, const Vec3& at, const Material& m) {
  if (kind != CrateKind::link) {
    return add_dynamic(
        world,
        {.shape = kBox, .material = m, .pose = SE3(at), .continuous = kind == CrateKind::swept});
  }
  LinkSpec link;
  link.joint = FreeJoint{};
  link.T_parent_joint = SE3(at);
  link.inertia = solid_inertia(kBox, 1000.0);
  const auto id = must(world.create_articulation({model_of({link})}));
  must(world.add_collider(world.link_body(id, 0), collider_of(kBox, m)));
  return world.link_body(id, 0);
}

// A crate at rest under a horizontal force. The ground's impulses equal its weight and that force,
// with the moment of both.
TEST(ContactsOf, CarryTheWeightAndHoldThePush) {
  const Material m{0.5, 0.0, 0.0};
  for (const CrateKind kind : {CrateKind::body, CrateKind::swept, CrateKind::link}) {
    for (const double rate : kSlowAndFast) {
      World world;
      const BodyId ground = add_ground(world, m);
      const BodyId crate = add_crate(world, kind, {0, 0, 0.5}, m);
      const double dt = 1.0 / rate, weight = 1000.0 * kG;
      for (int i = 0; i < static_cast<int>(rate); ++i) {
        must(world.apply_force(crate, {2000.0, 0, 0}));
        must(world.step(dt));
      }
      const Sum sum = sum_of(world, crate), on_ground = sum_of(world, ground);
      const Vec3 expected = dt * Vec3{-2000.0, 0, weight};
      std::printf("kind %d, %4.0f Hz: %zu points, %.2e of the load off\n", static_cast<int>(kind),
                  rate, sum.count, norm(sum.impulse - expected) / norm(expected));
      EXPECT_EQ(sum.count, 4u);
      EXPECT_LT(norm(sum.impulse - expected), 2e-3 * norm(expected));
      EXPECT_LT(norm(on_ground.impulse + sum.impulse), 1e-9 * norm(expected));
      // No moment about the centre of mass, half a metre up.
      const Vec3 about = sum.moment - cross(world.pose(crate).position(), sum.impulse);
      EXPECT_LT(norm(about), 0.01 * norm(expected));
    }
  }
}

TEST(ContactsOf, AStackAddUpFromBodyToBody) {
  for (const double rate : kSlowAndFast) {
    World world;
    const BodyId ground = add_ground(world, {});
    std::vector<BodyId> stack;
    for (int i = 0; i < 3; ++i) {
      stack.push_back(add_dynamic(world, {.shape = kBox, .pose = SE3(Vec3{0, 0, 0.5 + i})}));
    }
    for (int i = 0; i < static_cast<int>(2 * rate); ++i) must(world.step(1.0 / rate));
    const double weight = 1000.0 * kG / rate;
    EXPECT_NEAR(sum_of(world, ground).impulse.z, -3.0 * weight, 0.01 * weight);
    for (const BodyId body : stack) {
      EXPECT_NEAR(sum_of(world, body).impulse.z, weight, 0.01 * weight);
      EXPECT_EQ(sum_of(world, body).count, body == stack[2] ? 4u : 8u);
    }
  }
}

// A crate on a plate that is a link; the joint's drive carries both.
TEST(ContactsOf, ABodyOnALink) {
  for (const double rate : kSlowAndFast) {
    World world;
    LinkSpec link;
    link.joint = PrismaticJoint{{0, 0, 1}};
    link.T_parent_joint = SE3(Vec3{0, 0, -0.5});
    link.inertia = solid_inertia(Box{{5, 5, 0.5}}, 1000.0);
    link.forces = {stops(0.0, 0.0)};
    const auto floor = must(world.create_articulation({model_of({link})}));
    const BodyId plate = world.link_body(floor, 0);
    must(world.add_collider(plate, collider_of(Box{{5, 5, 0.5}}, {})));
    const BodyId crate = add_crate(world, CrateKind::body, {0, 0, 0.5}, {});
    for (int i = 0; i < static_cast<int>(rate); ++i) {
      must(world.apply_force(crate, {1000.0, 0, 0}));
      must(world.step(1.0 / rate));
    }
    const Vec3 expected = (1.0 / rate) * Vec3{-1000.0, 0, 1000.0 * kG};
    const Sum sum = sum_of(world, crate);
    EXPECT_LT(norm(sum.impulse - expected), 2e-3 * norm(expected)) << rate;
    EXPECT_LT(norm(sum_of(world, plate).impulse + sum.impulse), 1e-9 * norm(expected)) << rate;
  }
}

// The impulses of a complete bounce sum to the change of momentum plus the impulse of gravity
// meanwhile.
TEST(ContactsOf, ABounceGiveItsChangeOfMomentum) {
  for (const bool continuous : {false, true}) {
    for (const double rate : kSlowAndFast) {
      World world;
      const Material m{0.3, 0.7, 0.0};
      add_ground(world, m);
      const BodyId ball = add_dynamic(world, {.shape = Sphere{0.1},
                                              .material = m,
                                              .pose = SE3(Vec3{0, 0, 1}),
                                              .velocity = {{}, {1, 0, 0}},
                                              .continuous = continuous});
      const double mass = world.inertia(ball).mass();
      const auto momentum = [&] { return mass * world.velocity_world(ball).linear; };
      const Vec3 start = momentum();
      Vec3 impulse;
      const int steps = static_cast<int>(0.7 * rate);
      for (int i = 0; i < steps; ++i) {
        must(world.step(1.0 / rate));
        impulse += sum_of(world, ball).impulse;
      }
      const Vec3 gravity = mass * (steps / rate) * Vec3{0, 0, -kG};
      const Vec3 missing = momentum() - start - gravity - impulse;
      std::printf("bounce, %s, %4.0f Hz: (%.1e %.1e %.1e) of %.1e N s missing\n",
                  continuous ? "swept" : "in lanes", rate, missing.x, missing.y, missing.z,
                  norm(impulse));
      EXPECT_LT(std::fabs(missing.z), 1e-4 * norm(impulse));
    }
  }
}

TEST(ContactsOf, WhatSleepsStayAndAreGoneAfterARestore) {
  WorldDesc desc;
  desc.sleep_after = 0.1;
  World world(desc);
  add_ground(world, {});
  const BodyId box = add_dynamic(world, {.shape = kBox, .pose = SE3(Vec3{0, 0, 0.5})});
  const BodyId high = add_dynamic(world, {.shape = kBox, .pose = SE3(Vec3{5, 0, 500})});
  EXPECT_EQ(sum_of(world, box).count, 0u);
  for (int i = 0; i < 100; ++i) must(world.step(0.01));
  ASSERT_TRUE(world.is_asleep(box));
  EXPECT_NEAR(sum_of(world, box).impulse.z, 1000.0 * kG * 0.01, 0.1);
  EXPECT_EQ(sum_of(world, high).count, 0u);
  std::vector<std::byte> bytes;
  world.snapshot(bytes);
  must(world.restore(bytes));
  EXPECT_EQ(sum_of(world, box).count, 0u);
}

}  // namespace
}  // namespace vp::test
