// The quality of play is 1 for an ideal game, and each part decreases separately.
#include "foosball/playability.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace foosball {
namespace {

// Ten ideal matches of three minutes each.
Statistics ideal() {
  Statistics s;
  constexpr std::uint64_t kMinute = 60'000;
  s.play_ticks = 30 * kMinute;
  s.ball_ticks = 28 * kMinute;
  s.wins = {5, 5};
  s.unreachable_ticks = s.ball_ticks / 25;
  s.still_ticks = s.ball_ticks / 100;
  s.dead_balls = 3;
  s.lead_changes = 12;
  s.shots_on_target = {100, 100};
  s.saves = {50, 50};
  for (int rally = 0; rally < 100; ++rally) s.rally.add(24.0);
  return s;
}

TEST(Playability, OfPlayAsItIsMeantToBeIsOne) {
  const Playability p = playability_of(ideal());
  for (const double part : {p.rallies, p.saves, p.reach, p.surprise, p.length, p.flow, p.total}) {
    EXPECT_NEAR(part, 1.0, 1e-12);
  }
}

TEST(Playability, IsNothingWithoutAMinuteOfPlay) {
  Statistics s = ideal();
  s.play_ticks = 59'000;
  EXPECT_EQ(playability_of(s).total, 0.0);
  EXPECT_EQ(playability_of(Statistics{}).total, 0.0);
}

TEST(Playability, EachPartFallsOffByItself) {
  struct Case {
    std::function<void(Statistics&)> change;
    double Playability::*part;
    double value;
  };
  const Case cases[] = {
      {[](Statistics& s) {
         s.saves = {0, 0};
       },
       &Playability::saves, 0.0},
      {[](Statistics& s) {
         s.saves = {100, 100};
       },
       &Playability::saves, 0.0},
      {[](Statistics& s) {
         s.saves = {20, 30};
       },
       &Playability::saves, 0.75},
      {[](Statistics& s) { s.unreachable_ticks = s.ball_ticks * 3 / 10; }, &Playability::reach,
       0.0},
      {[](Statistics& s) { s.lead_changes = 5; }, &Playability::surprise, 0.5},
      {[](Statistics& s) {
         s.wins = {15, 15}, s.lead_changes = 30;
       },
       &Playability::length, 0.5},
      {[](Statistics& s) {
         s.wins = {2, 3};
       },
       &Playability::length, 4.0 / 6.0},
      {[](Statistics& s) { s.still_ticks = s.ball_ticks / 25; }, &Playability::flow, 0.5},
      {[](Statistics& s) { s.dead_balls = 12; }, &Playability::flow, 0.5},
      {[](Statistics& s) {
         s.rally = {};
         for (int rally = 0; rally < 100; ++rally) s.rally.add(0.0);
       },
       &Playability::rallies, 0.0},
  };
  double Playability::*const parts[] = {&Playability::rallies, &Playability::saves,
                                        &Playability::reach,   &Playability::surprise,
                                        &Playability::length,  &Playability::flow};
  for (const Case& c : cases) {
    Statistics s = ideal();
    c.change(s);
    const Playability p = playability_of(s);
    EXPECT_NEAR(p.*c.part, c.value, 0.01) << &c - cases;
    for (const auto other : parts) {
      if (other == c.part) continue;
      EXPECT_NEAR(p.*other, 1.0, 1e-12) << &c - cases;
    }
    EXPECT_NEAR(p.total, std::pow(p.*c.part, 1.0 / 6.0), 1e-9) << &c - cases;
  }
}

}  // namespace
}  // namespace foosball
