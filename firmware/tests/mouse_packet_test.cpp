#include "core/mouse_packet.h"

#include <gtest/gtest.h>

namespace firmware {
namespace {

PacketParser::Event feed(PacketParser& parser, std::uint8_t head, std::uint8_t x, std::uint8_t y) {
  parser.byte(head, true, false);
  parser.byte(x, true, false);
  return parser.byte(y, true, false);
}

TEST(PacketParser, EveryNineBitDeltaIsRead) {
  PacketParser parser;
  for (int delta = -256; delta <= 255; ++delta) {
    const auto low = static_cast<std::uint8_t>(delta);
    const unsigned sign = delta < 0 ? 1 : 0;
    ASSERT_EQ(feed(parser, static_cast<std::uint8_t>(0x08 | sign << 4), low, 0),
              PacketParser::kMovement);
    EXPECT_EQ(parser.movement().slide, delta);
    EXPECT_EQ(parser.movement().spin, 0);
    ASSERT_EQ(feed(parser, static_cast<std::uint8_t>(0x08 | sign << 5), 0, low),
              PacketParser::kMovement);
    EXPECT_EQ(parser.movement().slide, 0);
    EXPECT_EQ(parser.movement().spin, delta);
    EXPECT_FALSE(parser.movement().overflow);
  }
}

TEST(PacketParser, ButtonsAreIgnored) {
  PacketParser parser;
  ASSERT_EQ(feed(parser, 0x0F, 3, 4), PacketParser::kMovement);
  EXPECT_EQ(parser.movement().slide, 3);
  EXPECT_EQ(parser.movement().spin, 4);
}

TEST(PacketParser, OverflowSaturatesInTheDirectionOfTheSign) {
  PacketParser parser;
  ASSERT_EQ(feed(parser, 0x08 | 0x40, 7, 9), PacketParser::kMovement);
  EXPECT_EQ(parser.movement().slide, 255);
  EXPECT_EQ(parser.movement().spin, 9);
  EXPECT_TRUE(parser.movement().overflow);
  ASSERT_EQ(feed(parser, 0x08 | 0x80 | 0x20, 7, 9), PacketParser::kMovement);
  EXPECT_EQ(parser.movement().slide, 7);
  EXPECT_EQ(parser.movement().spin, -256);
  EXPECT_TRUE(parser.movement().overflow);
}

TEST(PacketParser, AHeadWithoutBit3IsThrownAway) {
  PacketParser parser;
  EXPECT_EQ(parser.byte(0x10, true, false), PacketParser::kResync);
  EXPECT_TRUE(parser.between_packets());
  EXPECT_EQ(feed(parser, 0x08, 1, 2), PacketParser::kMovement);
}

TEST(PacketParser, AGapBeginsAPacketWhateverWasExpected) {
  PacketParser parser;
  parser.byte(0x08, true, true);
  parser.byte(0x01, true, false);
  EXPECT_EQ(parser.byte(0x08, true, true), PacketParser::kResync);
  EXPECT_EQ(parser.byte(0x05, true, false), PacketParser::kNone);
  EXPECT_EQ(parser.byte(0x06, true, false), PacketParser::kMovement);
  EXPECT_EQ(parser.movement().slide, 5);
  EXPECT_EQ(parser.movement().spin, 6);
}

TEST(PacketParser, APacketWithABadByteIsDroppedWhole) {
  for (int bad = 0; bad < 3; ++bad) {
    PacketParser parser;
    parser.byte(0x08, bad != 0, true);
    parser.byte(0x01, bad != 1, false);
    EXPECT_EQ(parser.byte(0x02, bad != 2, false), PacketParser::kResync);
    EXPECT_EQ(feed(parser, 0x08, 3, 4), PacketParser::kMovement) << "after bad byte " << bad;
  }
}

TEST(PacketParser, AfterLostBitsNothingCountsUntilAGap) {
  PacketParser parser;
  parser.lose();
  for (int i = 0; i < 7; ++i) EXPECT_EQ(parser.byte(0x08, true, false), PacketParser::kNone);
  EXPECT_EQ(parser.byte(0x08, true, true), PacketParser::kNone);
  EXPECT_EQ(parser.byte(0x01, true, false), PacketParser::kNone);
  EXPECT_EQ(parser.byte(0x02, true, false), PacketParser::kMovement);
}

TEST(PacketParser, RecognisesAMouseThatHasJustBeenPowered) {
  PacketParser parser;
  parser.byte(0xAA, true, true);
  EXPECT_FALSE(parser.looks_like_power_on());
  parser.byte(0x00, true, false);
  EXPECT_TRUE(parser.looks_like_power_on());
  parser.byte(0x00, true, false);
  EXPECT_FALSE(parser.looks_like_power_on());
}

}  // namespace
}  // namespace firmware
