#include "core/settings.h"

#include <gtest/gtest.h>

#include <array>

#include "core/settings_store.h"

namespace firmware {
namespace {

bool same(const wire::StickScale& a, const wire::StickScale& b) {
  return a.travel == b.travel && a.turn == b.turn;
}
bool same(const wire::DeviceSettings& a, const wire::DeviceSettings& b) {
  for (int rod = 0; rod < wire::kDeviceRods; ++rod) {
    if (!same(a.sticks[rod], b.sticks[rod])) return false;
  }
  return a.resolution == b.resolution && a.brightness == b.brightness && a.ps2 == b.ps2 &&
         a.switches == b.switches && a.slide_reversed == b.slide_reversed &&
         a.spin_reversed == b.spin_reversed;
}

TEST(Settings, ComeBackAndEverySingleBitFlipIsRefused) {
  wire::DeviceSettings settings;
  settings.resolution = 60;
  settings.brightness = 200;
  settings.ps2 = 0x0F;
  settings.switches = wire::kPulsesOff | wire::kGamepads;
  settings.sticks[7] = {2016, 402};
  settings.slide_reversed = 0x81;
  settings.spin_reversed = 0x42;
  std::uint8_t bytes[kKeptBytes];
  encode_kept(settings, bytes);
  wire::DeviceSettings read;
  ASSERT_TRUE(decode_kept(bytes, read));
  EXPECT_EQ(read.resolution, 60);
  EXPECT_EQ(read.brightness, 200);
  EXPECT_EQ(read.ps2, 0x0F);
  EXPECT_EQ(read.switches, 3);
  EXPECT_EQ(read.sticks[7].travel, 2016);
  EXPECT_EQ(read.sticks[7].turn, 402);
  EXPECT_EQ(read.sticks[6].travel, 0);
  EXPECT_EQ(read.slide_reversed, 0x81);
  EXPECT_EQ(read.spin_reversed, 0x42);
  for (unsigned bit = 0; bit < 8 * sizeof bytes; ++bit) {
    bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ 1u << bit % 8);
    EXPECT_FALSE(decode_kept(bytes, read)) << bit;
    bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ 1u << bit % 8);
  }
}

// As stored by earlier controllers: the old bytes with their CRC.
TEST(Settings, ThoseOfVersion1AreReadAndHaveNoSticks) {
  std::uint8_t bytes[kKeptBytes];
  for (auto& byte : bytes) byte = 0xFF;
  const std::uint8_t before[] = {1, 60, 200, 0x0F, 1, 0, 0, 0};
  for (std::size_t i = 0; i < sizeof before; ++i) bytes[i] = before[i];
  wire::device_put16(bytes + 6, wire::device_crc16(bytes, 6));
  wire::DeviceSettings settings;
  ASSERT_TRUE(decode_kept(bytes, settings));
  EXPECT_EQ(settings.resolution, 60);
  EXPECT_EQ(settings.brightness, 200);
  EXPECT_EQ(settings.ps2, 0x0F);
  EXPECT_EQ(settings.switches, wire::kPulsesOff);
  for (const wire::StickScale& stick : settings.sticks)
    EXPECT_TRUE(same(stick, wire::StickScale()));
  bytes[4] = 2;  // a switch that version 1 did not have
  wire::device_put16(bytes + 6, wire::device_crc16(bytes, 6));
  EXPECT_FALSE(decode_kept(bytes, settings));
}

TEST(Settings, AScaleThatIsNoTravelIsRefusedUnderARightCrcToo) {
  wire::DeviceSettings settings;
  std::uint8_t bytes[kKeptBytes];
  for (const int at : {6, 8, 34, 36}) {
    encode_kept(settings, bytes);
    bytes[at] = 63;
    wire::device_put16(bytes + 40, wire::device_crc16(bytes, 40));
    EXPECT_FALSE(decode_kept(bytes, settings)) << at;
  }
}

wire::DeviceCommand stick_command(std::uint8_t rod, std::uint16_t travel, std::uint16_t turn,
                                  std::uint8_t reversed) {
  wire::DeviceCommand command{};
  command.kind = wire::kStickCommand;
  command.rod = rod;
  command.travel = travel;
  command.turn = turn;
  command.reversed = reversed;
  return command;
}

