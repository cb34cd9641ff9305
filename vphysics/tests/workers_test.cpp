// A step gives the same bits with any task scheduler and any number of workers.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <barrier>
#include <thread>
#include <vector>

#include "joints_rig.h"
#include "surfaces.h"
#include "task_schedulers.h"
// The thread sanitizer does not see how Debian's oneTBB, built without it, hands tasks over.
#if defined(VP_TEST_TBB) && defined(__has_feature)
#if __has_feature(thread_sanitizer)
#undef VP_TEST_TBB
#endif
#endif
#ifdef VP_TEST_TBB
#include "vphysics/tbb_task_scheduler.h"
#endif

namespace vp::test {
namespace {

// Runs a given number of threads; each takes the next free grain.
class Threads final : public TaskScheduler {
 public:
  explicit Threads(int count) : begin_(count), end_(count) {
    for (int i = 1; i < count; ++i) {
      others_.emplace_back([this] {
        for (;;) {
          begin_.arrive_and_wait();
          if (!task_) return;
          take_parts();
          end_.arrive_and_wait();
        }
      });
    }
  }
  ~Threads() override {
    task_ = nullptr;
    begin_.arrive_and_wait();
    for (std::thread& other : others_) other.join();
  }

  void run(std::size_t count, std::size_t grain, const Task& task) override {
    next_ = 0;
    count_ = count;
    grain_ = grain;
    task_ = &task;
    begin_.arrive_and_wait();
    take_parts();
    end_.arrive_and_wait();
  }

 private:
  void take_parts() {
    for (std::size_t i = next_.fetch_add(grain_); i < count_; i = next_.fetch_add(grain_))
      (*task_)(i, std::min(count_, i + grain_));
  }

