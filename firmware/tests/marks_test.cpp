// Index marks on the AVR boards: Hall switches on an expander that shares the motors' bus, read by
// the actual .elf of each board in simavr.
#include "commands_fixture.h"

#include <cstdio>

namespace firmware_sim {
namespace {

constexpr int kReadMs = 4;  // between reads

class Marks : public testing::TestWithParam<Board> {
 protected:
  // A frame every millisecond, or every four.
  int frame_ms() const { return GetParam() == Board::mega32u4 ? 1 : 4; }
  void expect_frames_for(MotorCabinet& cabinet, int ms, std::uint8_t marks) {
    cabinet.take();
    cabinet.sim.advance_us(1000u * static_cast<unsigned>(ms));
    const Frames frames = cabinet.take();
    EXPECT_NEAR(static_cast<double>(frames.good.size()), ms / frame_ms(), 2);
    for (const wire::DeviceFrame& frame : frames.good) EXPECT_EQ(frame.index, marks);
  }
};
INSTANTIATE_TEST_SUITE_P(Boards, Marks, testing::Values(Board::mega32u4, Board::mega2560),
                         [](const auto& chosen) { return name_of(chosen.param); });

// The expander's byte: a pin is low while its magnet is near.
void show(MotorCabinet& cabinet, unsigned under) {
  cabinet.sim.motors().expander = static_cast<std::uint8_t>(~under);
}

// From the first read on: the number of reads and the max time between two.
struct Readings {
  std::size_t count = 0;
  double longest_ms = 0;
};
Readings readings_from(const MotorBus& bus, std::size_t first) {
  Readings readings;
  for (std::size_t i = first + 1; i < bus.reads_ns().size(); ++i) {
    readings.longest_ms = std::max(
        readings.longest_ms, static_cast<double>(bus.reads_ns()[i] - bus.reads_ns()[i - 1]) * 1e-6);
    ++readings.count;
  }
  return readings;
}

TEST_P(Marks, AreInAFrameWithinAReadingAndAFrameAfterTheyChanged) {
  MotorCabinet cabinet(GetParam());
  show(cabinet, 0);
  ASSERT_TRUE(cabinet.start());
  cabinet.sim.advance_us(200'000);  // the mice are at rest
  std::mt19937 random(5);
  std::uint64_t longest_us = 0;
  for (int i = 0; i < 60; ++i) {
    cabinet.sim.advance_us(8'000 + random() % 4000);
    cabinet.take();
    const unsigned under = random() % 256;
    show(cabinet, under);
    const std::uint64_t changed_us = cabinet.sim.now_us();
    bool seen = false;
    for (int step = 0; step < 300 && !seen; ++step) {
      cabinet.sim.advance_us(100);
      seen = !cabinet.take().good.empty() && cabinet.last().index == under;
    }
    ASSERT_TRUE(seen);
    longest_us = std::max(longest_us, cabinet.sim.now_us() - changed_us);
  }
  std::printf("%s: from a switch to the report at most %llu us\n", name_of(GetParam()).c_str(),
              static_cast<unsigned long long>(longest_us));
  EXPECT_LE(longest_us, 1000u * static_cast<unsigned>(kReadMs + frame_ms() + 2));
  cabinet.expect_no_fault();
}

TEST_P(Marks, APulseStillBeginsWithin2MsWithAllMiceMoving) {
  MotorCabinet cabinet(GetParam(), mixed_mice());
  show(cabinet, 0x24);
  ASSERT_TRUE(cabinet.start());
  Shaker shaker;
  std::uint64_t longest_us = 0;
  for (int round = 0; round < 100; ++round) {
    const int rod = round % 8, amplitude = 40 + round;
    cabinet.send(pulse_command(rod, amplitude, 8));
    for (int ms = 0; ms < 12; ++ms) shaker.step(cabinet.sim);
    cabinet.sim.advance_us(static_cast<std::uint64_t>(137 * round % 1000));
    const std::uint64_t sent_us = cabinet.sim.last_sent_us();
    const auto begun = cabinet.written_us(rod, amplitude, sent_us);
    ASSERT_TRUE(begun) << round;
    longest_us = std::max(longest_us, *begun - sent_us);
  }
  std::printf("%s: from a command to its write at most %llu us\n", name_of(GetParam()).c_str(),
              static_cast<unsigned long long>(longest_us));
  EXPECT_LE(longest_us, 2000u);
  cabinet.settle();
  EXPECT_EQ(cabinet.take().errors(), 0u);
  EXPECT_EQ(cabinet.last().index, 0x24);
  expect_counts(cabinet.last(), shaker.moved);
  cabinet.expect_no_fault();
}

// Idle fraction of the processor, read interval of the switches, and no lost counts.
TEST_P(Marks, AreReadBesideEightMovingMiceAndPlayingMotors) {
  for (const int pulse_ms : {0, 10}) {
    MotorCabinet cabinet(GetParam(), mixed_mice());
    show(cabinet, 0x81);
    ASSERT_TRUE(cabinet.start());
    Shaker shaker;
    cabinet.sim.reset_idle();
    const std::size_t first = cabinet.sim.motors().reads_ns().size();
    for (int ms = 0; ms < 3000; ++ms) {
      if (pulse_ms != 0 && ms % pulse_ms == 0)
        cabinet.send(pulse_command(ms / pulse_ms % 8, 60, 15));
      shaker.step(cabinet.sim);
    }
    const double idle = cabinet.sim.idle_share();
    const Readings readings = readings_from(cabinet.sim.motors(), first);
    const Frames frames = cabinet.take();
    std::printf("%s, %s: %.0f%% of the processor left; a reading each %.1f ms, at most %.1f\n",
                name_of(GetParam()).c_str(), pulse_ms == 0 ? "no pulses" : "a pulse each 10 ms",
                100 * idle, 3000.0 / static_cast<double>(readings.count), readings.longest_ms);
    EXPECT_GT(idle, 0.05);
    EXPECT_EQ(frames.errors(), 0u);
    EXPECT_EQ(frames.bad, 0);
    const double nominal = 3000.0 / frame_ms();
    EXPECT_NEAR(static_cast<double>(frames.good.size()), nominal, 0.01 * nominal);
    EXPECT_LT(3000.0 / static_cast<double>(readings.count), kReadMs + 2);
    ASSERT_TRUE(cabinet.settle());
    cabinet.take();
    expect_counts(cabinet.last(), shaker.moved);
    cabinet.expect_no_fault();
  }
}

TEST_P(Marks, AnExpanderThatComesLaterIsFoundWithinASecondAndOneThatVanishesLeavesNone) {
  MotorCabinet cabinet(GetParam());
  ASSERT_TRUE(cabinet.start());
  expect_frames_for(cabinet, 200, 0);
  show(cabinet, 0x81);
  const auto marks_are = [&](std::uint8_t marks) {
    return [&cabinet, marks] {
      cabinet.take();
      return cabinet.last().index == marks;
    };
  };
  EXPECT_TRUE(cabinet.advance_until(marks_are(0x81), 1100));
  cabinet.sim.motors().expander.reset();
  EXPECT_TRUE(cabinet.advance_until(marks_are(0), 20));
  expect_frames_for(cabinet, 100, 0);
  cabinet.expect_no_fault();
}

TEST_P(Marks, OnABusThatIsStuckThereAreNoneAndTheFramesGoOn) {
  MotorCabinet cabinet(GetParam());
  show(cabinet, 0xFF);
  ASSERT_TRUE(cabinet.start());
  EXPECT_EQ(cabinet.last().index, 0xFF);
  cabinet.sim.motors().holds_clock = true;
  cabinet.sim.advance_us(20'000);
  expect_frames_for(cabinet, 300, 0);
  EXPECT_EQ(cabinet.sim.resets(), 0);
}

}  // namespace
}  // namespace firmware_sim
