// Results in the file, and files that cannot be used.
#include "results_log.h"

#include <gtest/gtest.h>
#include <sqlite3.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>

#include "foosball/computer_player.h"
#include "match_scribe.h"
#include "results/store.h"

namespace server {
namespace {

using namespace std::chrono_literals;

std::string temp_path() {
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  return testing::TempDir() + "sf_results_log_" + test->name() + "_" + std::to_string(::getpid());
}
void remove(const std::string& path) {
  for (const char* more : {"", "-wal", "-shm"}) std::remove((path + more).c_str());
}
results::MatchResult won(int minute = 0) {
  results::MatchResult result;
  result.finished_at = "2026-11-22T20:" + std::to_string(10 + minute) + ":00Z";
  result.layout = "tournament";
  result.teams[0] = {{{"Ann", "person"}}, 5, std::nullopt};
  result.teams[1] = {{{"computer", "computer"}}, 3, std::nullopt};
  return result;
}
std::size_t kept_in(const std::string& path) {
  const auto store = results::Store::open(path, results::Access::read_only);
  EXPECT_TRUE(store) << store.error();
  return store ? store->matches({}).value().size() : 0;
}

TEST(ResultsLog, KeepsAllThatWasAddedBeforeItIsClosed) {
  const std::string path = temp_path();
  ResultsLog log({.path = path});
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(log.add(won(i)));
  log.close();
  EXPECT_EQ(log.problem(), "");
  EXPECT_EQ(log.kept(), 20u);
  EXPECT_EQ(kept_in(path), 20u);
  remove(path);
}

TEST(ResultsLog, TellsOnceThatTheFileIsDamagedAndTakesItWhenItIsMendedWithWhatWaited) {
  const std::string path = temp_path();
  std::ofstream(path) << std::string(5000, 'x');
  ResultsLog log({.path = path, .retry_period = 1ms});
  const auto until = std::chrono::steady_clock::now() + 20s;
  wire::Sentence reported;
  while (!log.problem_changed(reported) && std::chrono::steady_clock::now() < until) {
  }
  EXPECT_EQ(reported, wire::make_sentence<wire::SentenceId::results_not_kept>(
                          wire::make_sentence<wire::SentenceId::results_problem>(
                              path, wire::make_sentence<wire::SentenceId::results_no_database>())))
      << reported.text() << ": clients know the store's sentence";
  EXPECT_FALSE(log.problem_changed(reported));
  log.add(won());
  remove(path);
  while (log.kept() == 0 && std::chrono::steady_clock::now() < until) {
  }
  log.close();
  EXPECT_EQ(log.kept(), 1u);
  EXPECT_EQ(log.problem(), "");
  remove(path);
}

TEST(ResultsLog, EndsInTimeThoughTheFileIsLockedAndSaysSo) {
  const std::string path = temp_path();
  { ASSERT_TRUE(results::Store::open(path, results::Access::create)); }
  sqlite3* other = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &other), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(other, "BEGIN EXCLUSIVE", nullptr, nullptr, nullptr), SQLITE_OK);
  const auto before = std::chrono::steady_clock::now();
  {
    ResultsLog log({.path = path, .close_patience = 50ms});
    log.add(won());
    log.close();
    EXPECT_LT(std::chrono::steady_clock::now() - before, 2s);
    EXPECT_NE(log.problem().find(path), std::string::npos) << log.problem();
  }
  sqlite3_close(other);
  remove(path);
}

TEST(ResultsLog, CountsWhatItHasNoRoomFor) {
  ResultsLog log({.path = "/nowhere/at/all", .retry_period = 1h});
  bool taken = true;
  for (std::size_t i = 0; i < 3 * ResultsLog::kWaiting && taken; ++i) taken = log.add(won());
  EXPECT_FALSE(taken);
  log.close();
  EXPECT_NE(log.problem().find("lost"), std::string::npos) << log.problem();
}

results::Answers answers_of(std::uint32_t rods) {
  return {.team = 0, .rods = rods, .scores = {5, 4, 3, 2, 1, 0}};
}

// Results that wait for the file keep their order, so that answers find their match.
TEST(ResultsLog, KeepsAnswersWithTheirMatchThoughTheFileComesLate) {
  const std::string path = temp_path();
  std::ofstream(path) << std::string(5000, 'x');
  ResultsLog log({.path = path, .retry_period = 1ms});
  for (std::uint32_t match = 1; match <= 3; ++match) log.add(won(static_cast<int>(match)), match);
  log.answer(answers_of(0x0F), 3);
  log.answer(answers_of(0x01), 2);
  remove(path);
  log.close();
  EXPECT_EQ(log.problem(), "");
  EXPECT_EQ(log.answers(), 2u);
  const auto kept = results::Store::open(path, results::Access::read_only)->answers().value();
  ASSERT_EQ(kept.size(), 2u);
  EXPECT_EQ(kept[0].match, 3);
  EXPECT_EQ(kept[1].match, 2);
  remove(path);
}

// The store would reject these; they are not retried, and later answers are stored.
TEST(ResultsLog, LosesWhatIsNoAnswerAndGoesOn) {
  const std::string path = temp_path();
  ResultsLog log({.path = path});
  log.add(won(), 1);
  log.answer(answers_of(0x01), 7);  // of no match
  log.answer(answers_of(0x00), 1);  // without rods
  log.answer(answers_of(0x03), 1);
  log.answer(answers_of(0x02), 1);  // again
  results::MatchResult bad = won();
  bad.finished_at = "yesterday";
  log.add(bad, 2);
  log.add(won(1), 3);
  log.close();
  EXPECT_EQ(log.kept(), 2u);
  EXPECT_EQ(log.answers(), 1u);
  EXPECT_NE(log.problem().find("4 results are lost"), std::string::npos) << log.problem();
  remove(path);
}

