// Impact loads in the sub-stepped solver: which impulses are reported, how far they propagate
// within a step, and stacks whose step length or ground changes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "rig.h"

namespace vp::test {
namespace {

const Material kDull{0.6, 0.0, 0.0};
const Box kCube{{0.5, 0.5, 0.5}};

std::vector<BodyId> add_tower(World& world, int count, const se3& velocity = {}) {
  std::vector<BodyId> boxes;
  for (int i = 0; i < count; ++i) {
    boxes.push_back(add_dynamic(world, {.shape = kCube,
                                        .material = kDull,
                                        .pose = SE3(Vec3{0, 0, 0.5 + i}),
                                        .velocity = velocity}));
  }
  return boxes;
}

Vec3 velocity_of(const World& world, BodyId body) {
  return world.pose(body).rotate(world.velocity(body).v);
}

// m (v_after - v_before) = J - m g dt over the step of the hit, in whichever sub-step the hit
// occurs.
TEST(ImpactLoads, WithoutRestitutionIsToldWhole) {
  for (const double rate : kRates) {
    for (int phase = 0; phase < 10; ++phase) {
      World world;
      add_ground(world, kDull);
      const BodyId ball = add_dynamic(
          world,
          {.shape = Sphere{0.5}, .material = kDull, .pose = SE3(Vec3{0, 0, 1.5 + 0.03 * phase})});
      const double mass = solid_inertia(Sphere{0.5}, 1000.0).mass();
      int hits = 0;
      for (int i = 0; i < static_cast<int>(0.7 * rate); ++i) {
        const double before = velocity_of(world, ball).z;
        must(world.step(1.0 / rate));
        const double gained = velocity_of(world, ball).z - before;
        for (const ContactEvent& e : world.contact_events()) {
          if (e.kind != ContactEvent::Kind::hit) continue;
          ++hits;
          const double wanted = mass * (gained + 9.81 / rate);
          EXPECT_NEAR(e.impulse, wanted, 1e-3 * wanted) << rate << " Hz, phase " << phase;
        }
      }
      EXPECT_EQ(hits, 1) << rate << " Hz, phase " << phase;
    }
  }
}

// One box touches a wall, and another flies at it. The impact reaches the wall in the sub-step of
// the hit. One sub-step later, the box would penetrate by 6 mm at 60 Hz.
TEST(ImpactLoads, RunsThroughAnUnloadedContactInItsOwnSubStep) {
  for (const double gap : {0.0, 0.001}) {
    World world({.gravity = {}});
    add_fixed(world, Box{{0.5, 5, 5}}, {});
    std::vector<BodyId> boxes;
    for (int i = 0; i < 2; ++i) {
      boxes.push_back(add_dynamic(
          world, {.shape = kCube, .pose = SE3(Vec3{0.5 + gap + 0.5 + i * (1.0 + gap), 0, 0})}));
    }
    const BodyId striker = add_dynamic(
        world, {.shape = kCube, .pose = SE3(Vec3{5, 0, 0}), .velocity = {{}, {-20, 0, 0}}});
    boxes.push_back(striker);
    double deepest = 0.0;
    for (int i = 0; i < 60; ++i) {
      must(world.step(1.0 / 60));
      double last = 0.0;
      for (const BodyId box : boxes) {
        const double x = world.pose(box).position().x;
        deepest = std::max(deepest, 1.0 - (x - last));
        last = x;
      }
    }
    EXPECT_LT(deepest, 3e-3) << "gap " << gap;
    EXPECT_LT(std::fabs(velocity_of(world, striker).x), 1.5) << "gap " << gap;
  }
}

// The warm-start impulses of a step come from the step before, which had another length. Longer
// steps let a stack sink deeper, by 18 mm at 0.1 s. Shorter steps after them must not throw it up.
TEST(Stack, StandsWhileTheStepsChange) {
  const std::pair<double, double> kPairs[] = {{1.0 / 30, 1.0 / 240}, {1.0 / 60, 1e-3},
                                              {0.1, 0.01},           {0.1, 1e-3},
                                              {0.1, 1e-4},           {1.0 / 60, 1e-6}};
  for (const auto& [one, other] : kPairs) {
    World world;
    add_ground(world, kDull);
    const std::vector<BodyId> tower = add_tower(world, 10);
    double fastest = 0.0, farthest = 0.0;
    for (int i = 0; i < 300; ++i) {
      must(world.step(i % 2 == 0 ? one : other));
      for (std::size_t k = 0; k < tower.size(); ++k) {
        const Vec3 at{0, 0, 0.5 + static_cast<double>(k)};
        fastest = std::max(fastest, norm(velocity_of(world, tower[k])));
        farthest = std::max(farthest, norm(world.pose(tower[k]).position() - at));
      }
    }
    EXPECT_LT(fastest, 0.25) << one << " s, " << other << " s";
    EXPECT_LT(farthest, 0.03) << one << " s, " << other << " s";
  }
}

TEST(Stack, IsNotThrownByOneLongStep) {
  World world;
  add_ground(world, kDull);
  const std::vector<BodyId> tower = add_tower(world, 10);
  for (int i = 0; i < 1000; ++i) must(world.step(1e-3));
  must(world.step(0.1));
  double fastest = 0.0;
  for (int i = 0; i < 1000; ++i) {
    must(world.step(1e-3));
    for (const BodyId box : tower) fastest = std::max(fastest, norm(velocity_of(world, box)));
  }
  EXPECT_LT(fastest, 0.4);  // 1.8 with unscaled impulses and bias velocity
}

// A lift at 5 m/s, in steps of 1 ms: 400 m up, its tower rests on it as it did at the start.
TEST(Stack, OnAKinematicLiftRidesAsWellAfterHundredsOfMetres) {
  World world;
  add_kinematic(world, Box{{5, 5, 0.5}}, {{}, {0, 0, 5}}, kDull, SE3(Vec3{0, 0, -0.5}));
  const std::vector<BodyId> tower = add_tower(world, 5, {{}, {0, 0, 5}});
  std::size_t events = 0;
  double fastest = 0.0;
  for (int i = 0; i < 80000; ++i) {
    must(world.step(1e-3));
    if (i < 2000) continue;
    events += world.contact_events().size();
    for (const BodyId box : tower)
      fastest = std::max(fastest, norm(velocity_of(world, box) - Vec3{0, 0, 5}));
  }
  EXPECT_EQ(events, 0u);
  EXPECT_LT(fastest, 2e-3);
}

// A box at rest on a turntable moves along chords, outwards by w^2 r dt / 2 a step, because
// friction acts on velocities.
TEST(Stack, OnATurntableCreepsNoFasterThanChordsDo) {
  constexpr double kRate = 1.5, kRadius = 1.0;
  for (const double rate : kRates) {
    World world;
    add_kinematic(world, Cylinder{5, 0.5}, {{0, 0, kRate}, {}}, {1.0, 0.0, 0.0},
                  SE3(Vec3{0, 0, -0.5}));
    const BodyId box = add_dynamic(world, {.shape = kCube,
                                           .material = {1.0, 0.0, 0.0},
                                           .pose = SE3(Vec3{kRadius, 0, 0.5}),
                                           .velocity = {{0, 0, kRate}, {0, kRate * kRadius, 0}}});
    const auto radius = [&] {
      const Vec3 p = world.pose(box).position();
      return std::hypot(p.x, p.y);
    };
    for (int i = 0; i < static_cast<int>(2 * rate); ++i) must(world.step(1.0 / rate));
    const double start = radius();
    for (int i = 0; i < static_cast<int>(4 * rate); ++i) must(world.step(1.0 / rate));
    const double chords = 0.5 * kRate * kRate * kRadius / rate;
    EXPECT_LT((radius() - start) / 4.0, 1.4 * chords) << rate << " Hz";
  }
}

// v' = -c v, w' = -d w, for a body that slides on a plane without friction as for a flying one.
TEST(Damping, ActsOnWhatTouches) {
  for (const double rate : kRates) {
    World world;
    add_ground(world, {0.0, 0.0, 0.0});
    BodyDesc desc;
    desc.T_world_body = SE3(Vec3{0, 0, 0.5});
    desc.velocity = {{0, 0, 4}, {3, 0, 0}};
    desc.inertia = solid_inertia(kCube, 1000.0);
    desc.linear_damping = 0.5;
    desc.angular_damping = 2.0;
    const BodyId body = must(world.create_body(desc));
    ColliderDesc cube;
    cube.shape = kCube;
    cube.material = {0.0, 0.0, 0.0};
    must(world.add_collider(body, cube));
    for (int i = 0; i < static_cast<int>(rate); ++i) must(world.step(1.0 / rate));
    EXPECT_NEAR(norm(velocity_of(world, body)), 3 * std::exp(-0.5), 0.01) << rate << " Hz";
    EXPECT_NEAR(world.velocity(body).w.z, 4 * std::exp(-2.0), 0.01) << rate << " Hz";
  }
}

}  // namespace
}  // namespace vp::test
