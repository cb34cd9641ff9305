#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "render/distance_field.h"
#include "render/font.h"

namespace client {
namespace {

const Font& font() {
  static const Font loaded = Font::load().value();
  return loaded;
}

TEST(Font, MissingIsASentenceThatNamesThePackage) {
  const auto loaded = Font::load_from({"/nonexistent"});
  ASSERT_FALSE(loaded);
  EXPECT_NE(loaded.error().find("fonts-dejavu-core"), std::string::npos);
}

TEST(Text, WidthGrowsWithTextSizeAndSpacing) {
  const TextStyle style{Face::regular, 20.0f, 0.0f, Align::left};
  EXPECT_EQ(font().width("", style), 0.0f);
  EXPECT_LT(font().width("i", style), font().width("W", style));
  EXPECT_NEAR(font().width("abcabc", style), 2 * font().width("abc", style), 1e-3);
  TextStyle twice = style;
  twice.size = 40;
  EXPECT_NEAR(font().width("score", twice), 2 * font().width("score", style), 1e-3);
  TextStyle spaced = style;
  spaced.spacing = 0.1f;
  EXPECT_NEAR(font().width("abc", spaced), font().width("abc", style) + 2 * 0.1f * 20, 1e-3);
}

TEST(Text, GlyphsRunFromLeftToRightAndSpacesTakeRoomWithoutInk) {
  const auto placed = font().place("a b", {Face::bold, 30.0f, 0.0f, Align::left}, {100, 50});
  ASSERT_EQ(placed.size(), 2u);
  EXPECT_GT(placed[1].low.x, placed[0].high.x - 12.0f);
  for (const PlacedGlyph& g : placed) {
    EXPECT_GE(g.uv_low.x, 0.0f);
    EXPECT_LE(g.uv_high.y, 1.0f);
    EXPECT_LT(g.uv_low.x, g.uv_high.x);
    EXPECT_LT(g.low.y, 50.0f);  // stands on the baseline
  }
}

TEST(Text, AlignmentPutsTheAnchorWhereItSays) {
  TextStyle style{Face::regular, 24.0f, 0.0f, Align::left};
  const float left = font().place("HUD", style, {200, 0})[0].low.x;
  style.align = Align::centre;
  const float centre = font().place("HUD", style, {200, 0})[0].low.x;
  style.align = Align::right;
  const float right = font().place("HUD", style, {200, 0})[0].low.x;
  const float width = font().width("HUD", style);
  EXPECT_NEAR(left - centre, 0.5f * width, 1e-3);
  EXPECT_NEAR(left - right, width, 1e-3);
}

TEST(Text, StrangersBytesShowAsQuestionMarks) {
  const TextStyle style{Face::regular, 20.0f, 0.0f, Align::left};
  EXPECT_NEAR(font().width("\xFF\xC3", style), font().width("??", style), 1e-3);
  EXPECT_NEAR(font().width("\xE6\xBC\xA2", style), font().width("?", style),
              1e-3);                                                     // not in the atlas
  EXPECT_NE(font().width("\xC3\xA9", style), font().width("?", style));  // Latin-1 is
}

TEST(Utf8, TakesOneCharacterAtATime) {
  std::string_view text = "a\xC3\xA9\xE2\x82\xAC\xF0\x9F\x98\x80\x80z";
  EXPECT_EQ(next_character(text), 'a');
  EXPECT_EQ(next_character(text), 0xE9u);
  EXPECT_EQ(next_character(text), 0x20ACu);
  EXPECT_EQ(next_character(text), 0x1F600u);
  EXPECT_EQ(next_character(text), 0xFFFDu);
  EXPECT_EQ(next_character(text), 'z');
  EXPECT_TRUE(text.empty());
}

TEST(DistanceField, OfADiscIsTheDistanceToItsRim) {
  constexpr int kSize = 90, kRadius = 24, kReach = 18;
  std::vector<std::uint8_t> disc(kSize * kSize);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const double r = std::hypot(x - 44.5, y - 44.5);
      disc[static_cast<std::size_t>(y * kSize + x)] = r < kRadius ? 255 : 0;
    }
  }
  const auto field = distance_field(disc, kSize, kSize, 3, kReach);
  ASSERT_EQ(field.size(), 900u);
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 30; ++x) {
      const double inside = kRadius - std::hypot(3 * x + 1 - 44.5, 3 * y + 1 - 44.5);
      const double wanted = std::clamp(128.0 + 127.0 * inside / kReach, 0.0, 255.0);
      EXPECT_NEAR(field[static_cast<std::size_t>(30 * y + x)], wanted, 9.0)
          << x << " " << y;  // a pixel is 7
    }
  }
}

}  // namespace
}  // namespace client
