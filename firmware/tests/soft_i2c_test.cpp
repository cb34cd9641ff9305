#include "core/soft_i2c.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "firmware_sim/motor_bus.h"

namespace firmware {
namespace {

using firmware_sim::MotorBus;

constexpr std::uint64_t kEdgeNs = 130, kSettleNs = 300, kHighNs = 600, kLowNs = 1050,
                        kStepNs = 1500, kTickNs = 20'000;

// The devices, and the lines that a controller pulls low; its actions advance the time.
struct Bench {
  MotorBus bus;
  std::uint64_t now_ns = 1'000'000;
  bool clock_low = false, data_low = false;

  // Runs the devices' own events at their times.
  void pass(std::uint64_t ns) {
    const std::uint64_t end = now_ns + ns;
    while (bus.next_event_ns() && *bus.next_event_ns() <= end) {
      now_ns = *bus.next_event_ns();
      bus.drive(now_ns, clock_low, data_low);
    }
    now_ns = end;
  }

  void drive() {
    pass(kEdgeNs);
    bus.drive(now_ns, clock_low, data_low);
  }
};
Bench* g_bench = nullptr;

struct Wires {
  static void clock_low() { set(g_bench->clock_low, true); }
  static void clock_free() { set(g_bench->clock_low, false); }
  static void data_low() { set(g_bench->data_low, true); }
  static void data_free() { set(g_bench->data_low, false); }
  static bool clock() { return !g_bench->clock_low && !g_bench->bus.pulls_clock(); }
  static bool data() { return !g_bench->data_low && !g_bench->bus.pulls_data(); }
  static void settle() { g_bench->pass(kSettleNs); }
  static void wait_high() { g_bench->pass(kHighNs); }
  static void wait_low() { g_bench->pass(kLowNs); }

 private:
  static void set(bool& line, bool low) {
    line = low;
    g_bench->drive();
  }
};

struct SoftI2cTest : testing::Test {
  Bench bench;
  SoftI2c<Wires> master;

  void SetUp() override { g_bench = &bench; }