  std::barrier<> begin_, end_;
  std::atomic<std::size_t> next_{0};
  std::size_t count_ = 0, grain_ = 1;
  const Task* task_ = nullptr;
  std::vector<std::thread> others_;
};

// Dumbbells on waves.
void add_waves(World& world, const Vec3& at) {
  add_fixed(world, wave_mesh(24, 0.25, 0.1).made(), {}, SE3(at));
  const std::vector<CompoundPart> parts{{Sphere{0.08}, SE3(Vec3{0.1, 0, 0})},
                                        {Box{{0.08, 0.06, 0.05}}, SE3(Vec3{-0.1, 0, 0})}};
  const Compound dumbbell = Compound::of(parts).value();
  for (int i = 0; i < 100; ++i) {
    const int row = i / 10;
    add_dynamic(world, {.shape = dumbbell,
                        .pose = SE3(at + Vec3{0.5 * (i % 10 - 5), 0.5 * (row - 5), 0.22})});
  }
}

// Enough objects that each loop is shared: boxes and balls that fall on one another and on a belt,
// chains, dumbbells on waves, and a corner that falls asleep.
World busy_world(int region_bodies) {
  WorldDesc desc;
  desc.sleep_after = 0.05;
  desc.region_bodies = region_bodies;
  World world(desc);
  add_ground(world, {.restitution = 0.2});
  add_kinematic(world, Box{{3, 3, 0.05}}, {{0, 0, 0.1}, {0.3, 0, 0}});
  for (int i = 0; i < 26; ++i) {
    for (int j = 0; j < 26; ++j) {
      Part part{.material = {.restitution = j % 5 == 0 ? 0.5 : 0.0}};
      if ((i + j) % 4 == 0)
        part.shape = Sphere{0.1};
      else
        part.shape = Box{{0.1, 0.1, 0.1}};
      part.pose = SE3(Vec3{0.25 * (i - 13), 0.25 * (j - 13), 0.16 + 0.001 * ((7 * i + j) % 9)});
      const BodyId low = add_dynamic(world, part);
      part.pose = SE3(part.pose.position() + Vec3{0.01, 0.02, 0.24});
      const BodyId high = add_dynamic(world, part);
      if (i % 8 == 0) join(world, low, high, BallSocket{}, SE3(part.pose.position()));
    }
  }
  add_waves(world, {20.0, 0.0, 0.5});
  return world;
}

// The hashes of every tenth step.
std::vector<std::uint64_t> hashes_of(World& world, int steps, double rate) {
  std::vector<std::uint64_t> hashes;
  for (int i = 0; i < steps; ++i) {
    must(world.step(1.0 / rate));
    if (i % 10 == 9) hashes.push_back(world.state_hash());
  }
  return hashes;
}

std::vector<std::uint64_t> hashes_with(std::shared_ptr<TaskScheduler> jobs, int steps = 30,
                                       int region_bodies = 2048) {
  World world = busy_world(region_bodies);
  world.set_task_scheduler(std::move(jobs));
  return hashes_of(world, steps, 240.0);
}

class Workers : public testing::Test {
 protected:
  static void SetUpTestSuite() { alone_ = hashes_with(nullptr); }
  static std::vector<std::uint64_t> alone_;
};
std::vector<std::uint64_t> Workers::alone_;

TEST_F(Workers, MayTakeThePartsInAnyOrder) {
  const auto jobs = std::make_shared<Backwards>();
  EXPECT_EQ(hashes_with(jobs), alone_);
  EXPECT_GT(jobs->parts, 2000);  // the loops were shared
  World world = busy_world(2048);
  for (int i = 0; i < 30; ++i) must(world.step(1.0 / 240));
  EXPECT_GT(world.counters().contacts, 1000u);
}
// Fewer steps: with more threads than cores, each loop waits until all of them have run.
TEST_F(Workers, MayBeTwoThreads) {
  EXPECT_EQ(hashes_with(std::make_shared<Threads>(2), 20),
            std::vector<std::uint64_t>(alone_.begin(), alone_.begin() + 2));
}
TEST_F(Workers, MayBeFiveThreads) {
  EXPECT_EQ(hashes_with(std::make_shared<Threads>(5), 10),
            std::vector<std::uint64_t>(alone_.begin(), alone_.begin() + 1));
}
#ifdef VP_TEST_TBB
TEST_F(Workers, MayBeThoseOfOneTbb) {
  for (const int workers : {1, 2, 4}) {
    SCOPED_TRACE(workers);
    EXPECT_EQ(hashes_with(make_tbb_task_scheduler(workers)), alone_);
  }
}
#endif
// Contacts only, in regions of a few bodies that are recomputed on the way: a heap on a lift that
// rises and rotates.
std::vector<std::uint64_t> hashes_of_lift(const std::shared_ptr<TaskScheduler>& jobs) {
  WorldDesc desc;
  desc.region_bodies = 12;
  World world(desc);
  add_kinematic(world, Box{{3, 3, 0.05}}, {{0, 0, 0.3}, {0.1, 0, 0.5}});
  for (int i = 0; i < 120; ++i) {
    Part part{.shape = Box{{0.1, 0.1, 0.1}}, .material = {.restitution = i % 7 == 0 ? 0.5 : 0.0}};
    if (i % 5 == 0) part.shape = Sphere{0.1};
    const int row = i / 5, layer = i / 25;
    part.pose = SE3(Vec3{0.21 * (i % 5) + 0.01 * (i % 3), 0.21 * (row % 5), 0.2 + 0.22 * layer});
    add_dynamic(world, part);
  }
  world.set_task_scheduler(jobs);
  const std::vector<std::uint64_t> hashes = hashes_of(world, 150, 240.0);
  EXPECT_EQ(world.counters().regions, 16u);
  EXPECT_GT(world.counters().manifolds, 120u);
  return hashes;
}
// hashes_by(task scheduler) does not depend on it.
template <class F>
void expect_same_hashes(const F& hashes_by) {
  const auto alone = hashes_by(nullptr);
  EXPECT_EQ(hashes_by(std::make_shared<Backwards>()), alone);
  EXPECT_EQ(hashes_by(std::make_shared<Threads>(2)), alone);
}
TEST_F(Workers, MayTakeTheTurnsOfRegions) {
  expect_same_hashes(hashes_of_lift);
}
// Bodies that fly, so that the displacements of many restart in the same step.
std::vector<std::uint64_t> hashes_of_swarm(const std::shared_ptr<TaskScheduler>& jobs) {
  World world;
  add_ground(world, {.restitution = 0.4});
  const std::vector<CompoundPart> parts{{Sphere{0.06}, SE3(Vec3{0.06, 0, 0})},
                                        {Box{{0.06, 0.05, 0.04}}, SE3(Vec3{-0.06, 0, 0})}};
  const Compound dumbbell = Compound::of(parts).value();
  for (int i = 0; i < 400; ++i) {
    const int row = i / 8, layer = i / 64;
    Part part{.shape = Box{{0.06, 0.08, 0.1}},
              .pose = SE3(Vec3{0.3 * (i % 8), 0.3 * (row % 8), 0.3 + 0.3 * layer}),
              .velocity = {{0.1 * (i % 7), 0.2 * (i % 5), 0}, {6.0, 0, 0.3 * (i % 3)}}};
    if (i % 3 == 0) part.shape = dumbbell;
    add_dynamic(world, part);
  }
  world.set_task_scheduler(jobs);
  const std::vector<std::uint64_t> hashes = hashes_of(world, 60, 60.0);
  EXPECT_GT(world.counters().pairs, 400u);
  return hashes;
}
TEST_F(Workers, MayRestartDisplacements) {
  expect_same_hashes(hashes_of_swarm);
}
// Also with regions.
TEST_F(Workers, MayTakeRegions) {
  constexpr int kRegionBodies = 100;
  const auto alone = hashes_with(nullptr, 30, kRegionBodies);
  EXPECT_NE(alone, alone_);  // another order of solving
  EXPECT_EQ(hashes_with(std::make_shared<Backwards>(), 30, kRegionBodies), alone);
  EXPECT_EQ(hashes_with(std::make_shared<Threads>(2), 20, kRegionBodies),
            std::vector<std::uint64_t>(alone.begin(), alone.begin() + 2));
  World world = busy_world(kRegionBodies);
  must(world.step(1.0 / 240));
  EXPECT_EQ(world.counters().regions, 16u);
}
// Changed between steps of a run.
TEST_F(Workers, MayComeAndGo) {
  World world = busy_world(2048);
  for (int i = 0; i < 30; ++i) {
    world.set_task_scheduler(i % 2 == 0 ? std::make_shared<Backwards>() : nullptr);
    must(world.step(1.0 / 240));
  }
  EXPECT_EQ(world.state_hash(), alone_[2]);
}

}  // namespace
}  // namespace vp::test
