#include "characters/character_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

namespace characters {
namespace {

namespace fs = std::filesystem;
using foosball::Character;
using foosball::kBodyFields;
using foosball::kMaxCharacters;
using foosball::kVoiceFields;

// A folder for one test.
class CharacterFolder : public testing::Test {
 protected:
  CharacterFolder() {
    std::string name = (fs::temp_directory_path() / "characters-XXXXXX").string();
    folder = ::mkdtemp(name.data());
  }
  ~CharacterFolder() override { fs::remove_all(folder); }
  std::string write(const std::string& file, const std::string& text) const {
    const std::string path = folder + "/" + file;
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }
  std::string folder;
};

std::string error_of(const std::string& text) {
  const auto result = parse_character(text, "mine.toml");
  return result ? "" : result.error();
}

bool says(const std::string& error, const std::string& part) {
  return error.find(part) != std::string::npos;
}

// --- accepted files ------------------------------------------------------------------------------

TEST(CharacterFile, TheBuiltInOnesAreTheFilesOfTheRepository) {
  const auto files = load_characters(CHARACTERS_DATA);
  ASSERT_TRUE(files) << files.error();
  EXPECT_EQ(*files, foosball::built_in_characters());
  EXPECT_GE(files->size(), 6u);
}

TEST(CharacterFile, ComesBackBitForBit) {
  for (Character c : foosball::built_in_characters()) {
    c.name = "\"quoted\" \\ \xEC\x9A\xB0\xEC\xA3\xBC";
    double share = 0.0;
    for (const auto& f : kBodyFields) {
      share += 1.0 / 17.0;
      c.body.*f.value = f.min + share * (f.max - f.min) / 3.0;
    }
    const auto again = parse_character(format_character(c), "x.toml");
    ASSERT_TRUE(again) << again.error();
    EXPECT_EQ(*again, c);
  }
}

TEST(CharacterFile, NeedsNoMoreThanAName) {
  const auto c = parse_character("name = \"plain\"", "x.toml");
  ASSERT_TRUE(c) << c.error();
  Character plain;
  plain.name = "plain";
  EXPECT_EQ(*c, plain);
}

TEST(CharacterFile, TakesCarriageReturnsAByteOrderMarkAndNamesOfAnyScript) {
  const auto c = parse_character(
      "\xEF\xBB\xBFname = \"\xEC\x9A\xB0\xEC\xA3\xBC J\xC3\xBCrgen\"\r\n[body]\r\nmass = 1e-1\r\n",
      "x.toml");
  ASSERT_TRUE(c) << c.error();
  EXPECT_EQ(c->name, "\xEC\x9A\xB0\xEC\xA3\xBC J\xC3\xBCrgen");
  EXPECT_EQ(c->body.mass, 0.1);
}

// --- rejected files ------------------------------------------------------------------------------

template <class Fields>
void expect_ranges(const Fields& fields, const std::string& section) {
  for (const auto& f : fields) {
    const auto text = [&](const std::string& value) {
      return "name = \"x\"\n[" + section + "]\n" + f.name + " = " + value + "\n";
    };
    char min[40], max[40], below[40], above[40];
    std::snprintf(min, sizeof min, "%.17e", f.min);
    std::snprintf(max, sizeof max, "%.17e", f.max);
    std::snprintf(below, sizeof below, "%.17e", std::nextafter(f.min, -INFINITY));
    std::snprintf(above, sizeof above, "%.17e", std::nextafter(f.max, INFINITY));
    const bool foot = std::string(f.name).starts_with("foot_reach");
    const std::string shallow = foot ? "foot_depth = 0.012\n" : "";  // corner in range
    EXPECT_EQ(error_of(text(min) + shallow), "") << f.name;
    EXPECT_EQ(error_of(text(max) + shallow), "") << f.name;
    for (const std::string& bad :
         {std::string(below), std::string(above), std::string("nan"), std::string("inf"),
          std::string("-inf"), std::string("1e300"), std::string("true"), std::string("\"0.02\""),
          std::string("[1]"), std::string("{}"), std::string("1979-05-27")}) {
      const std::string error = error_of(text(bad));
      EXPECT_TRUE(error.rfind("mine.toml:3: ", 0) == 0) << f.name << bad << error;
      EXPECT_TRUE(says(error, std::string(f.name) + " must be a number from ")) << error;
    }
  }
}

TEST(CharacterFile, TakesTheEndsOfEachRangeAndRefusesWhatLiesBeyondWithItsLine) {
  expect_ranges(kBodyFields, "body");
  expect_ranges(kVoiceFields, "voice");
}

TEST(CharacterFile, NamesTheLineAndTheNearestNameOfWhatItDoesNotKnow) {
  const struct {
    const char *text, *line, *nearest;
  } kCases[] = {{"name = \"x\"\n[body]\nmas = 0.1", ":3:", "mass"},
                {"name = \"x\"\n\n\n[body]\nfoot_widht = 0.1", ":5:", "foot_width"},
                {"nam = \"x\"", ":1:", "name"},
                {"name = \"x\"\n[look]\nhedgear = \"cap\"", ":3:", "headgear"},
                {"name = \"x\"\n[voice]\npich = 100", ":3:", "pitch"},
                {"name = \"x\"\n[bdoy]\nmass = 0.1", ":2:", "body"}};
  for (const auto& c : kCases) {
    const std::string error = error_of(c.text);
    EXPECT_TRUE(says(error, std::string("mine.toml") + c.line)) << error;
    EXPECT_TRUE(says(error, std::string("the nearest name is ") + c.nearest)) << error;
  }
}

TEST(CharacterFile, RefusesANameThatDoesNotLookAsItIsWritten) {
  const struct {
    const char *name, *shown;
  } kCases[] = {{"   ", "unnamed"},
                {" keeper", "keeper"},
                {"the  wall", "the wall"},
                {"\u202Eevil", "evil"},
                {"aver\u200Bage", "average"}};
  for (const auto& c : kCases) {
    const std::string error = error_of(std::string("name = \"") + c.name + "\"\n");
    EXPECT_TRUE(says(error, "mine.toml:1: name must have a letter")) << error;
    EXPECT_TRUE(says(error, std::string("write name = \"") + c.shown + "\"")) << error;
  }
  EXPECT_EQ(error_of("name = \"\uD55C\uAD6D \uC120\uC218 \u26BD\"\n"), "");
  EXPECT_EQ(error_of("name = \"average\"\r\n"), "");
}

TEST(CharacterFile, RefusesTextsColoursAndChoicesThatAreNone) {
  const std::string name = "name = \"x\"\n";
  for (const char* bad : {"name = 7", "name = \"\"", "name = \"a\\nb\"", "name = \"\\u0085\"",
                          "name = \"123456789012345678901234567890123\"", "name = [\"x\"]"}) {
    EXPECT_TRUE(says(error_of(bad), "mine.toml:1: name must be a text of 1 to 32 bytes"))
        << error_of(bad);
  }
  for (const char* bad : {"\"red\"", "\"#12345\"", "\"#1234567\"", "\"#12345g\"", "0xffffff"}) {
    const std::string error = error_of(name + "[look]\nskin = " + bad);
    EXPECT_TRUE(says(error, "mine.toml:3: skin must be a colour from \"#000000\"")) << error;
  }
  const std::string error = error_of(name + "[look]\nface = \"grin\"");
  EXPECT_TRUE(says(error, "mine.toml:3: face must be one of visor, eyes, goggles, beard")) << error;
  EXPECT_TRUE(says(error_of(name + "body = 3"), "mine.toml:2: body must be a section"));
}

TEST(CharacterFile, RefusesGarbageWithALine) {
  for (const std::string& bad :
       {std::string("]["), std::string("name"), std::string("\x01\x02"), std::string("name = \"x"),
        std::string("[["), std::string("name = \"\xFF\""),
        std::string("name = \"x\"\nname = \"y\""), std::string("a = 99999999999999999999999"),
        std::string(1, '\0'), std::string(3000, '['), "a = " + std::string(3000, '[')}) {
    const std::string error = error_of(bad);
    EXPECT_EQ(error.rfind("mine.toml:", 0), 0u) << error;
    EXPECT_TRUE(says(error, ";")) << error;
    EXPECT_LT(error.size(), 400u);
  }
  EXPECT_TRUE(says(error_of(""), "mine.toml:1: the character has no name")) << error_of("");
}

TEST(CharacterFile, RefusesAFootThatWouldMeetTheNextRodsMen) {
  const std::string error =
      error_of("name = \"x\"\n[body]\nfoot_depth = 0.030\nfoot_reach = 0.0745\n");
  EXPECT_TRUE(says(error, "mine.toml:4: the foot's corner is more than 0.0749 m")) << error;
}

TEST_F(CharacterFolder, RefusesFilesThatAreNone) {
  EXPECT_TRUE(says(load_character("/nowhere/x.toml").error(), "check its name"));
  EXPECT_TRUE(says(load_character("/").error(), "give a file of a character"));
  EXPECT_TRUE(says(load_character("/dev/zero").error(), "give a file of a character"));
  const std::string fifo = folder + "/fifo.toml";
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  EXPECT_TRUE(says(load_character(fifo).error(), "give a file of a character"));
  EXPECT_TRUE(says(load_characters(folder).error(), "give a file of a character")) << "nor in one";
  const std::string large = write("large.toml", std::string(10 << 20, '#'));
  EXPECT_TRUE(says(load_character(large).error(), "larger than 65536 bytes"));
}

// --- folders -------------------------------------------------------------------------------------

TEST_F(CharacterFolder, IsReadInTheOrderOfItsFilesAndHoldsOneToTheMost) {
  EXPECT_TRUE(says(load_characters(folder).error(), "at least one character"));
  EXPECT_TRUE(says(load_characters(folder + "/none").error(), "give a folder"));
  for (int i = 0; i < kMaxCharacters; ++i) {
    const char letter = static_cast<char>('z' - i);
    write(std::string(1, letter) + ".toml", std::string("name = \"") + letter + "\"");
    const auto list = load_characters(folder);
    ASSERT_TRUE(list) << list.error();
    EXPECT_EQ(list->size(), static_cast<std::size_t>(i + 1));
    EXPECT_EQ(list->front().name[0], letter);
  }
  write("notes.txt", "not a character");
  EXPECT_TRUE(load_characters(folder));
  write("a.toml", "name = \"a\"");
  EXPECT_TRUE(says(load_characters(folder).error(), "more than 12 files")) << "one too many";
}

TEST_F(CharacterFolder, RefusesOneNameTwiceAndNamesBothFiles) {
  write("1.toml", "name = \"twin\"");
  write("2.toml", "name = \"twin\"");
  const auto result = load_characters(folder);
  ASSERT_FALSE(result);
  EXPECT_TRUE(says(result.error(), "2.toml") && says(result.error(), "1.toml")) << result.error();
}

TEST_F(CharacterFolder, OfAPlayerAddsToTheGamesOwnAndReplacesThoseOfTheSameName) {
  const auto& base = foosball::built_in_characters();
  EXPECT_EQ(load_more_characters(base, folder + "/none").value(), base);
  write("1.toml", "name = \"" + base[2].name + "\"\n[body]\nmass = 0.2");
  write("2.toml", "name = \"mine\"");
  const auto list = load_more_characters(base, folder);
  ASSERT_TRUE(list) << list.error();
  ASSERT_EQ(list->size(), base.size() + 1);
  EXPECT_EQ((*list)[2].body.mass, 0.2);
  EXPECT_EQ(list->back().name, "mine");
  for (int i = 0; i < kMaxCharacters; ++i) {
    write("m" + std::to_string(i) + ".toml", "name = \"m" + std::to_string(i) + "\"");
  }
  EXPECT_FALSE(load_more_characters(base, folder));
}

}  // namespace
}  // namespace characters
