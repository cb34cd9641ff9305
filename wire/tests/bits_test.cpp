#include "bits.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "crc32.h"

namespace wire::test {
namespace {

using Bytes = std::vector<std::byte>;

struct Piece {
  std::uint64_t value;
  int bits;
  bool align_after;
};

std::vector<Piece> random_pieces(std::mt19937_64& random) {
  std::vector<Piece> pieces(random() % 60);
  for (Piece& piece : pieces) {
    piece.bits = 1 + static_cast<int>(random() % 64);
    piece.value = random() >> (64 - piece.bits);
    piece.align_after = random() % 8 == 0;
  }
  return pieces;
}

// The definition, bit by bit.
Bytes packed(const std::vector<Piece>& pieces) {
  std::vector<bool> bits;
  for (const Piece& piece : pieces) {
    for (int i = 0; i < piece.bits; ++i) bits.push_back((piece.value >> i & 1) != 0);
    while (piece.align_after && bits.size() % 8 != 0) bits.push_back(false);
  }
  Bytes bytes((bits.size() + 7) / 8);
  for (std::size_t i = 0; i < bits.size(); ++i) {
    if (bits[i]) bytes[i / 8] |= static_cast<std::byte>(1 << i % 8);
  }
  return bytes;
}

bool write(const std::vector<Piece>& pieces, std::span<std::byte> out) {
  BitWriter writer(out);
  for (const Piece& piece : pieces) {
    writer.put(piece.value, piece.bits);
    if (piece.align_after) writer.align();
  }
  writer.align();
  return writer.ok();
}

TEST(Bits, AreWrittenAsDefinedAndReadBack) {
  std::mt19937_64 random(51);
  for (int round = 0; round < 2000; ++round) {
    const auto pieces = random_pieces(random);
    const Bytes expected = packed(pieces);
    Bytes bytes(expected.size());
    ASSERT_TRUE(write(pieces, bytes));
    ASSERT_EQ(bytes, expected);
    BitReader reader(bytes);
    for (const Piece& piece : pieces) {
      ASSERT_EQ(reader.get(piece.bits), piece.value);
      if (piece.align_after) {
        ASSERT_TRUE(reader.align());
      }
    }
    EXPECT_TRUE(reader.align());
    EXPECT_TRUE(reader.ok());
    EXPECT_EQ(reader.remaining(), 0U);
  }
}

TEST(Bits, AByteTooFewIsAStickyErrorOnBothSides) {
  std::mt19937_64 random(52);
  for (int round = 0; round < 2000; ++round) {
    const auto pieces = random_pieces(random);
    const Bytes whole = packed(pieces);
    if (whole.empty()) continue;
    Bytes less(whole.begin(), whole.end() - 1);
    BitReader reader(less);
    for (const Piece& piece : pieces) {
      reader.get(piece.bits);
      if (piece.align_after) reader.align();
    }
    EXPECT_FALSE(reader.ok());
    EXPECT_EQ(reader.get(1), 0U);
    EXPECT_FALSE(write(pieces, less));
  }
}

TEST(Bits, PaddingThatIsNotZeroIsSeen) {
  for (unsigned padding = 0; padding < 128; ++padding) {
    const Bytes bytes{static_cast<std::byte>(padding << 1 | 1), std::byte{0xFF}};
    BitReader reader(bytes);
    EXPECT_EQ(reader.get(1), 1U);
    EXPECT_EQ(reader.align(), padding == 0);
    EXPECT_EQ(reader.consumed(), 1U);
    EXPECT_EQ(reader.get(8), 0xFFU);
  }
}

TEST(Bits, BytesAreTakenFromTheMiddle) {
  const Bytes bytes{std::byte{1}, std::byte{2}, std::byte{3}, std::byte{4}, std::byte{5}};
  BitReader reader(bytes);
  EXPECT_EQ(reader.get(8), 1U);
  reader.align();
  const auto two = reader.get_bytes(2);
  ASSERT_EQ(two.size(), 2U);
  EXPECT_EQ(two[0], std::byte{2});
  EXPECT_EQ(reader.get(16), 0x0504U);
  EXPECT_TRUE(reader.get_bytes(1).empty());
  EXPECT_FALSE(reader.ok());
}

TEST(Crc32, IsThatOfZlibForEveryLengthAndAlignment) {
  const std::string check = "123456789";
  EXPECT_EQ(crc32(std::as_bytes(std::span(check))), 0xCBF43926U);
  std::mt19937_64 random(53);
  Bytes bytes(100);
  for (std::byte& b : bytes) b = static_cast<std::byte>(random());
  for (std::size_t from = 0; from < 8; ++from) {
    for (std::size_t size = 0; size + from <= bytes.size(); ++size) {
      const auto part = std::span(bytes).subspan(from, size);
      std::uint32_t crc = 0xFFFFFFFFU;
      for (const std::byte b : part) {
        crc ^= static_cast<std::uint32_t>(b);
        for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ ((crc & 1) != 0 ? 0xEDB88320U : 0U);
      }
      ASSERT_EQ(crc32(part), ~crc);
    }
  }
}

}  // namespace
}  // namespace wire::test
