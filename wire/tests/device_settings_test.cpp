#include "wire/device_settings.h"

#include <gtest/gtest.h>

#include <vector>

#include "samples.h"

namespace wire::test {
namespace {

using Report = std::vector<std::uint8_t>;

Report settings_report() {
  Report bytes(kDeviceFrameBytes);
  encode_settings_report(samples::device_settings(), kHasSensors | kCanBeGamepads, 0x1234,
                         bytes.data());
  return bytes;
}

bool reads(const Report& bytes) {
  SettingsReport report;
  return decode_settings_report(bytes.data(), bytes.size(), report);
}

TEST(DeviceSettings, TheBytesAreThese) {
  Report expected(kDeviceFrameBytes, 0);
  const Report head{0x81, 3, 2, 60, 200, 0x81, 3, 0};
  std::copy(head.begin(), head.end(), expected.begin());
  expected[20] = 0xC0;  // rod 3: travel 1216, turn 402
  expected[21] = 0x04;
  expected[22] = 0x92;
  expected[23] = 0x01;
  expected[40] = 0x08;
  expected[41] = 0x42;
  expected[42] = 0x34;
  expected[43] = 0x12;
  device_put16(expected.data() + 44, device_crc16(expected.data(), 44));
  EXPECT_EQ(settings_report(), expected);
}

TEST(DeviceSettings, AReportComesBackAndIsNoFrame) {
  const Report bytes = settings_report();
  SettingsReport report;
  ASSERT_TRUE(decode_settings_report(bytes.data(), bytes.size(), report));
  const DeviceSettings& read = report.settings;
  EXPECT_EQ(report.abilities, kHasSensors | kCanBeGamepads);
  EXPECT_EQ(report.sequence, 0x1234);
  EXPECT_EQ(read.resolution, 60);
  EXPECT_EQ(read.sticks[3].travel, 1216);
  EXPECT_EQ(read.sticks[3].turn, 402);
  EXPECT_EQ(read.sticks[2].travel, 0);
  EXPECT_EQ(read.slide_reversed, 0x08);
  EXPECT_EQ(read.spin_reversed, 0x42);
  DeviceFrame frame{};
  EXPECT_FALSE(decode_device_frame(bytes.data(), bytes.size(), frame));
  Report frame_bytes(kDeviceFrameBytes);
  encode_device_frame(frame, frame_bytes.data());
  EXPECT_FALSE(reads(frame_bytes));
}

TEST(DeviceSettings, OtherSizesAndEverySingleBitFlipAreRefused) {
  Report bytes = settings_report();
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(reads(Report(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size))));
  }
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ 1 << bit % 8);
    EXPECT_FALSE(reads(bytes)) << bit;
    bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ 1 << bit % 8);
  }
}

TEST(DeviceSettings, WhatIsOutOfRangeIsRefusedUnderARightCrcToo) {
  struct Case {
    std::size_t at;
    std::uint8_t value;
  };
  // Kind, abilities, version, resolution 0 and 121, switches, the reserved byte, a travel of 63.
  for (const Case& c : {Case{0, 0x82}, Case{1, 4}, Case{2, 1}, Case{2, 3}, Case{3, 0}, Case{3, 121},
                        Case{6, 4}, Case{7, 1}, Case{8, 63}}) {
    Report bytes = settings_report();
    bytes[c.at] = c.value;
    device_put16(bytes.data() + 44, device_crc16(bytes.data(), 44));
    EXPECT_FALSE(reads(bytes)) << c.at;
    EXPECT_EQ(is_settings_report(bytes.data(), bytes.size()), c.at != 0) << "of another version";
  }
}

}  // namespace
}  // namespace wire::test
