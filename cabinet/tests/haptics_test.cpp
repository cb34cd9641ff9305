// The pulse of a hit, the limit on pulses, and their transmission to a controller.
#include "cabinet/haptics.h"

#include <gtest/gtest.h>

#include <sys/stat.h>
#include <algorithm>

#include <limits>
#include <memory>

#include "cabinet/device_haptics.h"
#include "simulated_device.h"
#include "wire/device_command.h"

using namespace cabinet;
using namespace cabinet_test;

namespace {

constexpr double kHard = 0.9, kSoft = 0.2;

TEST(HapticPulse, GrowsWithTheImpulseAndEndsAtTheMotorsMost) {
  float before = 0.0f;
  for (double impulse = kSoftestFelt; impulse <= kHardestFelt;) {
    const auto pulse = haptic_pulse(3, impulse, kHard);
    ASSERT_TRUE(pulse) << impulse;
    EXPECT_EQ(pulse->rod, 3);
    EXPECT_GT(pulse->strength, before) << impulse;
    before = pulse->strength;
    impulse *= 1.3;
  }
  EXPECT_EQ(haptic_pulse(0, 1e9, 1.0)->strength, 1.0f);
  EXPECT_EQ(haptic_pulse(0, std::numeric_limits<double>::infinity(), 1.0)->strength, 1.0f);
}

TEST(HapticPulse, OfASofterManIsWeakerAndLonger) {
  for (const double impulse : {0.02, 0.1, 0.5}) {
    const auto hard = haptic_pulse(0, impulse, kHard), soft = haptic_pulse(0, impulse, kSoft);
    EXPECT_GT(hard->strength, soft->strength);
    EXPECT_LT(hard->ms, soft->ms);
  }
}

TEST(HapticPulse, IsBoundedAndNoneForWhatIsNoHit) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double impulse : {-1.0, 0.0, 0.009, nan}) EXPECT_FALSE(haptic_pulse(0, impulse, 0.5));
  for (const int rod : {-1, kRods}) EXPECT_FALSE(haptic_pulse(rod, 0.5, 0.5));
  for (const double restitution : {-1e9, 0.0, 1e9, nan}) {
    for (const double impulse : {0.01, 0.1, 1e9}) {
      const auto pulse = haptic_pulse(0, impulse, restitution);
      EXPECT_GE(pulse->strength, 0.04f);
      EXPECT_LE(pulse->strength, 1.0f);
      EXPECT_GE(pulse->ms, kShortestPulseMs);
      EXPECT_LE(pulse->ms, kLongestPulseMs);
    }
  }
}

