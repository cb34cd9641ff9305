#include "wire/snapshot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "layouts.h"
#include "samples.h"
#include "wire/limits.h"
#include "wire/snapshot_description.h"

namespace wire::test {
namespace {

using samples::Bytes;
using samples::encoded;

// Every index and every number may be used by a receiver without further checks.
void expect_valid(const Snapshot& s) {
  EXPECT_LT(s.layout, kLayoutCount);
  EXPECT_LT(s.screen, kScreenCount);
  EXPECT_LT(s.last_scorer, kTeamCount);
  EXPECT_GE(s.send_time_us, 0);
  EXPECT_LE(s.tick, kMaxTick);
  for (const auto character : s.character) EXPECT_LT(character, kMaxCharacterCount);
  const auto expect_pose = [](const PoseVelocity& p, double spin) {
    double norm = 0;
    for (const float q : p.orientation) norm += static_cast<double>(q) * static_cast<double>(q);
    EXPECT_NEAR(norm, 1, 1e-3);
    for (const float v : p.position) EXPECT_LE(std::abs(v), 2.0F);
    for (const float v : p.linear_velocity) EXPECT_LE(std::abs(v), 64.0F);
    for (const float v : p.angular_velocity) EXPECT_LE(std::abs(v), spin);
  };
  expect_pose(s.ball, 2048);
  for (const RodSnapshot& rod : s.rods) {
    EXPECT_LE(std::abs(rod.slide), 2.0F);
    EXPECT_LE(std::abs(rod.angle), 128 * kTurn + 1e-3);
    EXPECT_LT(rod.status, kRodStatusCount);
    EXPECT_LT(rod.source, kRodSourceCount);
  }
  EXPECT_LE(s.men.size(), static_cast<std::size_t>(kMaxMen));
  EXPECT_LE(s.events.size(), static_cast<std::size_t>(kMaxEvents));
  for (const ManState& man : s.men) {
    EXPECT_LT(man.rod, kRods);
    EXPECT_LT(man.man, kMenOnRod);
    expect_pose(man.body, 256);
  }
  for (const EventSnapshot& event : s.events) {
    EXPECT_LT(event.kind, kEventKindCount);
    EXPECT_LT(event.team, kTeamCount);
    EXPECT_LT(event.rod, kRods);
    EXPECT_LT(event.man, kMenOnRod);
  }
}

// Angle between two rotations [rad].
double angle_between(const std::array<float, 4>& a, const std::array<float, 4>& b) {
  double dot = 0, la = 0, lb = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const double x = static_cast<double>(a[i]), y = static_cast<double>(b[i]);
    dot += x * y;
    la += x * x;
    lb += y * y;
  }
  const double c = std::min(1.0, std::abs(dot) / std::sqrt(la * lb));
  return 2 * std::acos(c);
}

struct WorstErrors {
  double position = 0, orientation = 0, velocity = 0, man_spin = 0, ball_spin = 0;
  double slide = 0, angle = 0, seconds = 0, impulse = 0;
};

void widen(double& worst, double a, double b) {
  worst = std::max(worst, std::abs(a - b));
}

template <std::size_t n>
void widen(double& worst, const std::array<float, n>& a, const std::array<float, n>& b) {
  for (std::size_t i = 0; i < n; ++i) {
    widen(worst, static_cast<double>(a[i]), static_cast<double>(b[i]));
  }
}

void widen(WorstErrors& worst, double& spin, const PoseVelocity& a, const PoseVelocity& b) {
  widen(worst.position, a.position, b.position);
  widen(worst.velocity, a.linear_velocity, b.linear_velocity);
  widen(spin, a.angular_velocity, b.angular_velocity);
  worst.orientation = std::max(worst.orientation, angle_between(a.orientation, b.orientation));
}

void widen(WorstErrors& worst, const Snapshot& a, const Snapshot& b) {
  widen(worst, worst.ball_spin, a.ball, b.ball);
  for (std::size_t i = 0; i < a.men.size(); ++i) {
    widen(worst, worst.man_spin, a.men[i].body, b.men[i].body);
  }
  for (std::size_t i = 0; i < a.rods.size(); ++i) {
    widen(worst.slide, a.rods[i].slide, b.rods[i].slide);
    widen(worst.angle, a.rods[i].angle, b.rods[i].angle);
    widen(worst.velocity, a.rods[i].slide_rate, b.rods[i].slide_rate);
    widen(worst.man_spin, a.rods[i].angle_rate, b.rods[i].angle_rate);
  }
  for (std::size_t i = 0; i < a.events.size(); ++i) {
    widen(worst.impulse, a.events[i].value, b.events[i].value);
    widen(worst.position, a.events[i].point, b.events[i].point);
  }
  widen(worst.seconds, a.screen_seconds, b.screen_seconds);
  widen(worst.seconds, a.play_seconds, b.play_seconds);
}

void expect_same_integers(const Snapshot& a, const Snapshot& b) {
  EXPECT_EQ(a.session, b.session);
  EXPECT_EQ(a.sequence, b.sequence);
  EXPECT_EQ(a.tick, b.tick);
  EXPECT_EQ(a.send_time_us, b.send_time_us);
  EXPECT_EQ(a.layout, b.layout);
  EXPECT_EQ(a.screen, b.screen);
  EXPECT_EQ(a.paused, b.paused);
  EXPECT_EQ(a.ball_in_play, b.ball_in_play);
  EXPECT_EQ(a.score, b.score);
  EXPECT_EQ(a.character, b.character);
  EXPECT_EQ(a.confirmed, b.confirmed);
  EXPECT_EQ(a.last_scorer, b.last_scorer);
  for (std::size_t i = 0; i < a.rods.size(); ++i) {
    EXPECT_EQ(a.rods[i].status, b.rods[i].status);
    EXPECT_EQ(a.rods[i].source, b.rods[i].source);
  }
  ASSERT_EQ(a.men.size(), b.men.size());
  for (std::size_t i = 0; i < a.men.size(); ++i) {
    EXPECT_EQ(a.men[i].rod, b.men[i].rod);
    EXPECT_EQ(a.men[i].man, b.men[i].man);
  }
  ASSERT_EQ(a.events.size(), b.events.size());
  for (std::size_t i = 0; i < a.events.size(); ++i) {
    EXPECT_EQ(a.events[i].id, b.events[i].id);
    EXPECT_EQ(a.events[i].kind, b.events[i].kind);
    EXPECT_EQ(a.events[i].team, b.events[i].team);
    EXPECT_EQ(a.events[i].rod, b.events[i].rod);
    EXPECT_EQ(a.events[i].man, b.events[i].man);
  }
}

TEST(Snapshot, FitsTheDatagramWhateverItHolds) {
  std::mt19937_64 random(1);
  const std::size_t full = encoded(samples::random_snapshot(random, true)).size();
  const std::size_t empty = encoded(Snapshot{}).size();
  std::printf("[   size   ] %zu bytes with %d men, 1 ball, %d rods and %d events; %zu with none\n",
              full, kMaxMen, kRods, kMaxEvents, empty);
  EXPECT_LE(full, kMaxDatagram);
  // The size depends only on the counts, and no count can be larger.
  EXPECT_EQ(full, max_bits(snapshot_layout()) / 8) << "7 bits of padding are counted in";
  Snapshot crowded = samples::random_snapshot(random, true);
  crowded.men.resize(1000, crowded.men[0]);
  crowded.events.resize(1000, crowded.events[0]);
  EXPECT_EQ(encoded(crowded).size(), full);
}

TEST(Snapshot, RoundTripKeepsIntegersAndLosesLessThanTheStatedBounds) {
  std::mt19937_64 random(2);
  WorstErrors worst;
  for (int i = 0; i < 300; ++i) {
    const Snapshot sent = samples::random_snapshot(random, i % 2 == 0);
    Snapshot received;
    ASSERT_TRUE(decode_snapshot(encoded(sent), received));
    expect_same_integers(sent, received);
    widen(worst, sent, received);
  }
  // Bounds: half a step each, plus the rounding of a float. Measured values beside the bounds.
  EXPECT_LE(worst.position, 7.8e-6);     // 7.63e-6 m
  EXPECT_LE(worst.velocity, 9.9e-4);     // 9.77e-4 m/s
  EXPECT_LE(worst.man_spin, 3.95e-3);    // 3.91e-3 rad/s
  EXPECT_LE(worst.ball_spin, 0.0314);    // 0.0312 rad/s
  EXPECT_LE(worst.orientation, 1.5e-4);  // 1.21e-4 rad; bound for four equal components
  EXPECT_LE(worst.slide, 2.0e-6);        // 1.91e-6 m, of the 0.5 mm allowed at the cabinet
  EXPECT_LE(worst.angle, 8.0e-5);        // 6.11e-5 rad, of the 1 degree (0.017) allowed
  EXPECT_LE(worst.seconds, 4.9e-4);      // 4.88e-4 s
  EXPECT_LE(worst.impulse, 3.1e-5);      // 3.05e-5 N s
}

TEST(Snapshot, DecodedEncodesToTheSameAgain) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 300; ++i) {
    Snapshot once, twice;
    ASSERT_TRUE(decode_snapshot(encoded(samples::random_snapshot(random, false)), once));
    ASSERT_TRUE(decode_snapshot(encoded(once), twice));
    EXPECT_TRUE(samples::same_but_for_ties(once, twice));
  }
}

