#include "scenes/scene_world.h"

#include <gtest/gtest.h>

#include "scenes/catalogue.h"
#include "scenes/measure.h"

namespace scenes {
namespace {

SceneWorld world_of(Scene scene) {
  auto made = SceneWorld::create(std::move(scene));
  if (!made) ADD_FAILURE() << made.error().message;
  return std::move(made.value());
}

TEST(SceneWorld, BeginsAsTheSceneSays) {
  for (const Entry& entry : catalogue()) {
    const Scene scene = make_scene(entry.name).value();
    if (scene.bodies.size() > 2000) continue;
    const SceneWorld world = world_of(scene);
    ASSERT_EQ(world.bodies().size(), scene.bodies.size()) << entry.name;
    const auto poses = world.poses();
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const vp::SE3& expected = scene.bodies[i].T_world_body;
      if (!exists(scene.bodies[i], 0.0)) continue;
      // A world may store a rotation in another form.
      ASSERT_LT(norm(poses[i].position() - expected.position()), 1e-15) << entry.name;
      ASSERT_LT(norm(poses[i].rotation().cx - expected.rotation().cx), 1e-14) << entry.name;
      const vp::se3 V = world.world().velocity(world.bodies()[i]);
      ASSERT_LT(norm(poses[i].rotate(V.w) - scene.bodies[i].spin), 1e-14) << entry.name;
    }
  }
}

TEST(SceneWorld, FallsWithTheScenesGravity) {
  Scene scene = bounce();
  scene.gravity = {0.0, 0.0, -4.0};
  SceneWorld world = world_of(scene);
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(world.step(0.001).has_value());
  EXPECT_NEAR(world.world().velocity(world.bodies()[1]).v.z, -0.4, 1e-12);
  EXPECT_NEAR(world.time(), 0.1, 1e-12);
}

TEST(SceneWorld, LaunchesWhenItIsTime) {
  Scene scene = wall(3);
  const int ball = scene.launches[0].body;
  scene.launches[0].time = 0.05;
  for (const double dt : {0.01, 0.001, 1.0 / 240.0}) {
    SceneWorld world = world_of(scene);
    double launched = -1.0;
    while (world.time() < 0.1 && launched < 0.0) {
      const double before = world.time();
      ASSERT_TRUE(world.step(dt).has_value());
      if (norm(world.world().velocity(world.bodies()[ball]).v) > 40.0) launched = before;
    }
    EXPECT_NEAR(launched, 0.05, 0.5 * dt + 1e-9) << dt;
  }
}

Body ball_from(double from, double until, double x) {
  Body ball;
  ball.T_world_body = SE3(Vec3{x, 0.0, 5.0});
  ball.parts.push_back({Sphere{0.1}, SE3{}, 1000.0, {}});
  ball.from = from;
  ball.until = until;
  return ball;
}

TEST(SceneWorld, HasBodiesAndTheirJointsWhileTheyExist) {
  Scene scene;
  scene.bodies = {ball_from(0.0, Joint::kNever, 0.0), ball_from(0.1, 0.3, 1.0),
                  ball_from(0.2, Joint::kNever, 2.0), ball_from(0.0, 0.25, 3.0)};
  const auto joint = [](int a, int b) {
    return Joint{Joint::Kind::ball, a, b, SE3(Vec3{0.5, 0.0, 0.0}), SE3(Vec3{-0.5, 0.0, 0.0})};
  };
  scene.joints = {joint(0, 1), joint(1, 2)};
  scene.launches = {{0.05, 1, {9.0, 9.0, 9.0}, {}}};  // of a body that does not exist yet
  SceneWorld world = world_of(scene);
  const double dt = 0.01;
  for (int i = 0; i < 40; ++i) {
    const double middle = world.time() + 0.5 * dt;
    ASSERT_TRUE(world.step(dt).has_value());
    const auto poses = world.poses();
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
      ASSERT_EQ(static_cast<bool>(world.bodies()[b]), exists(scene.bodies[b], middle)) << i;
      if (world.bodies()[b]) continue;
      EXPECT_EQ(poses[b].position(), scene.bodies[b].T_world_body.position());
    }
  }
  EXPECT_EQ(world.happened(), 9u);
  // The body created at 0.2 s has fallen, and has had no joint since 0.3 s.
  EXPECT_EQ(measure(scene, world.poses(), world.time()).of, 2);
}

TEST(SceneWorld, TakesAKinematicBodyAlongAPath) {
  Scene scene = make_scene("shaken_pyramid").value();
  const auto table = static_cast<std::size_t>(scene.launches[0].body);
  const SE3 start = scene.bodies[table].T_world_body;
  scene.bodies.resize(table + 1);
  SceneWorld world = world_of(scene);
  double farthest = 0.0;
  for (int i = 1; i <= 120; ++i) {
    ASSERT_TRUE(world.step(1.0 / 60.0).has_value());
    const Vec3 moved = world.poses()[table].position() - start.position();
    EXPECT_NEAR(moved.x, 0.005 * vp::sin_cos(2.0 * vp::kPi * 3.0 * i / 60.0).sin, 1e-9) << i;
    farthest = std::max(farthest, moved.x);
  }
  EXPECT_NEAR(farthest, 0.005, 1e-6);
}

// Joints hold: the origins of their frames stay together at every step.
TEST(SceneWorld, HoldsJointsTogether) {
  struct Case {
    const char* scene;
    double rate, gap;  // [Hz], [m]
  };
  for (const Case& c : {Case{"plumb", 1000, 5e-3}, Case{"catenary", 1000, 1e-3}}) {
    SceneWorld world = world_of(make_scene(c.scene).value());
    for (int i = 0; i < 500; ++i) ASSERT_TRUE(world.step(1.0 / c.rate).has_value());
    const double gap = measure(world.scene(), world.poses()).gap;
    std::printf("%s at %.0f Hz: gap %.4f mm\n", c.scene, c.rate, 1e3 * gap);
    EXPECT_LT(gap, c.gap) << c.scene;
  }
}

TEST(SceneWorld, GivesBackWhatTheWorldRefuses) {
  Scene scene = bounce();
  std::get<Sphere>(scene.bodies[3].parts[0].shape).radius = -1.0;
  const auto made = SceneWorld::create(scene);
  ASSERT_FALSE(made.has_value());
  EXPECT_EQ(made.error().code, vp::Errc::invalid_argument);
  SceneWorld world = world_of(bounce());
  EXPECT_FALSE(world.step(-1.0).has_value());
  EXPECT_EQ(world.time(), 0.0);
}

// A second of a tower at 1 kHz: the scene, its world and its measures together.
TEST(SceneWorld, HoldsATower) {
  SceneWorld world = world_of(make_scene("tower10").value());
  for (int i = 0; i < 1000; ++i) ASSERT_TRUE(world.step(0.001).has_value());
  const Standing standing = measure(world.scene(), world.poses());
  EXPECT_EQ(standing.in_place, 10);
  EXPECT_LT(standing.penetration, 1e-3);
  EXPECT_LT(standing.drift, 1e-3);
}

}  // namespace
}  // namespace scenes
