#include "wire/device_frame.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace wire::test {
namespace {

using Octets = std::vector<std::uint8_t>;

DeviceFrame random_frame(std::mt19937_64& random) {
  DeviceFrame frame{};
  frame.flags = static_cast<std::uint8_t>(random());
  frame.sequence = static_cast<std::uint16_t>(random());
  frame.time_us = static_cast<std::uint32_t>(random());
  for (int rod = 0; rod < kDeviceRods; ++rod) {
    frame.slide[rod] = static_cast<std::uint16_t>(random());
    frame.spin[rod] = static_cast<std::uint16_t>(random());
  }
  frame.present = static_cast<std::uint8_t>(random());
  frame.overflow = static_cast<std::uint8_t>(random());
  frame.quality = static_cast<std::uint8_t>(random());
  frame.index = static_cast<std::uint8_t>(random());
  return frame;
}

Octets octets_of(const DeviceFrame& frame) {
  Octets bytes(kDeviceFrameBytes);
  encode_device_frame(frame, bytes.data());
  return bytes;
}

// The definition: the remainder of a polynomial division, bit by bit.
std::uint16_t crc_by_bits(const Octets& bytes) {
  unsigned crc = 0xFFFF;
  for (const std::uint8_t byte : bytes) {
    for (int bit = 7; bit >= 0; --bit) {
      const bool carry = ((crc >> 15 ^ byte >> bit) & 1U) != 0;
      crc = (crc << 1 ^ (carry ? 0x1021U : 0U)) & 0xFFFFU;
    }
  }
  return static_cast<std::uint16_t>(crc);
}

TEST(DeviceFrame, CrcIsCcittFalse) {
  const Octets check{'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  EXPECT_EQ(device_crc16(check.data(), check.size()), 0x29B1);
  std::mt19937_64 random(41);
  for (int i = 0; i < 2000; ++i) {
    Octets bytes(random() % 60);
    for (auto& b : bytes) b = static_cast<std::uint8_t>(random());
    EXPECT_EQ(device_crc16(bytes.data(), bytes.size()), crc_by_bits(bytes));
  }
}

TEST(DeviceFrame, RoundTripIsExact) {
  std::mt19937_64 random(42);
  for (int i = 0; i < 1000; ++i) {
    const Octets bytes = octets_of(random_frame(random));
    DeviceFrame decoded{};
    ASSERT_TRUE(decode_device_frame(bytes.data(), bytes.size(), decoded));
    EXPECT_EQ(octets_of(decoded), bytes);
  }
}

TEST(DeviceFrame, WrongSizesAndEverySingleBitFlipAreRefusedAndLeaveTheFrameAlone) {
  std::mt19937_64 random(43);
  const DeviceFrame frame = random_frame(random);
  Octets bytes = octets_of(frame);
  const DeviceFrame untouched = random_frame(random);
  DeviceFrame decoded = untouched;
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const Octets part(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_FALSE(decode_device_frame(part.data(), part.size(), decoded));
  }
  Octets longer = bytes;
  longer.push_back(0);
  EXPECT_FALSE(decode_device_frame(longer.data(), longer.size(), decoded));
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ 1 << bit % 8);
    EXPECT_FALSE(decode_device_frame(bytes.data(), bytes.size(), decoded)) << bit;
    bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ 1 << bit % 8);
  }
  EXPECT_EQ(octets_of(decoded), octets_of(untouched));
}

Octets sealed(Octets bytes) {
  device_put16(bytes.data() + 44, device_crc16(bytes.data(), 44));
  return bytes;
}

TEST(DeviceFrame, ControllersAndRecordingsOfVersion1AreReadAndHaveNoIndexMarks) {
  std::mt19937_64 random(47);
  DeviceFrame sent = random_frame(random);
  sent.index = 0;
  Octets bytes = octets_of(sent);
  bytes[0] = 1;
  DeviceFrame decoded = random_frame(random);
  ASSERT_TRUE(decode_device_frame(sealed(bytes).data(), bytes.size(), decoded));
  EXPECT_EQ(octets_of(decoded), octets_of(sent));
  bytes[43] = 4;  // reserved in that version
  EXPECT_FALSE(decode_device_frame(sealed(bytes).data(), bytes.size(), decoded));
  for (const int version : {0, 3, 255}) {
    bytes[0] = static_cast<std::uint8_t>(version);
    EXPECT_FALSE(decode_device_frame(sealed(bytes).data(), bytes.size(), decoded));
  }
}

TEST(Cobs, RoundTripsEveryLengthAndHoldsNoZeroBeforeItsEnd) {
  std::mt19937_64 random(44);
  for (std::size_t size = 0; size <= 254; ++size) {
    for (const std::uint64_t zeros : {0U, 2U, 10U, 1000U}) {  // one byte in this many is 0
      Octets plain(size);
      for (auto& b : plain) {
        b = static_cast<std::uint8_t>(zeros != 0 && random() % zeros == 0 ? 0 : 1 + random() % 255);
      }
      Octets coded(size + 2), back(size + 1);
      ASSERT_EQ(cobs_encode(plain.data(), size, coded.data()), size + 2);
      EXPECT_EQ(coded.back(), 0);
      for (std::size_t i = 0; i + 1 < coded.size(); ++i) ASSERT_NE(coded[i], 0);
      ASSERT_EQ(cobs_decode(coded.data(), coded.size() - 1, back.data(), back.size()), size);
      back.resize(size);
      EXPECT_EQ(back, plain);
    }
  }
}

TEST(Cobs, TheFrameHasTheStatedSize) {
  const Octets plain(kDeviceFrameBytes, 0);
  Octets coded(kDeviceCobsBytes);
  EXPECT_EQ(cobs_encode(plain.data(), plain.size(), coded.data()), kDeviceCobsBytes);
}

TEST(Cobs, GarbageStaysWithinItsBuffers) {
  std::mt19937_64 random(45);
  for (int i = 0; i < 20'000; ++i) {
    Octets bytes(random() % 60);
    for (auto& b : bytes) b = static_cast<std::uint8_t>(random() % (i % 2 ? 256 : 8));
    Octets out(random() % 50);  // exact size: the sanitizer detects an overrun by one byte
    EXPECT_LE(cobs_decode(bytes.data(), bytes.size(), out.data(), out.size()), out.size());
  }
}

TEST(Cobs, ATruncatedFrameIsNoFrame) {
  std::mt19937_64 random(46);
  const Octets plain = octets_of(random_frame(random));
  Octets coded(kDeviceCobsBytes), out(kDeviceFrameBytes);
  cobs_encode(plain.data(), plain.size(), coded.data());
  for (std::size_t size = 0; size + 1 < coded.size(); ++size) {
    const std::size_t got = cobs_decode(coded.data(), size, out.data(), out.size());
    DeviceFrame frame{};
    EXPECT_FALSE(decode_device_frame(out.data(), got, frame)) << size;
  }
}

}  // namespace
}  // namespace wire::test
