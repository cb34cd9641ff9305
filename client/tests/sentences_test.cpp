// English sentences of other programs, in the person's language.
#include "render/sentences.h"

#include <gtest/gtest.h>

#include "render/translate.h"
#include "wire/sentence.h"

namespace client {
namespace {

struct Language {
  explicit Language(const char* code) { use_language(code, CLIENT_CATALOGUES); }
  ~Language() { use_language("en", CLIENT_CATALOGUES); }
};

TEST(Sentences, KeepTheWordsOfOthersInATranslation) {
  const Language german("de");
  EXPECT_EQ(tr_sentence("Ann was lost: rods 1 and 2 are reserved for 30 s"),
            "Ann ist weg: Stangen 1, 2 bleiben 30 s lang reserviert");
  EXPECT_EQ(tr_sentence("no snapshot for 5000 ms"), "seit 5000 ms kein Bild vom Server");
  EXPECT_EQ(tr_sentence("watchers have no vote"), "Zuschauer haben keine Stimme");
  EXPECT_EQ(
      tr_sentence(
          "/tmp/a.sfr is not a recorded match (bad header): choose a file that --record wrote"),
      "/tmp/a.sfr ist keine Aufzeichnung (bad header): wähle eine Datei, die --record "
      "geschrieben hat");
}

TEST(Sentences, CallComputerPlayersInThePersonsLanguageAndPeopleAsTheyAre) {
  {
    const Language german("de");
    EXPECT_EQ(tr_player("computer 4:gambler"), "Computer 4, Zocker");
    EXPECT_EQ(tr_player("nobody"), "niemand");
    for (const char* person : {"Annemarie", "computers", "computer 2:person", "wall", ""})
      EXPECT_EQ(tr_player(person), person);
  }
  const Language korean("ko");
  EXPECT_EQ(tr_player("computer 4:gambler"), "컴퓨터 4, 승부사");
  EXPECT_EQ(tr_player("computer 2"), "컴퓨터 2");
}

TEST(Sentences, MayHaveTheirWordsInAnotherOrder) {
  const Language korean("ko");
  EXPECT_EQ(tr_sentence("the computer plays rods 3 for Ann"),
            "컴퓨터가 대신 맡습니다: Ann 님의 3번 봉");
}

TEST(Sentences, ThatAreNotKnownStayAsTheyAreWhateverIsInThem) {
  const Language german("de");
  for (const char* text :
       {"", "%1", "%", "%9 was lost", "no snapshot for ", "no snapshot for 5 msec",
        " was lost: rods", "the computer plays", "watchers have no vote, they say"})
    EXPECT_EQ(tr_sentence(text), text);
  EXPECT_EQ(tr_sentence("%3%1 was lost: rods %2 are reserved for 30 s"),
            "%3%1 ist weg: Stangen %2 bleiben 30 s lang reserviert")
      << "a name is no form";
}

// The server produces no other sentences: a Sentence is made from these patterns.
TEST(Sentences, OfTheServerAreAllKnownInEachLanguage) {
  for (const char* code : {"de", "ko"}) {
    const Language language(code);
    for (const std::string_view form : wire::kSentences) {
      std::string said(form);
      for (char place = '1'; place <= '9'; ++place) {
        const std::size_t at = said.find(std::string("%") + place);
        if (at != std::string::npos) said.replace(at, 2, std::string("<") + place + ">");
      }
      const std::string shown = tr_sentence(said);
      EXPECT_NE(shown, said) << code;
      for (char place = '1'; place <= '0' + wire::count_placeholders(form); ++place)
        EXPECT_NE(shown.find(std::string("<") + place + ">"), std::string::npos) << shown;
      EXPECT_EQ(shown.find('%'), std::string::npos) << shown;
    }
  }
}

TEST(Sentences, WithinASentenceAreTranslatedToo) {
  using wire::SentenceId, wire::make_sentence;
  const Language german("de");
  const std::string rods =
      make_sentence<SentenceId::rods_for>("1 and 2", "Ann").text() + "; " +
      make_sentence<SentenceId::rods_for>("3", make_sentence<SentenceId::a_player>()).text();
  EXPECT_EQ(tr_sentence(make_sentence<SentenceId::computer_plays>(rods).text()),
            "der Computer spielt: Stangen 1, 2 für Ann; Stangen 3 für jemanden");
  EXPECT_EQ(tr_sentence(make_sentence<SentenceId::rods_offered>(10, rods).text()),
            "10 s lang frei für die Mannschaft, dann spielt der Computer: Stangen 1, 2 für Ann; "
            "Stangen 3 für jemanden");
  EXPECT_EQ(tr_sentence(make_sentence<SentenceId::results_not_kept>(
                            make_sentence<SentenceId::results_problem>(
                                "/tmp/a.sqlite", make_sentence<SentenceId::results_locked>()))
                            .text()),
            "Ergebnisse in /tmp/a.sqlite: ein anderes Programm hält sie gesperrt; beende es und "
            "versuche es noch einmal; das Spiel geht weiter");
  EXPECT_EQ(tr_sentence(make_sentence<SentenceId::not_rated>("Ann (62%), Bob; (9%)").text()),
            "das Spiel zählt nicht für die Wertung derer, die zu wenig davon gespielt haben: "
            "Ann (62%), Bob; (9%)");
}

TEST(Sentences, OfARecordingAreNotTakenForTheShorterOnesTheyBeginLike) {
  const Language german("de");
  EXPECT_EQ(tr_sentence(wire::make_sentence<wire::SentenceId::disk_too_slow>("a.sfr").text()),
            "die Aufzeichnung in a.sfr endete vorzeitig: die Platte ist zu langsam; das Spiel geht "
            "weiter");
}

TEST(Sentences, AreEnglishInEnglish) {
  const Language english("en");
  const std::string said = "Ann wants to remove Bob from the match: 1 of 2 votes";
  EXPECT_EQ(tr_sentence(said), said);
}

}  // namespace
}  // namespace client
