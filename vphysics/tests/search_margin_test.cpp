// Speculative pairs are not processed for several steps. A contact that begins meanwhile must not
// be missed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "random.h"
#include "rig.h"
#include "vphysics/compound.h"

namespace vp::test {
namespace {

constexpr double kFrame = 1.0 / 60;

// A stick flies past a rotating ball with the ball's velocity at the stick's centre. There their
// relative velocity is zero, but the stick's end approaches.
TEST(SearchMargin, AStickThatGoesWithATurningBoulderMeetsIt) {
  constexpr double kRadius = 1.1, kHalfLength = 1.0, kHalfWidth = 0.1;
  for (const bool kinematic : {false, true}) {
    for (const double rate : {0.25, 0.5, 1.0, 2.0, 4.0}) {
      for (const double gap : {0.05, 0.1, 0.15}) {
        WorldDesc desc;
        desc.gravity = {};
        World world(desc);
        const SE3 tilt = SE3(Exp(Vec3{0, -0.5, 0}), {});
        const Vec3 end = tilt * Vec3{-kHalfLength, 0, -kHalfWidth};
        const double height = std::sqrt((kRadius + gap) * (kRadius + gap) - end.x * end.x) - end.z;
        BodyDesc ball;
        ball.motion = kinematic ? Motion::kinematic : Motion::dynamic;
        ball.velocity.w = {0, rate, 0};
        ball.inertia = solid_inertia(Sphere{kRadius}, 1000.0);
        const BodyId boulder = must(world.create_body(ball));
        ColliderDesc collider;
        collider.shape = Sphere{kRadius};
        must(world.add_collider(boulder, collider));
        const BodyId stick =
            add_dynamic(world, {.shape = Box{{kHalfLength, kHalfWidth, kHalfWidth}},
                                .pose = SE3(tilt.rotation(), Vec3{0, 0, height}),
                                .velocity = {{}, tilt.unrotate(Vec3{rate * height, 0, 0})}});
        double deepest = 0.0;
        for (int i = 0; i < 200; ++i) {
          must(world.step(kFrame));
          const Vec3 at = inverse_times(world.pose(stick), world.pose(boulder).position());
          const auto beyond = [](double x, double half) {
            return std::max(std::fabs(x) - half, 0.0);
          };
          const Vec3 out{beyond(at.x, kHalfLength), beyond(at.y, kHalfWidth),
                         beyond(at.z, kHalfWidth)};
          deepest = std::max(deepest, kRadius - norm(out));
        }
        EXPECT_LT(deepest, 2e-3) << kinematic << ", " << rate << " rad/s, gap " << gap;
      }
    }
  }
}

// A stick spins above a compound much larger than itself. It stops spinning, but falls on.
TEST(SearchMargin, ASpinThatEndsHidesNoPartOfALargeCompound) {
  WorldDesc desc;
  desc.gravity = {};
  World world(desc);
  std::vector<CompoundPart> plates;
  for (const double x : {-20.0, 0.0, 20.0})
    plates.push_back({Box{{0.05, 0.05, 0.01}}, SE3(Vec3{x, 0, 0})});
  add_fixed(world, Compound::of(plates).value(), {});
  BodyDesc stick;
  stick.T_world_body = SE3(Vec3{0, 0, 0.06});
  stick.velocity = {{0, 0, 10.0}, {0, 0, -0.5}};
  stick.angular_damping = 1e6;
  stick.inertia = solid_inertia(Box{{1.0, 0.02, 0.02}}, 1000.0);
  const BodyId body = must(world.create_body(stick));
  ColliderDesc collider;
  collider.shape = Box{{1.0, 0.02, 0.02}};
  must(world.add_collider(body, collider));
  for (int i = 0; i < 40; ++i) {
    must(world.step(kFrame));
    EXPECT_GT(world.pose(body).position().z, 0.025);
  }
}

// The angular velocity turns in the plane: the sum of the rotation vectors stays on a circle, while
// the rod itself turns about z, into a ball at rest.
TEST(SearchMargin, ARodThatWobblesMeetsWhatIsInItsWay) {
  constexpr double kTurning = 12.0, kWobbleStep = 1.0 / 240;        // [rad/s], [s]
  for (const double radius : {0.14, 0.17, 0.2, 0.23, 0.26, 0.3}) {  // of the circle [rad]
    WorldDesc desc;
    desc.gravity = {};
    World world(desc);
    const BodyId rod = add_kinematic(world, Box{{1.0, 0.05, 0.5}}, {}, {},
                                     SE3(Exp(Vec3{0, 0, kPi / 4}).matrix(), {}));
    add_dynamic(world, {.shape = Sphere{0.05}, .pose = SE3(Vec3{-0.5, 0.5, 0.0})});
    int hits = 0;
    for (int k = 0; k < 4800; ++k) {
      const double angle = kTurning * kWobbleStep * k, rate = radius * kTurning;
      must(
          world.set_velocity_world(rod, {{}, {rate * std::cos(angle), rate * std::sin(angle), 0}}));
      must(world.step(kWobbleStep));
      hits += static_cast<int>(world.contact_events().size());
    }
    EXPECT_GT(hits, 0) << radius;
  }
}

// The displacements of both restart every few steps, while the pair has its clearance for hundreds.
TEST(SearchMargin, TwoThatTravelFarTogetherMeetInTheEnd) {
  for (const double travel : {5.0, 60.0, 500.0}) {  // [m/s]
    for (const double gap : {0.02, 0.3}) {
      World world({.gravity = {}});
      constexpr double kClosing = 0.05;  // [m/s]
      const Shape box = Box{{0.1, 0.1, 0.1}};
      add_dynamic(world, {.shape = box, .velocity = {{}, {travel, 0, 0}}});
      const BodyId behind = add_dynamic(world, {.shape = box,
                                                .pose = SE3(Vec3{0, -0.2 - gap, 0}),
                                                .velocity = {{}, {travel, kClosing, 0}}});
      double time = 0.0;
      while (world.contact_events().empty() && time < 10.0) {
        must(world.step(kFrame));
        time += kFrame;
      }
      EXPECT_NEAR(time, gap / kClosing, 2.0 * kFrame) << travel << " m/s, " << gap << " m";
      EXPECT_GT(world.pose(behind).position().x, 0.9 * travel * time);
    }
  }
}

// A board tilts in circles, as a labyrinth game does. Its wall keeps its distance from a ball that
// waits, then comes slowly. The sum of the board's rotation vectors drifts.
TEST(SearchMargin, ABoardThatTiltsInCirclesMeetsWhatComesLate) {
  for (const double radius : {0.02, 0.06, 0.1}) {  // [rad]
    for (const double turning : {-12.0, 12.0}) {   // [rad/s]
      for (const double wait : {3.0, 10.0}) {      // [s]
        World world({.gravity = {}});
        const auto tilt = [&](double time) {
          const double angle = turning * time;
          return Exp(Vec3{radius * std::cos(angle), radius * std::sin(angle), 0}).matrix();
        };
        BodyDesc desc;
        desc.motion = Motion::kinematic;
        desc.T_world_body = SE3(tilt(0.0), {});
        const BodyId board = must(world.create_body(desc));
        ColliderDesc wall;
        wall.shape = Box{{0.02, 0.5, 1.0}};
        wall.T_body_shape = SE3(Vec3{0, 2, 0});
        must(world.add_collider(board, wall));
        const BodyId ball = add_dynamic(
            world, {.shape = Sphere{0.05}, .pose = SE3(Vec3{-0.12 - 1.1 * radius, 2, 0})});
        double deepest = 0.0;
        bool comes = false;
        for (double time = 0.0; time < wait + 4.0; time += kFrame) {
          const Mat3 step = transposed_times(tilt(time), tilt(time + kFrame));
          must(world.set_velocity(board, {(1.0 / kFrame) * Log(SO3(step)), {}}));
          if (!comes && time > wait) {
            must(world.set_velocity_world(ball, {{0.05, 0, 0}, {}}));
            comes = true;
          }
          must(world.step(kFrame));
          const Vec3 at =
              inverse_times(world.pose(board) * wall.T_body_shape, world.pose(ball).position());
          deepest = std::max(deepest, 0.07 + at.x);
        }
        EXPECT_LT(deepest, 5e-3) << radius << " rad, " << turning << " rad/s, " << wait << " s";
      }
    }
  }
}

// What flies apart is forgotten as soon as its bounds have parted.
TEST(SearchMargin, WhatFliesApartIsNoPairAnyMore) {
  World world({.gravity = {}});
  constexpr int kRow = 6;
  for (int k = 0; k < kRow * kRow * kRow; ++k) {
    const int row = k / kRow, layer = row / kRow;
    const Vec3 at{k % kRow - 2.5, row % kRow - 2.5, layer - 2.5};
    add_dynamic(world, {.shape = Sphere{0.1}, .pose = SE3(0.25 * at), .velocity = {{}, 3.0 * at}});
  }
  std::uint32_t most = 0;
  for (int i = 0; i < 120; ++i) {
    must(world.step(kFrame));
    most = std::max(most, world.counters().pairs);
  }
  EXPECT_GT(most, 100u);
  EXPECT_LT(world.counters().pairs, most / 20);
}

// A body flies along the face of a wall, past its axis. The wall turns towards it.
TEST(SearchMargin, AWallThatTurnsMeetsWhatFliesAlongIt) {
  for (const bool kinematic : {false, true}) {
    for (const double rate : {0.1, 0.3, 1.0}) {
      for (const double speed : {1.0, 4.0}) {
        for (const double half : {0.02, 0.1}) {
          World world({.gravity = {}});
          const Box wall{{3.0, 1.0, 0.1}};
          BodyDesc desc;
          desc.motion = kinematic ? Motion::kinematic : Motion::dynamic;
          desc.inertia = solid_inertia(wall, 1e6);
          const BodyId board = must(world.create_body(desc));
          ColliderDesc collider;
          collider.shape = wall;
          must(world.add_collider(board, collider));
          must(world.set_velocity_world(board, {{}, {0, -rate, 0}}));
          const BodyId flyer = add_dynamic(world, {.shape = Box{{half, half, half}},
                                                   .pose = SE3(Vec3{-1.0, 0, 0.11 + half}),
                                                   .velocity = {{}, {speed, 0, 0}}});
          double deepest = 0.0;
          for (double time = 0.0; time < std::min(3.5 / speed, 1.2 / rate); time += kFrame) {
            must(world.step(kFrame));
            const Vec3 at = inverse_times(world.pose(board), world.pose(flyer).position());
            if (std::fabs(at.x) < 3.0) deepest = std::max(deepest, 0.1 + half - at.z);
          }
          EXPECT_LT(deepest, 0.2 * half)
              << kinematic << ", " << rate << " rad/s, " << speed << " m/s, half extent " << half;
        }
      }
    }
  }
}

// Two that tumble fly past each other closely. A contact would deflect them.
TEST(SearchMargin, WhatFliesPastHasNoContact) {
  struct Flyer {
    Shape shape;
    double radius;  // that it reaches as it tumbles [m]
  };
  const std::vector<CompoundPart> balls{{Sphere{0.1}, SE3(Vec3{0, 0, 0.15})},
                                        {Sphere{0.1}, SE3(Vec3{0, 0, -0.15})}};
  const std::vector<CompoundPart> boxes{{Box{{0.05, 0.1, 0.05}}, SE3(Vec3{0, 0.12, 0})},
                                        {Box{{0.05, 0.1, 0.05}}, SE3(Vec3{0, -0.12, 0})}};
  const Flyer flyers[] = {{Sphere{0.2}, 0.2},
                          {must(Compound::of(balls)), 0.25},
                          {must(Compound::of(boxes)), 0.231},
                          {Capsule{0.1, 0.2}, 0.3},
                          {Box{{0.1, 0.15, 0.2}}, 0.27},
                          {Cylinder{0.1, 0.2}, 0.224},
                          {Cone{0.15, 0.2}, 0.4}};
  Random random(2104);
  int manifolds = 0, steps = 0;
  for (const Flyer& a : flyers) {
    for (const Flyer& b : flyers) {
      for (const double speed : {1.0, 10.0, 50.0}) {
        World world({.gravity = {}});
        BodyId bodies[2];
        Vec3 before[2];
        for (const int k : {0, 1}) {
          const double side = k == 0 ? -1.0 : 1.0;
          const Vec3 turning = random.in_cube(5.0);
          const Mat3 R = random.rotation();
          bodies[k] = add_dynamic(
              world, {.shape = k == 0 ? a.shape : b.shape,
                      .pose = SE3(R, {-side, 0.5 * (a.radius + b.radius + 0.02) * side, 0})});
          must(world.set_velocity_world(bodies[k], {{0.5 * side * speed, 0, 0}, turning}));
          before[k] = world.velocity_world(bodies[k]).linear;
        }
        for (double time = 0.0; time < 4.0 / speed; time += kFrame, ++steps) {
          must(world.step(kFrame));
          manifolds += static_cast<int>(world.counters().manifolds);
        }
        for (const int k : {0, 1})
          EXPECT_LT(norm(world.velocity_world(bodies[k]).linear - before[k]), 1e-6)
              << speed << " m/s";
      }
    }
  }
  EXPECT_LT(manifolds, 0.01 * steps);
}

// Two boxes fly side by side and tumble. Their bounding spheres, which do not rotate, stay apart,
// so that there is nothing to test.
TEST(SearchMargin, WhatFliesSideBySideIsSeldomTested) {
  for (const double speed : {0.0, 1.0, 20.0}) {
    for (const double drift : {0.0, 0.05}) {
      World world({.gravity = {}});
      const Box box{{0.1, 0.15, 0.2}};
      const double gap = 0.03, side = norm(box.half_extents) + 0.5 * gap;
      for (const double y : {-side, side}) {
        const BodyId body = add_dynamic(world, {.shape = box, .pose = SE3(Vec3{0, y, 0})});
        const Vec3 turning = y < 0 ? Vec3{8, 5, -3} : Vec3{-2, 6, 7};
        must(world.set_velocity_world(body, {{speed + (y < 0 ? drift : 0.0), 0, 0}, turning}));
      }
      std::uint32_t tests = 0, together = 0;
      for (int i = 0; i < 120; ++i) {
        must(world.step(kFrame));
        tests += world.counters().narrow_phase_pairs;
        together += world.counters().pairs;
      }
      EXPECT_GT(together, 60u) << speed << " m/s, " << drift;
      EXPECT_LT(tests, 12u) << speed << " m/s, " << drift;
    }
  }
}

// Two rows fly past each other, straight and without contact: no clearance is used up.
TEST(SearchMargin, WhatHasFlownPastIsNoPairAnyMore) {
  World world({.gravity = {}});
  for (int k = 0; k < 40; ++k) {
    const double side = k % 2 == 0 ? 1.0 : -1.0;
    const int at = k / 2;
    const BodyId body = add_dynamic(world, {.shape = Box{{0.1, 0.1, 0.1}},
                                            .pose = SE3(Vec3{side * (at + 0.5), 0.18 * side, 0})});
    must(world.set_velocity_world(body, {{-6.0 * side, 0, 0}, {0, 0, 12}}));
  }
  std::uint32_t most = 0;
  for (int i = 0; i < 120; ++i) {
    must(world.step(kFrame));
    most = std::max(most, world.counters().pairs);
  }
  EXPECT_GT(most, 20u);
  EXPECT_LE(world.counters().pairs, 2u);
}

// Pairs of compounds that touched have moved apart, corner to corner: their bounds still overlap.
TEST(SearchMargin, CompoundsThatTouchedMayBeFarFromIt) {
  const std::vector<CompoundPart> halves{{Box{{0.2, 0.2, 0.1}}, SE3(Vec3{0, 0, 0.1})},
                                         {Box{{0.2, 0.2, 0.1}}, SE3(Vec3{0, 0, -0.1})}};
  const Shape cube = must(Compound::of(halves));
  const Mat3 R = Exp(Vec3{0, 0, kPi / 4}).matrix();
  World world({.gravity = {}});
  std::vector<BodyId> moved;
  const auto beside = [](std::size_t k, const Vec3& by) {
    return Vec3{3.0 * static_cast<double>(k), 0, 0} + by;
  };
  for (std::size_t k = 0; k < 4; ++k) {
    add_dynamic(world, {.shape = cube, .pose = SE3(R, beside(k, {}))});
    moved.push_back(
        add_dynamic(world, {.shape = cube, .pose = SE3(R, beside(k, {0.282, 0.282, 0.05}))}));
  }
  must(world.step(kFrame));
  EXPECT_GE(world.counters().contacts, 8u);
  for (std::size_t k = 0; k < moved.size(); ++k) {
    must(world.set_pose(moved[k], SE3(R, beside(k, {0.56, 0.45, 0.05}))));
    must(world.set_velocity_world(moved[k], {{5, -5, 0}, {}}));
  }
  must(world.step(kFrame));
  EXPECT_EQ(world.counters().contacts, 0u);
  EXPECT_EQ(world.counters().pairs, 4u);
  EXPECT_EQ(world.counters().narrow_phase_pairs, 4u);
  for (const BodyId body : moved)
    EXPECT_LT(norm(world.velocity_world(body).linear - Vec3{5, -5, 0}), 1e-6);
}

// Balls that are off their bodies' centres of mass swing around them, past each other or into each
// other. Meanwhile some get another velocity.
TEST(SearchMargin, BallsThatSwingOffTheirCentresMeet) {
  constexpr double kRadius = 0.1;
  Random random(2105);
  int met = 0;
  double deepest = 0.0;
  for (int i = 0; i < 400; ++i) {
    World world({.gravity = {}});
    BodyId bodies[2];
    Vec3 arms[2];
    for (const int k : {0, 1}) {
      BodyDesc desc;
      const Vec3 at = random.in_cube(0.8);
      const Mat3 R = random.rotation();
      arms[k] = random.uniform(0.0, 0.4) * random.direction();
      const double side = k == 0 ? -1.0 : 1.0;
      desc.T_world_body = SE3(R, at + Vec3{1.5 * side, 0, 0});
      desc.inertia = solid_inertia(Sphere{0.5}, 10.0);
      bodies[k] = must(world.create_body(desc));
      ColliderDesc collider;
      collider.shape = Sphere{kRadius};
      collider.T_body_shape = SE3(arms[k]);
      must(world.add_collider(bodies[k], collider));
      const Vec3 linear = Vec3{-3.0 * side, 0, 0} + random.in_cube(1.0);
      const Vec3 angular = random.in_cube(10.0);
      must(world.set_velocity_world(bodies[k], {linear, angular}));
    }
    const int turns = static_cast<int>(random.uniform(10.0, 50.0));
    bool touched = false;
    for (int step = 0; step < 90; ++step) {
      if (step == turns) {  // back to the other
        const Vec3 between = world.pose(bodies[1]).position() - world.pose(bodies[0]).position();
        must(world.set_velocity_world(bodies[0], {4.0 * between, random.in_cube(10.0)}));
      }
      must(world.step(kFrame));
      touched = touched || world.counters().manifolds > 0;
      const Vec3 between = world.pose(bodies[1]) * arms[1] - world.pose(bodies[0]) * arms[0];
      deepest = std::max(deepest, 2.0 * kRadius - norm(between));
    }
    met += touched ? 1 : 0;
  }
  EXPECT_GT(met, 50);
  EXPECT_LT(deepest, 0.02);
}

// A body that leaves the range of positions stops where the step began. What comes near it
// afterwards touches it there.
TEST(SearchMargin, ABodyThatWasStoppedIsWhereItStopped) {
  for (const double speed : {20.0, 5.0}) {
    for (const double gap : {0.3, 0.45, 0.6, 0.8}) {
      WorldDesc desc;
      desc.gravity = {};
      World world(desc);
      const double at = 1e9 - 0.3;
      add_dynamic(
          world,
          {.shape = Sphere{0.05}, .pose = SE3(Vec3{at, 0, 0}), .velocity = {{}, {speed, 0, 0}}});
      const double off = std::sqrt(0.5) * (gap + 0.1);
      const BodyId plate =
          add_kinematic(world, Box{{0.05, 2.0, 0.5}}, {}, {},
                        SE3(Exp(Vec3{0, 0, kPi / 4}).matrix(), Vec3{at - off, -off, 0}));
      bool touches = false;
      for (int k = 0; k < 150 && !touches; ++k) {
        if (k == 3) must(world.set_velocity(plate, {{}, {0.5, 0, 0}}));
        must(world.step(kFrame));
        touches = !world.contact_events().empty();
      }
      EXPECT_TRUE(touches) << speed << " m/s, " << gap << " m";
    }
  }
}

}  // namespace
}  // namespace vp::test
