// A computer player's model of its strokes, against the simulated table.
#include "../src/computer_stroke.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "../src/computer_hand.h"
#include "../src/table_world.h"
#include "bodies.h"

namespace foosball {
namespace {

constexpr int kRod = 5;  // attack of team 0
constexpr int kMan = 1;
constexpr AxisLimits kFull{112.0, 10000.0}, kSlow{45.0, 10000.0}, kPass{24.4, 10000.0};

struct Sent {
  double slope = 0.0, speed = 0.0, rise = 0.0;
};

// A stroke as the player makes it: foot drawn back, at its offset for the meeting.
class Table {
 public:
  Table(Layout layout, const CharacterBody& body) : world_(layout, {body, body}), body_(body) {}

  Meeting expect(double ahead, const AxisLimits& stroke) const {
    Meeting m{0.0, ahead, man_offset(spec(), kMan), stroke.rate};
    m.time = stroke_time(drawn(ahead), contact_swing(world_.table(), foot(), ahead), stroke);
    return m;
  }

  Sent strike(const Meeting& m, double vx, double vy, double offset, const AxisLimits& stroke) {
    const TableSpec& table = world_.table();
    for (int rod = 0; rod < kRods; ++rod) {
      if (rod != kRod) world_.set_rod(rod, {0.0, feet_up(rod), 0.0, 0.0});
    }
    HandAxis swing;
    swing.adopt(drawn(m.ahead));
    world_.set_rod(kRod, {offset, -swing.position(), 0.0, 0.0});
    // The hand moves one tick after the decision.
    const double time = m.time - kTick;
    const double r = table.ball_radius;
    world_.set_ball({vp::SE3(vp::Vec3{spec().x + m.ahead - time * vx, m.y - time * vy, r}),
                     {vx, vy, 0.0},
                     {-vy / r, vx / r, 0.0}});
    const double through = contact_swing(table, foot(), m.ahead) + 0.2;
    for (int tick = 0; tick < 150; ++tick) {
      if (swing.position() < through) {
        swing.swing(2.0, stroke);
      } else {
        swing.brake(stroke);
      }
      for (int rod = 0; rod < kRods; ++rod) {
        if (rod != kRod) world_.drive(rod, {0.0, feet_up(rod), 0.0, 0.0, true});
      }
      world_.drive(kRod, {offset, -swing.position(), 0.0, -swing.rate(), true});
      world_.step();
      const BallState& ball = world_.ball();
      if (ball.pose.position().x - spec().x < 0.11) continue;
      return {ball.velocity.y / ball.velocity.x, ball.velocity.x, ball.velocity.z};
    }
    return {};
  }

  Foot foot() const { return foot_of(body_); }
  const TableSpec& spec_of_table() const { return world_.table(); }

 private:
  const RodSpec& spec() const { return world_.table().rods[kRod]; }
  double feet_up(int rod) const { return -1.5 * attack_sign(world_.table().rods[rod].team); }
  double drawn(double ahead) const {
    return ahead < 0.5 * world_.table().ball_radius ? -1.25 : -0.95;
  }

  TableWorld world_;
  CharacterBody body_;
};

CharacterBody feet(double width, double depth) {
  CharacterBody body;
  body.foot_width = width;
  body.foot_depth = depth;
  return body;
}

class ComputerStroke : public testing::TestWithParam<Layout> {};
INSTANTIATE_TEST_SUITE_P(Layouts, ComputerStroke,
                         testing::Values(Layout::paper, Layout::tournament));

// Balls that roll along the rod and perpendicular to it, behind and ahead of the axis.
TEST_P(ComputerStroke, SendsTheBallWhereItIsAimed) {
  for (const CharacterBody& body : {feet(0.024, 0.020), feet(0.036, 0.020), feet(0.024, 0.014)}) {
    Table table(GetParam(), body);
    std::vector<double> errors;
    for (const AxisLimits& stroke : {kFull, kSlow, kPass}) {
      // Passes only use a ball that is almost at rest and will not hop.
      const bool passes = stroke.rate == kPass.rate;
      const double across = passes ? 0.05 : 0.2, along = passes ? 0.2 : 0.4;
      for (const double ahead : {-0.015, 0.005, 0.02, 0.035, 0.045}) {
        for (const double vx : {-across, across}) {
          for (const double vy : {-along, 0.0, 0.15}) {
            for (const double slope : {-0.6, -0.1, 0.0, 0.3}) {
              const Meeting m = table.expect(ahead, stroke);
              if (passes && lifts_ball(table.foot(), table.spec_of_table(), m)) continue;
              const double natural = natural_slope(table.foot(), table.spec_of_table(), m, vy);
              const double offset =
                  foot_offset(table.foot(), table.spec_of_table(), m, slope - natural);
              const Sent sent = table.strike(m, vx, vy, offset, stroke);
              const std::string what = "foot " + std::to_string(body.foot_width) + ", depth " +
                                       std::to_string(body.foot_depth) + ", rate " +
                                       std::to_string(stroke.rate) + ", ahead " +
                                       std::to_string(ahead) + ", v " + std::to_string(vx) + " " +
                                       std::to_string(vy) + ", slope " + std::to_string(slope);
              EXPECT_GT(sent.speed, 0.5) << what << ": missed";
              EXPECT_NEAR(sent.slope, slope, 0.13) << what;
              errors.push_back(std::fabs(sent.slope - slope));
            }
          }
        }
      }
    }
    std::sort(errors.begin(), errors.end());
    const auto at = [&](double share) {
      return errors[static_cast<std::size_t>(share * static_cast<double>(errors.size() - 1))];
    };
    std::printf("slope off by %.4f (half of %zu), %.4f (90 %%), %.4f (most)\n", at(0.5),
                errors.size(), at(0.9), at(1.0));
    EXPECT_LT(at(0.5), 0.012);
    EXPECT_LT(at(0.9), 0.05);
  }
}

TEST_P(ComputerStroke, KnowsWhichBallsHopAndHowFastTheyGo) {
  Table table(GetParam(), CharacterBody{});
  for (const double ahead : {-0.01, 0.005, 0.02, 0.026, 0.035, 0.045}) {
    const Meeting m = table.expect(ahead, kFull);
    const Sent sent = table.strike(m, 0.0, 0.0, 0.0, kFull);
    EXPECT_EQ(lifts_ball(table.foot(), table.spec_of_table(), m), sent.rise > 0.5) << ahead;
    const double speed = stroke_speed(table.foot(), table.spec_of_table(), m);
    EXPECT_NEAR(sent.speed / speed, 1.0, 0.13) << ahead;
  }
}

}  // namespace
}  // namespace foosball
