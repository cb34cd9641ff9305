#include "scenes/touchstone.h"

#include <gtest/gtest.h>

#include "scenes/measure.h"
#include "scenes/scene_world.h"

namespace scenes {
namespace {

TEST(Touchstone, BeginsFreeAndJoined) {
  for (const Touchstone& stone : {touchstone(), joined_touchstone()}) {
    const Standing standing = measure(stone.scene, start_poses(stone.scene));
    EXPECT_LE(standing.penetration, 1e-9) << stone.scene.name;
    EXPECT_LE(standing.gap, 1e-12) << stone.scene.name;
    EXPECT_GE(stone.expectations.size(), 4u);
  }
}

// Each expected point moves, so that a body that stays at its start fails.
TEST(Touchstone, ExpectsMoreThanItTolerates) {
  for (const Touchstone& stone : {touchstone(), joined_touchstone()}) {
    const auto start = start_poses(stone.scene);
    for (const Expectation& e : stone.expectations) {
      EXPECT_GT(e.off(start), 2.0 * e.tolerance) << e.what;
    }
  }
}

TEST(Touchstone, IsMetByTheEngine) {
  for (const Touchstone& stone : {touchstone(), joined_touchstone()}) {
    for (const double rate : {240.0, 1000.0}) {
      auto world = SceneWorld::create(stone.scene);
      ASSERT_TRUE(world.has_value());
      for (int i = 0; i < static_cast<int>(rate); ++i)
        ASSERT_TRUE(world->step(1.0 / rate).has_value());
      const auto poses = world->poses();
      for (const Expectation& e : stone.expectations) {
        const double off = e.off(poses);
        std::printf("%4.0f Hz: %-40s off by %.4f m\n", rate, e.what, off);
        EXPECT_LT(off, e.tolerance) << e.what;
      }
    }
  }
}

}  // namespace
}  // namespace scenes
