// The ATmega32U4's own USB stack against a simulated host.
#include <algorithm>

#include "cabinet_fixture.h"

namespace firmware_sim {
namespace {

using Request = std::array<std::uint8_t, 8>;

struct Usb : testing::Test {
  Cabinet cabinet{Board::mega32u4};
  void SetUp() override {
    ASSERT_TRUE(cabinet.advance_until([&] { return cabinet.sim.usb_configured(); }, 500));
  }
};

TEST_F(Usb, SaysThatItIsTheCabinet) {
  const auto& device = cabinet.sim.device_descriptor();
  ASSERT_EQ(device.size(), 18u);
  EXPECT_EQ(device[8] | device[9] << 8, 0x1209);
  EXPECT_EQ(device[10] | device[11] << 8, 0x0001);
}

// The serial number identifies a cabinet's calibration.
TEST_F(Usb, EachChipHasASerialNumberOfItsOwn) {
  EXPECT_EQ(cabinet.sim.device_descriptor()[16], 3);
  const auto text = [](const std::vector<std::uint8_t>& descriptor) {
    std::string digits;
    for (std::size_t i = 2; i < descriptor.size(); i += 2) {
      digits += static_cast<char>(descriptor[i]);
      EXPECT_EQ(descriptor[i + 1], 0);
    }
    EXPECT_EQ(descriptor[0], descriptor.size());
    EXPECT_EQ(descriptor[1], 3);
    return digits;
  };
  EXPECT_EQ(text(cabinet.sim.serial_descriptor()), "5936343231390B1CA0FE");
  CabinetOptions options;
  options.unique_id[9] = 0xFF;
  Cabinet other(Board::mega32u4, options);
  ASSERT_TRUE(other.advance_until([&] { return other.sim.usb_configured(); }, 500));
  EXPECT_EQ(text(other.sim.serial_descriptor()), "5936343231390B1CA0FF");
}

TEST_F(Usb, TheConfigurationIsOneHidInterfacePolledEveryMillisecond) {
  const auto& bytes = cabinet.sim.configuration_descriptor();
  ASSERT_GE(bytes.size(), 9u);
  EXPECT_EQ(static_cast<std::size_t>(bytes[2] | bytes[3] << 8), bytes.size());
  std::vector<int> kinds, endpoints;
  for (std::size_t at = 0; at < bytes.size(); at += bytes[at]) {
    ASSERT_GE(bytes[at], 2);
    ASSERT_LE(at + bytes[at], bytes.size());
    kinds.push_back(bytes[at + 1]);
    if (bytes[at + 1] == 4) {
      EXPECT_EQ(bytes[at + 5], 3) << "class HID";
    }
    if (bytes[at + 1] == 0x21) {
      EXPECT_EQ(static_cast<std::size_t>(bytes[at + 7] | bytes[at + 8] << 8),
                cabinet.sim.report_descriptor().size());
    }
    if (bytes[at + 1] == 5) {
      endpoints.push_back(bytes[at + 2]);
      EXPECT_EQ(bytes[at + 4] | bytes[at + 5] << 8, 64);
      EXPECT_EQ(bytes[at + 6], 1);
    }
  }
  EXPECT_EQ(kinds, (std::vector<int>{2, 4, 0x21, 5, 5}));
  EXPECT_EQ(endpoints, (std::vector<int>{0x81, 0x02}));
}

TEST_F(Usb, TheReportIs64BytesOnAVendorPage) {
  const auto& bytes = cabinet.sim.report_descriptor();
  ASSERT_GE(bytes.size(), 3u);
  EXPECT_EQ(bytes[0], 0x06);
  EXPECT_EQ(bytes[2], 0xFF);
  const std::array<std::uint8_t, 4> eight_by_64{0x75, 8, 0x95, 64};
  EXPECT_NE(std::search(bytes.begin(), bytes.end(), eight_by_64.begin(), eight_by_64.end()),
            bytes.end());
}

TEST_F(Usb, AReportEndsInZeros) {
  cabinet.sim.advance_us(5000);
  const auto reports = cabinet.sim.take_reports();
  ASSERT_FALSE(reports.empty());
  const auto& bytes = reports.back().bytes;
  EXPECT_TRUE(std::all_of(bytes.begin() + wire::kDeviceFrameBytes, bytes.end(),
                          [](auto b) { return b == 0; }));
}

TEST_F(Usb, AReportCanAlsoBeAskedForByAControlTransfer) {
  cabinet.sim.advance_us(5000);
  for (const std::uint8_t asked : {std::uint8_t{64}, std::uint8_t{255}, std::uint8_t{46}}) {
    const auto result = cabinet.sim.control({0xA1, 1, 0, 1, 0, 0, asked, 0});
    EXPECT_FALSE(result.stalled);
    ASSERT_EQ(result.data.size(), std::min<std::size_t>(asked, 64));
    wire::DeviceFrame frame{};
    EXPECT_TRUE(wire::decode_device_frame(result.data.data(), wire::kDeviceFrameBytes, frame));
  }
}

TEST_F(Usb, AShorterDescriptorIsSentWhenLessIsAskedFor) {
  const auto result = cabinet.sim.control({0x80, 6, 0, 1, 0, 0, 8, 0});
  EXPECT_EQ(result.data.size(), 8u);
}

TEST_F(Usb, StandardQuestionsAreAnswered) {
  EXPECT_EQ(cabinet.sim.control({0x80, 0, 0, 0, 0, 0, 2, 0}).data,
            (std::vector<std::uint8_t>{1, 0}));
  EXPECT_EQ(cabinet.sim.control({0x80, 8, 0, 0, 0, 0, 1, 0}).data, (std::vector<std::uint8_t>{1}));
  EXPECT_EQ(cabinet.sim.control({0x81, 10, 0, 0, 0, 0, 1, 0}).data, (std::vector<std::uint8_t>{0}));
  EXPECT_FALSE(cabinet.sim.control({0x21, 10, 0, 7, 0, 0, 0, 0}).stalled);
  EXPECT_EQ(cabinet.sim.control({0xA1, 2, 0, 0, 0, 0, 1, 0}).data, (std::vector<std::uint8_t>{7}));
}

TEST_F(Usb, WhatItDoesNotKnowIsStalledAndNothingElseStops) {
  const std::array<Request, 6> unknown{{{0x80, 6, 9, 3, 9, 4, 255, 0},
                                        {0x80, 6, 0, 0x0F, 0, 0, 255, 0},
                                        {0x00, 9, 7, 0, 0, 0, 0, 0},
                                        {0xC0, 0x42, 0, 0, 0, 0, 8, 0},
                                        {0x21, 9, 0, 2, 0, 0, 0, 0},
                                        {0xA1, 1, 0, 3, 0, 0, 64, 0}}};
  for (const Request& request : unknown) {
    EXPECT_TRUE(cabinet.sim.control(request).stalled) << int{request[1]};
  }
  EXPECT_FALSE(cabinet.sim.control({0x80, 8, 0, 0, 0, 0, 1, 0}).stalled);
  cabinet.sim.take_reports();
  cabinet.sim.advance_us(100'000);
  EXPECT_NEAR(static_cast<double>(cabinet.sim.take_reports().size()), 100, 2);
}

TEST_F(Usb, AHaltedEndpointIsSilentUntilItIsCleared) {
  EXPECT_FALSE(cabinet.sim.control({0x02, 3, 0, 0, 0x81, 0, 0, 0}).stalled);
  EXPECT_EQ(cabinet.sim.control({0x82, 0, 0, 0, 0x81, 0, 2, 0}).data,
            (std::vector<std::uint8_t>{1, 0}));
  cabinet.sim.take_reports();
  cabinet.sim.advance_us(20'000);
  EXPECT_TRUE(cabinet.sim.take_reports().empty());
  EXPECT_FALSE(cabinet.sim.control({0x02, 1, 0, 0, 0x81, 0, 0, 0}).stalled);
  cabinet.sim.take_reports();
  cabinet.sim.advance_us(20'000);
  EXPECT_GE(cabinet.sim.take_reports().size(), 19u);
}

TEST_F(Usb, ABusResetIsFollowedByAnotherEnumerationAndTheCountsStand) {
  ASSERT_TRUE(cabinet.wait_for_present(0xFF));
  Moved moved;
  moved.move(cabinet.sim, 3, 40, 50);
  ASSERT_TRUE(cabinet.settle());
  cabinet.sim.usb_reset();
  ASSERT_TRUE(cabinet.advance_until([&] { return cabinet.sim.usb_configured(); }, 200));
  cabinet.sim.advance_us(10'000);
  cabinet.take();
  EXPECT_EQ(cabinet.last().present, 0xFF);
  expect_counts(cabinet.last(), moved);
}

TEST(Uart, RunsAtOneMegabaud) {
  Cabinet cabinet(Board::mega2560);
  cabinet.sim.advance_us(10'000);
  EXPECT_EQ(cabinet.sim.serial_baud(), 1'000'000u);
}

}  // namespace
}  // namespace firmware_sim