TEST(Snapshot, ZeroAndIdentityAreExact) {
  Snapshot received = samples::snapshot();
  ASSERT_TRUE(decode_snapshot(encoded(Snapshot{}), received));
  EXPECT_EQ(received.ball.position, (std::array<float, 3>{}));
  EXPECT_EQ(received.ball.orientation, (std::array<float, 4>{0, 0, 0, 1}));
  EXPECT_EQ(received.ball.angular_velocity, (std::array<float, 3>{}));
  EXPECT_EQ(received.rods[0].angle, 0.0F);
  EXPECT_TRUE(received.men.empty());
}

TEST(Snapshot, ScreenNumbersInEventsAreExact) {
  Snapshot sent;
  for (unsigned i = 0; i < kScreenCount; ++i) {
    sent.events.push_back({i, 7, 0, 0, 0, static_cast<float>(i), {}});
  }
  Snapshot received;
  ASSERT_TRUE(decode_snapshot(encoded(sent), received));
  for (unsigned i = 0; i < kScreenCount; ++i) {
    EXPECT_EQ(received.events[i].value, static_cast<float>(i));
  }
}

TEST(Snapshot, AQuaternionAndItsNegativeAreTheSameRotation) {
  Snapshot sent;
  sent.ball.orientation = {0.5F, -0.5F, 0.5F, -0.5F};  // four equal: every index may be the largest
  Snapshot received;
  ASSERT_TRUE(decode_snapshot(encoded(sent), received));
  EXPECT_LT(angle_between(sent.ball.orientation, received.ball.orientation), 1.51e-4);
}

