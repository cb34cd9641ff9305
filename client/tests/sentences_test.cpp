// Sentences that others say in English, in the person's language.
#include "render/sentences.h"

#include <gtest/gtest.h>

#include "render/translate.h"

namespace client {
namespace {

struct Language {
  explicit Language(const char* code) { use_language(code, CLIENT_CATALOGUES); }
  ~Language() { use_language("en", CLIENT_CATALOGUES); }
};

TEST(Sentences, KeepTheWordsOfOthersInATranslation) {
  const Language german("de");
  EXPECT_EQ(tr_sentence("Ann was lost: rods 1 and 2 are kept for 30 s"),
            "Ann ist weg: Stangen 1, 2 bleiben 30 s lang reserviert");
  EXPECT_EQ(tr_sentence("no snapshot for 5000 ms"), "seit 5000 ms kein Bild vom Server");
  EXPECT_EQ(tr_sentence("watchers have no vote"), "Zuschauer haben keine Stimme");
  EXPECT_EQ(tr_sentence("/tmp/a.sfr is no recorded match (bad header): choose a file that --record "
                        "wrote"),
            "/tmp/a.sfr ist keine Aufzeichnung (bad header): wähle eine Datei, die --record "
            "geschrieben hat");
}

TEST(Sentences, MayHaveTheirWordsInAnotherOrder) {
  const Language korean("ko");
  EXPECT_EQ(tr_sentence("the computer plays rods 3 for Ann"),
            "컴퓨터가 Ann 님 대신 3번 봉을 맡습니다");
}

TEST(Sentences, ThatAreNotKnownStayAsTheyAreWhateverIsInThem) {
  const Language german("de");
  for (const char* text :
       {"", "%1", "%", "%9 was lost", "no snapshot for ", "no snapshot for 5 msec",
        " was lost: rods", "the computer plays rods ", "watchers have no vote, they say"})
    EXPECT_EQ(tr_sentence(text), text);
  EXPECT_EQ(tr_sentence("%3%1 was lost: rods %2 are kept for 30 s"),
            "%3%1 ist weg: Stangen %2 bleiben 30 s lang reserviert")
      << "a name is no form";
}

TEST(Sentences, AreEnglishInEnglish) {
  const Language english("en");
  const std::string said = "Ann would put Bob out of the match: 1 of 2 votes";
  EXPECT_EQ(tr_sentence(said), said);
}

}  // namespace
}  // namespace client
