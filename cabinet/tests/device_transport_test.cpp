// Invalid bytes on every kind of line: counted, without other effect.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>
#include <tuple>
#include <utility>

#include "cabinet/device_source.h"
#include "simulated_device.h"
#include "wire/device_settings.h"

using namespace cabinet;
using namespace cabinet_test;

namespace {

struct Socket {
  int pair[2] = {-1, -1};
  Descriptor far;
  SimulatedDevice device;
  std::unique_ptr<DeviceSource> source;
  std::int64_t now_us = 0;

  Socket(int type, DeviceFraming framing) {
    EXPECT_EQ(socketpair(AF_UNIX, type, 0, pair), 0);
    far.fd = pair[0];
    DeviceOptions options;
    options.framing = framing;
    source = std::make_unique<DeviceSource>(options, [this] { return std::exchange(pair[1], -1); });
  }
  void send(const Bytes& bytes) {
    far.send(bytes);
    source->poll(now_us += 1'000);
  }
  const SourceCounters& counters() const { return source->counters(); }
};

Bytes cut(Bytes bytes, std::size_t size) {
  bytes.resize(size);
  return bytes;
}

TEST(SerialBytes, AFrameInAnyTwoPiecesArrives) {
  Socket s(SOCK_STREAM, DeviceFraming::cobs);
  for (std::size_t at = 1; at < wire::kDeviceCobsBytes; ++at) {
    const Bytes whole = cobs(s.device.frame());
    s.send(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(at)));
    EXPECT_EQ(s.counters().frames, at - 1);
    s.send(Bytes(whole.begin() + static_cast<std::ptrdiff_t>(at), whole.end()));
    EXPECT_EQ(s.counters().frames, at);
  }
  EXPECT_EQ(s.counters().bad, 0u);
}

TEST(SerialBytes, EveryTruncationCostsOneFrameAndIsCounted) {
  Socket s(SOCK_STREAM, DeviceFraming::cobs);
  for (std::size_t size = 1; size + 1 < wire::kDeviceCobsBytes; ++size) {
    Bytes part = cut(cobs(s.device.frame()), size);
    part.push_back(0);
    s.send(part);
    EXPECT_EQ(s.counters().bad, size);
    s.send(cobs(s.device.frame()));
    EXPECT_EQ(s.counters().frames, size);
  }
}

TEST(SerialBytes, NoBitFlipIsTakenForMotion) {
  Socket s(SOCK_STREAM, DeviceFraming::cobs);
  s.send(cobs(s.device.frame()));
  std::uint64_t good = 1;
  for (std::size_t bit = 0; bit < 8 * (wire::kDeviceCobsBytes - 1); ++bit) {
    Bytes bytes = cobs(s.device.frame());
    bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ (1 << bit % 8));
    s.send(bytes);
    s.send(cobs(s.device.frame()));
    ++good;
    ASSERT_EQ(s.counters().frames, good) << bit;
    ASSERT_GE(s.counters().bad, bit + 1);
  }
  for (const RodInput& rod : s.source->rods()) {
    EXPECT_EQ(rod.slide, 0.0);
    EXPECT_EQ(rod.angle, 0.0);
  }
}

