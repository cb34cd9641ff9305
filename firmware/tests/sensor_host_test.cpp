#include "core/sensor_host.h"

#include <gtest/gtest.h>

#include <array>
#include <random>

namespace firmware {
namespace {

TEST(Transpose8, IsATurnedMatrix) {
  std::mt19937 random(71);
  for (int i = 0; i < 2000; ++i) {
    alignas(4) std::uint8_t rows[8], columns[8];
    for (auto& row : rows) row = static_cast<std::uint8_t>(random());
    transpose8(rows, columns);
    for (unsigned sensor = 0; sensor < 8; ++sensor) {
      unsigned wanted = 0;
      for (const std::uint8_t row : rows) wanted = wanted << 1 | (row >> sensor & 1u);
      EXPECT_EQ(columns[sensor], wanted);
    }
  }
}

// Sensors that answer at once; timing and electrical behaviour are covered by the simulated board.
struct SensorsBus final : SensorBus {
  struct Sensor {
    bool there = true;
    std::array<std::uint8_t, 128> registers{};
    int x = 0, y = 0;
    std::uint8_t observation = 0x3F;
    bool bursts = false, held_low = false;
  };
  std::array<Sensor, kSensors> sensors{};
  int accesses = 0;

  SensorsBus() {
    for (Sensor& sensor : sensors) power(sensor);
  }
  static void power(Sensor& sensor) {
    sensor.registers = {};
    sensor.registers[0x00] = 0x42;
    sensor.registers[0x3F] = 0xBD;
    sensor.registers[0x0F] = 0x31;
    sensor.x = sensor.y = 0;
    sensor.bursts = false;
  }
  void burst(std::uint8_t selected, std::uint8_t* out) override {
    std::array<std::array<std::uint8_t, kBurstBytes>, kSensors> bytes{};
    for (unsigned i = 0; i < kSensors; ++i) {
      Sensor& sensor = sensors[i];
      if (!sensor.there || (selected & 1u << i) == 0) {
        bytes[i].fill(0xFF);
        continue;
      }
      // Sent by the sensor, but not received.
      if (sensor.bursts && sensor.held_low) sensor.x = sensor.y = 0;
      if (!sensor.bursts || sensor.held_low) continue;
      const auto x = static_cast<std::uint16_t>(sensor.x), y = static_cast<std::uint16_t>(sensor.y);
      bytes[i] = {static_cast<std::uint8_t>(sensor.x != 0 || sensor.y != 0 ? 0x80 : 0),
                  sensor.observation,
                  static_cast<std::uint8_t>(x),
                  static_cast<std::uint8_t>(x >> 8),
                  static_cast<std::uint8_t>(y),
                  static_cast<std::uint8_t>(y >> 8)};
      sensor.x = sensor.y = 0;
    }
    for (unsigned bit = 0; bit < 8 * kBurstBytes; ++bit) {
      unsigned row = 0;
      for (unsigned i = 0; i < kSensors; ++i) {
        row |= (bytes[i][bit / 8] >> (7 - bit % 8) & 1u) << i;
      }
      out[bit] = static_cast<std::uint8_t>(row);
    }
  }
  void read(std::uint8_t selected, std::uint8_t address, std::uint8_t* out) override {
    ++accesses;
    for (unsigned i = 0; i < kSensors; ++i) {
      const bool answers = sensors[i].there && (selected & 1u << i) != 0;
      out[i] = answers ? sensors[i].registers[address] : 0xFF;
      if (answers) sensors[i].bursts = false;
    }
  }
  void write(std::uint8_t selected, std::uint8_t address, std::uint8_t value) override {
    ++accesses;
    for (unsigned i = 0; i < kSensors; ++i) {
      if (!sensors[i].there || (selected & 1u << i) == 0) continue;
      sensors[i].bursts = address == 0x50;
      if (address == 0x3A && value == 0x5A) power(sensors[i]);
      if (address != 0x50) sensors[i].registers[address] = value;
    }
  }
};

struct SensorsRig {
  SensorsBus bus;
  SensorHost host{bus};
  std::uint32_t ms = 0;

