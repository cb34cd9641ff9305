#include "client/qr_code.h"

#include <gtest/gtest.h>

#include <string>

#include "wire/control.h"

namespace client {
namespace {

// The finder pattern, a dark ring with a core, by which a camera locates the code.
bool finder_at(const QrCode& code, int left, int top) {
  for (int y = 0; y < 7; ++y) {
    for (int x = 0; x < 7; ++x) {
      const bool ring = x == 0 || x == 6 || y == 0 || y == 6;
      const bool core = x >= 2 && x <= 4 && y >= 2 && y <= 4;
      if (code(left + x, top + y) != (ring || core)) return false;
    }
  }
  return true;
}

TEST(QrCode, HasItsFindersAndTimingWhateverTheText) {
  for (std::size_t bytes = 1; bytes <= wire::kMaxUrl; bytes += 7) {
    const QrCode code =
        qr_code_of("http://" + std::string(bytes, 'x').substr(7 < bytes ? 7 : bytes));
    ASSERT_GE(code.size, 21);
    ASSERT_EQ((code.size - 21) % 4, 0);
    ASSERT_EQ(code.dark.size(), static_cast<std::size_t>(code.size * code.size));
    EXPECT_TRUE(finder_at(code, 0, 0));
    EXPECT_TRUE(finder_at(code, code.size - 7, 0));
    EXPECT_TRUE(finder_at(code, 0, code.size - 7));
    EXPECT_FALSE(finder_at(code, code.size - 7, code.size - 7));
    for (int i = 8; i < code.size - 8; ++i) EXPECT_EQ(code(i, 6), i % 2 == 0) << i;
  }
}

TEST(QrCode, OtherTextsAreOtherCodesAndOneIsAlwaysTheSame) {
  const QrCode a = qr_code_of("http://192.168.1.5:7532/abc"),
               b = qr_code_of("http://192.168.1.5:7532/abd");
  EXPECT_NE(a.dark, b.dark);
  EXPECT_EQ(a.dark, qr_code_of("http://192.168.1.5:7532/abc").dark);
}

TEST(QrCode, AnUrlOfTheServerFitsIntoThirtyThreeModules) {
  EXPECT_LE(qr_code_of("http://192.168.100.123:65535/23456789abcdefghjkmn").size, 33);
}

TEST(QrCode, OfNothingOrOfTooMuchThereIsNone) {
  EXPECT_EQ(qr_code_of("").size, 0);
  EXPECT_EQ(qr_code_of(std::string(wire::kMaxUrl + 1, 'a')).size, 0);
  EXPECT_GT(qr_code_of(std::string(wire::kMaxUrl, 'a')).size, 0);
}

}  // namespace
}  // namespace client
