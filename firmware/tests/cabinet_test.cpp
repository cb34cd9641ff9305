// The actual .elf of each board in simavr, with eight mice on its pins.
#include <algorithm>
#include <cstdio>
#include <ctime>

#include "commands_fixture.h"

namespace firmware_sim {
namespace {

constexpr unsigned kAll = 0xFF;

class OnEachBoard : public testing::TestWithParam<Board> {};
INSTANTIATE_TEST_SUITE_P(Boards, OnEachBoard, testing::Values(Board::mega32u4, Board::mega2560),
                         [](const auto& chosen) { return name_of(chosen.param); });

TEST_P(OnEachBoard, SetsUpAllMiceAtRate200And8CountsPerMillimetre) {
  Cabinet cabinet(GetParam());
  ASSERT_TRUE(cabinet.wait_for_present(kAll));
  for (int rod = 0; rod < kMice; ++rod) {
    EXPECT_TRUE(cabinet.sim.mouse(rod).enabled());
    EXPECT_EQ(cabinet.sim.mouse(rod).rate(), 200);
    EXPECT_EQ(cabinet.sim.mouse(rod).counts_per_mm(), 8);
  }
}

TEST_P(OnEachBoard, EachMouseCountsExactlyAndAlone) {
  Cabinet cabinet(GetParam());
  ASSERT_TRUE(cabinet.wait_for_present(kAll));
  Moved moved;
  for (int rod = 0; rod < kMice; ++rod) {
    moved.move(cabinet.sim, rod, 320 + rod, -90 * (rod + 1));
    ASSERT_TRUE(cabinet.settle());
    cabinet.take();
    expect_counts(cabinet.last(), moved);
  }
}

TEST_P(OnEachBoard, AMousePluggedInAgainIsBackWithinTwoSecondsAndDoesNotJump) {
  Cabinet cabinet(GetParam());
  ASSERT_TRUE(cabinet.wait_for_present(kAll));
  Moved moved;
  moved.move(cabinet.sim, 5, 77, -78);
  ASSERT_TRUE(cabinet.settle());
  for (const std::uint64_t away_us : {15'000u, 700'000u}) {
    cabinet.sim.mouse(5).unplug();
    cabinet.sim.advance_us(away_us);
    cabinet.take();
    cabinet.sim.mouse(5).replug();
    const std::uint64_t plugged_us = cabinet.sim.now_us();
    ASSERT_TRUE(cabinet.advance_until([&] { return cabinet.sim.mouse(5).enabled(); }, 2000));
    ASSERT_TRUE(cabinet.wait_for_present(kAll));
    EXPECT_LT(cabinet.sim.now_us() - plugged_us, 2'000'000u);
    expect_counts(cabinet.last(), moved);
  }
  moved.move(cabinet.sim, 5, -3, 4);
  ASSERT_TRUE(cabinet.settle());
  cabinet.take();
  expect_counts(cabinet.last(), moved);
}

TEST_P(OnEachBoard, AnUnpluggedMouseIsReportedWithinHalfASecond) {
  Cabinet cabinet(GetParam());
  ASSERT_TRUE(cabinet.wait_for_present(kAll));
  cabinet.sim.mouse(0).unplug();
  EXPECT_TRUE(cabinet.wait_for_present(kAll & ~1u, 500));
}

TEST_P(OnEachBoard, AWrongParityIsCountedAndCostsThatPacketOnly) {
  Cabinet cabinet(GetParam());
  ASSERT_TRUE(cabinet.wait_for_present(kAll));
  cabinet.sim.mouse(2).flip_parity();
  cabinet.sim.mouse(2).move(11, 12);
  ASSERT_TRUE(cabinet.settle());
  const Frames frames = cabinet.take();
  EXPECT_EQ(frames.errors(), 1u);
  EXPECT_TRUE(frames.resynchronised());
  Moved moved;
  moved.move(cabinet.sim, 2, 5, 6);
  ASSERT_TRUE(cabinet.settle());
  EXPECT_EQ(cabinet.take().errors(), 0u);
  expect_counts(cabinet.last(), moved);
}

TEST_P(OnEachBoard, OverflowIsReportedAndSaturates) {
  CabinetOptions options;
  options.mice[1].splits_overflow = false;
  Cabinet cabinet(GetParam(), options);
  ASSERT_TRUE(cabinet.wait_for_present(kAll));
  cabinet.take();
  cabinet.sim.mouse(1).move(900, -900);
  ASSERT_TRUE(cabinet.settle());
  EXPECT_EQ(cabinet.take().overflow(), 1u << 1);
  EXPECT_EQ(cabinet.last().slide[1], 255);
  EXPECT_EQ(cabinet.last().spin[1], static_cast<std::uint16_t>(-256));
}

TEST_P(OnEachBoard, TheDeepestStackLeavesAQuarterOfTheRamFree) {
  Cabinet cabinet(GetParam());
  ASSERT_TRUE(cabinet.wait_for_present(kAll));
  for (int rod = 0; rod < kMice; ++rod) cabinet.sim.mouse(rod).move(500, 500);
  ASSERT_TRUE(cabinet.settle());
  std::printf("%s: %zu bytes of static RAM, %zu never used\n", name_of(GetParam()).c_str(),
              cabinet.sim.static_ram_bytes(), cabinet.sim.unused_ram_bytes());
  EXPECT_GT(cabinet.sim.unused_ram_bytes(), 640u);  // measured 1014 of 2560, and 6833 of 8192
}

struct Load {
  Board board;
  std::uint32_t clock_hz;
  int seconds;
};
class UnderFullLoad : public testing::TestWithParam<Load> {};
// The slowest clocks keep the lines busy longest; the fastest leave the least time for each bit.
INSTANTIATE_TEST_SUITE_P(
    Loads, UnderFullLoad,
    testing::Values(Load{Board::mega32u4, 12'500, 10}, Load{Board::mega2560, 12'500, 10},
                    Load{Board::mega32u4, 16'700, 3}, Load{Board::mega2560, 16'700, 3},
                    Load{Board::mega32u4, 10'000, 3}, Load{Board::mega2560, 10'000, 3}),
    [](const auto& chosen) {
      return name_of(chosen.param.board) + "_" + std::to_string(chosen.param.clock_hz);
    });

TEST_P(UnderFullLoad, AllEightAt200ReportsASecondLoseNoCountAndFramesKeepTheirRate) {
  CabinetOptions options;
  for (std::size_t i = 0; i < kMice; ++i) {
    options.mice[i].clock_hz = GetParam().clock_hz;
    options.mice[i].jitter_ns = 500;
    options.mice[i].seed = 100 + i;
  }
  Cabinet cabinet(GetParam().board, options);
  ASSERT_TRUE(cabinet.wait_for_present(kAll));
  cabinet.take();
  std::array<std::uint64_t, kMice> sent_before{};
  for (std::size_t i = 0; i < kMice; ++i)
    sent_before[i] = cabinet.sim.mouse(static_cast<int>(i)).packets_sent();

  std::mt19937 random(7);
  Moved moved;
  const std::clock_t began = std::clock();
  cabinet.sim.reset_idle();
  for (int ms = 0; ms < 1000 * GetParam().seconds; ++ms) {
    for (int rod = 0; rod < kMice; ++rod) {
      moved.move(cabinet.sim, rod, static_cast<int>(random() % 81) - 40,
                 static_cast<int>(random() % 81) - 40);
    }
    cabinet.sim.advance_us(1000);
  }
  const double idle = cabinet.sim.idle_share();
  const Frames frames = cabinet.take();
  const double cpu = static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC;
  const double rate = static_cast<double>(frames.good.size()) / GetParam().seconds;
  std::printf("%d s simulated in %.2f s of CPU time; %.1f frames a second, processor idle %.0f%%\n",
              GetParam().seconds, cpu, rate, 100 * idle);

  EXPECT_EQ(frames.errors(), 0u);
  EXPECT_FALSE(frames.resynchronised());
  EXPECT_LE(frames.bad, 0);
  for (std::size_t i = 1; i < frames.good.size(); ++i) {
    ASSERT_EQ(frames.good[i].sequence, static_cast<std::uint16_t>(frames.good[i - 1].sequence + 1));
  }
  const double nominal = GetParam().board == Board::mega32u4 ? 1000 : 250;
  EXPECT_NEAR(rate, nominal, 0.01 * nominal);
  for (std::size_t i = 0; i < kMice; ++i) {
    const auto sent = cabinet.sim.mouse(static_cast<int>(i)).packets_sent() - sent_before[i];
    EXPECT_GE(sent, static_cast<std::uint64_t>(198 * GetParam().seconds));
  }
  ASSERT_TRUE(cabinet.settle());
  cabinet.take();
  expect_counts(cabinet.last(), moved);
}

}  // namespace
}  // namespace firmware_sim
