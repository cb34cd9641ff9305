#include "core/haptics.h"

#include <gtest/gtest.h>

#include <array>

namespace firmware {
namespace {

// Each write takes one poll; missing drivers do not acknowledge.
struct Bus final : I2cBus {
  std::uint8_t attached = 0xFF, channel = 0;
  std::array<std::uint8_t, kMotors> running{};
  State state_ = kIdle;
  bool stuck = false;
  bool chains = false;  // supports a chained second write

  bool chain(std::uint8_t address, const std::uint8_t* bytes, std::uint8_t size) override {
    if (!chains) return false;
    if (state_ == kIdle) write(address, bytes, size);
    return true;
  }
  void write(std::uint8_t address, const std::uint8_t* bytes, std::uint8_t size) override {
    EXPECT_NE(state_, kBusy);
    if (stuck) {
      state_ = kFailed;
      return;
    }
    if (address == Haptics::kMultiplexer) {
      EXPECT_EQ(size, 1);
      channel = bytes[0];
      state_ = kIdle;
      return;
    }
    EXPECT_EQ(address, Haptics::kDriver);
    EXPECT_EQ(size, 2);
    state_ = (channel & attached) != 0 ? kIdle : kFailed;
    if (state_ == kFailed || bytes[0] != 0x02) return;
    for (unsigned i = 0; i < kMotors; ++i) {
      if ((channel & 1u << i) != 0) running[i] = bytes[1];
    }
  }
  State state() override { return state_; }
};

struct Rig {
  Bus bus;
  Haptics haptics{bus};
  std::uint32_t ms = 1000;
  void run(int times) {
    for (int i = 0; i < times; ++i, ++ms) {
      for (int k = 0; k < 4; ++k) haptics.poll(ms);
    }
  }
};

TEST(Haptics, APulseIsAsLongAsItWasAskedFor) {
  Rig rig;
  rig.run(50);
  EXPECT_EQ(rig.haptics.present(), 0xFF);
  rig.haptics.pulse(4, 99, 30, rig.ms);
  rig.run(2);
  EXPECT_EQ(rig.bus.running[4], 99);
  rig.run(27);
  EXPECT_EQ(rig.bus.running[4], 99);
  rig.run(3);
  EXPECT_EQ(rig.bus.running[4], 0);
}

TEST(Haptics, ABusThatChainsWritesPlaysTheSameAndMissesTheSameDrivers) {
  Rig rig;
  rig.bus.chains = true;
  rig.bus.attached = 0xFD;
  rig.run(50);
  EXPECT_EQ(rig.haptics.present(), 0xFD);
  for (std::uint8_t rod = 0; rod < kMotors; ++rod) {
    rig.haptics.pulse(rod, static_cast<std::uint8_t>(50 + rod), 20, rig.ms);
  }
  rig.run(8);
  for (std::uint8_t rod = 0; rod < kMotors; ++rod) {
    EXPECT_EQ(rig.bus.running[rod], rod == 1 ? 0 : 50 + rod);
  }
  rig.bus.attached = 0xFC;
  rig.run(30);
  EXPECT_EQ(rig.haptics.present(), 0xFC) << "found out where its motor was to stop";
  EXPECT_FALSE(rig.haptics.safe());
}

TEST(Haptics, NoPulseIsLongerThanTheLongest) {
  Rig rig;
  rig.run(50);
  rig.haptics.pulse(0, 10, 60'000, rig.ms);
  rig.run(wire::kMaxPulseMs + 3);
  EXPECT_EQ(rig.bus.running[0], 0);
}

TEST(Haptics, TheAverageOfAMotorIsBounded) {
  Rig rig;
  rig.run(50);
  long sum = 0;
  const int kMs = 10'000;
  for (int i = 0; i < kMs; ++i) {
    rig.haptics.pulse(1, 255, 250, rig.ms);
    rig.run(1);
    sum += rig.bus.running[1];
  }
  EXPECT_LE(sum, 255L * 260 + kMs * Haptics::kCreditPerMs);
  EXPECT_GE(sum, kMs * Haptics::kCreditPerMs / 2);
}

TEST(Haptics, OffIsOff) {
  Rig rig;
  rig.run(50);
  for (std::uint8_t rod = 0; rod < kMotors; ++rod) rig.haptics.pulse(rod, 50, 200, rig.ms);
  rig.run(8);
  for (const std::uint8_t value : rig.bus.running) EXPECT_EQ(value, 50);
  rig.haptics.allow(false);
  rig.run(8);
  for (const std::uint8_t value : rig.bus.running) EXPECT_EQ(value, 0);
  rig.haptics.pulse(0, 50, 200, rig.ms);
  rig.run(8);
  EXPECT_EQ(rig.bus.running[0], 0);
}

TEST(Haptics, ADriverThatIsPluggedInLaterIsFound) {
  Rig rig;
  rig.bus.attached = 0;
  rig.run(2000);
  EXPECT_EQ(rig.haptics.present(), 0);
  rig.bus.attached = 0x20;
  rig.run(8 * Haptics::kRetryMs + 10);
  EXPECT_EQ(rig.haptics.present(), 0x20);
}

TEST(Haptics, AMotorThatCannotBeStoppedIsNotSafe) {
  Rig rig;
  rig.run(50);
  rig.haptics.pulse(3, 50, 20, rig.ms);
  rig.run(5);
  rig.bus.stuck = true;
  EXPECT_TRUE(rig.haptics.safe());
  rig.run(30);
  EXPECT_FALSE(rig.haptics.safe());
  rig.haptics.made_safe();
  rig.bus.stuck = false;
  rig.run(8 * Haptics::kRetryMs + 10);
  EXPECT_TRUE(rig.haptics.safe());
  EXPECT_EQ(rig.haptics.present(), 0xFF);
  EXPECT_EQ(rig.bus.running[3], 0);
}

}  // namespace
}  // namespace firmware
