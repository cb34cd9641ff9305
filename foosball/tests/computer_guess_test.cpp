// The coarse model of the current ball.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "../src/computer_guess.h"

namespace foosball {
namespace {

constexpr double kStep = 0.002;  // of the model [s]

// The model takes many collision-free steps at once. Calls of one step each never do.
TEST(ComputerGuess, OfALongTimeIsThatOfItsStepsOneByOne) {
  std::mt19937_64 bits(7);
  const auto between = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(bits() >> 11) * 0x1p-53;
  };
  double max = 0.0;
  int parted = 0, moved = 0;
  constexpr int kTries = 4000;
  for (int i = 0; i < kTries; ++i) {
    const Layout layout = i % 2 == 0 ? Layout::paper : Layout::tournament;
    const TableSpec& table = table_spec(layout);
    const GuessModel model{&table, i / 2 % 2, {0.012, 0.012}};
    Tuning tuning;
    tuning.gravity = between(5.0, 30.0);
    Sighting rods;
    for (std::size_t rod = 0; rod < kRods; ++rod) {
      rods.slide[rod] = between(-0.05, 0.05);
      rods.swing[rod] = between(-2.0, 8.0);
    }
    const bool rolls = i % 3 == 0;
    const BallGuess from{
        {between(-0.5, 0.5), between(-0.3, 0.3),
         table.ball_radius + (rolls ? 0.0 : between(0.0, 0.1))},
        {between(-5.0, 5.0), between(-3.0, 3.0), rolls ? 0.0 : between(-2.0, 2.0)}};
    const BallGuess at_once = advance(model, tuning, rods, from, 150 * kStep);
    BallGuess ball = from;
    for (int step = 0; step < 150; ++step) ball = advance(model, tuning, rods, ball, kStep);
    const double off = vp::norm(at_once.position - ball.position);
    moved += vp::norm(ball.position - from.position) > 0.05 ? 1 : 0;
    // At the edge of a foot or a post, the last bit decides the direction of the ball.
    off > 1e-6 ? void(++parted) : void(max = std::max(max, off));
  }
  std::printf("at most %.1e m off; %d of %d parted at an edge\n", max, parted, kTries);
  EXPECT_LT(max, 1e-9);  // measured 7e-15
  EXPECT_LE(parted, kTries / 1000);
  EXPECT_GT(moved, kTries / 2);
}

// Without downward gravity the ball does not fall.
TEST(ComputerGuess, HoldsWithoutGravity) {
  for (const double gravity : {0.0, -12.0}) {
    const GuessModel model{&table_spec(Layout::tournament), 0, {0.012, 0.012}};
    Tuning tuning;
    tuning.gravity = gravity;
    const BallGuess from{{0.0, 0.0, 0.2}, {0.1, 0.0, 0.0}};
    const BallGuess to = advance(model, tuning, {}, from, 0.3);
    EXPECT_NEAR(to.position.x, 0.03, 1e-12);
    EXPECT_NEAR(to.position.z, 0.2 - 0.5 * gravity * 0.3 * (0.3 - kStep), 1e-9);
  }
}

}  // namespace
}  // namespace foosball
