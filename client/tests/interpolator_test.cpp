#include "client/interpolator.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "scripted_scene.h"

namespace client {
namespace {

constexpr double kGravity = 9.81;

// A thrown ball: the closed form that the curve must match.
wire::PoseVelocity thrown(double t) {
  wire::PoseVelocity ball;
  ball.position = {static_cast<float>(2.0 * t), static_cast<float>(-0.7 * t),
                   static_cast<float>(0.1 + 1.5 * t - 0.5 * kGravity * t * t)};
  ball.linear_velocity = {2.0f, -0.7f, static_cast<float>(1.5 - kGravity * t)};
  const double half = 0.5 * 30.0 * t;  // rotates at 30 rad/s about y
  ball.orientation = {0, static_cast<float>(std::sin(half)), 0, static_cast<float>(std::cos(half))};
  ball.angular_velocity = {0, 30, 0};
  return ball;
}

double distance(const wire::PoseVelocity& a, const wire::PoseVelocity& b) {
  return std::hypot(a.position[0] - b.position[0], a.position[1] - b.position[1],
                    a.position[2] - b.position[2]);
}

// Angle between two orientations [rad].
double turn_between(const wire::PoseVelocity& a, const wire::PoseVelocity& b) {
  double dot = 0;
  for (std::size_t i = 0; i < 4; ++i)
    dot += static_cast<double>(a.orientation[i]) * static_cast<double>(b.orientation[i]);
  return 2.0 * std::acos(std::min(1.0, std::abs(dot)));
}

TEST(Interpolator, UniformlyAcceleratedMotionIsReproduced) {
  const double span = 0.020;
  for (int i = 0; i <= 40; ++i) {
    const double share = i / 40.0;
    const auto drawn = interpolate(thrown(0.05), thrown(0.05 + span), share, span);
    const auto truth = thrown(0.05 + share * span);
    EXPECT_LT(distance(drawn, truth), 1e-6) << share;      // measured 6e-8: rounding of floats
    EXPECT_LT(turn_between(drawn, truth), 2e-3) << share;  // measured 7e-4, likewise
  }
}

TEST(Interpolator, TheEndsAreTheSnapshots) {
  const auto a = thrown(0.1), b = thrown(0.101);
  EXPECT_EQ(interpolate(a, b, 0.0, 0.001).position, a.position);
  EXPECT_EQ(interpolate(a, b, 1.0, 0.001).position, b.position);
}

TEST(Interpolator, AJumpIsNotDrawnThroughTheAir) {
  wire::PoseVelocity a = thrown(0), b = thrown(0);
  b.position[0] += 0.5f;
  EXPECT_EQ(interpolate(a, b, 0.99, 0.001).position, a.position);
  EXPECT_EQ(interpolate(a, b, 1.0, 0.001).position, b.position);
}

TEST(Interpolator, ABounceInALongGapStaysBetweenItsEnds) {
  wire::PoseVelocity a, b;
  a.position = {0.55f, 0, 0};
  a.linear_velocity = {15, 0, 0};
  b.position = {0.56f, 0, 0};
  b.linear_velocity = {-12, 0, 0};
  for (int i = 0; i <= 20; ++i) {
    const float x = interpolate(a, b, i / 20.0, 0.010).position[0];
    EXPECT_GE(x, 0.5499f);
    EXPECT_LE(x, 0.5601f);
  }
}

TEST(Interpolator, ExtrapolationFollowsVelocityAndSpin) {
  const auto ahead = extrapolate(thrown(0.05), 0.002);
  EXPECT_LT(distance(ahead, thrown(0.052)), 0.5 * kGravity * 0.002 * 0.002 + 1e-6);
  EXPECT_LT(turn_between(ahead, thrown(0.052)), 2e-3);
}

TEST(Interpolator, WhatCountsChangesOnlyWhenItsSnapshotIsReached) {
  wire::Snapshot a = scripted_play(1.0), b = scripted_play(1.001);
  b.score = {4, 2};
  b.rods[2].status = 2;
  EXPECT_EQ(interpolate(a, b, 0.99, 0.001).score, a.score);
  EXPECT_EQ(interpolate(a, b, 0.99, 0.001).rods[2].status, a.rods[2].status);
  EXPECT_EQ(interpolate(a, b, 1.0, 0.001).score, b.score);
}

TEST(Interpolator, ARodSpunPastTheEndOfTheWiresAnglesGoesOnTheSameWay) {
  constexpr double kTurn = 6.283185307179586, kRate = 60.0, kSpan = 0.004;
  for (const double way : {1.0, -1.0}) {
    // The end of the wire's range, half way between two snapshots, which are encoded and decoded.
    wire::Snapshot scenes[2];
    for (int i = 0; i < 2; ++i) {
      wire::Snapshot sent;
      sent.rods[2].angle = static_cast<float>(way * (128 * kTurn + (i - 0.5) * kRate * kSpan));
      std::array<std::byte, wire::kMaxDatagram> bytes;
      const std::size_t size = wire::encode_snapshot(sent, bytes);
      ASSERT_TRUE(wire::decode_snapshot({bytes.data(), size}, scenes[i]));
    }
    ASSERT_LT(scenes[1].rods[2].angle * scenes[0].rods[2].angle, 0.0f) << "not at the end";
    for (const double share : {0.0, 0.1, 0.37, 0.51, 0.9, 1.0}) {
      const double drawn = interpolate(scenes[0], scenes[1], share, kSpan).rods[2].angle;
      const double truth = way * (128 * kTurn + (share - 0.5) * kRate * kSpan);
      EXPECT_NEAR(std::remainder(drawn - truth, kTurn), 0.0, 3e-4) << way << " " << share;
    }
  }
}

TEST(Interpolator, MenOfAnotherLayoutAreNotMixed) {
  const wire::Snapshot a = scripted_play(1.0, foosball::Layout::tournament);
  const wire::Snapshot b = scripted_play(1.001, foosball::Layout::paper);
  const wire::Snapshot scene = interpolate(a, b, 0.5, 0.001);
  ASSERT_EQ(scene.men.size(), a.men.size());
  for (std::size_t i = 0; i < scene.men.size(); ++i) EXPECT_EQ(scene.men[i].rod, a.men[i].rod);
}

}  // namespace
}  // namespace client