// A minute of the hardest hits of a pinched ball: the motor's energy relative to its maximum.
TEST(HapticLimiter, KeepsTheMeanPowerWhateverComes) {
  for (const std::int64_t every_us : {1'000, 10'000, 61'000}) {
    HapticLimiter limiter;
    double energy_ms = 0.0, first_second_ms = 0.0;
    for (std::int64_t now = 1'000'000; now < 61'000'000; now += every_us) {
      const auto pulse = limiter.admit({2, 1.0f, kLongestPulseMs}, now);
      if (!pulse) continue;
      ASSERT_LE(pulse->strength, 1.0f);
      ASSERT_LE(pulse->ms, kLongestPulseMs);
      energy_ms += static_cast<double>(pulse->strength * pulse->strength) * pulse->ms;
      if (now < 2'000'000) first_second_ms = energy_ms;
    }
    const double max = HapticLimiter::kMeanPower * 60'000.0 + HapticLimiter::kPulseEnergyMs;
    EXPECT_LE(energy_ms, 1.0001 * max);
    EXPECT_GE(energy_ms, 0.8 * max) << "and is not silent";
    EXPECT_LE(first_second_ms, HapticLimiter::kPulseEnergyMs + 150.0 + 1.0);
  }
}

TEST(HapticLimiter, LetsHitsOfOrdinaryPlayThroughAsTheyAre) {
  HapticLimiter limiter;
  const HapticPulse hit = *haptic_pulse(1, 0.2, 0.7);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(limiter.admit(hit, 250'000 * (i + 1)), hit) << i;
}

TEST(HapticLimiter, OnlyAHarderHitInterruptsAPulseAndRodsDoNotShareAnAccount) {
  HapticLimiter limiter;
  EXPECT_TRUE(limiter.admit({0, 0.5f, 40}, 1'000));
  EXPECT_FALSE(limiter.admit({0, 0.4f, 40}, 20'000));
  EXPECT_TRUE(limiter.admit({0, 0.8f, 40}, 30'000));
  EXPECT_TRUE(limiter.admit({0, 0.1f, 40}, 71'000));
  for (int i = 0; i < 100; ++i) limiter.admit({0, 1.0f, 60}, 100'000 + 60'000 * i);
  EXPECT_EQ(limiter.admit({1, 1.0f, 60}, 6'200'000)->strength, 1.0f);
}

TEST(HapticLimiter, RefusesARodThatIsNone) {
  HapticLimiter limiter;
  EXPECT_FALSE(limiter.admit({-1, 1.0f, 20}, 0));
  EXPECT_FALSE(limiter.admit({kRods, 1.0f, 20}, 0));
}

// The packet format of this test: rod, strength, length.
std::size_t encode(const HapticPulse& pulse, std::span<std::byte> out) {
  out[0] = static_cast<std::byte>(pulse.rod);
  out[1] = static_cast<std::byte>(255.0f * pulse.strength);
  out[2] = static_cast<std::byte>(pulse.ms);
  return 3;
}

TEST(DeviceHaptics, APulseArrivesAtTheControllersEndOfTheLine) {
  SerialLine line;
  line.plug();
  DeviceSource device(DeviceOptions{},
                      [&line] { return ::open(line.path.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC); });
  DeviceHaptics haptics(device, encode);
  haptics.pulse({5, 1.0f, 42});
  EXPECT_EQ(haptics.unsent(), 1u) << "nothing is attached yet";
  device.poll(1'000);
  haptics.pulse({5, 1.0f, 42});
  EXPECT_EQ(haptics.sent(), 1u);
  std::array<std::uint8_t, 8> got{};
  ASSERT_EQ(::read(line.master.fd, got.data(), got.size()), 3);
  EXPECT_EQ(got[0], 5);
  EXPECT_EQ(got[1], 255);
  EXPECT_EQ(got[2], 42);
}

TEST(DeviceHaptics, ADeviceThatWasOpenedByItsAddressCanBeSentTo) {
  SerialLine line;
  line.plug();
  auto device = open_device("serial:" + line.path, nominal_calibration());
  ASSERT_TRUE(device) << device.error();
  DeviceHaptics haptics(**device, encode);
  for (std::int64_t now = 0; (*device)->state() == DeviceState::missing; now += 1'000)
    (*device)->poll(now);  // another thread opens it
  haptics.pulse({5, 1.0f, 42});
  EXPECT_EQ(haptics.sent(), 1u);
  std::array<std::uint8_t, 8> got{};
  EXPECT_EQ(::read(line.master.fd, got.data(), got.size()), 3);
}

TEST(DeviceHaptics, ALineThatNobodyReadsIsNeverWaitedForAndGetsWholePacketsOnly) {
  int pair[2];
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET, 0, pair), 0);
  const Descriptor far(pair[0]);
  DeviceOptions options;
  options.framing = DeviceFraming::report;
  DeviceSource device(options, [&pair] { return std::exchange(pair[1], -1); });
  DeviceHaptics haptics(device, encode);
  device.poll(1'000);
  while (haptics.unsent() == 0) haptics.pulse({1, 0.5f, 20});
  std::array<std::uint8_t, 8> got{};
  for (std::uint64_t i = 0; i < haptics.sent(); ++i)
    ASSERT_EQ(::recv(far.fd, got.data(), got.size(), MSG_DONTWAIT), 3);
  haptics.pulse({1, 0.5f, 20});
  EXPECT_EQ(haptics.unsent(), 1u) << "there is room again";
}

TEST(DeviceHaptics, WithoutAnEncoderOrWithARecordingNothingIsSent) {
  SerialLine line;
  line.plug();
  DeviceSource device(DeviceOptions{},
                      [&line] { return ::open(line.path.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC); });
  device.poll(1'000);
  DeviceHaptics none(device, {});
  none.pulse({1, 0.5f, 20});
  DeviceHaptics silent(device, [](const HapticPulse&, std::span<std::byte>) { return 0; });
  silent.pulse({1, 0.5f, 20});
  EXPECT_EQ(none.sent() + none.unsent() + silent.sent() + silent.unsent(), 0u);

  const std::string path = testing::TempDir() + "haptics_recording";
  const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  ASSERT_GE(file, 0);
  DeviceSource recording(DeviceOptions{}, [file] { return file; });
  recording.poll(1'000);
  DeviceHaptics haptics(recording, encode);
  haptics.pulse({1, 0.5f, 20});
  EXPECT_EQ(haptics.sent(), 0u);
  struct stat about {};
  EXPECT_EQ(::stat(path.c_str(), &about), 0);
  EXPECT_EQ(about.st_size, 0) << "a recording is not written to";
  ::unlink(path.c_str());
}

TEST(DeviceHaptics, AControllerIsToldAsItsCommandsAreDescribed) {
  for (const auto framing : {DeviceFraming::cobs, DeviceFraming::report}) {
    std::array<std::byte, kMaxPacket> out{};
    const std::size_t size = command_encoder(framing)({6, 0.5f, 40}, out);
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(out.data());
    std::array<std::uint8_t, wire::kDeviceCommandBytes> plain{};
    if (framing == DeviceFraming::cobs) {
      ASSERT_EQ(size, wire::kDeviceCommandBytes + 2);
      EXPECT_EQ(bytes[size - 1], 0);
      ASSERT_EQ(wire::cobs_decode(bytes, size - 1, plain.data(), plain.size()), plain.size());
    } else {
      ASSERT_EQ(size, 1 + wire::kDeviceReportBytes);
      EXPECT_EQ(bytes[0], 0) << "the report's number";
      std::copy_n(bytes + 1, plain.size(), plain.begin());
    }
    wire::DeviceCommand command{};
    ASSERT_TRUE(wire::decode_device_command(plain.data(), plain.size(), command));
    EXPECT_EQ(command.kind, wire::kPulseCommand);
    EXPECT_EQ(command.rod, 6);
    EXPECT_EQ(command.amplitude, 128);
    EXPECT_EQ(command.duration_ms, 40);
  }
  std::array<std::byte, kMaxPacket> out{};
  EXPECT_EQ(command_encoder(DeviceFraming::report)({6, 0.5f, 0}, out), 0u) << "no length";
}

}  // namespace
