#include "core/settings.h"

#include <gtest/gtest.h>

namespace firmware {
namespace {

TEST(Settings, ComeBackAndEverySingleBitFlipIsRefused) {
  Settings settings;
  settings.resolution = 60;
  settings.brightness = 200;
  settings.ps2 = 0x0F;
  settings.switches = kPulsesOff;
  std::uint8_t bytes[kSettingsBytes];
  encode_settings(settings, bytes);
  Settings read;
  ASSERT_TRUE(decode_settings(bytes, read));
  EXPECT_EQ(read.resolution, 60);
  EXPECT_EQ(read.brightness, 200);
  EXPECT_EQ(read.ps2, 0x0F);
  EXPECT_EQ(read.switches, kPulsesOff);
  for (unsigned bit = 0; bit < 8 * sizeof bytes; ++bit) {
    bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ 1u << bit % 8);
    EXPECT_FALSE(decode_settings(bytes, read)) << bit;
    bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ 1u << bit % 8);
  }
}

TEST(Settings, AnErasedSectorHasNone) {
  std::uint8_t bytes[kSettingsBytes];
  for (auto& byte : bytes) byte = 0xFF;
  Settings settings;
  EXPECT_FALSE(decode_settings(bytes, settings));
  EXPECT_EQ(settings.resolution, 20);
}

}  // namespace
}  // namespace firmware
