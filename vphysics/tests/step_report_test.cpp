// What a step reports: its stages, its counters, and each limit that it reached.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "random.h"
#include "rig.h"
#include "surfaces.h"

namespace vp::test {
namespace {

// Records "+stage" and "-stage".
class Diary final : public StageObserver {
 public:
  void begin(Stage stage) override { lines.push_back(std::string("+") + name_of(stage)); }
  void end(Stage stage) override { lines.push_back(std::string("-") + name_of(stage)); }
  std::vector<std::string> lines;
};

std::vector<std::string> each_once(std::initializer_list<Stage> stages) {
  std::vector<std::string> lines;
  for (const Stage stage : stages) {
    lines.push_back(std::string("+") + name_of(stage));
    lines.push_back(std::string("-") + name_of(stage));
  }
  return lines;
}

struct Pile {
  explicit Pile(const WorldDesc& desc = {}) : world(desc) {
    add_ground(world, {0.6, 0.3, 0.0});
    Random random(7);
    for (int i = 0; i < 12; ++i) {
      Part part{.shape = Box{{0.1, 0.15, 0.1}},
                .material = {0.6, 0.3, 0.0},
                .pose = SE3(random.rotation(), Vec3{0.05 * (i % 3), 0, 0.3 + 0.35 * i})};
      bodies.push_back(add_dynamic(world, part));
    }
  }
  World world;
  std::vector<BodyId> bodies;
};

TEST(Stages, AreToldOnceAStepInOrder) {
  Pile pile;
  const auto diary = std::make_shared<Diary>();
  pile.world.observe_stages(diary);
  for (int i = 0; i < 300; ++i) {
    diary->lines.clear();
    must(pile.world.step(0.004));
    ASSERT_EQ(diary->lines,
              each_once({Stage::prepare, Stage::broad_phase, Stage::narrow_phase,
                         Stage::contact_slots, Stage::sub_steps, Stage::report, Stage::advance}))
        << i;
  }
  add_ball(pile.world, {1, 1, 1}, {5, 0, 0}, {});
  diary->lines.clear();
  must(pile.world.step(0.004));
  EXPECT_EQ(diary->lines, each_once({Stage::prepare, Stage::broad_phase, Stage::narrow_phase,
                                     Stage::contact_slots, Stage::sub_steps, Stage::report,
                                     Stage::forces, Stage::impacts}));
  World only_a_ball;
  add_ball(only_a_ball, {0, 0, 1}, {}, {});
  only_a_ball.observe_stages(diary);
  diary->lines.clear();
  must(only_a_ball.step(0.004));
  EXPECT_EQ(diary->lines, each_once({Stage::prepare, Stage::forces, Stage::impacts}));
  pile.world.observe_stages(nullptr);
  diary->lines.clear();
  must(pile.world.step(0.004));
  EXPECT_TRUE(diary->lines.empty());
}

TEST(Stages, HaveSleepAsTheLastWhereBodiesMaySleep) {
  WorldDesc desc;
  desc.sleep_after = 0.2;
  World world(desc);
  add_ground(world, {});
  const BodyId box =
      add_dynamic(world, {.shape = Box{{0.1, 0.1, 0.1}}, .pose = SE3(Vec3{0, 0, 0.1})});
  const auto diary = std::make_shared<Diary>();
  world.observe_stages(diary);
  must(world.step(0.004));
  EXPECT_EQ(diary->lines, each_once({Stage::prepare, Stage::broad_phase, Stage::narrow_phase,
                                     Stage::contact_slots, Stage::sub_steps, Stage::report,
                                     Stage::advance, Stage::sleep}));
  for (int i = 0; i < 200; ++i) must(world.step(0.004));
  ASSERT_TRUE(world.is_asleep(box));
  diary->lines.clear();
  must(world.step(0.004));
  EXPECT_EQ(diary->lines, each_once({Stage::prepare, Stage::advance, Stage::sleep}));
}

TEST(Stages, AreWatchedWithoutChangingABit) {
  Pile watched, alone;
  watched.world.observe_stages(std::make_shared<Diary>());
  for (int i = 0; i < 200; ++i) {
    must(watched.world.step(0.004));
    must(alone.world.step(0.004));
    ASSERT_EQ(watched.world.state_hash(), alone.world.state_hash()) << i;
  }
}

std::int64_t told_ns = 0;

TEST(StageClock, AddsUpWhatItsClockSays) {
  StageClock clock([] { return told_ns; });
  for (int i = 1; i <= 3; ++i) {
    clock.begin(Stage::contact_slots);
    told_ns += 10 * i;
    clock.end(Stage::contact_slots);
    told_ns += 1000;
  }
  EXPECT_EQ(clock.total(Stage::contact_slots), 60);
  EXPECT_EQ(clock.total(Stage::sleep), 0);
  clock.clear();
  EXPECT_EQ(clock.total(Stage::contact_slots), 0);
}

// Two layers of three boxes at rest: six pairs in contact, with four points each.
TEST(Counters, OfBoxesAtRestAreThoseOfASketch) {
  World world;
  add_ground(world, {});
  for (int i = 0; i < 6; ++i) {
    add_dynamic(world, {.shape = Box{{0.1, 0.1, 0.1}},
                        .pose = SE3(Vec3{0.5 * (i % 3), 0, 0.1 + 0.2 * (i / 3)})});
  }
  for (int i = 0; i < 500; ++i) must(world.step(0.002));
  const StepCounters& c = world.counters();
  EXPECT_EQ(c.manifolds, 6u);
  EXPECT_EQ(c.contacts, 24u);
  EXPECT_EQ(c.recycled, 6u);
  EXPECT_EQ(c.narrow_phase_pairs, 0u);
  EXPECT_EQ(c.pairs, 6u);
  EXPECT_EQ(c.colours, 2u);  // box on box, box on ground
  EXPECT_EQ(c.sub_steps, 3u);
  EXPECT_EQ(c.restitution_iterations, 0u);
  EXPECT_EQ(c.awake, 6u);
  EXPECT_EQ(c.events, world.contact_events().size());
}

// --- limits

std::vector<Limit> reached_in(const StepStatus& status) {
  std::vector<Limit> out;
  std::copy_if(kLimits.begin(), kLimits.end(), std::back_inserter(out),
               [&](Limit limit) { return reached(status, limit); });
  return out;
}
std::vector<Limit> reached_by(World& world, int steps, double dt) {
  StepStatus all;
  for (int i = 0; i < steps; ++i) all |= must(world.step(dt));
  return reached_in(all);
}

TEST(Limits, EachHasASentenceOfItsOwn) {
  std::vector<std::string> sentences;
  for (const Limit limit : kLimits) sentences.emplace_back(sentence(limit));
  std::sort(sentences.begin(), sentences.end());
  EXPECT_EQ(std::unique(sentences.begin(), sentences.end()), sentences.end());
  EXPECT_GT(sentences.front().size(), 20u);
  EXPECT_TRUE(reached_in({}).empty());
}

TEST(Limits, OfADayWithoutTroubleAreNone) {
  Pile pile;
  EXPECT_TRUE(reached_by(pile.world, 500, 0.004).empty());
}

// A row of touching balls, in the reverse order of the impact's propagation: each iteration
// advances it by one ball.
TEST(Limits, BouncesThroughARowOfManyBallsAreMoreThanOneSubStepHas) {
  WorldDesc desc;
  desc.gravity = {};
  for (const int count : {10, 300}) {
    World world(desc);
    for (int i = count - 1; i >= 0; --i) {
      Part ball{.shape = Sphere{0.5},
                .material = {0.0, 1.0, 0.0},
                .pose = SE3(Vec3{1.0 * i + (i == 0 ? -0.5 : 0.0), 0, 0})};
      if (i == 0) ball.velocity = {{}, {10, 0, 0}};
      add_dynamic(world, ball);
    }
    const auto found = reached_by(world, 100, 0.002);
    if (count == 10) {
      EXPECT_TRUE(found.empty());
    } else {
      EXPECT_EQ(found, std::vector{Limit::bounces});
    }
  }
}

// A disc in a bowl of the given number of slopes touches all of them.
TEST(Limits, ManifoldsAreToldApartUpToTwelveSlopes) {
  for (const int fan : {8, 24}) {
    std::vector<Vec3> v{{0, 0, 0}};
    std::vector<TriangleMesh::Triangle> triangles;
    for (int i = 0; i <= fan; ++i) {  // a flat pyramid upside down with `fan` slopes
      const auto at = sin_cos(2.0 * kPi * i / fan);
      v.push_back({at.cos, at.sin, 0.5});
    }
    for (std::uint32_t i = 1; i <= static_cast<std::uint32_t>(fan); ++i) {
      triangles.push_back({0, i, i + 1});
    }
    World world;
    add_fixed(world, TriangleMesh::of(v, triangles).value(), {});
    add_dynamic(world, {.shape = Cylinder{0.5, 0.05}, .pose = SE3(Vec3{0, 0, 0.29})});
    const auto found = reached_by(world, 50, 0.002);
    if (fan == 8) {
      EXPECT_TRUE(found.empty()) << fan;
    } else {
      EXPECT_EQ(found, std::vector{Limit::manifolds}) << fan;
    }
  }
}

// A plate with a hundred balls on it.
TEST(Limits, ColoursAreSharedFromTheFortiethNeighbourOn) {
  for (const int along : {4, 10}) {
    World world;
    add_ground(world, {});
    add_dynamic(world, {.shape = Box{{1, 1, 0.1}}, .pose = SE3(Vec3{0, 0, 0.1})});
    for (int i = 0; i < along * along; ++i) {
      add_dynamic(world,
                  {.shape = Sphere{0.05},
                   .pose = SE3(Vec3{0.15 * (i % along) - 0.7, 0.15 * (i / along) - 0.7, 0.25})});
    }
    const auto found = reached_by(world, 20, 0.002);
    if (along == 4) {
      EXPECT_TRUE(found.empty());
    } else {
      EXPECT_EQ(found, std::vector{Limit::colours});
    }
    EXPECT_EQ(world.counters().manifolds, static_cast<std::uint32_t>(along * along + 1));
  }
}

// A cylinder deep inside another on the same axis: nearly all directions have the same depth. For a
// box in a box, the depth is exact.
TEST(Limits, DistancesAreToldWhereTheSearchIsLeftUnfinished) {
  for (const bool round : {false, true}) {
    Random random(3);
    World world;
    for (int i = 0; i < 100; ++i) {
      const SE3 T(random.rotation(), Vec3{4.0 * i, 0, 0});
      Part thin{.shape = Cylinder{0.097, 0.45}, .pose = T},
          wide{.shape = Cylinder{0.22, 0.13}, .pose = T * SE3(random.in_cube(1e-3))};
      if (!round) thin.shape = Box{{0.097, 0.097, 0.45}}, wide.shape = Box{{0.22, 0.22, 0.13}};
      add_dynamic(world, thin);
      add_dynamic(world, wide);
    }
    const auto found = reached_by(world, 1, 0.001);
    EXPECT_EQ(found, round ? std::vector{Limit::distances} : std::vector<Limit>{}) << round;
  }
}

TEST(Limits, OfTheRangeOfNumbersStopABody) {
  World world;
  const BodyId body = add_dynamic(world, {});
  must(world.set_velocity(body, {{}, {0.99e9, 0, 0}}));
  must(world.set_pose(body, SE3(Vec3{0.9999e9, 0, 0})));
  EXPECT_EQ(reached_by(world, 1, 0.1), std::vector{Limit::range});
}

}  // namespace
}  // namespace vp::test
