#include "core/index_marks.h"

#include <gtest/gtest.h>

namespace firmware {
namespace {

// An expander, and drivers that accept every write. A transfer takes `polls` calls of state().
struct MarksBus final : I2cReadBus {
  bool attached = true, multiplexer = true;
  std::uint8_t pins = 0xFF;
  int polls = 1, left = 0, reads = 0, writes = 0;
  bool good = true;

  void begin(bool answers) {
    EXPECT_EQ(left, 0) << "two transfers at once";
    left = polls;
    good = answers;
  }
  void write(std::uint8_t address, const std::uint8_t*, std::uint8_t) override {
    EXPECT_NE(address, IndexMarks::kExpander);
    ++writes;
    begin(multiplexer);
  }
  void read(std::uint8_t address) override {
    EXPECT_EQ(address, IndexMarks::kExpander);
    ++reads;
    begin(attached);
  }
  std::uint8_t byte() override {
    EXPECT_TRUE(good);
    return pins;
  }
  State state() override {
    if (left > 0 && --left > 0) return kBusy;
    return good ? kIdle : kFailed;
  }
};

struct MarksRig {
  MarksBus bus;
  Haptics haptics{bus};
  IndexMarks marks{bus};
  std::uint32_t ms = 1000;
  void run(int times) {
    for (int i = 0; i < times; ++i, ++ms) {
      for (int k = 0; k < 8; ++k) {
        marks.poll(ms);
        haptics.poll(ms);
      }
    }
  }
};

TEST(IndexMarks, APinThatIsPulledLowIsAMark) {
  MarksRig rig;
  rig.run(3);
  EXPECT_EQ(rig.marks.under(), 0);
  rig.bus.pins = 0xF6;
  rig.run(2);
  EXPECT_EQ(rig.marks.under(), 0x09);
}

TEST(IndexMarks, IsReadOnceAMillisecondAndWithoutAnExpanderOnceASecond) {
  MarksRig rig;
  rig.bus.multiplexer = false;
  rig.run(100);
  EXPECT_NEAR(rig.bus.reads, 100, 1);
  rig.bus.attached = false;
  rig.bus.reads = 0;
  rig.run(10'000);
  EXPECT_NEAR(rig.bus.reads, 11, 1);
}

TEST(IndexMarks, AreGoneWithTheirExpanderAndBackWithIt) {
  MarksRig rig;
  rig.bus.pins = 0x00;
  rig.run(3);
  EXPECT_EQ(rig.marks.under(), 0xFF);
  rig.bus.attached = false;
  rig.run(3);
  EXPECT_EQ(rig.marks.under(), 0);
  rig.bus.attached = true;
  rig.run(IndexMarks::kRetryMs + 3);
  EXPECT_EQ(rig.marks.under(), 0xFF);
}

// For any transfer time up to most of a millisecond, neither starts one during the other's, nor
// takes the other's end for its own; and both are served.
TEST(IndexMarks, ShareTheBusWithTheMotors) {
  for (const int polls : {1, 2, 3, 5}) {
    MarksRig rig;
    rig.bus.polls = polls;
    rig.run(400);  // all drivers are set up
    EXPECT_EQ(rig.haptics.present(), 0xFF) << polls;
    rig.bus.pins = 0xFE;
    rig.bus.reads = rig.bus.writes = 0;
    for (int i = 0; i < 100; ++i) {
      rig.haptics.pulse(static_cast<std::uint8_t>(i % 8), static_cast<std::uint8_t>(1 + i), 5,
                        rig.ms);
      rig.run(4);
    }
    EXPECT_EQ(rig.haptics.present(), 0xFF) << polls;
    EXPECT_TRUE(rig.haptics.safe());
    EXPECT_EQ(rig.marks.under(), 1) << polls;
    EXPECT_GT(rig.bus.reads, 50) << polls;
    // Two writes start a pulse and two end it; the last is still on.
    EXPECT_GE(rig.bus.writes, 390) << polls;
  }
}

// The index marks fail, the motors do not: each gets only its own answers.
TEST(IndexMarks, WithoutAnExpanderTheMotorsAreWell) {
  MarksRig rig;
  rig.bus.attached = false;
  rig.bus.polls = 3;
  rig.run(3'000);
  EXPECT_EQ(rig.haptics.present(), 0xFF);
  EXPECT_TRUE(rig.haptics.safe());
}

}  // namespace
}  // namespace firmware
