#include "wire/device_command.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace wire::test {
namespace {

using Octets = std::vector<std::uint8_t>;

DeviceCommand pulse(std::uint8_t rod, std::uint8_t amplitude, std::uint16_t duration_ms) {
  DeviceCommand command{};
  command.kind = kPulseCommand;
  command.rod = rod;
  command.amplitude = amplitude;
  command.duration_ms = duration_ms;
  return command;
}

Octets octets_of(const DeviceCommand& command) {
  Octets bytes(kDeviceCommandBytes);
  encode_device_command(command, bytes.data());
  return bytes;
}

void seal(Octets& bytes) {
  device_put16(bytes.data() + 14, device_crc16(bytes.data(), 14));
}

bool accepted(const Octets& bytes) {
  DeviceCommand command{};
  return decode_device_command(bytes.data(), bytes.size(), command);
}

TEST(DeviceCommand, TheBytesAreThese) {
  DeviceCommand command = pulse(5, 200, 20);
  command.sequence = 0x1234;
  EXPECT_EQ(octets_of(command),
            (Octets{1, 1, 0x34, 0x12, 5, 200, 20, 0, 0, 0, 0, 0, 0, 0, 0xFF, 0x0F}));
  command = {};
  command.kind = kAllOffCommand;
  EXPECT_EQ(octets_of(command), (Octets{1, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xCD, 0x58}));
  command.kind = kSettingsCommand;
  command.resolution = 20;
  command.brightness = 64;
  command.ps2 = 0x81;
  command.switches = 1;
  EXPECT_EQ(octets_of(command),
            (Octets{1, 3, 0, 0, 0, 0, 0, 0, 20, 64, 0x81, 1, 0, 0, 0x5F, 0x8C}));
}

TEST(DeviceCommand, RoundTripIsExact) {
  std::mt19937_64 random(51);
  for (int i = 0; i < 1000; ++i) {
    DeviceCommand command =
        pulse(static_cast<std::uint8_t>(random() % 8), static_cast<std::uint8_t>(random()),
              static_cast<std::uint16_t>(1 + random() % kMaxPulseMs));
    command.sequence = static_cast<std::uint16_t>(random());
    const Octets bytes = octets_of(command);
    DeviceCommand decoded{};
    ASSERT_TRUE(decode_device_command(bytes.data(), bytes.size(), decoded));
    EXPECT_EQ(octets_of(decoded), bytes);
  }
}

TEST(DeviceCommand, WrongSizesAndEverySingleBitFlipAreRefusedAndLeaveTheCommandAlone) {
  Octets bytes = octets_of(pulse(2, 90, 100));
  DeviceCommand decoded = pulse(7, 1, 1);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const Octets part(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_FALSE(decode_device_command(part.data(), part.size(), decoded));
  }
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ 1 << bit % 8);
    EXPECT_FALSE(decode_device_command(bytes.data(), bytes.size(), decoded)) << bit;
    bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ 1 << bit % 8);
  }
  EXPECT_EQ(octets_of(decoded), octets_of(pulse(7, 1, 1)));
}

TEST(DeviceCommand, WhatIsOutOfRangeIsRefusedUnderARightCrcToo) {
  struct Case {
    std::size_t at;
    std::uint8_t value;
  };
  // Version, unknown kind, rod, durations of 0 and 256 ms, a setting in a pulse, the reserved
  // bytes.
  for (const Case& c : {Case{0, 2}, Case{1, 0}, Case{1, 6}, Case{4, 8}, Case{6, 0}, Case{7, 1},
                        Case{8, 1}, Case{12, 1}, Case{13, 1}}) {
    Octets bytes = octets_of(pulse(2, 90, 100));
    ASSERT_TRUE(accepted(bytes));
    bytes[c.at] = c.value;
    seal(bytes);
    EXPECT_FALSE(accepted(bytes)) << c.at;
  }
  DeviceCommand settings{};
  settings.kind = kSettingsCommand;
  settings.resolution = kMaxSensorResolution;
  EXPECT_TRUE(valid_device_command(settings));
  settings.resolution = 0;
  EXPECT_FALSE(valid_device_command(settings));
  settings.resolution = kMaxSensorResolution + 1;
  EXPECT_FALSE(valid_device_command(settings));
  settings.resolution = 20;
  settings.switches = 3;
  EXPECT_TRUE(valid_device_command(settings));
  settings.switches = 4;
  EXPECT_FALSE(valid_device_command(settings));
}

TEST(DeviceCommand, AStickHasATravelAndATurnOrNoneAndNothingOfOtherKinds) {
  DeviceCommand stick{};
  stick.kind = kStickCommand;
  stick.rod = 7;
  EXPECT_TRUE(accepted(octets_of(stick))) << "by the table's dimensions";
  stick.travel = 0x1234;
  stick.turn = kMinStickCounts;
  stick.reversed = 3;
  const Octets bytes = octets_of(stick);
  EXPECT_EQ(Octets(bytes.begin(), bytes.begin() + 14),
            (Octets{1, 4, 0, 0, 7, 3, 0, 0, 0x34, 0x12, 64, 0, 0, 0}));
  DeviceCommand decoded{};
  ASSERT_TRUE(decode_device_command(bytes.data(), bytes.size(), decoded));
  EXPECT_EQ(decoded.travel, 0x1234);
  EXPECT_EQ(decoded.turn, 64);
  EXPECT_EQ(decoded.reversed, 3);
  EXPECT_EQ(decoded.resolution, 0);
  struct Case {
    std::size_t at;
    std::uint8_t value;
  };
  // Unknown rod, unknown direction, a duration, travel too small, turn too small, reserved.
  for (const Case& c :
       {Case{4, 8}, Case{5, 4}, Case{6, 1}, Case{9, 0}, Case{10, 63}, Case{12, 1}}) {
    Octets broken = bytes;
    broken[c.at] = c.value;
    seal(broken);
    EXPECT_FALSE(accepted(broken)) << c.at;
  }
}

TEST(DeviceCommand, GarbageIsRefusedOrComesBackToTheBit) {
  std::mt19937_64 random(52);
  for (int i = 0; i < 20'000; ++i) {
    Octets bytes(kDeviceCommandBytes);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random() % (i % 2 ? 256 : 4));
    bytes[0] = kDeviceCommandVersion;
    seal(bytes);
    DeviceCommand command{};
    if (decode_device_command(bytes.data(), bytes.size(), command)) {
      EXPECT_EQ(octets_of(command), bytes);
    }
  }
}

}  // namespace
}  // namespace wire::test