TEST(Snapshot, ValuesOutOfRangeAreClamped) {
  Snapshot sent;
  sent.screen = 200;
  sent.last_scorer = 9;
  sent.send_time_us = -5;
  sent.screen_seconds = -1;
  sent.play_seconds = 1e30F;
  sent.ball.position = {1e30F, -1e30F, 3.0F};
  sent.rods[0].status = 255;
  sent.men.push_back({100, 100, {}});
  Snapshot received;
  ASSERT_TRUE(decode_snapshot(encoded(sent), received));
  expect_valid(received);
  EXPECT_EQ(received.screen, kScreenCount - 1);
  EXPECT_EQ(received.send_time_us, 0);
  EXPECT_EQ(received.screen_seconds, 0.0F);
  EXPECT_NEAR(received.play_seconds, 16384, 1);
  EXPECT_NEAR(received.ball.position[0], 2, 1e-4);
  EXPECT_NEAR(received.ball.position[1], -2, 1e-4);
  EXPECT_EQ(received.men[0].man, kMenOnRod - 1);
}

TEST(Snapshot, WhatIsNotFiniteIsZero) {
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
        -std::numeric_limits<float>::infinity()}) {
    Snapshot sent;
    sent.screen_seconds = bad;
    sent.ball = {{bad, 1, bad}, {bad, 0, 0, 1}, {bad, bad, bad}, {bad, bad, bad}};
    sent.rods[5] = {bad, bad, bad, bad, 1, 1};
    Snapshot received;
    ASSERT_TRUE(decode_snapshot(encoded(sent), received));
    EXPECT_EQ(received.screen_seconds, 0.0F);
    EXPECT_EQ(received.ball.position, (std::array<float, 3>{0, 1, 0}));
    EXPECT_EQ(received.ball.orientation, (std::array<float, 4>{0, 0, 0, 1}));
    EXPECT_EQ(received.ball.linear_velocity, (std::array<float, 3>{}));
    EXPECT_EQ(received.rods[5].slide, 0.0F);
    EXPECT_EQ(received.rods[5].angle, 0.0F);
  }
}

