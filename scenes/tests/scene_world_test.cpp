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
      // A world may hold a rotation otherwise than as it was given it.
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

// Joints hold: the frames' origins stay together at every step.
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

// A second of a tower at 1 kHz: the scene, its world and the measures together.
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
