#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "layouts.h"
#include "samples.h"
#include "wire/description.h"

namespace wire::test {
namespace {

using samples::Bytes;
using samples::encoded;

TEST(InputDatagram, HasOneSizeThatFits) {
  std::mt19937_64 random(11);
  const std::size_t size = encoded(samples::random_input(random)).size();
  std::printf("[   size   ] %zu bytes\n", size);
  EXPECT_LE(size, kMaxInputDatagram);
  EXPECT_EQ(size, max_bits(input_layout()) / 8);
}

TEST(InputDatagram, RoundTripKeepsIntegersAndLosesLessThanTheStatedBounds) {
  std::mt19937_64 random(12);
  for (int n = 0; n < 1000; ++n) {
    const InputDatagram sent = samples::random_input(random);
    InputDatagram received;
    ASSERT_TRUE(decode_input(encoded(sent), received));
    EXPECT_EQ(received.session, sent.session);
    EXPECT_EQ(received.token, sent.token);
    EXPECT_EQ(received.sequence, sent.sequence);
    for (std::size_t i = 0; i < sent.rods.size(); ++i) {
      EXPECT_EQ(received.rods[i].driven, sent.rods[i].driven);
      EXPECT_NEAR(received.rods[i].slide, sent.rods[i].slide, 2.0e-6);
      EXPECT_NEAR(received.rods[i].angle, sent.rods[i].angle, 4.8e-5);
      EXPECT_NEAR(received.rods[i].slide_rate, sent.rods[i].slide_rate, 9.9e-4);
      EXPECT_NEAR(received.rods[i].angle_rate, sent.rods[i].angle_rate, 3.95e-3);
    }
    EXPECT_EQ(samples::hex(encoded(received)), samples::hex(encoded(sent)));
  }
}

TEST(InputDatagram, EveryTruncationIsRefused) {
  const Bytes whole = encoded(samples::input());
  for (std::size_t size = 0; size < whole.size(); ++size) {
    Bytes part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    InputDatagram received;
    EXPECT_FALSE(decode_input(part, received));
    samples::reseal(part);
    EXPECT_FALSE(decode_input(part, received));
  }
}

TEST(InputDatagram, EverySingleBitFlipIsRefused) {
  Bytes bytes = encoded(samples::input());
  InputDatagram received;
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    bytes[bit / 8] ^= static_cast<std::byte>(1 << bit % 8);
    EXPECT_FALSE(decode_input(bytes, received)) << bit;
    bytes[bit / 8] ^= static_cast<std::byte>(1 << bit % 8);
  }
  EXPECT_TRUE(decode_input(bytes, received));
}

TEST(InputDatagram, AFlipUnderARightChecksumIsRefusedOrGivesFiniteValuesInRange) {
  const Bytes whole = encoded(samples::input());
  for (std::size_t bit = 0; bit < 8 * (whole.size() - 4); ++bit) {
    Bytes bytes = whole;
    bytes[bit / 8] ^= static_cast<std::byte>(1 << bit % 8);
    samples::reseal(bytes);
    InputDatagram received;
    const bool accepted = decode_input(bytes, received);
    if (bit < 32 + 16 + 32) {
      EXPECT_FALSE(accepted) << bit;
    }
    for (const InputRod& rod : received.rods) {
      EXPECT_LE(std::abs(rod.slide), 2.0F);
      EXPECT_LE(std::abs(rod.angle), 32768 * kTurn);
      EXPECT_LE(std::abs(rod.slide_rate), 64.0F);
      EXPECT_LE(std::abs(rod.angle_rate), 256.0F);
    }
  }
}

TEST(InputDatagram, TrailingAndReorderedBytesAreRefused) {
  Bytes bytes = encoded(samples::input());
  InputDatagram received;
  Bytes longer = bytes;
  longer.push_back(std::byte{0});
  samples::reseal(longer);
  EXPECT_FALSE(decode_input(longer, received));
  std::mt19937_64 random(13);
  for (int i = 0; i < 1000; ++i) {
    Bytes shuffled = bytes;
    std::swap(shuffled[random() % bytes.size()], shuffled[random() % bytes.size()]);
    EXPECT_EQ(decode_input(shuffled, received), shuffled == bytes);
  }
}

TEST(InputDatagram, ASnapshotIsNoInput) {
  InputDatagram input;
  EXPECT_FALSE(decode_input(encoded(samples::snapshot()), input));
  Snapshot snapshot;
  EXPECT_FALSE(decode_snapshot(encoded(samples::input()), snapshot));
}

TEST(InputDatagram, WhatIsNotFiniteIsZeroAndTheRestIsClamped) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  InputDatagram sent;
  sent.rods[0] = {true, nan, std::numeric_limits<double>::infinity(), nan, nan};
  sent.rods[1] = {true, 1e30F, 1e300, -1e30F, 1e30F};
  InputDatagram received;
  ASSERT_TRUE(decode_input(encoded(sent), received));
  EXPECT_EQ(received.rods[0].slide, 0.0F);
  EXPECT_EQ(received.rods[0].angle, 0.0);
  EXPECT_NEAR(received.rods[1].slide, 2, 1e-5);
  EXPECT_TRUE(std::isfinite(received.rods[1].angle));
  EXPECT_NEAR(received.rods[1].slide_rate, -64, 1e-2);
}

}  // namespace
}  // namespace wire::test