TEST(Settings, ACommandForAStickChangesThatRodAloneAndSaysWhetherItDid) {
  wire::DeviceSettings settings;
  settings.slide_reversed = 0x08;
  EXPECT_TRUE(take_stick(stick_command(5, 2016, 402, wire::kSpinReversed), settings));
  EXPECT_FALSE(take_stick(stick_command(5, 2016, 402, wire::kSpinReversed), settings));
  EXPECT_TRUE(same(settings.sticks[5], wire::StickScale{2016, 402}));
  EXPECT_TRUE(same(settings.sticks[4], wire::StickScale{}));
  EXPECT_EQ(settings.slide_reversed, 0x08);
  EXPECT_EQ(settings.spin_reversed, 0x20);
  EXPECT_TRUE(take_stick(stick_command(5, 0, 0, 0), settings));
  EXPECT_EQ(settings.spin_reversed, 0);
  wire::DeviceCommand command{};
  command.kind = wire::kSettingsCommand;
  command.resolution = settings.resolution;
  command.brightness = settings.brightness;
  EXPECT_FALSE(take_settings(command, settings));
  command.switches = wire::kGamepads;
  EXPECT_TRUE(take_settings(command, settings));
  EXPECT_EQ(settings.switches, wire::kGamepads);
  EXPECT_EQ(settings.slide_reversed, 0x08);
  // The measured values were in counts of the old resolution.
  EXPECT_TRUE(take_stick(stick_command(5, 900, 300, 0), settings));
  command.resolution = static_cast<std::uint8_t>(settings.resolution + 1);
  EXPECT_TRUE(take_settings(command, settings));
  for (const wire::StickScale& stick : settings.sticks)
    EXPECT_TRUE(same(stick, wire::StickScale{}));
  EXPECT_EQ(settings.slide_reversed, 0);
}

TEST(Settings, AnErasedSectorHasNone) {
  std::uint8_t bytes[kKeptBytes];
  for (auto& byte : bytes) byte = 0xFF;
  wire::DeviceSettings settings;
  EXPECT_FALSE(decode_kept(bytes, settings));
  EXPECT_EQ(settings.resolution, 20);
}

// A memory that takes some polls for each byte, and loses power after a given number of bytes.
struct Memory {
  static inline std::array<std::uint8_t, kKeptBytes> bytes;
  static inline int busy, writes, supplied_writes;

  static void erase() {
    bytes.fill(0xFF);
    busy = writes = 0;
    supplied_writes = 1000;
  }
  static bool ready() { return busy == 0 || --busy == 0; }
  static std::uint8_t read(std::uint8_t at) {
    EXPECT_EQ(busy, 0);
    return bytes[at];
  }
  static void write(std::uint8_t at, std::uint8_t value) {
    EXPECT_EQ(busy, 0);
    busy = 3;
    if (writes == supplied_writes) return;
    ++writes;
    bytes[at] = value;
  }
};
using Store = SettingsStore<Memory>;

wire::DeviceSettings settings_with(std::uint8_t resolution, std::uint8_t brightness,
                                   std::uint8_t ps2, std::uint8_t switches) {
  wire::DeviceSettings settings;
  settings.resolution = resolution;
  settings.brightness = brightness;
  settings.ps2 = ps2;
  settings.switches = switches;
  return settings;
}

void save(const wire::DeviceSettings& settings) {
  Store store;
  store.save(settings);
  for (int step = 0; store.saving() && step < 1000; ++step) store.step();
  EXPECT_FALSE(store.saving());
  Memory::busy = 0;
}

TEST(SettingsStore, WhatIsSavedIsLoadedAndSavedAgainIsNotWritten) {
  Memory::erase();
  wire::DeviceSettings settings;
  EXPECT_FALSE(Store::load(settings));
  const wire::DeviceSettings wanted = settings_with(60, 200, 0x0F, wire::kPulsesOff);
  save(wanted);
  ASSERT_TRUE(Store::load(settings));
  EXPECT_TRUE(same(settings, wanted));
}

// All pairs of a few settings, with power lost after each number of bytes: never a mixture.
TEST(SettingsStore, PowerLostWhileSavingLeavesOldNewOrNone) {
  const wire::DeviceSettings some[] = {settings_with(20, 64, 0, 0), settings_with(20, 65, 0, 0),
                                       settings_with(60, 200, 0xFF, wire::kPulsesOff),
                                       settings_with(1, 0, 1, 0)};
  for (const wire::DeviceSettings& before : some) {
    for (const wire::DeviceSettings& after : some) {
      for (int bytes = 0; bytes <= kKeptBytes + 1; ++bytes) {
        Memory::erase();
        save(before);
        Memory::supplied_writes = Memory::writes + bytes;
        save(after);
        wire::DeviceSettings read;
        if (!Store::load(read)) continue;
        EXPECT_TRUE(same(read, before) || same(read, after)) << bytes;
      }
      wire::DeviceSettings read;
      ASSERT_TRUE(Store::load(read));
      EXPECT_TRUE(same(read, after));
    }
  }
}

TEST(SettingsStore, ASaveThatOvertakesAnotherWins) {
  const wire::DeviceSettings first = settings_with(20, 10, 0, 0),
                             second = settings_with(30, 20, 3, 1);
  for (int steps = 0; steps < 200; ++steps) {
    Memory::erase();
    Store store;
    store.save(first);
    for (int i = 0; i < steps; ++i) store.step();
    store.save(second);
    for (int i = 0; i < 300; ++i) store.step();
    Memory::busy = 0;
    wire::DeviceSettings read;
    ASSERT_TRUE(Store::load(read)) << steps;
    EXPECT_TRUE(same(read, second)) << steps;
  }
}

}  // namespace
}  // namespace firmware
