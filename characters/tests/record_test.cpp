#include "characters/record.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>

namespace characters {
namespace {

using foosball::built_in_characters;

TEST(Record, OfTheBuiltInOnesComesBackBitForBit) {
  const auto again = from_record(to_record(built_in_characters()));
  ASSERT_TRUE(again);
  EXPECT_EQ(*again, built_in_characters());
  EXPECT_EQ(digest(*again), digest(built_in_characters()));
}

TEST(Record, ThroughTheWireIsTheSame) {
  wire::Characters received;
  ASSERT_TRUE(decode_characters(encode_characters(to_record(built_in_characters())), received));
  EXPECT_EQ(from_record(received), built_in_characters());
}

// Each number set to values that an untrusted sender may send: never an unplayable character.
TEST(Record, NumbersOutOfRangeAreRefused) {
  const wire::Characters good = to_record(built_in_characters());
  const double bad[] = {std::nan(""), INFINITY, -INFINITY, -1.0, 1e300, 0x1p-1074};
  for (std::size_t i = 0; i < wire::kBodyNumberCount; ++i) {
    for (const double value : bad) {
      if (in_range(foosball::kBodyFields[i], value)) continue;
      wire::Characters record = good;
      record.characters[1].body[i] = std::bit_cast<std::uint64_t>(value);
      EXPECT_FALSE(from_record(record)) << foosball::kBodyFields[i].name << " " << value;
    }
  }
  for (std::size_t i = 0; i < wire::kVoiceNumberCount; ++i) {
    wire::Characters record = good;
    record.characters[0].voice[i] = std::bit_cast<std::uint64_t>(std::nan(""));
    EXPECT_FALSE(from_record(record));
  }
}

TEST(Record, WithoutANameOrWithoutAnyCharacterIsRefused) {
  EXPECT_FALSE(from_record({}));
  wire::Characters record = to_record(built_in_characters());
  record.characters[0].name.clear();
  EXPECT_FALSE(from_record(record));
}

TEST(Record, OfAFootThatWouldMeetTheNextRodIsRefused) {
  foosball::Characters characters = built_in_characters();
  characters[0].body.foot_reach = 0.0745;
  characters[0].body.foot_depth = 0.030;
  EXPECT_FALSE(from_record(to_record(characters)));
}

TEST(Digest, DiffersWithEveryField) {
  const foosball::Characters& same = built_in_characters();
  const auto differs = [&](auto change) {
    foosball::Characters other = same;
    change(other[2]);
    return digest(other) != digest(same);
  };
  using foosball::Character;
  EXPECT_TRUE(differs([](Character& c) { c.name += "x"; }));
  EXPECT_TRUE(differs([](Character& c) { c.specialty += "x"; }));
  for (const auto& f : foosball::kBodyFields) {
    EXPECT_TRUE(differs([&](Character& c) { c.body.*f.value += 1e-9; })) << f.name;
  }
  for (const auto& f : foosball::kVoiceFields) {
    EXPECT_TRUE(differs([&](Character& c) { c.voice.*f.value += 1e-9; })) << f.name;
  }
  EXPECT_TRUE(differs([](Character& c) { c.look.skin[2] ^= 1; }));
  EXPECT_TRUE(differs([](Character& c) { c.look.accent[0] ^= 1; }));
  EXPECT_TRUE(differs([](Character& c) { c.look.headgear = foosball::Headgear::bubble; }));
  EXPECT_TRUE(differs([](Character& c) { c.look.face = foosball::Face::goggles; }));
  foosball::Characters fewer = same;
  fewer.pop_back();
  EXPECT_NE(digest(fewer), digest(same));
}

}  // namespace
}  // namespace characters
