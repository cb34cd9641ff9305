#include "wire/characters.h"

#include <gtest/gtest.h>

#include "layouts.h"
#include "samples.h"
#include "wire/control.h"

namespace wire::test {
namespace {

using samples::Bytes;

Characters of(std::vector<CharacterRecord> list) {
  return {std::move(list)};
}

TEST(Characters, RoundTripIsExactWhateverTheirNumbers) {
  std::mt19937_64 random(5);
  for (int i = 0; i < 200; ++i) {
    const Characters sent = of(samples::random_characters(random));
    Characters received;
    ASSERT_TRUE(decode_characters(encode_characters(sent), received));
    EXPECT_EQ(received, sent);
  }
}

TEST(Characters, TheLongestListFitsAControlMessageAndAJournalsHeader) {
  Characters max;
  max.characters.resize(kMaxCharacterCount);
  for (CharacterRecord& c : max.characters) {
    c.name = std::string(kMaxCharacterName, 'x');
    c.specialty = std::string(kMaxCharacterSpecialty, 'y');
    c.body.fill(~std::uint64_t{0});
    c.voice = {~std::uint64_t{0}, ~std::uint64_t{0}};
  }
  EXPECT_LE(encode_characters(max).size(), max_bits(characters_layout()) / 8 + 1);
  ControlReader reader;
  reader.push(samples::encoded(ControlMessage{max}));
  ControlMessage message;
  ASSERT_EQ(reader.next(message), ControlReader::Status::message);
  EXPECT_EQ(std::get<Characters>(message), max);

  EXPECT_LE(max_bits(journal_layouts()[0].layout) / 8, kMaxJournalHeader);
  std::vector<JournalEntry> entries{JournalHeader{}};
  std::get<JournalHeader>(entries[0]).characters = max.characters;
  const Bytes file = samples::encoded(entries);
  JournalReader journal(file);
  const auto header = journal.next();
  ASSERT_TRUE(header) << journal.problem();
  EXPECT_EQ(std::get<JournalHeader>(*header).characters, max.characters);
}

TEST(Characters, EveryTruncationAndALongerOneIsRefused) {
  const Bytes whole = encode_characters(of(samples::characters()));
  Characters received;
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(decode_characters(std::span(whole).first(size), received)) << size;
  }
  Bytes longer = whole;
  longer.push_back(std::byte{0});
  EXPECT_FALSE(decode_characters(longer, received));
}

// For any bytes, the decoded values stay within every limit that the receiver uses as an index.
TEST(Characters, WithAnyBitFlippedAreRefusedOrWithinTheirLimits) {
  const Bytes whole = encode_characters(of(samples::characters()));
  for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    Bytes bytes = whole;
    bytes[bit / 8] ^= static_cast<std::byte>(1 << bit % 8);
    Characters received;
    if (!decode_characters(bytes, received)) continue;
    ASSERT_GE(received.characters.size(), 1u);
    ASSERT_LE(received.characters.size(), kMaxCharacterCount);
    for (const CharacterRecord& c : received.characters) {
      EXPECT_LE(c.name.size(), kMaxCharacterName);
      EXPECT_LE(c.specialty.size(), kMaxCharacterSpecialty);
      EXPECT_LT(c.headgear, kHeadgearCount);
      EXPECT_LT(c.face, kFaceCount);
    }
  }
}

TEST(Characters, NoneTooManyAndTextsThatAreNoneAreRefused) {
  Characters received;
  const Bytes none(1, std::byte{0});
  EXPECT_FALSE(decode_characters(none, received));
  Bytes many = encode_characters(of(samples::characters()));
  many[0] = std::byte{kMaxCharacterCount + 1};
  EXPECT_FALSE(decode_characters(many, received));
  Bytes control = encode_characters(of(samples::characters()));
  control[2] = std::byte{'\n'};  // count, length, then the name
  EXPECT_FALSE(decode_characters(control, received));
  control[2] = std::byte{0xFF};
  EXPECT_FALSE(decode_characters(control, received));
}

TEST(Characters, WhatIsSentIsCutToTheLimits) {
  std::vector<CharacterRecord> list(kMaxCharacterCount + 3);
  list[0].name = std::string(100, 'x') + "\n";
  list[0].headgear = 200;
  Characters received;
  ASSERT_TRUE(decode_characters(encode_characters(of(list)), received));
  EXPECT_EQ(received.characters.size(), kMaxCharacterCount);
  EXPECT_EQ(received.characters[0].name, std::string(kMaxCharacterName, 'x'));
  EXPECT_EQ(received.characters[0].headgear, kHeadgearCount - 1);
}

}  // namespace
}  // namespace wire::test