TEST(SerialBytes, ReorderedFramesMoveNothingTwice) {
  Socket s(SOCK_STREAM, DeviceFraming::cobs);
  s.device.time_us = 60'000'000;
  s.send(cobs(s.device.frame()));
  std::mt19937 random(1);
  for (int block = 0; block < 100; ++block) {
    std::vector<Bytes> frames;
    for (int i = 0; i < 8; ++i) {
      s.device.slide[0] += 3;
      frames.push_back(cobs(s.device.frame()));
    }
    std::shuffle(frames.begin(), frames.end(), random);
    for (const Bytes& frame : frames) s.send(frame);
  }
  s.send(cobs(s.device.frame()));
  EXPECT_NEAR(s.source->rods()[0].slide, 2'400 * 1e-3 / 8, 1e-9);
  EXPECT_EQ(s.counters().frames + s.counters().stale, 802u);
  EXPECT_GT(s.counters().stale, 100u);
}

TEST(SerialBytes, AnEndlessRunWithoutAZeroIsOneBadFrame) {
  Socket s(SOCK_STREAM, DeviceFraming::cobs);
  for (int i = 0; i < 10; ++i) s.send(Bytes(1'000, 0xAA));
  EXPECT_EQ(s.counters().bad, 1u);
  s.send({0});
  s.send(cobs(s.device.frame()));
  EXPECT_EQ(s.counters().frames, 1u);
  EXPECT_EQ(s.counters().bad, 1u);
}

TEST(HidReports, ShortAndLongOnesAreCountedAndTheNextIsTaken) {
  Socket s(SOCK_SEQPACKET, DeviceFraming::report);
  std::uint64_t bad = 0;
  for (const std::size_t size : {std::size_t{1}, std::size_t{46}, std::size_t{63}, std::size_t{65},
                                 std::size_t{128}, std::size_t{5'000}}) {
    s.send(cut(report(s.device.frame()), size));
    EXPECT_EQ(s.counters().bad, ++bad) << size;
    s.send(report(s.device.frame()));
    EXPECT_EQ(s.counters().frames, bad);
  }
}

// The controller's page requests the settings; a server or doctor on the same device reads the
// answer too.
TEST(SettingsTold, AreNoFaultOfTheLine) {
  Bytes told(wire::kDeviceFrameBytes);
  wire::encode_settings_report({}, wire::kHasSensors, 1, told.data());
  Bytes coded(wire::kDeviceCobsBytes);
  wire::cobs_encode(told.data(), told.size(), coded.data());
  Bytes padded = told;
  padded.resize(wire::kDeviceReportBytes);
  for (const auto& [kind, framing, bytes] : {std::tuple{SOCK_STREAM, DeviceFraming::cobs, coded},
                                             {SOCK_SEQPACKET, DeviceFraming::report, padded},
                                             {SOCK_STREAM, DeviceFraming::report, padded}}) {
    Socket s(kind, framing);
    const auto frame = [&s, framing = framing] {
      return framing == DeviceFraming::cobs ? cobs(s.device.frame()) : report(s.device.frame());
    };
    s.send(frame());
    s.send(bytes);
    s.send(frame());
    EXPECT_EQ(s.counters().frames, 2u);
    EXPECT_EQ(s.counters().bad, 0u);
    Bytes broken = bytes;
    broken[4] ^= 1;
    s.send(broken);
    EXPECT_EQ(s.counters().bad, 1u);
  }
}

TEST(HidReports, AnythingInThePaddingIsRefused) {
  Socket s(SOCK_SEQPACKET, DeviceFraming::report);
  Bytes bytes = report(s.device.frame());
  bytes[63] = 1;
  s.send(bytes);
  EXPECT_EQ(s.counters().bad, 1u);
  EXPECT_EQ(s.counters().frames, 0u);
}

TEST(HidReports, AStreamThatLostItsPlaceFindsItAgain) {
  Socket s(SOCK_STREAM, DeviceFraming::report);
  s.send(report(s.device.frame()));
  for (std::size_t lost = 1; lost < wire::kDeviceReportBytes; ++lost) {
    const Bytes whole = report(s.device.frame());
    s.send(Bytes(whole.begin() + static_cast<std::ptrdiff_t>(lost), whole.end()));
    s.send(report(s.device.frame()));
    s.send(report(s.device.frame()));
    ASSERT_EQ(s.counters().frames, 1 + 2 * lost) << lost;
    EXPECT_EQ(s.counters().bad, lost);
  }
}

TEST(HidReports, AClosedSocketHoldsTheRodsAtTheNextPoll) {
  Socket s(SOCK_SEQPACKET, DeviceFraming::report);
  s.send(report(s.device.frame()));
  EXPECT_TRUE(s.source->connected());
  s.far.close();
  s.source->poll(s.now_us + 1);
  EXPECT_FALSE(s.source->connected());
  EXPECT_EQ(s.source->rods()[7].status, RodStatus::held);
}

TEST(DeviceBytes, RandomBytesAreNeverAFrame) {
  for (const DeviceFraming framing : {DeviceFraming::cobs, DeviceFraming::report}) {
    Socket s(SOCK_STREAM, framing);
    std::mt19937 random(7);
    for (int i = 0; i < 500; ++i) {
      Bytes noise(1'000);
      for (auto& byte : noise) byte = static_cast<std::uint8_t>(random() % 3 == 0 ? 0 : random());
      s.send(noise);
    }
    EXPECT_EQ(s.counters().frames, 0u);
    EXPECT_GT(s.counters().bad, 0u);
    for (const RodInput& rod : s.source->rods()) EXPECT_EQ(rod.status, RodStatus::absent);
  }
}

}  // namespace
