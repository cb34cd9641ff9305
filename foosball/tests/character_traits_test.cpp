// The differences between the built-in characters, measured on the table. It prints the table of
// docs/characters.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "../src/table_world.h"
#include "bodies.h"

namespace foosball {
namespace {

constexpr int kRod = 5;  // team 0's front row, in both layouts

struct Strike {
  double speed = 0.0;   // of the ball, 20 ms after the hit [m/s]
  double height = 0.0;  // maximum height of its underside in 300 ms [m]
};

// The foot strikes at foot_speed; the ball lies in front of it.
Strike strike(const CharacterBody& body, double foot_speed) {
  TableWorld world(Layout::tournament, {body, body});
  const TableSpec& table = world.table();
  const RodSpec& spec = table.rods[kRod];
  const double forward = attack_sign(spec.team), rate = foot_speed / body.foot_reach;
  double angle = forward * 1.1;
  world.set_rod(kRod, {0.0, angle, 0.0, -forward * rate});
  world.set_ball({spec.x + forward * 0.034, man_offset(spec, spec.men / 2), table.ball_radius}, {});
  Strike result;
  int since = -1;  // the hit [ticks]
  for (int tick = 0; tick < 360; ++tick) {
    if (since < 0) angle = std::max(forward * angle - rate * kTick, -1.0) * forward;
    world.drive(kRod, {0.0, angle, 0.0, since < 0 ? -forward * rate : 0.0, true});
    world.step();
    const BallState ball = world.ball();
    if (since < 0 && vp::norm(ball.velocity) > 0.5) since = 0;
    if (since < 0) continue;
    if (++since == 20) result.speed = vp::norm(ball.velocity);
    const vp::Vec3 at = ball.pose.position();
    if (std::fabs(at.x) < 0.5 * table.length)
      result.height = std::max(result.height, at.z - table.ball_radius);
  }
  return result;
}

// A ball at 4 m/s hits a man who stands still: ratio of its speed 30 ms later to that before.
double returned(const CharacterBody& body) {
  TableWorld world(Layout::tournament, {body, body});
  const RodSpec& spec = world.table().rods[kRod];
  const double forward = attack_sign(spec.team);
  world.set_ball(
      {spec.x + forward * 0.08, man_offset(spec, spec.men / 2), world.table().ball_radius},
      {-forward * 4.0, 0.0, 0.0});
  for (int tick = 0; tick < 50; ++tick) {
    world.drive(kRod, {0.0, 0.0, 0.0, 0.0, true});
    world.step();
  }
  return std::max(0.0, forward * world.ball().velocity.x) / 4.0;
}

// Time for a row to slide by 80 mm [s].
double slide_time(const CharacterBody& body) {
  TableWorld world(Layout::tournament, {body, body});
  int tick = 0;
  while (tick < 1000 && std::fabs(world.rod(kRod).slide - 0.08) > 0.002) {
    world.drive(kRod, {0.08, 0.0, 0.0, 0.0, true});
    world.step();
    ++tick;
  }
  return tick * kTick;
}

TEST(Characters, AreEachFirstAtWhatTheyAreKnownFor) {
  enum { kTall, kAverage, kSmall, kSoft, kHeavy, kJumper };
  std::vector<double> shot, hop, kept, aside, foot;
  std::printf("| character | shot | hop of a soft shot | a still man returns | 80 mm aside |\n");
  for (const Character& c : built_in_characters()) {
    shot.push_back(strike(c.body, 6.0).speed);
    hop.push_back(strike(c.body, 2.0).height);
    kept.push_back(returned(c.body));
    aside.push_back(slide_time(c.body));
    foot.push_back(c.body.foot_width + c.body.torso_width);
    std::printf("| %s | %.1f m/s | %.0f mm | %.0f %% | %.0f ms |\n", c.name.c_str(), shot.back(),
                1e3 * hop.back(), 100.0 * kept.back(), 1e3 * aside.back());
  }
  ASSERT_EQ(shot.size(), 6u);
  const auto largest = [](const std::vector<double>& v) {
    return std::max_element(v.begin(), v.end()) - v.begin();
  };
  const auto min = [](const std::vector<double>& v) {
    return std::min_element(v.begin(), v.end()) - v.begin();
  };
  EXPECT_EQ(largest(shot), kHeavy);
  EXPECT_EQ(largest(aside), kHeavy) << "and pays for it";
  EXPECT_GT(aside[kHeavy], 1.5 * aside[kAverage]);
  EXPECT_GT(shot[kTall], 1.05 * shot[kAverage]);
  EXPECT_EQ(min(foot), kTall) << "and lets more through";
  EXPECT_EQ(largest(foot), kSmall);
  EXPECT_LT(shot[kSmall], 0.95 * shot[kAverage]);
  EXPECT_EQ(min(kept), kSoft);
  EXPECT_EQ(largest(hop), kJumper);
  EXPECT_GT(hop[kJumper], 1.5 * hop[kAverage]);
}

}  // namespace
}  // namespace foosball
