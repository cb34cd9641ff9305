#include "core/usb_requests.h"

#include <gtest/gtest.h>

#include <random>

#include "wire/device_frame.h"

namespace firmware {
namespace {

UsbAnswer ask(UsbRequests& requests, std::uint8_t type, std::uint8_t request, std::uint16_t value,
              std::uint16_t index, std::uint16_t length) {
  return requests.answer({type, request, value, index, length});
}

TEST(UsbRequests, AnyEightBytesAreAnsweredWithinBounds) {
  UsbRequests requests;
  const std::uint8_t report[wire::kDeviceReportBytes] = {};
  const std::uint8_t serial[] = {4, 3, '1', 0};
  requests.set_report(report);
  requests.set_serial(serial);
  std::mt19937 random(81);
  for (int i = 0; i < 200'000; ++i) {
    std::uint8_t bytes[8];
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random() % (i % 2 ? 256 : 12));
    if (i % 3 == 0) bytes[0] = static_cast<std::uint8_t>(bytes[0] | 0x80);
    const UsbSetup setup = read_setup(bytes);
    const UsbAnswer answer = requests.answer(setup);
    if (answer.kind == UsbAnswer::kSend) {
      EXPECT_TRUE(setup.to_host());
      EXPECT_NE(answer.bytes, nullptr);
      EXPECT_LE(answer.size, setup.length);
    }
    if (answer.kind == UsbAnswer::kTake) {
      EXPECT_LE(answer.size, wire::kDeviceReportBytes);
    }
  }
}

TEST(UsbRequests, AReplyOfWholePacketsEndsWithAnEmptyOneIfMoreWasAskedFor) {
  UsbRequests requests;
  const std::uint8_t report[wire::kDeviceReportBytes] = {};
  EXPECT_EQ(ask(requests, 0xA1, 1, 0x0100, 0, 64).kind, UsbAnswer::kStall) << "no report yet";
  requests.set_report(report);
  EXPECT_TRUE(ask(requests, 0xA1, 1, 0x0100, 0, 255).end_with_empty);
  EXPECT_FALSE(ask(requests, 0xA1, 1, 0x0100, 0, 64).end_with_empty);
  EXPECT_FALSE(ask(requests, 0x80, 6, 0x0100, 0, 255).end_with_empty);
}

TEST(UsbRequests, ABusResetForgetsAddressConfigurationAndHalts) {
  UsbRequests requests;
  EXPECT_EQ(ask(requests, 0x00, 9, 1, 0, 0).kind, UsbAnswer::kConfigure);
  EXPECT_EQ(ask(requests, 0x02, 3, 0, 0x81, 0).kind, UsbAnswer::kReportHalt);
  EXPECT_TRUE(requests.configured() && requests.report_halted());
  ask(requests, 0x00, 5, 9, 0, 0);
  EXPECT_EQ(requests.new_address(), 9);
  requests.on_bus_reset();
  EXPECT_FALSE(requests.configured() || requests.report_halted());
  EXPECT_EQ(requests.new_address(), 0);
}

TEST(UsbRequests, AHaltConcernsItsOwnEndpointOnly) {
  UsbRequests requests;
  ask(requests, 0x00, 9, 1, 0, 0);
  EXPECT_EQ(ask(requests, 0x02, 3, 0, kCommandEndpoint, 0).kind, UsbAnswer::kCommandHalt);
  EXPECT_TRUE(requests.command_halted());
  EXPECT_FALSE(requests.report_halted());
  EXPECT_EQ(ask(requests, 0x02, 1, 0, 0x81, 0).kind, UsbAnswer::kReportHalt);
  EXPECT_TRUE(requests.command_halted());
  EXPECT_EQ(ask(requests, 0x02, 1, 0, kCommandEndpoint, 0).kind, UsbAnswer::kCommandHalt);
  EXPECT_FALSE(requests.command_halted());
}

TEST(UsbRequests, WhatLiesInFlashIsMarked) {
  UsbRequests requests;
  const std::uint8_t serial[] = {4, 3, '1', 0};
  requests.set_serial(serial);
  EXPECT_TRUE(ask(requests, 0x80, 6, 0x0100, 0, 18).in_flash);
  EXPECT_FALSE(ask(requests, 0x80, 6, 0x0300 | kSerialString, 0x0409, 255).in_flash);
  EXPECT_FALSE(ask(requests, 0x80, 8, 0, 0, 1).in_flash);
}

}  // namespace
}  // namespace firmware