  // Runs steps until the transfer has ended; returns their number.
  int run(int limit = 2000) {
    int steps = 0;
    while (master.busy() && steps < limit) {
      bench.pass(kStepNs);
      // May have been held or released.
      bench.bus.drive(bench.now_ns, bench.clock_low, bench.data_low);
      master.step(static_cast<std::uint8_t>(bench.now_ns / kTickNs));
      ++steps;
    }
    EXPECT_FALSE(master.busy());
    return steps;
  }
  I2cBus::State write(std::uint8_t address, std::vector<std::uint8_t> bytes) {
    master.write(address, bytes.data(), static_cast<std::uint8_t>(bytes.size()));
    run();
    return master.state();
  }
  void expect_at_rest() {
    EXPECT_FALSE(bench.clock_low || bench.data_low);
    EXPECT_EQ(bench.bus.violations(), std::vector<std::string>{});
  }
};

TEST_F(SoftI2cTest, WritesEveryValueToTheRegisterOfTheChosenDriver) {
  for (unsigned value = 0; value < 256; ++value) {
    const unsigned rod = value % 8;
    ASSERT_EQ(write(MotorBus::kMultiplexer, {static_cast<std::uint8_t>(1u << rod)}), I2cBus::kIdle);
    ASSERT_EQ(write(MotorBus::kDriver, {0x02, static_cast<std::uint8_t>(value)}), I2cBus::kIdle);
    EXPECT_EQ(bench.bus.running(static_cast<int>(rod)), value);
  }
  EXPECT_EQ(bench.bus.writes().size(), 256u);
  expect_at_rest();
}

TEST_F(SoftI2cTest, ReadsEveryValue) {
  for (unsigned value = 0; value < 256; ++value) {
    bench.bus.expander = static_cast<std::uint8_t>(value);
    master.read(MotorBus::kExpander);
    run();
    ASSERT_EQ(master.state(), I2cBus::kIdle);
    EXPECT_EQ(master.byte(), value);
  }
  ASSERT_EQ(write(MotorBus::kMultiplexer, {1}), I2cBus::kIdle) << "and the bus is free";
  expect_at_rest();
}

TEST_F(SoftI2cTest, NobodyAtTheAddressIsAFailureAndTheBusIsFree) {
  bench.bus.multiplexer = false;
  EXPECT_EQ(write(MotorBus::kMultiplexer, {1}), I2cBus::kFailed);
  master.read(MotorBus::kExpander);
  run();
  EXPECT_EQ(master.state(), I2cBus::kFailed);
  expect_at_rest();
}

TEST_F(SoftI2cTest, APartThatHoldsTheDataLineIsGivenUpToNineClocks) {
  for (int clocks = 1; clocks <= 9; ++clocks) {
    bench.bus.hold_data(clocks);
    ASSERT_EQ(write(MotorBus::kMultiplexer, {0x10}), I2cBus::kIdle) << clocks;
    ASSERT_EQ(write(MotorBus::kDriver, {0x02, static_cast<std::uint8_t>(clocks)}), I2cBus::kIdle);
    EXPECT_EQ(bench.bus.running(4), clocks);
  }
  expect_at_rest();
}

TEST_F(SoftI2cTest, ADataLineThatIsHeldForEverIsAFailureAfterTenClocks) {
  bench.bus.hold_data(1'000'000);
  const std::uint64_t before = bench.bus.clocks();
  EXPECT_EQ(write(MotorBus::kMultiplexer, {1}), I2cBus::kFailed);
  EXPECT_LE(bench.bus.clocks() - before, 10u);
  EXPECT_FALSE(bench.clock_low || bench.data_low);
  bench.bus.hold_data(0);
  bench.drive();
  EXPECT_EQ(write(MotorBus::kMultiplexer, {1}), I2cBus::kIdle);
}

TEST_F(SoftI2cTest, AStretchedClockIsWaitedForBelowAMillisecond) {
  bench.bus.stretch_us = 900;
  EXPECT_EQ(write(MotorBus::kMultiplexer, {1}), I2cBus::kIdle);
  bench.bus.stretch_us = 1200;
  EXPECT_EQ(write(MotorBus::kMultiplexer, {1}), I2cBus::kFailed);
  EXPECT_FALSE(bench.clock_low || bench.data_low);
}

// For a clock release at any time between two steps.
TEST_F(SoftI2cTest, AStretchedClockIsHighForItsTimeToo) {
  for (std::uint32_t us = 1; us < 40; ++us) {
    bench.bus.stretch_us = us;
    for (int shift = 0; shift < 20; ++shift) {
      bench.pass(70);
      ASSERT_EQ(write(MotorBus::kMultiplexer, {1}), I2cBus::kIdle);
    }
  }
  expect_at_rest();
}

TEST_F(SoftI2cTest, AClockThatIsHeldForEverIsAFailureAfterAMillisecond) {
  bench.bus.holds_clock = true;
  const std::uint64_t began_ns = bench.now_ns;
  EXPECT_EQ(write(MotorBus::kMultiplexer, {1}), I2cBus::kFailed);
  EXPECT_EQ(write(MotorBus::kMultiplexer, {1}), I2cBus::kFailed) << "held from the start";
  EXPECT_LE(bench.now_ns - began_ns, 2'200'000u);
  EXPECT_FALSE(bench.clock_low || bench.data_low);
}

// A device holds the data line from any edge on: the transfer ends, with or without success, and
// the next one succeeds.
TEST_F(SoftI2cTest, AHoldAtAnyMomentEndsAndTheNextTransferIsGood) {
  for (int at = 0; at < 12; ++at) {
    const std::uint8_t bytes[2] = {0x02, 0xFF};
    ASSERT_EQ(write(MotorBus::kMultiplexer, {0x02}), I2cBus::kIdle);
    master.write(MotorBus::kDriver, bytes, 2);
    for (int step = 0; step < at && master.busy(); ++step) {
      bench.now_ns += kStepNs;
      master.step(static_cast<std::uint8_t>(bench.now_ns / kTickNs));
    }
    bench.bus.hold_data(5);
    bench.bus.drive(bench.now_ns, bench.clock_low, bench.data_low);
    run();
    ASSERT_EQ(write(MotorBus::kMultiplexer, {0x02}), I2cBus::kIdle) << at;
    ASSERT_EQ(write(MotorBus::kDriver, {0x02, 0x33}), I2cBus::kIdle) << at;
    EXPECT_EQ(bench.bus.running(1), 0x33) << at;
  }
}

}  // namespace
}  // namespace firmware
