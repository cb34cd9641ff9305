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
  const std::uint8_t pad_report[kPadBytes] = {};
  for (std::uint8_t pad = 0; pad < kPads; ++pad) requests.set_pad_report(pad, pad_report);
  std::mt19937 random(81);
  for (int i = 0; i < 200'000; ++i) {
    requests.set_gamepads(i % 5 < 2);
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
    if (answer.kind == UsbAnswer::kPadHalt) {
      EXPECT_LT(answer.size, kPads);
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

TEST(UsbRequests, GamepadsAreThereWhenTheyAreSwitchedOnAndOnlyThen) {
  UsbRequests requests;
  ask(requests, 0x00, 9, 1, 0, 0);
  const std::uint8_t report[kPadBytes] = {1, 2, 3};
  requests.set_pad_report(3, report);
  for (const bool on : {false, true, false}) {
    requests.set_gamepads(on);
    const auto there = on ? UsbAnswer::kSend : UsbAnswer::kStall;
    EXPECT_EQ(ask(requests, 0x81, 6, 0x2200, 4, 255).kind, there) << "report descriptor";
    EXPECT_EQ(ask(requests, 0xA1, 1, 0x0100, 4, 64).kind, there) << "report";
    EXPECT_EQ(ask(requests, 0x02, 3, 0, 0x86, 0).kind,
              on ? UsbAnswer::kPadHalt : UsbAnswer::kStall);
    EXPECT_EQ(ask(requests, 0x21, 9, 0x0200, 4, 64).kind, UsbAnswer::kStall) << "takes nothing";
    EXPECT_EQ(ask(requests, 0x81, 6, 0x2200, 5, 255).kind, UsbAnswer::kStall) << "no fifth";
  }
  requests.set_gamepads(true);
  EXPECT_EQ(ask(requests, 0xA1, 1, 0x0100, 4, 64).bytes, report);
  EXPECT_TRUE(requests.pad_halted(3));
  EXPECT_FALSE(requests.pad_halted(2) || requests.report_halted());
  EXPECT_EQ(ask(requests, 0x02, 1, 0, 0x86, 0).size, 3);
  EXPECT_FALSE(requests.pad_halted(3));
  ask(requests, 0x21, 10, 0x0700, 2, 0);
  ask(requests, 0xA1, 2, 0, 2, 1);
  EXPECT_EQ(ask(requests, 0xA1, 2, 0, 2, 1).bytes[0], 7) << "idle of one interface";
  EXPECT_EQ(ask(requests, 0xA1, 2, 0, 1, 1).bytes[0], 0);
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
