// The matches of --report and --stuck-balls, and the evaluation of their results.
#include "match/report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace match {
namespace {

TEST(Report, CallsNoShareOfFewMatchesExact) {
  ReportPlan plan{.matches = 4};
  std::vector<Series> series;
  for (const SeriesDesc& desc : report_series(plan)) {
    series.emplace_back(desc);
    GameResult won;  // by the first player, in both games of the pair
    won.statistics.wins[1] = 2;
    for (const int team : {0, 1}) {
      won.winner = team;
      series.back().take(won);
    }
  }
  int shares = 0;
  for (const Figure& figure : report_figures(plan, series)) {
    if (figure.unit != "% points" && figure.name != "team 1 wins") continue;
    EXPECT_EQ(figure.value, 100.0) << figure.name;
    EXPECT_GT(figure.error, 5.0) << figure.section << figure.name;
    EXPECT_LT(figure.error, 50.0) << figure.section << figure.name;
    ++shares;
  }
  EXPECT_EQ(shares, 2 + 2 + 6) << "both layouts, spinner, one rod, each character";
}

TEST(Report, PlaysOnlySeriesThatCanBeAndTellSomething) {
  for (const char* home : {"1", "5:wall@shot_bar=0.4", "classic", "idle", "spinner", "one-rod",
                           "one-rod:2", "one-rod:idle", "one-rod:spinner"}) {
    for (const char* away : {"2", "idle", "spinner", "one-rod:3"}) {
      const ReportPlan plan{.home = home, .away = away, .matches = 2};
      const auto series = report_series(plan);
      std::vector<Series> unplayed;
      std::set<std::string> texts;
      for (const SeriesDesc& desc : series) {
        for (const std::string& name : desc.players)
          EXPECT_TRUE(make_player({name, 0, 1}).has_value())
              << home << ", " << away << ": " << name;
        EXPECT_TRUE(texts.insert(desc.text()).second) << "twice: " << desc.text();
        unplayed.emplace_back(desc);
      }
      EXPECT_FALSE(report_figures(plan, unplayed).empty()) << home << ", " << away;
    }
  }
}

std::vector<Figure> server_scores_next(std::uint64_t servers, std::uint64_t receivers) {
  foosball::Statistics s;
  s.goals_of_server[0] = servers;
  s.goals_of_receiver[0] = receivers;
  auto figures = figures_of("", s);
  std::erase_if(figures, [](const Figure& f) { return f.name != "the server scores next"; });
  return figures;
}

// 48 to 52 %.
TEST(Report, LeavesAShareOpenWithinTwoStandardErrorsOfABoundOfItsGoal) {
  using Judgment = Figure::Judgment;
  const auto judged = [](std::uint64_t servers, std::uint64_t receivers) {
    return server_scores_next(servers, receivers).at(0).judgment;
  };
  EXPECT_EQ(judged(0, 0), Judgment::unknown);
  EXPECT_EQ(judged(50, 50), Judgment::open) << "5 % of error";
  EXPECT_EQ(judged(56, 44), Judgment::open);
  EXPECT_EQ(judged(70, 30), Judgment::falls_short);
  EXPECT_EQ(judged(25'000, 25'000), Judgment::pass) << "0.2 % of error";
  EXPECT_EQ(judged(25'900, 24'100), Judgment::open);
  EXPECT_EQ(judged(27'000, 23'000), Judgment::falls_short);
}

// The numbers in the text of a goal, in order.
std::vector<double> numbers_in(const std::string& text) {
  std::vector<double> numbers;
  for (std::size_t i = 0; i < text.size();) {
    if (text[i] < '0' || text[i] > '9') {
      ++i;
      continue;
    }
    std::size_t used = 0;
    numbers.push_back(std::stod(text.substr(i), &used));
    i += used;
  }
  return numbers;
}

TEST(Report, JudgesByTheNumberThatItPrints) {
  foosball::Statistics s;
  s.play_ticks = s.ball_ticks = 100'000;
  const auto judged_at = [&](std::uint64_t ticks) {
    s.moving_ticks[0] = {100'000 - ticks, 0, 0, ticks, 0};
    s.longest_unreachable_ticks = s.longest_stuck_ticks = 10 * ticks;
    return figures_of("", s);
  };
  int bounds = 0;
  for (std::uint64_t ticks = 0; ticks < 2000; ++ticks) {
    for (const Figure& f : judged_at(ticks)) {
      if (f.name != "  longest" && f.name != "longest stuck" &&
          f.name != "team 0 moves 3 rods or more at once")
        continue;
      const double bound = numbers_in(f.goal).at(0);
      ASSERT_EQ(f.judgment == Figure::Judgment::pass, f.value <= bound)
          << f.name << " " << f.value << ", goal " << f.goal;
      ++bounds;
    }
  }
  EXPECT_EQ(bounds, 3 * 2000);
}

TEST(Report, SaysOfEqualPlayersThatHalfOfThePointsIsWhatIsAskedOfOneRod) {
  ReportPlan plan{.matches = 2};
  std::vector<Series> series;
  for (const SeriesDesc& desc : report_series(plan)) series.emplace_back(desc);
  const auto figures = report_figures(plan, series);
  const auto one = std::ranges::find(figures, "points of the player with one rod", &Figure::name);
  ASSERT_NE(one, figures.end());
  EXPECT_EQ(one->goal, "at least 50");
}

TEST(StuckBalls, AreLookedForAtEveryLevelInBothLayoutsAndFallShortBeyondTheRule) {
  const auto plan = stuck_ball_series({.matches = 2});
  std::set<std::pair<std::string, foosball::Layout>> played;
  std::vector<Series> series;
  for (const SeriesDesc& desc : plan) {
    EXPECT_EQ(desc.players[0], desc.players[1]);
    played.emplace(desc.players[0], desc.layout);
    series.emplace_back(desc);
  }
  EXPECT_EQ(played.size(), 10u);
  EXPECT_FALSE(any_short(stuck_ball_figures(series)));
  GameResult result;
  result.statistics.longest_unreachable_ticks = 2000;
  series[3].take(result);
  EXPECT_FALSE(any_short(stuck_ball_figures(series)));
  result.statistics.longest_unreachable_ticks = 2001;
  series[3].take(result);
  EXPECT_TRUE(any_short(stuck_ball_figures(series)));
}

}  // namespace
}  // namespace match
