// The questionnaire over the control port: who is asked, and which answers are stored with what.
#include <cstdio>

#include "control_fixture.h"
#include "results/store.h"
#include "seats.h"
#include "wire/enums.h"

namespace server {
namespace {

constexpr std::array<std::uint8_t, 6> kScores{5, 4, 0, 1, 3, 2};

class QuestionnaireTest : public testing::Test {
 protected:
  QuestionnaireTest() { forget(); }
  ~QuestionnaireTest() override { forget(); }
  void forget() {
    for (const char* more : {"", "-wal", "-shm"}) std::remove((path_ + more).c_str());
  }
  // A match lasts a tenth of a second, and ends in a draw.
  std::function<void(ServerOptions&)> short_match() {
    return [this](ServerOptions& o) {
      o.computer = {false, true};
      o.match.rules.match_seconds = 0.1;
      o.match.rules.golden_goal = false;
      o.match.rules.end_seconds = 0.1;
      o.results = path_;
      o.date = [] { return std::string("2026-11-22T20:00:00Z"); };
    };
  }
  // Sends inputs in each tick, without which a match waits.
  static bool play_to_the_end(Lockstep& table, ProbeClient& player, const wire::Welcome& seat) {
    const auto played_until = [&](const std::function<bool()>& condition) {
      return table.tick_until([&] {
        wire::InputDatagram input{.session = seat.session, .token = seat.token};
        input.sequence = static_cast<std::uint32_t>(table->ticks() + 1);
        for (wire::InputRod& rod : input.rods) rod = {true, 0.0f, 0.0, 0.0f, 0.0f};
        player.send_input(input);
        return condition();
      });
    };
    for (int i = 0; i < 2; ++i) {
      const auto before = table->counters().control.requests;
      player.send(wire::MatchRequest{number(wire::RequestKind::push), 0, 0});
      if (!played_until([&] { return table->counters().control.requests > before; })) return false;
      table.tick(3);
    }
    return played_until([&] { return table->match().view().screen == foosball::Screen::end; });
  }
  std::vector<results::Answers> kept() {
    const auto store = results::Store::open(path_, results::Access::read_only);
    EXPECT_TRUE(store) << store.error();
    return store ? store->answers().value() : std::vector<results::Answers>{};
  }
  const std::string path_ = temp_path("results.sqlite");
};

TEST_F(QuestionnaireTest, WhoHasPlayedIsAskedAndTheAnswersAreKeptWithTheMatch) {
  {
    Lockstep table(short_match());
    ProbeClient player(table.port()), watcher(table.port());
    const auto seat = player.join(0);
    ASSERT_TRUE(seat);
    ASSERT_TRUE(watcher.join());
    for (std::uint32_t match = 1; match <= 2; ++match) {
      ASSERT_TRUE(play_to_the_end(table, player, *seat));
      const auto asked = player.receive_a<wire::Questionnaire>();
      ASSERT_TRUE(asked);
      EXPECT_EQ(asked->match, match);
      EXPECT_EQ(asked->rods, rods_of_team(foosball::Layout::tournament, 0));
      if (match == 2) player.send(wire::Answers{match, asked->rods, kScores});
      ASSERT_TRUE(
          table.tick_until([&] { return table->match().view().screen == foosball::Screen::logo; }));
    }
    ASSERT_TRUE(table.tick_until([&] { return table->counters().answers_kept == 1; }));
    EXPECT_FALSE(watcher.receive_a<wire::Questionnaire>(50)) << "a watcher has not played";
    for (ProbeClient* client : {&player, &watcher}) {
      const auto& report = client->report();
      ASSERT_TRUE(table.tick_until([&] { return client->receive(1), report.has_value(); }))
          << "all see the result";
      EXPECT_LE(report->match, 2u);
      EXPECT_EQ(report->fame.size(), 2u);
    }
  }
  const auto answers = kept();
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_EQ(answers[0].match, 2);
  EXPECT_EQ(answers[0].team, 0);
  EXPECT_EQ(answers[0].scores, (std::array<int, 6>{5, 4, 0, 1, 3, 2}));
}

TEST_F(QuestionnaireTest, ForgedAndRepeatedAnswersAreRefusedAndSaidSo) {
  const auto rods = rods_of_team(foosball::Layout::tournament, 0);
  const RodSet one = RodSet(rods & -rods), rest = RodSet(rods & ~one);
  const auto other = rods_of_team(foosball::Layout::tournament, 1);
  {
    Lockstep table(short_match());
    ProbeClient player(table.port()), watcher(table.port());
    const auto seat = player.join(0);
    ASSERT_TRUE(seat);
    ASSERT_TRUE(watcher.join());
    player.send(wire::Answers{1, rods, kScores});
    EXPECT_NE(notice_of(player).find("not the one"), std::string::npos) << "before any match";
    ASSERT_TRUE(play_to_the_end(table, player, *seat));
    ASSERT_TRUE(player.receive_a<wire::Questionnaire>());
    const auto refused = [&](ProbeClient& client, const wire::Answers& answers) {
      client.send(answers);
      const auto notice = client.receive_a<wire::Notice>();
      return notice && notice->topic == wire::kAnswersTopic;
    };
    EXPECT_TRUE(refused(watcher, {1, rods, kScores})) << "of others' rods";
    EXPECT_TRUE(refused(player, {2, rods, kScores})) << "of a match to come";
    EXPECT_TRUE(refused(player, {0, rods, kScores}));
    EXPECT_TRUE(refused(player, {1, other, kScores})) << "of the computer's rods";
    EXPECT_TRUE(refused(player, {1, RodSet(rods | other), kScores}));
    EXPECT_TRUE(refused(player, {1, rods, {}})) << "nothing was answered";
    player.send(wire::Answers{1, one, kScores});
    player.send(wire::Answers{1, rest, kScores});  // two people at one client
    EXPECT_TRUE(refused(player, {1, one, kScores})) << "twice";
    EXPECT_TRUE(refused(player, {1, rods, kScores})) << "twice";
    ASSERT_TRUE(table.tick_until([&] { return table->counters().answers_kept == 2; }));
    EXPECT_EQ(table->counters().control.answers_refused, 9u);
  }
  EXPECT_EQ(kept().size(), 2u);
}

TEST_F(QuestionnaireTest, AnswersThatAreNoneEndTheConnection) {
  Lockstep table(short_match());
  ProbeClient player(table.port());
  const auto seat = player.join(0);
  ASSERT_TRUE(seat);
  ASSERT_TRUE(play_to_the_end(table, player, *seat));
  const auto asked = player.receive_a<wire::Questionnaire>();
  ASSERT_TRUE(asked);
  wire::Answers forged{asked->match, asked->rods, kScores};
  forged.scores[3] = wire::kMaxScore + 1;
  player.send(forged);
  const auto refusal = player.receive_a<wire::Refusal>();
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->code, Code::bad_message);
  EXPECT_TRUE(player.sees_close());
  EXPECT_EQ(table->counters().control.answers, 0u);
}

TEST_F(QuestionnaireTest, NobodyIsAskedWithoutAFileOrWhereItIsTurnedOff) {
  for (const bool file : {false, true}) {
    Lockstep table([&](ServerOptions& o) {
      short_match()(o);
      if (!file) o.results.clear();
      o.questionnaire = !file;
    });
    ProbeClient player(table.port());
    const auto seat = player.join(0);
    ASSERT_TRUE(seat);
    ASSERT_TRUE(play_to_the_end(table, player, *seat));
    table.tick(5);
    EXPECT_FALSE(player.receive_a<wire::Questionnaire>(50)) << file;
  }
}

// Regression test: four people at one window shared one name, and so one rating.
TEST_F(QuestionnaireTest, TheResultNamesAllPeopleAtOneWindow) {
  {
    Lockstep table(short_match());
    ProbeClient window(table.port());
    const auto seat = window.join(0);
    ASSERT_TRUE(seat);
    wire::Names names{"Ann", {}};
    names.players[static_cast<std::size_t>(
        foosball::rods_of_team(foosball::table_spec(foosball::MatchDesc{}.layout), 0)[3])] = "Ben";
    window.send(names);
    ASSERT_TRUE(window.catch_up());
    ASSERT_TRUE(play_to_the_end(table, window, *seat));
    table->finish(wire::Sentence::untranslated("done"));
    ASSERT_EQ(table->counters().results_kept, 1u);
  }
  const auto matches = results::Store::open(path_, results::Access::read_only)->matches({}).value();
  ASSERT_EQ(matches.size(), 1u);
  const auto& players = matches[0].teams[0].players;
  ASSERT_EQ(players.size(), 2u);
  EXPECT_EQ(players[0], (results::Player{"Ann", "person", 1.0, false}));
  EXPECT_EQ(players[1], (results::Player{"Ben", "person", 1.0, false}));
}

// Demonstration matches are not stored, even if a client has rods.
TEST_F(QuestionnaireTest, AMatchThatIsShownIsNotKeptAndNobodyIsAsked) {
  Lockstep table([&](ServerOptions& o) {
    short_match()(o);
    o.match.rules.attract_seconds = 0.1;
  });
  ProbeClient player(table.port());
  ASSERT_TRUE(player.join(0));
  ASSERT_TRUE(table.tick_until([&] {
    return table->match().view().attract && table->match().view().screen == foosball::Screen::end;
  }));
  table.tick(5);
  EXPECT_FALSE(player.receive_a<wire::Questionnaire>(50));
  table->finish(wire::Sentence::untranslated("done"));
  EXPECT_EQ(table->counters().results_kept, 0u);
}

}  // namespace
}  // namespace server