TEST(Snapshot, AQuaternionOfLengthZeroIsTheIdentity) {
  Snapshot sent;
  sent.ball.orientation = {0, 0, 0, 0};
  Snapshot received;
  ASSERT_TRUE(decode_snapshot(encoded(sent), received));
  EXPECT_EQ(received.ball.orientation, (std::array<float, 4>{0, 0, 0, 1}));
}

TEST(Snapshot, AnglesWrapAt256TurnsAndUnwrapNearTheOldOne) {
  for (const double turns : {0.0, 1.25, -3.5, 127.9, 128.1, 300.0, -1000.25}) {
    Snapshot sent;
    sent.rods[2].angle = static_cast<float>(turns * kTurn);
    Snapshot received;
    ASSERT_TRUE(decode_snapshot(encoded(sent), received));
    const double wrapped = static_cast<double>(received.rods[2].angle);
    EXPECT_LE(std::abs(wrapped), 128 * kTurn + 1e-4);
    EXPECT_NEAR(unwrap_angle(wrapped, turns * kTurn + 5.0), turns * kTurn, 1e-3) << turns;
  }
}

TEST(Snapshot, EveryTruncationIsRefused) {
  std::mt19937_64 random(4);
  const Bytes whole = encoded(samples::random_snapshot(random, true));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    Bytes part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    Snapshot received;
    EXPECT_FALSE(decode_snapshot(part, received)) << size;
    samples::reseal(part);
    EXPECT_FALSE(decode_snapshot(part, received)) << size << " resealed";
  }
}

TEST(Snapshot, EverySingleBitFlipIsRefused) {
  std::mt19937_64 random(5);
  Bytes bytes = encoded(samples::random_snapshot(random, true));
  Snapshot received;
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    bytes[bit / 8] ^= static_cast<std::byte>(1 << bit % 8);
    EXPECT_FALSE(decode_snapshot(bytes, received)) << bit;
    bytes[bit / 8] ^= static_cast<std::byte>(1 << bit % 8);
  }
  EXPECT_TRUE(decode_snapshot(bytes, received));
}

// A forger who knows the checksum.
TEST(Snapshot, AFlipUnderARightChecksumIsRefusedOrGivesValidValues) {
  std::mt19937_64 random(6);
  const Bytes whole = encoded(samples::random_snapshot(random, true));
  constexpr std::size_t kPreambleBits = 32 + 16 + 32;
  int accepted = 0;
  for (std::size_t bit = 0; bit < 8 * (whole.size() - 4); ++bit) {
    Bytes bytes = whole;
    bytes[bit / 8] ^= static_cast<std::byte>(1 << bit % 8);
    samples::reseal(bytes);
    Snapshot received;
    if (!decode_snapshot(bytes, received)) continue;
    EXPECT_GE(bit, kPreambleBits) << "magic, version and layout are not free";
    expect_valid(received);
    ++accepted;
  }
  EXPECT_GT(accepted, 1000) << "the fields under the checksum were reached";
}

