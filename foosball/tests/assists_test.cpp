// The assists for a person who plays with one hand, and their limits.
#include "foosball/assists.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "../src/random.h"
#include "bodies.h"

namespace foosball {
namespace {

constexpr std::uint8_t kAll = 0xff;
constexpr int kGoalie = 0, kDefence = 1, kMidfield = 3, kAttack = 5;  // of team 0

const TableSpec& table() {
  return table_spec(Layout::tournament);
}

Assists assists_with(const AssistChoice& choice, int team = 0, std::uint8_t rods = kAll) {
  std::uint8_t mine = 0;
  for (const int rod : rods_of_team(table(), team)) mine |= static_cast<std::uint8_t>(1u << rod);
  return {team, Layout::tournament, static_cast<std::uint8_t>(mine & rods), choice};
}

AssistView ball_at(double x, double y, double vx = 0.0, double vy = 0.0) {
  AssistView view;
  view.ball_in_play = true;
  view.ball = {x, y, table().ball_radius};
  view.velocity = {vx, vy, 0.0};
  return view;
}

AssistHand hand_on(int rod) {
  AssistHand hand;
  for (RodTarget& target : hand.targets) target.live = true;
  hand.held = static_cast<std::uint8_t>(1u << rod);
  return hand;
}

bool same(const RodTarget& a, const RodTarget& b) {
  return a.slide == b.slide && a.angle == b.angle && a.slide_rate == b.slide_rate &&
         a.angle_rate == b.angle_rate && a.live == b.live;
}

// --- automatic rod -------------------------------------------------------------------------------

TEST(AutomaticRod, TakesTheRodThatTheBallFliesToNotTheNearest) {
  const Assists assists = assists_with({.automatic_rod = true});
  // Just behind the midfield's reach, moving towards the goal: the midfield is nearest.
  const AssistView view = ball_at(-0.20, 0.0, -3.0);
  EXPECT_EQ(assists.rod_to_take(view, hand_on(kMidfield), kMidfield), kDefence);
  EXPECT_EQ(assists.rod_to_take(ball_at(0.32, 0.0, 0.0), hand_on(kGoalie), kGoalie), kAttack);
}

TEST(AutomaticRod, DoesNotFlickerBetweenTwoRods) {
  const Assists assists = assists_with({.automatic_rod = true});
  int rod = kGoalie, changes = 0;
  const double between = 0.5 * (table().rods[kGoalie].x + table().rods[kDefence].x);
  for (int i = 0; i < 1000; ++i) {
    const int taken =
        assists.rod_to_take(ball_at(between + 0.012 * std::sin(0.1 * i), 0.0), hand_on(rod), rod);
    changes += taken != rod ? 1 : 0;
    rod = taken;
  }
  EXPECT_LE(changes, 1);
}

TEST(AutomaticRod, LeavesARodThatStrikesAndRodsOfOthersAlone) {
  AssistHand striking = hand_on(kAttack);
  striking.strikes = true;
  const AssistView far = ball_at(-0.5, 0.0);
  EXPECT_EQ(assists_with({.automatic_rod = true}).rod_to_take(far, striking, kAttack), kAttack);
  // A teammate plays goalie and defence.
  const Assists front = assists_with({.automatic_rod = true}, 0, 1u << kMidfield | 1u << kAttack);
  EXPECT_EQ(front.rod_to_take(far, hand_on(kAttack), kAttack), kMidfield);
  EXPECT_EQ(assists_with({}).rod_to_take(far, hand_on(kAttack), kAttack), kAttack);
  AssistView none = far;
  none.ball_in_play = false;
  EXPECT_EQ(assists_with({.automatic_rod = true}).rod_to_take(none, hand_on(kAttack), kAttack),
            kAttack);
}

// --- goalie follows ------------------------------------------------------------------------------

// Shots from the opponent's attack cross the goal line within the goal mouth, with speeds that a
// hand can follow. Returns the fraction of shots with a man of goalie or defence in their path.
double share_covered(const AssistChoice& choice) {
  Random random(5);
  int covered = 0;
  constexpr int kShots = 500;
  for (int shot = 0; shot < kShots; ++shot) {
    Assists assists = assists_with(choice);
    const double from = random.between(-0.2, 0.2), to = random.between(-0.08, 0.08);
    const double x0 = -0.12, run = x0 + 0.6, speed = random.between(1.0, 4.0);
    // The ball lay in front of the shooter for half a second.
    AssistHand hand = hand_on(kAttack);
    std::array<RodTarget, kRods> targets = hand.targets;
    for (int tick = 0; tick < 500; ++tick) targets = assists.steer(ball_at(x0, from), hand, 1);
    bool stopped = false;
    for (double x = x0, y = from; x > -0.6 && !stopped; x -= speed * kTick) {
      const double vy = speed * (to - from) / run;
      y += vy * kTick;
      targets = assists.steer(ball_at(x, y, -speed, vy), hand, 1);
      for (const int rod : {kGoalie, kDefence}) {
        const RodSpec& spec = table().rods[rod];
        if (std::fabs(x - spec.x) > speed * kTick) continue;
        for (int man = 0; man < spec.men; ++man) {
          const double beside = std::fabs(man_offset(spec, man) + targets[rod].slide - y);
          stopped = stopped || beside < 0.011 + table().ball_radius;
        }
      }
    }
    covered += stopped ? 1 : 0;
  }
  return static_cast<double>(covered) / kShots;
}

TEST(GoalieFollows, CoversShotsThatStandingMenLetThrough) {
  const double standing = share_covered({}), following = share_covered({.goalie_follows = true});
  std::printf("shots of 1 to 4 m/s covered: %.2f standing, %.2f following\n", standing, following);
  EXPECT_LT(standing, 0.6);
  EXPECT_GT(following, 0.9);
}

TEST(GoalieFollows, MovesNoFasterThanAHandWhateverTheBallDoes) {
  Assists assists = assists_with({.goalie_follows = true});
  Random random(6);
  std::array<RodTarget, kRods> before{};
  std::array<double, kRods> rate{};
  for (int tick = 0; tick < 20'000; ++tick) {
    const AssistView view = ball_at(random.between(-0.6, 0.6), random.between(-0.3, 0.3),
                                    random.between(-9.0, 9.0), random.between(-9.0, 9.0));
    const auto now = assists.steer(view, hand_on(kAttack), 1);
    for (const int rod : {kGoalie, kDefence}) {
      const double speed = (now[rod].slide - before[rod].slide) / kTick;
      ASSERT_LE(std::fabs(speed), kAssistRate + 1e-9);
      ASSERT_LE(std::fabs(speed - rate[rod]), kAssistAcceleration * kTick + 1e-9);
      ASSERT_LE(std::fabs(now[rod].slide), table().rods[rod].slide_limit + 2e-3);
      rate[rod] = speed;
    }
    before = now;
  }
}

TEST(GoalieFollows, LeavesTheRodInHandAndThoseInFrontAlone) {
  Assists assists = assists_with({.goalie_follows = true});
  const AssistHand hand = hand_on(kGoalie);
  const AssistView view = ball_at(0.0, 0.1, -2.0);
  const auto targets = assists.steer(view, hand, 200);
  EXPECT_EQ(assists.following(), 1u << kDefence);
  for (int rod = 0; rod < kRods; ++rod) {
    if (rod == kDefence) continue;
    EXPECT_TRUE(same(targets[rod], hand.targets[rod])) << rod;
  }
  EXPECT_GT(std::fabs(targets[kDefence].slide), 0.01);
}

TEST(GoalieFollows, DoesNotSweepABallAsideThatLiesAtTheFeet) {
  Assists assists = assists_with({.goalie_follows = true});
  const AssistView view = ball_at(table().rods[kDefence].x + 0.01, 0.05);
  const auto targets = assists.steer(view, hand_on(kAttack), 500);
  EXPECT_EQ(targets[kDefence].slide, 0.0);
}

// Lifted feet let every ball pass. Lowered beside the ball, they would drive it towards their own
// goal.
TEST(GoalieFollows, LetsTheMenHangDownWhileTheBallIsFar) {
  AssistHand hand = hand_on(kAttack);
  hand.targets[kGoalie].angle = 2.0 * vp::kPi + 1.2;
  Assists far = assists_with({.goalie_follows = true});
  EXPECT_NEAR(far.steer(ball_at(0.2, 0.0), hand, 1000)[kGoalie].angle, 2.0 * vp::kPi, 1e-12);
  Assists near = assists_with({.goalie_follows = true});
  const double x = table().rods[kGoalie].x + 0.05;
  EXPECT_EQ(near.steer(ball_at(x, 0.0), hand, 1000)[kGoalie].angle, 2.0 * vp::kPi + 1.2);
}

// --- aim -----------------------------------------------------------------------------------------

TEST(Aim, BringsAFootThatStrikesBesideTheBallBeforeIt) {
  Assists assists = assists_with({.aim = true});
  AssistHand hand = hand_on(kAttack);
  hand.targets[kAttack].slide = 0.012;  // the middle man; half a foot is 10 mm
  AssistView view = ball_at(table().rods[kAttack].x + 0.02, 0.0);
  view.rods[7].slide = 0.2;                                         // nobody stands straight ahead
  EXPECT_EQ(assists.steer(view, hand, 100)[kAttack].slide, 0.012);  // not striking
  hand.strikes = true;
  const double helped = assists.steer(view, hand, 1000)[kAttack].slide;
  EXPECT_LT(std::fabs(helped), 0.0101);
  hand.strikes = false;
  EXPECT_EQ(assists.steer(view, hand, 1000)[kAttack].slide, 0.012);
}

TEST(Aim, PullsSlowlyALittleAndNeverAFootThatIsFarOff) {
  Random random(7);
  Assists assists = assists_with({.aim = true});
  double before = 0.0;
  int helped = 0;
  for (int tick = 0; tick < 20'000; ++tick) {
    AssistView view =
        ball_at(table().rods[kAttack].x + random.between(-0.08, 0.08), random.between(-0.3, 0.3));
    for (RodState& rod : view.rods) rod.slide = random.between(-0.1, 0.1);
    AssistHand hand = hand_on(kAttack);
    hand.strikes = true;
    const double pull = assists.steer(view, hand, 1)[kAttack].slide;
    ASSERT_LE(std::fabs(pull), kAimPull + 1e-12);
    ASSERT_LE(std::fabs(pull - before), kAimRate * kTick + 1e-12);
    helped += pull != 0.0 ? 1 : 0;
    before = pull;
  }
  EXPECT_GT(helped, 1000);
  Assists fresh = assists_with({.aim = true});
  AssistHand hand = hand_on(kAttack);
  hand.strikes = true;
  const AssistView beside = ball_at(table().rods[kAttack].x + 0.02, 0.095);  // between two men
  EXPECT_EQ(fresh.steer(beside, hand, 1000)[kAttack].slide, 0.0);
}

TEST(Aim, PrefersTheLessGuardedOfTwoPlacesThatAreNear) {
  const double x = table().rods[kAttack].x + 0.02;
  std::array<double, 2> place{};
  for (const int side : {0, 1}) {
    Assists assists = assists_with({.aim = true});
    AssistHand hand = hand_on(kAttack);
    hand.strikes = true;
    // The edge of the foot is at the ball's centre; goalie and defence leave one side free.
    hand.targets[kAttack].slide = side == 0 ? 0.013 : -0.013;
    AssistView view = ball_at(x, 0.0);
    view.rods[6].slide = side == 0 ? 0.12 : -0.12;
    view.rods[7].slide = side == 0 ? 0.05 : -0.05;
    place[static_cast<std::size_t>(side)] = assists.steer(view, hand, 1000)[kAttack].slide;
  }
  EXPECT_EQ(place[0], -place[1]);
  EXPECT_GT(place[0], 0.013);  // further on the edge: the ball goes to -y, away from both
}

// --- all assists ---------------------------------------------------------------------------------

TEST(Assists, ThatAreOffChangeNothing) {
  Assists assists = assists_with({});
  const AssistHand hand = hand_on(kMidfield);
  const auto targets = assists.steer(ball_at(0.1, 0.1, -3.0), hand, 100);
  for (int rod = 0; rod < kRods; ++rod) EXPECT_TRUE(same(targets[rod], hand.targets[rod]));
  EXPECT_EQ(assists.following(), 0);
}

TEST(Assists, DoTheSameInOneCallAsTickByTick) {
  const AssistChoice all{true, true, true};
  Assists one = assists_with(all), many = assists_with(all);
  AssistHand hand = hand_on(kAttack);
  hand.strikes = true;
  const AssistView view = ball_at(table().rods[kAttack].x + 0.02, 0.01);
  std::array<RodTarget, kRods> ticked{};
  for (int tick = 0; tick < 64; ++tick) ticked = many.steer(view, hand, 1);
  const auto at_once = one.steer(view, hand, 64);
  for (int rod = 0; rod < kRods; ++rod)
    EXPECT_NEAR(at_once[rod].slide, ticked[rod].slide, 1e-12) << rod;
}

// Rotated by half a turn about z with exchanged teams: the same result, rotated, bit for bit.
TEST(Assists, DoForTeam1WhatTheyDoForTeam0) {
  const AssistChoice all{true, true, true};
  Assists home = assists_with(all, 0), away = assists_with(all, 1);
  Random random(8);
  int home_rod = kMidfield, away_rod = kRods - 1 - kMidfield, changes = 0;
  AssistView view, turned;
  AssistHand hand, other;
  for (int tick = 0; tick < 20'000; ++tick) {
    if (tick % 20 == 0) {
      view = ball_at(random.between(-0.6, 0.6), random.between(-0.33, 0.33),
                     random.between(-5.0, 5.0), random.between(-5.0, 5.0));
      view.bodies = built_in(static_cast<int>(tick / 20) % built_in_count(), 2);
      hand.strikes = random.unit() < 0.5;
      for (int rod = 0; rod < kRods; ++rod) {
        view.rods[rod] = {random.between(-0.1, 0.1), random.between(-3.0, 3.0), 0.0, 0.0};
        hand.targets[rod] = {random.between(-0.1, 0.1), random.between(-3.0, 3.0), 0.0, 0.0, true};
      }
    }
    turned = view;
    turned.bodies = {view.bodies[1], view.bodies[0]};
    turned.ball = {-view.ball.x, -view.ball.y, view.ball.z};
    turned.velocity = {-view.velocity.x, -view.velocity.y, view.velocity.z};
    other.strikes = hand.strikes;
    for (int rod = 0; rod < kRods; ++rod) {
      const RodState& state = view.rods[rod];
      const RodTarget& target = hand.targets[rod];
      turned.rods[kRods - 1 - rod] = {-state.slide, -state.angle, 0.0, 0.0};
      other.targets[kRods - 1 - rod] = {-target.slide, -target.angle, 0.0, 0.0, true};
    }
    const int before = home_rod;
    home_rod = home.rod_to_take(view, hand, home_rod);
    away_rod = away.rod_to_take(turned, other, away_rod);
    ASSERT_EQ(away_rod, kRods - 1 - home_rod) << tick;
    changes += home_rod != before ? 1 : 0;
    hand.held = static_cast<std::uint8_t>(1u << home_rod);
    other.held = static_cast<std::uint8_t>(1u << away_rod);
    const auto a = home.steer(view, hand, 1), b = away.steer(turned, other, 1);
    for (int rod = 0; rod < kRods; ++rod) {
      const RodTarget& p = a[rod];
      const RodTarget& q = b[kRods - 1 - rod];
      ASSERT_TRUE(p.slide == -q.slide && p.angle == -q.angle && p.slide_rate == -q.slide_rate)
          << "tick " << tick << " rod " << rod;
    }
  }
  EXPECT_GT(changes, 100);
}

}  // namespace
}  // namespace foosball
