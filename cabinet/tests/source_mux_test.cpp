#include "cabinet/source_mux.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

using namespace cabinet;

namespace {

struct FakeSource final : InputSource {
  RodInputs inputs{};
  SourceCounters counts;
  std::string label = "fake";
  int polls = 0;
  void poll(std::int64_t) override { ++polls; }
  const RodInputs& rods() const override { return inputs; }
  const SourceCounters& counters() const override { return counts; }
  const std::string& name() const override { return label; }
  void set(int rod, double slide, double angle, RodStatus status = RodStatus::live) {
    inputs[rod] = {slide, angle, 0, 0, 42, status};
  }
};

std::array<double, kRods> limits(double limit) {
  std::array<double, kRods> all;
  all.fill(limit);
  return all;
}

struct MuxBench {
  FakeSource cabinet, client, computer;
  SourceMux mux{limits(0.15)};
  int of_cabinet = mux.add(cabinet, Origin::relative);
  int of_client = mux.add(client, Origin::absolute);
  int of_computer = mux.add(computer, Origin::absolute);
  std::int64_t now_us = 0;

  MuxBench() {
    const int order[] = {of_cabinet, of_client, of_computer};
    for (int rod = 0; rod < kRods; ++rod) mux.assign(rod, order);
  }
  const RodInput& step(int ms = 1) {
    for (int i = 0; i < ms; ++i) mux.poll(now_us += 1'000);
    return mux.rods()[2];
  }
};

TEST(SourceMux, TheFirstInTheListThatHasTheRodDrivesIt) {
  MuxBench b;
  b.step();
  EXPECT_EQ(b.mux.source_of(2), SourceMux::kNobody);
  EXPECT_EQ(b.mux.rods()[2].status, RodStatus::absent);
  b.computer.set(2, 0, 0);
  b.step();
  EXPECT_EQ(b.mux.source_of(2), b.of_computer);
  b.client.set(2, 0, 0);
  b.step();
  EXPECT_EQ(b.mux.source_of(2), b.of_client);
  b.cabinet.set(2, 0, 0);
  EXPECT_EQ(b.step().time_us, 42);
  EXPECT_EQ(b.mux.source_of(2), b.of_cabinet);
  EXPECT_EQ(b.mux.source_of(3), SourceMux::kNobody);
}

TEST(SourceMux, AnIdleOrUnpluggedOwnerKeepsTheRod) {
  MuxBench b;
  b.cabinet.set(2, 0, 0);
  b.computer.set(2, -0.1, 0.0);
  b.step();
  b.cabinet.set(2, 0.05, 1.0);
  b.step(60'000);  // a minute without motion
  EXPECT_EQ(b.mux.source_of(2), b.of_cabinet);
  b.cabinet.inputs[2].status = RodStatus::held;
  b.step(1'000);
  EXPECT_EQ(b.mux.source_of(2), b.of_cabinet);
  EXPECT_EQ(b.mux.rods()[2].status, RodStatus::held);
  EXPECT_NEAR(b.mux.rods()[2].slide, 0.05, 1e-12);
}

TEST(SourceMux, ANewOrderPassesTheRodOn) {
  MuxBench b;
  b.cabinet.set(2, 0, 0, RodStatus::held);
  b.computer.set(2, 0, 0);
  b.step();
  const int computer_only[] = {b.of_computer, 77, -3};  // ignores indices that do not exist
  b.mux.assign(2, computer_only);
  b.step();
  EXPECT_EQ(b.mux.source_of(2), b.of_computer);
  b.mux.assign(2, {});
  b.step();
  EXPECT_EQ(b.mux.source_of(2), SourceMux::kNobody);
}

TEST(SourceMux, ADriverThatGoesLeavesTheRodWhereItIs) {
  MuxBench b;
  b.client.set(2, 0.1, 2.0);
  b.step(5'000);
  b.client.inputs[2].slide_rate = 3;
  b.step();
  b.client.inputs[2].status = RodStatus::absent;
  b.step();
  EXPECT_NEAR(b.mux.rods()[2].slide, 0.1, 1e-6);
  EXPECT_NEAR(b.mux.rods()[2].angle, 2.0, 1e-6);
  EXPECT_EQ(b.mux.rods()[2].slide_rate, 0);
}

// Every change of driver, with drivers that differ by the full slide and many turns.
TEST(SourceMux, NothingJumpsWhenTheDriverChanges) {
  MuxBench b;
  b.cabinet.set(2, -0.15, 30);
  b.client.set(2, 0.15, -12);
  b.computer.set(2, 0.0, 3);
  double slide = 0, angle = 0;
  const int orders[][3] = {{2, 1, 0}, {0, 1, 2}, {1, 0, 2}, {2, 0, 1}, {0, 2, 1}, {1, 2, 0}};
  for (int change = 0; change < 60; ++change) {
    b.mux.assign(2, orders[change % 6]);
    for (int ms = 0; ms < 37 * (change % 5) + 1; ++ms) {
      const RodInput& out = b.step();
      // 0.3 m and half a turn fade by at most 1/150 in 1 ms.
      ASSERT_LE(std::abs(out.slide - slide), 0.3 / 150) << change;
      ASSERT_LE(std::abs(out.angle - angle), std::numbers::pi / 150) << change;
      slide = out.slide;
      angle = out.angle;
    }
  }
}

TEST(SourceMux, AHandlesOffsetStaysAndItsMotionCountsInFull) {
  MuxBench b;
  b.mux.place(2, 0.1, 1.0);
  b.cabinet.set(2, 0.0, 0.0);
  b.step(10'000);
  EXPECT_NEAR(b.mux.rods()[2].slide, 0.1, 1e-12);
  b.cabinet.set(2, 0.03, 0.5);
  b.step();
  EXPECT_NEAR(b.mux.rods()[2].slide, 0.13, 1e-12);
  EXPECT_NEAR(b.mux.rods()[2].angle, 1.5, 1e-12);
}

TEST(SourceMux, AHandlePushedToTheStopLosesItsOffset) {
  MuxBench b;
  b.mux.place(2, 0.1, 0);
  b.cabinet.set(2, 0.0, 0);
  b.step();
  b.cabinet.set(2, 0.15, 0);  // the handle's own stop
  b.cabinet.inputs[2].slide_rate = 1.0;
  EXPECT_NEAR(b.step().slide, 0.15, 1e-12);
  EXPECT_EQ(b.mux.rods()[2].slide_rate, 0);
  b.cabinet.set(2, 0.0, 0);
  EXPECT_NEAR(b.step().slide, 0.0, 1e-12);  // aligned again
}

// Measured at 0.14 m, extrapolated to 0.17: the rod is at its stop, the handle is not.
TEST(SourceMux, APredictionBeyondTheStopTakesNoOffset) {
  MuxBench b;
  b.cabinet.set(2, 0.17, 0);
  b.cabinet.inputs[2].slide_ahead = 0.03;
  b.step();
  EXPECT_EQ(b.mux.rods()[2].slide, 0.0);  // its previous position: 0.17 is that of the handle
  b.cabinet.set(2, 0.33, 0);
  b.cabinet.inputs[2].slide_ahead = 0.03;
  EXPECT_NEAR(b.step().slide, 0.15, 1e-12);
  b.cabinet.set(2, 0.27, 0);
  b.cabinet.inputs[2].slide_ahead = 0;
  EXPECT_NEAR(b.step().slide, 0.10, 1e-12);
}

TEST(SourceMux, AnOffsetOnTheComputerFadesButForWholeTurns) {
  MuxBench b;
  b.mux.place(2, 0.1, 13.0);
  b.computer.set(2, -0.05, 0.2);
  b.step();
  b.step();
  EXPECT_LT(b.mux.rods()[2].slide_rate, -0.8);  // includes the rate of the fade
  b.step(3'000);
  EXPECT_NEAR(b.mux.rods()[2].slide, -0.05, 1e-9);
  EXPECT_NEAR(b.mux.rods()[2].angle, 0.2 + 4 * std::numbers::pi, 1e-9);
  EXPECT_EQ(b.mux.rods()[2].slide_rate, 0);
}

TEST(SourceMux, AHeldRodDoesNotFade) {
  MuxBench b;
  b.mux.place(2, 0.1, 0);
  b.client.set(2, 0.0, 0, RodStatus::held);
  b.step(1'000);
  EXPECT_NEAR(b.mux.rods()[2].slide, 0.1, 1e-12);
  EXPECT_EQ(b.mux.rods()[2].slide_rate, 0);
}

TEST(SourceMux, PollsEachSourceOnceAndSumsTheirCounters) {
  MuxBench b;
  b.cabinet.counts = {1, 2, 3, 4, 5, 6, 7, 8};
  b.client.counts = {10, 20, 30, 40, 50, 60, 70, 80};
  b.cabinet.counts.index_disagreements[7] = 9;
  b.client.counts.index_disagreements[7] = 90;
  b.step(3);
  EXPECT_EQ(b.cabinet.polls, 3);
  EXPECT_EQ(b.computer.polls, 3);
  const SourceCounters& sum = b.mux.counters();
  EXPECT_EQ(sum.frames, 11u);
  EXPECT_EQ(sum.lost, 33u);
  EXPECT_EQ(sum.impossible, 77u);
  EXPECT_EQ(sum.line_errors, 88u);
  EXPECT_EQ(sum.index_disagreements[7], 99u);
  EXPECT_EQ(b.mux.source(b.of_client).name(), "fake");
}

}  // namespace
