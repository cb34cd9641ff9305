// A ball at up to 25 m/s never passes through a man, a wall or the field. The seeds are shards:
// each is a test, so that they run in parallel.
//
// SF_SHOTS=N: total number of shots of all shards. A million take three minutes on one core:
//     SF_SHOTS=1000000 build/release/bin/foosball_many_shots_test
#include "shots.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

namespace foosball {
namespace {

// Shots of one test program: 100,000 over the ten seeds in the release build; 2,000 in the fast
// build, which also runs under the sanitizers.
#ifdef SF_MANY_SHOTS
constexpr int kShots = 100000;
#else
constexpr int kShots = 2000;
#endif
constexpr int kShards = 10;

int shots_of_a_shard() {
  const char* wanted = std::getenv("SF_SHOTS");
  return std::max(kShards, wanted ? std::atoi(wanted) : kShots) / kShards;
}

class Shots : public testing::TestWithParam<int> {};

TEST_P(Shots, NoneAtUpTo25MetresASecondPassesThroughAManAWallOrTheField) {
  const int seed = GetParam();
  const Layout layout = seed % 2 == 0 ? Layout::paper : Layout::tournament;
  ShotGallery gallery(layout, static_cast<std::uint64_t>(seed));
  const int shots = shots_of_a_shard();
  gallery.shoot(shots);
  const ShotsReport& r = gallery.report();
  std::printf(
      "%d shots, %ld ticks: %ld hits on men, %ld on table; %ld over the wall; deepest in a man "
      "%.2f mm, in the table %.2f mm; %ld steps held, %.2f ms in all\n",
      r.shots, r.ticks, r.man_hits, r.table_hits, r.over_the_wall, 1e3 * r.deepest_in_man,
      1e3 * r.deepest_in_table, r.held_steps, 1e3 * r.held_seconds);
  EXPECT_EQ(r.shots, shots);
  EXPECT_GT(r.man_hits, r.shots / 4) << "shots that hit nothing prove nothing";
  EXPECT_GT(r.table_hits, r.shots / 4);
  EXPECT_EQ(r.through_a_man, 0);
  EXPECT_EQ(r.outside, 0);
  EXPECT_LT(r.deepest_in_man, 0.002);
  EXPECT_LT(r.deepest_in_table, 0.002);
}

INSTANTIATE_TEST_SUITE_P(Seeds, Shots, testing::Range(0, kShards));

// The check must detect errors: a ball that jumps through a man, and one inside his foot.
TEST(ShotsJudge, FindsABallThatWentThrough) {
  const vp::Vec3 half{0.010, 0.012, 0.012};
  EXPECT_TRUE(ShotGallery::crosses({-0.03, 0.0, 0.0}, {0.03, 0.001, 0.0}, half));
  EXPECT_FALSE(ShotGallery::crosses({-0.03, 0.02, 0.0}, {0.03, 0.02, 0.0}, half));
  EXPECT_FALSE(ShotGallery::crosses({-0.03, 0.0, 0.0}, {-0.02, 0.0, 0.0}, half));
  EXPECT_NEAR(ShotGallery::distance({0.020, 0.0, 0.0}, half), 0.010, 1e-12);
  EXPECT_NEAR(ShotGallery::distance({0.013, 0.016, 0.0}, half), 0.005, 1e-12);
  EXPECT_NEAR(ShotGallery::distance({0.008, 0.0, 0.0}, half), -0.002, 1e-12);
}

}  // namespace
}  // namespace foosball
