#include "core/ps2_lines.h"

#include <gtest/gtest.h>

#include <bit>
#include <vector>

namespace firmware {
namespace {

std::uint8_t sample(Ps2Lines& lines, unsigned clock, unsigned data, unsigned again) {
  lines.count_sample();
  lines.sample(static_cast<std::uint8_t>(clock), static_cast<std::uint8_t>(data),
               static_cast<std::uint8_t>(again), [](std::uint8_t) {});
  return lines.data_low();
}
std::uint8_t sample(Ps2Lines& lines, unsigned clock, unsigned data = 0xFF) {
  return sample(lines, clock, data, clock);
}

TEST(Ps2Lines, AFallingClockIsHeardOnceWithItsData) {
  Ps2Lines lines;
  sample(lines, 0xFF, 0xFF);
  sample(lines, 0xFE, 0xFE);
  sample(lines, 0xFE, 0xFF);
  sample(lines, 0xFF, 0xFF);
  Edges edges{};
  ASSERT_TRUE(lines.pop(edges));
  EXPECT_EQ(edges.fell, 0x01);
  EXPECT_EQ(edges.data, 0xFE);
  EXPECT_EQ(edges.tick, 2);
  EXPECT_FALSE(lines.pop(edges));
}

TEST(Ps2Lines, ASpikeSeenByOneReadingOnlyIsNoEdge) {
  Ps2Lines lines;
  sample(lines, 0xFF, 0xFF, 0xFE);
  sample(lines, 0xFE, 0xFF, 0xFF);
  sample(lines, 0xFF);
  EXPECT_TRUE(lines.empty());
  // Nor does an upward spike end a low phase.
  sample(lines, 0xFE);
  sample(lines, 0xFF, 0xFF, 0xFE);
  sample(lines, 0xFE);
  Edges edges{};
  ASSERT_TRUE(lines.pop(edges));
  EXPECT_FALSE(lines.pop(edges));
}

TEST(Ps2Lines, EdgesThatFindTheRingFullAreCounted) {
  Ps2Lines lines;
  for (int i = 0; i < 80; ++i) {
    sample(lines, 0x00);
    sample(lines, 0xFF);
  }
  int taken = 0;
  for (Edges edges{}; lines.pop(edges);) ++taken;
  EXPECT_EQ(taken, 63);
  EXPECT_EQ(lines.dropped(), 80 - 63);
}

TEST(Ps2Lines, OurOwnHoldingOfTheClockIsNoEdge) {
  Ps2Lines lines;
  sample(lines, 0xFF);
  lines.inhibit(3);
  EXPECT_EQ(lines.clock_low(), 0x08);
  sample(lines, 0xF7);
  lines.release(3);
  sample(lines, 0xFF);
  EXPECT_TRUE(lines.empty());
}

// Returns what a mouse reads as it clocks value out of the host, eleven times; the other clocks are
// idle.
struct Taken {
  std::vector<bool> bits;
  bool acknowledged;
};
void clock_once(Ps2Lines& lines, int mouse, bool acknowledge, Taken& taken) {
  const unsigned low = 0xFFu & ~(1u << mouse);
  const std::uint8_t driven = sample(lines, low, acknowledge ? low : 0xFF);
  taken.bits.push_back((driven >> mouse & 1) == 0);
  sample(lines, 0xFF);
}

TEST(Ps2Lines, EveryByteIsSentWithOddParityAndStop) {
  for (unsigned value = 0; value < 256; ++value) {
    Ps2Lines lines;
    sample(lines, 0xFF);
    lines.inhibit(5);
    lines.send(5, static_cast<std::uint8_t>(value));
    EXPECT_EQ(lines.data_low(), 1u << 5);  // the start bit
    EXPECT_EQ(lines.clock_low(), 0);
    sample(lines, 0xFF);
    Taken taken{};
    for (int bit = 0; bit < 10; ++bit) clock_once(lines, 5, false, taken);
    EXPECT_TRUE(lines.sending(5));
    unsigned read = 0;
    for (unsigned bit = 0; bit < 8; ++bit) read |= taken.bits[bit] ? 1u << bit : 0;
    EXPECT_EQ(read, value);
    EXPECT_EQ(taken.bits[8], (std::popcount(value) & 1) == 0);
    EXPECT_TRUE(taken.bits[9]);
    clock_once(lines, 5, value % 2 == 0, taken);
    EXPECT_FALSE(lines.sending(5));
    EXPECT_EQ(lines.acknowledged(5), value % 2 == 0);
    EXPECT_TRUE(lines.empty());
  }
}

TEST(Ps2Lines, MiceAtDifferentBitsEachGetTheirOwn) {
  Ps2Lines lines;
  sample(lines, 0xFF);
  const std::uint8_t first = 0xF4, second = 0x9A;
  lines.send(0, first);
  Taken a{}, b{};
  for (int bit = 0; bit < 3; ++bit) clock_once(lines, 0, false, a);
  lines.send(7, second);
  for (int bit = 0; bit < 7; ++bit) {
    clock_once(lines, 7, false, b);
    clock_once(lines, 0, false, a);
  }
  for (int bit = 7; bit < 10; ++bit) clock_once(lines, 7, false, b);
  for (unsigned bit = 0; bit < 8; ++bit) {
    EXPECT_EQ(a.bits[bit], (first >> bit & 1) != 0);
    EXPECT_EQ(b.bits[bit], (second >> bit & 1) != 0);
  }
}

}  // namespace
}  // namespace firmware
