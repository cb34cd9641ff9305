#include "core/orbit_camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/vec4.hpp>

#include "core/step_times.h"

namespace sandbox {
namespace {

constexpr glm::ivec2 kScreen{1280, 720};

// Position of a point in the picture, [-1, 1] on both axes.
glm::vec3 projected(const OrbitCamera& camera, const vp::Vec3& p, const glm::ivec2& screen) {
  const vp::Vec3 q = p - camera.target();
  const glm::vec4 clip =
      camera.projection(screen) * camera.view() *
      glm::vec4(static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z), 1.0f);
  return glm::vec3(clip) / clip.w;
}

TEST(OrbitCamera, ShowsAllThatItIsFittedToAndNoMoreThanThat) {
  for (const glm::ivec2 screen : {glm::ivec2(1280, 720), glm::ivec2(400, 900)}) {
    for (const double covered : {0.0, 0.25}) {
      for (const double yaw : {-2.0, 0.3, 3.0}) {
        OrbitCamera camera;
        camera.leave_free(covered);
        camera.look_from(yaw, 0.5);
        const vp::Vec3 low{-3, 100, 2}, high{9, 104, 7};
        camera.fit(low, high, screen);
        float max = 0.0f;
        for (int corner = 0; corner < 8; ++corner) {
          const glm::vec3 p =
              projected(camera,
                        {(corner & 1) != 0 ? low.x : high.x, (corner & 2) != 0 ? low.y : high.y,
                         (corner & 4) != 0 ? low.z : high.z},
                        screen);
          const auto c = static_cast<float>(covered);
          const float x = (p.x - c) / (1.0f - c);  // in the free part
          max = std::max({max, std::abs(x), std::abs(p.y)});
        }
        EXPECT_LT(max, 1.0f) << screen.x << " " << covered << " " << yaw;
        EXPECT_GT(max, 0.9f) << screen.x << " " << covered << " " << yaw;
      }
    }
  }
}

TEST(OrbitCamera, ARayThroughAPixelMeetsWhatIsSeenThere) {
  OrbitCamera camera;
  camera.leave_free(0.2);
  camera.fit({-1, -2, 0}, {4, 3, 5}, kScreen);
  for (const glm::dvec2 pixel : {glm::dvec2(640, 360), glm::dvec2(10, 700), glm::dvec2(1200, 33)}) {
    const Ray ray = camera.ray(pixel, kScreen);
    EXPECT_NEAR(norm(ray.direction), 1.0, 1e-12);
    const glm::vec3 p = projected(camera, ray.origin + 20.0 * ray.direction, kScreen);
    EXPECT_NEAR((p.x + 1.0) * 0.5 * kScreen.x, pixel.x, 0.01);
    EXPECT_NEAR((1.0 - p.y) * 0.5 * kScreen.y, pixel.y, 0.01);
  }
}

TEST(OrbitCamera, PannedWhatLiesAsDeepAsTheTargetKeepsToThePointer) {
  OrbitCamera camera;
  camera.fit({-1, -1, 0}, {1, 1, 2}, kScreen);
  const vp::Vec3 point = camera.target();
  const glm::vec3 before = projected(camera, point, kScreen);
  camera.pan({30, -20}, kScreen);
  const glm::vec3 after = projected(camera, point, kScreen);
  EXPECT_NEAR(0.5f * (after.x - before.x) * kScreen.x, 30.0f, 0.01f);
  EXPECT_NEAR(-0.5f * (after.y - before.y) * kScreen.y, -20.0f, 0.01f);
}

TEST(OrbitCamera, NeverTurnsOverItsHeadNorZoomsThroughItsTarget) {
  OrbitCamera camera;
  camera.fit({-1, -1, 0}, {1, 1, 2}, kScreen);
  for (int i = 0; i < 1000; ++i) {
    camera.orbit({3.0, 50.0});
    camera.zoom(1.0);
  }
  EXPECT_LT(camera.forward().z, -0.99);
  EXPECT_GT(camera.forward().z, -1.0);
  EXPECT_GT(camera.distance(), 0.0);
  for (int i = 0; i < 5000; ++i) camera.zoom(-1.0);
  EXPECT_TRUE(std::isfinite(camera.distance()));
  EXPECT_NEAR(norm(camera.eye() - camera.target()), camera.distance(), 1e-9 * camera.distance());
}

TEST(StepTimes, FiguresAreOfTheLastOnesByRank) {
  StepTimes times(100);
  EXPECT_EQ(times.statistics().median, 0.0);
  for (int i = 1; i <= 250; ++i) times.add(i);
  EXPECT_EQ(times.size(), 100u);
  const StepTimes::Statistics all = times.statistics();  // of 151 .. 250
  EXPECT_EQ(all.median, 200.0);
  EXPECT_EQ(all.p99, 249.0);
  EXPECT_EQ(all.max, 250.0);
  EXPECT_EQ(times.last(3), (std::vector<double>{248, 249, 250}));
  EXPECT_EQ(times.statistics(1).p99, 250.0);
  times.clear();
  EXPECT_TRUE(times.last(3).empty());
}

}  // namespace
}  // namespace sandbox
