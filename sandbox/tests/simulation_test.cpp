#include "core/simulation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "app/thrown.h"
#include "clocks.h"
#include "scenes/catalogue.h"
#include "vphysics/convex_hull.h"

namespace sandbox {
namespace {

template <class T>
T must(vp::Expected<T> result) {
  if (!result) ADD_FAILURE() << result.error().message;
  return std::move(result).value();
}
void must(const vp::Expected<void>& result) {
  if (!result) ADD_FAILURE() << result.error().message;
}

Simulation opened(std::string_view scene, int rate = 1000) {
  return must(Simulation::open(scene, rate, kStopped));
}

// One ball of radius 1 m without gravity, at the origin.
constexpr double kBallMass = 1000.0 * 4.0 / 3.0 * vp::kPi;
Simulation floating_ball(int rate) {
  scenes::Scene scene;
  scene.name = "ball";
  scene.gravity = {};
  scenes::Body ball;
  ball.parts.push_back({scenes::Sphere{1.0}, {}, 1000.0, {}});
  scene.bodies.push_back(ball);
  return {must(scenes::SceneWorld::create(scene)), rate, kStopped};
}
vp::Vec3 velocity_in_world(const Simulation& simulation, vp::BodyId body) {
  return simulation.world().pose(body).rotate(simulation.world().velocity(body).v);
}

TEST(SandboxSimulation, EverySceneOpensAndSteps) {
  for (const scenes::Entry& entry : scenes::catalogue()) {
    if (entry.name == "pile10k") continue;  // like pile1120, but slow to build
    Simulation simulation = opened(entry.name, 240);
    EXPECT_EQ(simulation.scene().name, entry.name);
    EXPECT_EQ(simulation.pieces().size(), simulation.scene().bodies.size());
    for (int i = 0; i < 3; ++i) must(simulation.step());
    EXPECT_FALSE(simulation.status().non_finite) << entry.name;
    vp::Vec3 low, high;
    simulation.bounds(low, high);
    for (const Piece& piece : simulation.pieces()) {
      if (!piece.body || piece.motion != scenes::Motion::dynamic) continue;
      const vp::Vec3 p = simulation.world().pose(piece.body).position();
      EXPECT_TRUE(low.x < p.x && p.x < high.x && low.y < p.y && p.y < high.y && low.z < p.z &&
                  p.z < high.z)
          << entry.name;
    }
  }
}

TEST(SandboxSimulation, AnUnknownSceneIsToldWithAllThereAre) {
  const auto none = Simulation::open("tower of babel", 1000, kStopped);
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().message.find("tower of babel"), std::string::npos);
  for (const scenes::Entry& entry : scenes::catalogue())
    EXPECT_NE(none.error().message.find(entry.name), std::string::npos) << entry.name;
}

TEST(SandboxSimulation, BodiesThatComeAndGoAreFollowed) {
  scenes::Scene scene;
  scene.name = "two balls";
  scene.gravity = {};
  for (const double from : {0.0, 0.1}) {
    scenes::Body ball;
    ball.T_world_body = scenes::SE3(vp::Vec3{30.0 * from, 0.0, 0.0});
    ball.parts.push_back({scenes::Sphere{1.0}, {}, 1000.0, {}});
    ball.from = from;
    ball.until = from + 0.2;
    scene.bodies.push_back(ball);
  }
  Simulation simulation(must(scenes::SceneWorld::create(scene)), 100, kStopped);
  const auto there = [&](int i) {
    return static_cast<bool>(simulation.pieces()[static_cast<std::size_t>(i)].body);
  };
  EXPECT_TRUE(there(0) && !there(1));
  EXPECT_EQ(simulation.moving(), 1u);
  ASSERT_TRUE(simulation.grab({{0, 0, 9}, {0, 0, -1}}));
  for (int i = 0; i < 15; ++i) must(simulation.step());
  EXPECT_TRUE(there(0) && there(1));
  EXPECT_EQ(simulation.moving(), 2u);
  EXPECT_TRUE(simulation.grip());
  for (int i = 0; i < 10; ++i) must(simulation.step());
  EXPECT_TRUE(!there(0) && there(1));
  EXPECT_FALSE(simulation.grip());  // a removed body is not held
  for (int i = 0; i < 10; ++i) must(simulation.step());
  EXPECT_EQ(simulation.moving(), 0u);
  vp::Vec3 low, high;
  simulation.bounds(low, high);
  EXPECT_LT(low.x, high.x);
  must(simulation.reset());
  EXPECT_TRUE(there(0) && !there(1));
}

TEST(SandboxSimulation, StepsOnceWhenAskedForOne) {
  Simulation simulation = opened("tower10", 240);
  for (std::size_t i = 1; i <= 5; ++i) {
    must(simulation.step());
    EXPECT_EQ(simulation.steps(), i);
    EXPECT_EQ(simulation.times().size(), i);
    EXPECT_NEAR(simulation.time(), static_cast<double>(i) / 240.0, 1e-12);
  }
}

TEST(SandboxSimulation, StepsAsManyTimesAsTheFramesSecondsHold) {
  Simulation simulation = opened("tower10", 1000);
  // 60 frames per second, whose duration is no multiple of the step: the remainder carries over.
  for (int frame = 0; frame < 60; ++frame) must(simulation.advance(1.0 / 60.0, 1.0, 1.0));
  EXPECT_NEAR(static_cast<double>(simulation.steps()), 1000.0, 1.0);
  const std::size_t before = simulation.steps();
  for (int frame = 0; frame < 60; ++frame) must(simulation.advance(1.0 / 60.0, 0.25, 1.0));
  EXPECT_NEAR(static_cast<double>(simulation.steps() - before), 250.0, 1.0);
  simulation.set_rate(60);
  const double time = simulation.time();
  for (int frame = 0; frame < 60; ++frame) must(simulation.advance(1.0 / 60.0, 1.0, 1.0));
  EXPECT_NEAR(simulation.time() - time, 1.0, 1.5 / 60.0);
}

std::int64_t ticking_now = 0;
std::int64_t ticking_clock() {
  return ticking_now += 1'000'000;  // a millisecond for each call
}

TEST(SandboxSimulation, LetsGoOfWhatItsBudgetDoesNotHold) {
  Simulation simulation = must(Simulation::open("tower10", 1000, {ticking_clock, ticking_clock}));
  must(simulation.advance(0.1, 1.0, 0.030));
  // Called three times per step: before it, after it, and for the budget.
  EXPECT_NEAR(static_cast<double>(simulation.steps()), 10.0, 1.0);
  const std::size_t before = simulation.steps();
  must(simulation.advance(0.001, 1.0, 0.030));
  EXPECT_LE(simulation.steps() - before, 2u) << "the rest of the frame before was not let go";
  EXPECT_NEAR(simulation.times().statistics().median, 1000.0, 1e-6);  // [us]
}

TEST(SandboxSimulation, BeginsAnewToTheBit) {
  Simulation simulation = opened("dominoes");
  const auto run = [&] {
    for (int i = 0; i < 300; ++i) must(simulation.step());
    return simulation.world().state_hash();
  };
  const std::uint64_t first = run();
  const vp::Vec3 last = simulation.world().pose(simulation.pieces().back().body).position();
  ASSERT_TRUE(simulation.grab({last + vp::Vec3{0, 0, 10}, {0, 0, -1}}));
  must(simulation.reset());
  EXPECT_EQ(simulation.steps(), 0u);
  EXPECT_EQ(simulation.time(), 0.0);
  EXPECT_FALSE(simulation.grip());
  EXPECT_EQ(run(), first);
}

TEST(SandboxPicking, TakesTheFirstMovingBodyThatTheRayMeets) {
  Simulation simulation = opened("tower10");
  // From above, through the top box's centre.
  const vp::Vec3 top = simulation.world().pose(simulation.pieces().back().body).position();
  ASSERT_TRUE(simulation.grab({{top.x + 0.2, top.y + 0.1, 50.0}, {0, 0, -1}}));
  EXPECT_EQ(simulation.grip()->body, simulation.pieces().back().body);
  EXPECT_NEAR(norm(simulation.grip()->target - vp::Vec3{top.x + 0.2, top.y + 0.1, top.z + 0.5}),
              0.0, 1e-6);
  EXPECT_NEAR(norm(simulation.grip()->point_body - vp::Vec3{0.2, 0.1, 0.5}), 0.0, 1e-6);
  // The ray hits the ground, which cannot be grabbed; then the sky.
  EXPECT_FALSE(simulation.grab({{top.x + 20.0, top.y, 50.0}, {0, 0, -1}}));
  EXPECT_FALSE(simulation.grip());
  EXPECT_FALSE(simulation.grab({{top.x, top.y, 50.0}, {0, 0, 1}}));
}

TEST(SandboxPicking, DragsInThePlaneThatFacesTheEye) {
  Simulation simulation = floating_ball(1000);
  const vp::Vec3 forward{1, 0, 0};
  ASSERT_TRUE(simulation.grab({{-10, 0, 0}, forward}));
  const vp::Vec3 aside{1.0, 0.2, -0.1};
  simulation.drag({{-10, 0, 0}, (1.0 / norm(aside)) * aside}, forward);
  EXPECT_NEAR(norm(simulation.grip()->target - vp::Vec3{-1.0, 1.8, -0.9}), 0.0, 1e-9);
  const vp::Vec3 kept = simulation.grip()->target;
  simulation.drag({{-10, 0, 0}, {-1, 0, 0}}, forward);  // behind the eye: unchanged
  EXPECT_EQ(simulation.grip()->target, kept);
  simulation.let_go();
  EXPECT_FALSE(simulation.grip());
}

// Grabbed at the point closest to the eye and pulled along the line of sight, a ball is a point
// mass on a critically damped spring of 4 Hz: x = d (1 - (1 + w t) exp(-w t)).
TEST(SandboxPicking, FollowsAsACriticallyDampedSpringDoes) {
  for (const int rate : {60, 240, 1000}) {
    Simulation simulation = floating_ball(rate);
    ASSERT_TRUE(simulation.grab({{-10, 0, 0}, {1, 0, 0}}));
    simulation.drag({{-10, 0, 0}, {1, 0, 0}}, {1, 0, 0});
    const vp::BodyId ball = simulation.grip()->body;
    must(simulation.step());
    EXPECT_NEAR(norm(simulation.world().pose(ball).position()), 0.0, 1e-12) << "held where it is";

    // A plane 0.5 m farther away.
    simulation.let_go();
    Simulation pulled = floating_ball(rate);
    ASSERT_TRUE(pulled.grab({{-10, 0, 0}, {1, 0, 0}}));
    const double w = 2.0 * vp::kPi * 4.0, distance = 0.5;
    pulled.pull_to({-1.0 - distance, 0, 0});
    double worst = 0.0, overshoot = 0.0;
    for (int i = 1; i <= rate; ++i) {
      must(pulled.step());
      const double t = static_cast<double>(i) / rate;
      const double x = -pulled.world().pose(ball).position().x;
      const double expected = distance * (1.0 - (1.0 + w * t) * std::exp(-w * t));
      worst = std::max(worst, std::abs(x - expected));
      overshoot = std::max(overshoot, x - distance);
    }
    // The spring's implicit step lags by about one step at the highest speed: v dt = 0.37 w d /
    // rate.
    EXPECT_LT(worst, 1.2 * 0.37 * w * distance / rate) << rate << " Hz";
    EXPECT_LT(overshoot, 1e-3) << rate << " Hz";
    EXPECT_NEAR(-pulled.world().pose(ball).position().x, distance, 1e-3) << rate << " Hz";
    EXPECT_LT(norm(pulled.world().velocity(ball).v), 1e-3) << rate << " Hz";
  }
}

// Pulled at its side the ball rotates too, and then swings about the grabbed point without other
// damping. That point reaches its target, except for a small offset from the swing.
TEST(SandboxPicking, TheHeldPointComesToTheHandAndTheForceIsBounded) {
  constexpr double kStrongest = 60.0 * 9.81;  // [m/s^2]
  for (const int rate : {60, 240, 1000}) {
    Simulation simulation = floating_ball(rate);
    ASSERT_TRUE(simulation.grab({{-10, 0, 0}, {1, 0, 0}}));
    const vp::BodyId ball = simulation.grip()->body;
    simulation.pull_to({-1, 30, 12});
    vp::Vec3 before;
    for (int i = 0; i < 8 * rate; ++i) {
      must(simulation.step());
      const vp::Vec3 after = velocity_in_world(simulation, ball);
      ASSERT_LT(norm(after - before), 1.001 * kStrongest / rate) << rate << " Hz, step " << i;
      before = after;
    }
    const vp::Vec3 held = simulation.world().pose(ball) * simulation.grip()->point_body;
    EXPECT_LT(norm(held - vp::Vec3{-1, 30, 12}), 0.06) << rate << " Hz";  // 0.039 at 60 Hz
  }
}

TEST(SandboxPicking, OnceLetGoMomentumStaysAsItWas) {
  Simulation simulation = floating_ball(1000);
  ASSERT_TRUE(simulation.grab({{-10, 0.3, 0.2}, {1, 0, 0}}));
  const vp::BodyId ball = simulation.grip()->body;
  simulation.pull_to({0, 2, 1});
  for (int i = 0; i < 60; ++i) must(simulation.step());
  simulation.let_go();
  const vp::Vec3 v = velocity_in_world(simulation, ball);
  const vp::Vec3 spin = simulation.world().pose(ball).rotate(simulation.world().velocity(ball).w);
  EXPECT_GT(norm(v), 1.0);
  EXPECT_GT(norm(spin), 0.1);
  for (int i = 0; i < 1000; ++i) must(simulation.step());
  EXPECT_NEAR(kBallMass * norm(velocity_in_world(simulation, ball) - v), 0.0, 1e-3 * kBallMass);
  EXPECT_NEAR(
      norm(simulation.world().pose(ball).rotate(simulation.world().velocity(ball).w) - spin), 0.0,
      1e-3);
}

TEST(SandboxPicking, ABoxIsPulledOutOfATower) {
  Simulation simulation = opened("tower10");
  for (int i = 0; i < 200; ++i) must(simulation.step());
  const vp::BodyId box = simulation.pieces()[5].body;
  const vp::Vec3 middle = simulation.world().pose(box).position();
  ASSERT_TRUE(simulation.grab({{middle.x - 20, middle.y, middle.z}, {1, 0, 0}}));
  ASSERT_EQ(simulation.grip()->body, box);
  simulation.pull_to({middle.x - 5, middle.y, middle.z});
  for (int i = 0; i < 2000; ++i) must(simulation.step());
  const vp::Vec3 held = simulation.world().pose(box) * simulation.grip()->point_body;
  EXPECT_LT(norm(held - vp::Vec3{middle.x - 5, middle.y, middle.z}), 0.2);
  EXPECT_FALSE(simulation.status().non_finite);
}

TEST(SandboxThrowing, EveryKindFliesFromWhereItIsThrown) {
  for (int kind = 0; kind < static_cast<int>(kThrownNames.size()); ++kind) {
    Simulation simulation = floating_ball(1000);
    must(simulation.throw_body(thrown_shape(kind, 0.5), {0, 10, 0}, {2, 0, 0}));
    ASSERT_EQ(simulation.pieces().size(), 2u);
    const Piece& thrown = simulation.pieces().back();
    EXPECT_GT(thrown.inertia.mass(), 50.0) << kThrownNames[static_cast<std::size_t>(kind)];
    EXPECT_LT(thrown.inertia.mass(), 1000.0);
    for (int i = 0; i < 500; ++i) must(simulation.step());
    const vp::Vec3 centre = simulation.world().pose(thrown.body) * thrown.inertia.centre_of_mass();
    EXPECT_NEAR(norm(centre - vp::Vec3{1, 10, 0}), 0.0, 1e-6);
    ASSERT_TRUE(simulation.grab({centre + vp::Vec3{0, 0, 9}, {0, 0, -1}}));
    EXPECT_EQ(simulation.grip()->body, thrown.body);
  }
}

TEST(SandboxThrowing, WhatCannotBeIsRefusedAndLeavesNothing) {
  Simulation simulation = floating_ball(1000);
  const double nan = std::nan("");
  EXPECT_FALSE(simulation.throw_body(vp::Sphere{0.0}, {0, 5, 0}, {}));
  EXPECT_FALSE(simulation.throw_body(vp::Sphere{1.0}, {nan, 5, 0}, {}));
  EXPECT_FALSE(simulation.throw_body(vp::Sphere{1.0}, {0, 5, 0}, {0, nan, 0}));
  EXPECT_EQ(simulation.pieces().size(), 1u);
  must(simulation.step());
}

std::int64_t told_ns = 0;

// A clock that advances by a microsecond at each call: each stage takes one.
TEST(SandboxSimulation, TellsHowLongEachStageTakes) {
  const auto stopped = [] { return std::int64_t{0}; };
  const Simulation::Clocks ticking{stopped, stopped, [] { return told_ns += 1000; }};
  auto simulation = Simulation::open("tower10", 240, ticking).value();
  EXPECT_EQ(simulation.stage_us(vp::Stage::sub_steps), 0.0);
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(simulation.step());
  for (const vp::Stage stage : {vp::Stage::broad_phase, vp::Stage::narrow_phase,
                                vp::Stage::sub_steps, vp::Stage::advance}) {
    EXPECT_DOUBLE_EQ(simulation.stage_us(stage), 1.0) << name_of(stage);
  }
  EXPECT_EQ(simulation.stage_us(vp::Stage::impacts), 0.0);
  ASSERT_TRUE(simulation.reset());
  EXPECT_EQ(simulation.stage_us(vp::Stage::sub_steps), 0.0);
}

}  // namespace
}  // namespace sandbox
