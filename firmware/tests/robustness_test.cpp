// Settings in EEPROM, the watchdog and the LED of the actual .elf of each board in simavr.
#include <cstdio>

#include "commands_fixture.h"

namespace firmware_sim {
namespace {

constexpr std::uint64_t kLongestResetUs = 140'000;

class OnBoard : public testing::TestWithParam<Board> {};
INSTANTIATE_TEST_SUITE_P(Boards, OnBoard, testing::Values(Board::mega32u4, Board::mega2560),
                         [](const auto& chosen) { return name_of(chosen.param); });

constexpr std::uint64_t kSavedUs = 300'000;  // 42 bytes of 3.4 ms, plus the loop's other work

// Number of ticks of 100 ms with light, out of ten, and the max pulse width.
struct Light {
  int lit = 0;
  std::uint8_t width = 0;
};
Light light_of(MotorCabinet& cabinet) {
  Light light;
  for (int i = 0; i < 20; ++i) {
    cabinet.sim.advance_us(50'000);
    if (cabinet.sim.led() != 0) ++light.lit;
    light.width = std::max(light.width, cabinet.sim.led());
  }
  light.lit /= 2;
  return light;
}

TEST_P(OnBoard, SettingsAreKeptThroughPowerOffAndWrittenOnlyWhenTheyDiffer) {
  std::vector<std::uint8_t> kept;
  {
    MotorCabinet cabinet(GetParam());
    ASSERT_TRUE(cabinet.start());
    cabinet.send(settings_command(200));
    cabinet.sim.advance_us(kSavedUs);
    const std::uint64_t writes = cabinet.sim.eeprom_writes();
    EXPECT_GT(writes, 0u);
    cabinet.send(settings_command(200));
    cabinet.sim.advance_us(kSavedUs);
    EXPECT_EQ(cabinet.sim.eeprom_writes(), writes);
    cabinet.expect_no_fault();
    kept = cabinet.sim.eeprom();
  }
  CabinetOptions options;
  options.eeprom = kept;
  MotorCabinet again(GetParam(), options);
  ASSERT_TRUE(again.start());
  EXPECT_EQ(light_of(again).width, 200 * 200 / 255 + 1);
}

TEST_P(OnBoard, SavingSettingsKeepsFramesAndCountsGoing) {
  MotorCabinet cabinet(GetParam());
  ASSERT_TRUE(cabinet.start());
  Shaker shaker;
  for (int ms = 0; ms < 500; ++ms) {
    if (ms % 100 == 0) cabinet.send(settings_command(1 + ms / 4));
    shaker.step(cabinet.sim);
  }
  const Frames frames = cabinet.take();
  EXPECT_EQ(frames.errors(), 0u);
  EXPECT_GE(frames.good.size(), GetParam() == Board::mega32u4 ? 495u : 124u);
  ASSERT_TRUE(cabinet.settle());
  cabinet.take();
  expect_counts(cabinet.last(), shaker.moved);
  cabinet.expect_no_fault();
}

// Saves brightness 200, then 100, with a power failure after each byte of it.
TEST_P(OnBoard, PowerThatFailsWhileSavingLeavesTheOldTheNewOrTheDefaultSettings) {
  MotorCabinet cabinet(GetParam());
  ASSERT_TRUE(cabinet.start());
  cabinet.send(settings_command(200));
  cabinet.sim.advance_us(kSavedUs);
  const std::uint64_t before = cabinet.sim.eeprom_writes();
  cabinet.send(settings_command(100));
  std::vector<std::vector<std::uint8_t>> torn;
  for (std::uint64_t bytes = 0; cabinet.sim.eeprom_writes() < before + 5; ++bytes) {
    ASSERT_TRUE(
        cabinet.advance_until([&] { return cabinet.sim.eeprom_writes() >= before + bytes; }, 100));
    torn.push_back(cabinet.sim.eeprom());
  }
  ASSERT_EQ(torn.size(), 6u);
  const auto width = [](int brightness) { return (brightness * brightness + 254) / 255; };
  for (const auto& eeprom : torn) {
    CabinetOptions options;
    options.eeprom = eeprom;
    MotorCabinet again(GetParam(), options);
    again.sim.advance_us(300'000);
    const Light light = light_of(again);
    EXPECT_TRUE(light.width == width(200) || light.width == width(64) || light.width == width(100))
        << int{light.width};
  }
}

TEST_P(OnBoard, AStuckProgramIsResetComesBackAndSaysSo) {
  for (const bool interrupts_off : {false, true}) {
    MotorCabinet cabinet(GetParam());
    ASSERT_TRUE(cabinet.start());
    EXPECT_EQ(cabinet.take().errors(), 0u);
    cabinet.sim.stick_program(interrupts_off);
    const std::uint64_t stuck_us = cabinet.sim.now_us();
    ASSERT_TRUE(cabinet.advance_until([&] { return cabinet.sim.resets() == 1; }, 200));
    const std::uint64_t reset_us = cabinet.sim.now_us() - stuck_us;
    std::printf("%s: reset %llu ms after the program was stuck\n", name_of(GetParam()).c_str(),
                static_cast<unsigned long long>(reset_us / 1000));
    EXPECT_LE(reset_us, kLongestResetUs);
    EXPECT_FALSE(cabinet.sim.motors_enabled());
    cabinet.take();
    ASSERT_TRUE(cabinet.advance_until([&] { return !cabinet.take().good.empty(); }, 200) ||
                cabinet.last().quality > 0);
    unsigned errors = cabinet.last().quality;
    ASSERT_TRUE(cabinet.advance_until(
        [&] {
          errors += cabinet.take().errors();
          return cabinet.last().present == 0xFF;
        },
        3000));
    EXPECT_GE(errors, 1u);
    cabinet.send(pulse_command(5, 99, 100));
    cabinet.sim.advance_us(20'000);
    EXPECT_EQ(cabinet.sim.motors().running(5), 99);
    EXPECT_EQ(cabinet.sim.resets(), 1);
    EXPECT_EQ(light_of(cabinet).lit, 8) << "steady but for two gaps";
  }
}

TEST_P(OnBoard, APlainStartIsNoResetByTheWatchdog) {
  MotorCabinet cabinet(GetParam());
  ASSERT_TRUE(cabinet.start());
  cabinet.sim.advance_us(1'000'000);
  EXPECT_EQ(cabinet.take().errors(), 0u);
  EXPECT_EQ(cabinet.sim.resets(), 0);
}

TEST_P(OnBoard, TheLedSaysNoMouseNotAllAllIsWell) {
  MotorCabinet cabinet(GetParam());
  for (int rod = 0; rod < kMice; ++rod) cabinet.sim.mouse(rod).unplug();
  cabinet.sim.advance_us(500'000);
  EXPECT_EQ(light_of(cabinet).lit, 1);
  cabinet.sim.mouse(2).replug();
  ASSERT_TRUE(cabinet.wait_for_present(4));
  cabinet.sim.advance_us(100'000);
  EXPECT_EQ(light_of(cabinet).lit, 9);
  for (int rod = 0; rod < kMice; ++rod) {
    if (rod != 2) cabinet.sim.mouse(rod).replug();
  }
  ASSERT_TRUE(cabinet.wait_for_present(0xFF));
  cabinet.sim.advance_us(100'000);
  const Light light = light_of(cabinet);
  EXPECT_EQ(light.lit, 10);
  EXPECT_EQ(light.width, 64 * 64 / 255 + 1);
}

TEST(Led, SaysThatNoHostReads) {
  MotorCabinet cabinet(Board::mega32u4);
  cabinet.sim.usb_unplug();
  cabinet.sim.advance_us(500'000);
  EXPECT_EQ(light_of(cabinet).lit, 5);
}

}  // namespace
}  // namespace firmware_sim