// The report's ratings equal those of the standings, before and after the match.
TEST(ResultsLog, ReportsTheLastMatchAndWhoPlaysBest) {
  const std::string path = temp_path();
  {
    ResultsLog log({.path = path});
    for (int i = 0; i < 3; ++i) log.add(won(i), static_cast<std::uint32_t>(i + 1));
    log.close();
    ResultsLog::Report report;
    ASSERT_TRUE(log.report_changed(report));
    EXPECT_FALSE(log.report_changed(report)) << "once";
    EXPECT_EQ(report.number, 3u);
    EXPECT_EQ(report.match.finished_at, "2026-11-22T20:12:00Z");
    ASSERT_EQ(report.fame.size(), 2u);
    EXPECT_EQ(report.fame[0].name, "Ann");
    EXPECT_EQ(report.fame[0].matches, 3u);
    EXPECT_DOUBLE_EQ(report.rating[0], report.fame[0].rating);
    EXPECT_DOUBLE_EQ(report.rating[0] + report.rating[1], 2.0 * results::kFirstRating);
    EXPECT_GT(report.change[0], 0.0);
    EXPECT_DOUBLE_EQ(report.change[0], -report.change[1]);
  }
  ResultsLog log({.path = path});
  log.close();
  ResultsLog::Report report;
  ASSERT_TRUE(log.report_changed(report)) << "of the runs before";
  EXPECT_EQ(report.number, 0u);
  EXPECT_EQ(report.fame.size(), 2u);
  remove(path);
}

// The statistics of the last match are a difference of totals over several matches.
TEST(MatchScribe, GivesTheStatisticsOfOneMatch) {
  foosball::Statistics before, now;
  before.shots = {3, 4};
  before.shot_speed.add(12.0);
  now = before;
  now.shots = {5, 4};
  now.possession_ticks = {1500, 0};
  now.own_goals_swing = {1, 0};
  now.own_goals_deflected = {1, 1};
  EXPECT_EQ(shot_speeds(before, now), std::nullopt);
  for (const double speed : {5.0, 6.0, 9.0}) now.shot_speed.add(speed);
  const auto teams = statistics_of_teams(before, now);
  EXPECT_EQ(teams[0].shots, 2u);
  EXPECT_EQ(teams[1].shots, 0u);
  EXPECT_DOUBLE_EQ(teams[0].possession_seconds, 1.5);
  EXPECT_EQ(teams[0].own_goals, 2u);
  const auto speeds = shot_speeds(before, now);
  ASSERT_TRUE(speeds);
  EXPECT_NEAR(speeds->median, 6.0, 0.11);
  EXPECT_NEAR(speeds->fastest, 9.0, 0.11);
}

// Two computers play a match to its end.
results::MatchResult played_to_the_end(foosball::Match& match, MatchScribe& scribe, int& begun) {
  std::array<foosball::ComputerPlayer, 2> players{
      foosball::ComputerPlayer({.team = 0, .seed = 1, .player = *foosball::parse_player("2")}),
      foosball::ComputerPlayer({.team = 1, .seed = 2, .player = *foosball::parse_player("2")})};
  foosball::TickInput input;
  const foosball::Command push{foosball::Command::Kind::push, 0};
  for (int tick = 0; tick < 240'000; ++tick) {
    for (auto& player : players) player.play(match.view(), input.rods);
    const bool waits = match.view().screen == foosball::Screen::logo ||
                       match.view().screen == foosball::Screen::end;
    input.commands = std::span(&push, waits && tick % 600 == 599 ? 1 : 0);
    match.step(input);
    const bool over = scribe.observe(match, input.rods);
    begun += scribe.begins() ? 1 : 0;
    if (over) return scribe.result(match.view(), {});
  }
  ADD_FAILURE() << "the match does not end";
  return {};
}

// Regression test: from the second attempt on, a challenge's result included all earlier
// attempts.
TEST(MatchScribe, BeginsAnewWithEveryChallenge) {
  foosball::MatchDesc desc = foosball::challenge_of(20261122);
  desc.rules.match_seconds = 10.0;
  desc.rules.end_seconds = 1.0;
  foosball::Match match = *foosball::Match::create(desc);
  MatchScribe scribe(desc);
  for (int attempt = 1; attempt <= 3; ++attempt) {
    int begun = 0;
    const results::MatchResult result = played_to_the_end(match, scribe, begun);
    EXPECT_EQ(begun, 1) << attempt;
    double possession = 0.0;
    for (const results::Team& team : result.teams) {
      possession += team.statistics->possession_seconds;
      EXPECT_EQ(team.statistics->shots > 0, *team.statistics->fastest_shot > 0.0);
    }
    EXPECT_GT(possession, 5.0) << attempt;
    EXPECT_LE(possession, 10.001) << attempt << ": no more than the match lasts";
  }
}

// The last set alone would be 1:0 or 0:1.
TEST(MatchScribe, CountsTheSetsOfAMatchOfSeveral) {
  foosball::MatchDesc desc;
  desc.rules.goals_to_win = desc.rules.max_goals = 1;
  desc.rules.sets_to_win = 2;
  desc.rules.ceremony_seconds = 1.0;
  foosball::Match match = *foosball::Match::create(desc);
  MatchScribe scribe(desc);
  int begun = 0;
  const results::MatchResult result = played_to_the_end(match, scribe, begun);
  EXPECT_EQ(result.goals_to_win, 2u);
  ASSERT_TRUE(result.winner());
  const auto winner = static_cast<std::size_t>(*result.winner());
  EXPECT_EQ(result.teams[winner].goals, 2u);
  EXPECT_LE(result.teams[1 - winner].goals, 1u);
}

}  // namespace
}  // namespace server
