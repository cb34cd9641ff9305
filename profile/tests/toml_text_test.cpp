#include "profile/toml_text.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace profile {
namespace {

TEST(TomlText, KeepsEveryLetterOfStringsAndKeys) {
  // Latin, Greek, Hangul, the last letter of three bytes, an emoji; with and without a byte order
  // mark.
  const std::string letters = "gr\u00f6\u00dfe \u03b1 \ubcbd \ufeff \uffee \U0001F3D3";
  for (const std::string& mark : std::vector<std::string>{"", "\xEF\xBB\xBF"}) {
    const auto parsed = parse_toml(mark + "# " + letters + "\n\"" + letters + "\" = '" + letters +
                                   "' # " + letters + "\n");
    ASSERT_TRUE(parsed);
    ASSERT_EQ(parsed.table().size(), 1u);
    for (const auto& [key, node] : parsed.table()) {
      EXPECT_EQ(as_written(key.str()), letters);
      EXPECT_EQ(as_written(node.value<std::string_view>().value()), letters);
    }
  }
}

TEST(TomlText, RefusesLettersOutsideOfStringsInTheirLine) {
  for (const std::string& letter :
       std::vector<std::string>{"\u00e9", "\u00a6", "\u03b1", "\u2000", "\ubcbd", "\uffee"}) {
    for (const std::string& line :
         std::vector<std::string>{letter + " = 1", "a" + letter + " = 1", "a = " + letter,
                                  "a = 1 " + letter, "[" + letter + "]"}) {
      const auto parsed = parse_toml("b = 2\n" + line + "\n");
      ASSERT_FALSE(parsed) << line;
      EXPECT_EQ(parsed.error().source().begin.line, 2u) << line;
    }
  }
}

TEST(TomlText, RefusesKeysThatOverflowTheStack) {
  std::string key = "a";
  for (int i = 0; i < 30000; ++i) key += ".a";
  for (const std::string& line :
       {key + " = 1", "[" + key + "]", "[[" + key + "]]", "b = [{" + key + " = 1}]"}) {
    const auto parsed = parse_toml("z = 2\n" + line + "\n");
    ASSERT_FALSE(parsed) << line.substr(0, 20);
    EXPECT_EQ(parsed.error().source().begin.line, 2u) << line.substr(0, 20);
  }
}

TEST(TomlText, TakesDottedKeysAndDotsInCommentsAndNumbers) {
  std::string text = "a.b.c = 0.5 # " + std::string(5000, '.') + "\n";
  for (int i = 0; i < 500; ++i) text += "# A sentence. And 1.5 of another.\n";
  const auto parsed = parse_toml(text);
  ASSERT_TRUE(parsed);
  EXPECT_EQ(parsed.table()["a"]["b"]["c"].value<double>(), 0.5);
}

TEST(TomlText, LeavesWhatIsNoUtf8ToTheParserWhichRefusesIt) {
  for (const std::string& bytes :
       std::vector<std::string>{"\x80", "\xC3", "\xC0\x80", "\xED\xA0\x80", "\xE2\x82",
                                "\xF5\x80\x80\x80", "\xF0\x80\x80\x80", "\xFF"}) {
    EXPECT_FALSE(parse_toml("a = '" + bytes + "'\n")) << testing::PrintToString(bytes);
    EXPECT_EQ(as_written(bytes), bytes);
  }
}

}  // namespace
}  // namespace profile