TEST(Snapshot, AnAbsurdCountIsRefused) {
  Bytes bytes = encoded(Snapshot{});
  // Before the checksum there are only zeros and the two counts: finds the count of men by the
  // change that one man causes.
  Snapshot one;
  one.men.resize(1);
  const Bytes other = encoded(one);
  std::size_t bit = 0;
  const auto bit_of = [](const Bytes& b, std::size_t i) {
    return static_cast<unsigned>(b[i / 8]) >> i % 8 & 1U;
  };
  while (bit_of(bytes, bit) == bit_of(other, bit)) ++bit;
  for (std::size_t i = 0; i < 6; ++i)
    bytes[(bit + i) / 8] |= static_cast<std::byte>(1 << (bit + i) % 8);
  samples::reseal(bytes);
  Snapshot received;
  EXPECT_FALSE(decode_snapshot(bytes, received));
  EXPECT_LE(received.men.size(), static_cast<std::size_t>(kMaxMen));
}

// A receiver computes differences of simulated time, tick * tick_us, in 64 bits.
TEST(Snapshot, ATickWhoseTimeWouldNotFitIsRefusedAndNeverSent) {
  Snapshot s = samples::snapshot(), decoded;
  s.tick = kMaxTick;
  Bytes bytes = encoded(s);
  ASSERT_TRUE(decode_snapshot(bytes, decoded));
  EXPECT_EQ(decoded.tick, kMaxTick);
  constexpr std::size_t kTickAt = 4 + 2 + 4 + 8 + 8;  // magic, version, hash, session, sequence
  bytes[kTickAt + 6] = std::byte{1};                  // bit 48
  samples::reseal(bytes);
  EXPECT_FALSE(decode_snapshot(bytes, decoded));
  s.tick = ~std::uint64_t{0};
  ASSERT_TRUE(decode_snapshot(encoded(s), decoded));
  EXPECT_EQ(decoded.tick, kMaxTick);
}

TEST(Snapshot, TrailingBytesAreRefused) {
  Bytes bytes = encoded(samples::snapshot());
  Snapshot received;
  bytes.push_back(std::byte{0});
  EXPECT_FALSE(decode_snapshot(bytes, received));
  samples::reseal(bytes);
  EXPECT_FALSE(decode_snapshot(bytes, received));
  bytes.resize(65507);  // max size of a UDP datagram
  EXPECT_FALSE(decode_snapshot(bytes, received));
}

TEST(Snapshot, ReorderedBytesAreRefused) {
  Bytes bytes = encoded(samples::snapshot());
  std::mt19937_64 random(7);
  Snapshot received;
  for (int i = 0; i < 1000; ++i) {
    Bytes shuffled = bytes;
    const std::size_t a = random() % bytes.size(), b = random() % bytes.size();
    std::swap(shuffled[a], shuffled[b]);
    EXPECT_EQ(decode_snapshot(shuffled, received), shuffled == bytes);
  }
  std::reverse(bytes.begin(), bytes.end());
  EXPECT_FALSE(decode_snapshot(bytes, received));
}

TEST(Snapshot, ABufferTooSmallIsLeftUnusedAndSaidSo) {
  const std::size_t size = encoded(samples::snapshot()).size();
  for (std::size_t room = 0; room < size; ++room) {
    Bytes out(room);
    EXPECT_EQ(encode_snapshot(samples::snapshot(), out), 0U);
  }
  Bytes out(size);
  EXPECT_EQ(encode_snapshot(samples::snapshot(), out), size);
}

TEST(LayoutHash, ChangesWithNamesBitsAndRangesButNotWithMeanings) {
  const auto hash_of = [](const Integer& f) {
    Lister lister;
    lister.integer(f, 0);
    return layout_hash(lister.layout());
  };
  const Integer f{"a", 4, 9, "", "one"};
  EXPECT_EQ(hash_of(f), hash_of(Integer{"a", 4, 9, "", "another"}));
  EXPECT_NE(hash_of(f), hash_of(Integer{"b", 4, 9, "", "one"}));
  EXPECT_NE(hash_of(f), hash_of(Integer{"a", 5, 9, "", "one"}));
  EXPECT_NE(hash_of(f), hash_of(Integer{"a", 4, 8, "", "one"}));
}

}  // namespace
}  // namespace wire::test
