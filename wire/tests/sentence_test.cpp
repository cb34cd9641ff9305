// The forms of the server's sentences.
#include "wire/sentence.h"

#include <gtest/gtest.h>

#include <set>

#include "wire/control.h"

namespace wire::test {
namespace {

TEST(Sentence, HasItsWordsInTheirPlaces) {
  EXPECT_EQ(make_sentence<SentenceId::player_lost>("Ann", "1 and 2", 30).text(),
            "Ann was lost: rods 1 and 2 are reserved for 30 s");
  EXPECT_EQ(make_sentence<SentenceId::player_lost>("%2", std::string("%1"), std::uint8_t{3}).text(),
            "%2 was lost: rods %1 are reserved for 3 s")
      << "a stranger's words are no form";
  EXPECT_EQ(
      make_sentence<SentenceId::computer_plays>(make_sentence<SentenceId::rods_for>("3", "Bob"))
          .text(),
      "the computer plays rods 3 for Bob");
}

// A client identifies the values by their order; a truncated form would lose some.
TEST(Sentence, FormsHaveTheirPlacesInOrderAreDifferentAndFitIntoAText) {
  std::set<std::string_view> all;
  for (const std::string_view form : kSentences) {
    EXPECT_TRUE(all.insert(form).second) << form;
    EXPECT_LT(form.size(), kMaxText / 4 * 3) << form;
    char next = '1';
    for (std::size_t i = 0; i < form.size(); ++i) {
      if (form[i] != '%') continue;
      ASSERT_LT(i + 1, form.size()) << form;
      EXPECT_EQ(form[i + 1], next++) << form;
    }
    EXPECT_EQ(form.find("%1%"), std::string_view::npos) << form;
  }
}

}  // namespace
}  // namespace wire::test
