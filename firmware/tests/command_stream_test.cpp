#include "core/command_stream.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "core/serial_string.h"

namespace firmware {
namespace {

std::vector<std::uint8_t> coded(int rod) {
  wire::DeviceCommand command{};
  command.kind = wire::kPulseCommand;
  command.rod = static_cast<std::uint8_t>(rod);
  command.amplitude = 9;
  command.duration_ms = 30;
  std::uint8_t bytes[wire::kDeviceCommandBytes];
  wire::encode_device_command(command, bytes);
  std::vector<std::uint8_t> out(sizeof bytes + 2);
  wire::cobs_encode(bytes, sizeof bytes, out.data());
  return out;
}

struct Count {
  int commands = 0, errors = 0;
  wire::DeviceCommand last{};
};
void feed(CommandStream& stream, const std::vector<std::uint8_t>& bytes, Count& count) {
  for (const std::uint8_t byte : bytes) {
    switch (stream.byte(byte, count.last)) {
      case CommandStream::kNone:
        break;
      case CommandStream::kCommand:
        ++count.commands;
        break;
      case CommandStream::kError:
        ++count.errors;
        break;
    }
  }
}

TEST(CommandStream, EachCommandComesOutOnceAndEmptyPacketsAreNone) {
  CommandStream stream;
  Count count;
  for (int rod = 0; rod < 8; ++rod) {
    feed(stream, {0, 0}, count);
    feed(stream, coded(rod), count);
    EXPECT_EQ(count.last.rod, rod);
  }
  EXPECT_EQ(count.commands, 8);
  EXPECT_EQ(count.errors, 0);
}

TEST(CommandStream, EveryTruncationIsOneErrorAndTheNextCommandIsTaken) {
  const auto whole = coded(3);
  for (std::size_t size = 1; size + 1 < whole.size(); ++size) {
    CommandStream stream;
    Count count;
    feed(stream, {whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)}, count);
    feed(stream, {0}, count);
    feed(stream, coded(5), count);
    EXPECT_EQ(count.errors, 1) << size;
    EXPECT_EQ(count.commands, 1) << size;
    EXPECT_EQ(count.last.rod, 5);
  }
}

TEST(CommandStream, WhatIsTooLongIsOneError) {
  CommandStream stream;
  Count count;
  feed(stream, std::vector<std::uint8_t>(1000, 0x11), count);
  EXPECT_EQ(count.errors, 0);
  feed(stream, {0}, count);
  feed(stream, coded(1), count);
  EXPECT_EQ(count.errors, 1);
  EXPECT_EQ(count.commands, 1);
}

TEST(CommandStream, ALostByteSpoilsTheCommandUnderWayOnly) {
  CommandStream stream;
  Count count;
  auto bytes = coded(2);
  feed(stream, {bytes.begin(), bytes.begin() + 4}, count);
  stream.spoil();
  feed(stream, {bytes.begin() + 4, bytes.end()}, count);
  EXPECT_EQ(count.commands, 0);
  EXPECT_EQ(count.errors, 1);
  feed(stream, bytes, count);
  EXPECT_EQ(count.commands, 1);
}

TEST(CommandStream, NoiseIsNoCommand) {
  CommandStream stream;
  Count count;
  std::mt19937 random(13);
  for (int i = 0; i < 300'000; ++i) {
    feed(stream, {static_cast<std::uint8_t>(random() % (i % 2 ? 256 : 20))}, count);
  }
  EXPECT_EQ(count.commands, 0);
  EXPECT_GT(count.errors, 1000);
}

TEST(SerialString, IsTheNumberInHexadecimalDigitsOf16Bits) {
  const std::uint8_t id[3] = {0x00, 0xA9, 0xFF};
  SerialString<3> serial;
  serial.set(id);
  const std::vector<std::uint8_t> wanted{14, 3, '0', 0, '0', 0, 'A', 0, '9', 0, 'F', 0, 'F', 0};
  EXPECT_EQ(std::vector<std::uint8_t>(serial.descriptor, serial.descriptor + 14), wanted);
  EXPECT_EQ(sizeof serial.descriptor, 14u);
}

}  // namespace
}  // namespace firmware