  explicit SensorsRig(std::uint8_t used = 0xFF) { host.begin(used, 20); }
  wire::DeviceFrame frame() {
    wire::DeviceFrame made{};
    host.add_to_frame(made);
    return made;
  }
  void run(int times) {
    for (int i = 0; i < times; ++i, ++ms) {
      host.sample(1);
      host.service(ms);
    }
  }
};

TEST(SensorHost, AllAreSetUpTogetherWithinAnEighthOfASecond) {
  SensorsRig rig;
  rig.run(100);
  EXPECT_EQ(rig.host.present(), 0xFF);
  for (const SensorsBus::Sensor& sensor : rig.bus.sensors) EXPECT_EQ(sensor.registers[0x0F], 19);
  EXPECT_EQ(rig.frame().flags, 0);
}

TEST(SensorHost, CountsAreCumulativeAndWrap) {
  SensorsRig rig;
  rig.run(100);
  std::uint16_t slide = 0, spin = 0;
  for (int i = 0; i < 2000; ++i) {
    rig.bus.sensors[3].x = 300 - i % 7;
    rig.bus.sensors[3].y = -250 + i % 5;
    slide = static_cast<std::uint16_t>(slide + rig.bus.sensors[3].x);
    spin = static_cast<std::uint16_t>(spin + rig.bus.sensors[3].y);
    rig.run(1);
  }
  const wire::DeviceFrame frame = rig.frame();
  EXPECT_EQ(frame.slide[3], slide);
  EXPECT_EQ(frame.spin[3], spin);
  EXPECT_EQ(frame.slide[2], 0);
  EXPECT_EQ(frame.overflow, 0);
}

TEST(SensorHost, WhatIsLargerThanASensorFollowsIsFlaggedUntilItWasTold) {
  SensorsRig rig;
  rig.run(100);
  rig.bus.sensors[0].x = 600;  // 25 counts/ms for each 100 counts/inch, plus a quarter: 625 + 8
  rig.run(1);
  EXPECT_EQ(rig.frame().overflow, 0);
  rig.bus.sensors[0].x = -633;
  rig.bus.sensors[5].y = 32767;
  rig.run(1);
  EXPECT_EQ(rig.frame().overflow, 0x21);
  EXPECT_EQ(rig.frame().overflow, 0);
  rig.bus.sensors[0].x = 1200;  // in two milliseconds
  rig.host.sample(2);
  EXPECT_EQ(rig.frame().overflow, 0);
}

TEST(SensorHost, AllOnesAreNoMotion) {
  SensorsRig rig;
  rig.run(100);
  rig.bus.sensors[6].there = false;
  rig.run(3);
  wire::DeviceFrame frame = rig.frame();
  EXPECT_EQ(frame.present, 0xBF);
  EXPECT_EQ(frame.slide[6], 0);
  EXPECT_EQ(frame.quality, 1);
  rig.bus.sensors[6].there = true;
  SensorsBus::power(rig.bus.sensors[6]);
  rig.run(200);
  frame = rig.frame();
  EXPECT_EQ(frame.present, 0xFF);
  EXPECT_EQ(frame.flags, 1);
  EXPECT_EQ(frame.quality, 0);
}

// All zeros are valid for a sensor without motion, except for the flag that its processes run.
TEST(SensorHost, CountsThatALineHeldLowSwallowsAreAnError) {
  SensorsRig rig;
  rig.run(100);
  rig.frame();
  for (const int ms : {1, 3}) {
    rig.bus.sensors[2].held_low = true;
    rig.bus.sensors[2].x = 40;
    rig.run(ms);
    rig.bus.sensors[2].held_low = false;
    rig.run(2);
    EXPECT_GE(rig.frame().quality, 1) << ms;
    EXPECT_EQ(rig.frame().present, 0xFF) << ms;
  }
}

// In case such a sensor exists.
TEST(SensorHost, ASensorThatNeverSaysThatItsProcessesRunIsBelieved) {
  SensorsRig rig;
  for (SensorsBus::Sensor& sensor : rig.bus.sensors) sensor.observation = 0;
  rig.run(1000);
  rig.bus.sensors[2].x = 40;
  rig.run(10);
  const wire::DeviceFrame frame = rig.frame();
  EXPECT_EQ(frame.present, 0xFF);
  EXPECT_EQ(frame.quality, 0);
  EXPECT_EQ(frame.slide[2], 40);
}

TEST(SensorHost, ASensorThatForgotItsSetUpIsFoundOutWithinAllQuestions) {
  SensorsRig rig;
  rig.run(100);
  SensorsBus::power(rig.bus.sensors[1]);
  rig.run(SensorHost::kCheckMs * SensorHost::kQuestions + 2);
  EXPECT_EQ(rig.host.present(), 0xFD);
  rig.run(200);
  EXPECT_EQ(rig.host.present(), 0xFF);
}

TEST(SensorHost, RodsOfOthersStayAsTheyWere) {
  SensorsRig rig(0x0F);
  rig.run(100);
  wire::DeviceFrame frame{};
  frame.slide[7] = 77;
  frame.present = 0xC0;
  frame.overflow = 0x80;
  frame.quality = 255;
  rig.host.add_to_frame(frame);
  EXPECT_EQ(frame.present, 0xCF);
  EXPECT_EQ(frame.slide[7], 77);
  EXPECT_EQ(frame.overflow, 0x80);
  EXPECT_EQ(frame.quality, 255);
}

TEST(SensorHost, AMillisecondHasAtMostTwoAccessesBesideTheBurst) {
  SensorsRig rig;
  rig.bus.sensors[2].there = false;
  for (int i = 0; i < 1000; ++i) {
    const int before = rig.bus.accesses;
    rig.run(1);
    EXPECT_LE(rig.bus.accesses - before, 2);
  }
}

}  // namespace
}  // namespace firmware
