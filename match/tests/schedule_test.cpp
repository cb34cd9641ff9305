// Totals do not depend on the assignment and order of games; a killed run continues.
#include "match/schedule.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "match/checkpoint.h"
#include "match/codec.h"
#include "match/executor.h"

namespace match {
namespace {

SeriesDesc short_series(std::uint64_t seed, std::uint64_t games) {
  SeriesDesc desc;
  desc.players = {"classic:0.9", "classic:0.3"};
  desc.seed = seed;
  desc.max_ticks = 1500;
  desc.max_games = games;
  return desc;
}

// A result that depends only on the game.
GameResult made_up(const GameDesc& game) {
  GameResult result;
  result.winner = static_cast<int>(mix_seed(game.seed * 2 + game.variant) % 3) - 1;
  result.state_hash = mix_seed(game.seed);
  result.statistics.ticks = game.seed;
  result.statistics.longest_stuck_ticks = game.seed % 7;
  return result;
}

TEST(Series, ChangesSidesWithinAPairAndKeepsItsSeedAndCharacters) {
  const Series series(short_series(40, 4));
  const GameDesc a = series.game(2), b = series.game(3);
  EXPECT_EQ(a.seed, 41u);
  EXPECT_EQ(b.seed, 41u);
  EXPECT_EQ(a.characters, b.characters);
  EXPECT_EQ(a.players[0], b.players[1]);
  EXPECT_EQ(a.players[1], b.players[0]);
  EXPECT_NE(a.variant, b.variant);
}

TEST(Schedule, GivesTheSameTotalsInWhateverOrderResultsCome) {
  std::vector<SeriesDesc> plan{short_series(1, 30), short_series(100, 400)};
  plan[1].test = SequentialTest{0.4, 0.6, 0.05, 0.05};
  std::vector<std::uint64_t> digests, taken;
  for (const std::size_t ahead : {1u, 2u, 7u, 50u}) {  // games in progress at the same time
    Schedule schedule(plan);
    std::vector<JobId> under_way;
    std::uint64_t order = ahead;
    while (!schedule.finished()) {
      while (under_way.size() < ahead) {
        const auto id = schedule.next();
        if (!id) break;
        under_way.push_back(*id);
      }
      const std::size_t pick = mix_seed(order++) % under_way.size();
      const JobId id = under_way[pick];
      under_way.erase(under_way.begin() + static_cast<std::ptrdiff_t>(pick));
      if (mix_seed(order++) % 5 == 0) {
        schedule.give_back(id);  // its player is lost
      } else {
        schedule.complete(id, made_up(schedule.game(id)));
      }
    }
    digests.push_back(schedule.series()[0].digest() ^ schedule.series()[1].digest());
    taken.push_back(schedule.games_taken());
    EXPECT_EQ(schedule.series()[0].taken(), 30u);
  }
  for (const auto digest : digests) EXPECT_EQ(digest, digests[0]);
  for (const auto games : taken) EXPECT_EQ(games, taken[0]);
  EXPECT_LT(taken[0], 430u);
}

struct Outcome {
  std::uint64_t digest;
  foosball::Statistics statistics;
  bool operator==(const Outcome&) const = default;
};
Outcome outcome(const Schedule& schedule) {
  return {schedule.series()[0].digest(), schedule.series()[0].statistics()};
}

TEST(Executor, GivesTheSameTotalsWithOneThreadAndWithThree) {
  std::vector<Outcome> outcomes;
  for (const int jobs : {1, 3}) {
    Schedule schedule({short_series(1, 6)});
    ExecutorOptions options;
    options.jobs = jobs;
    const auto effort = play_all(schedule, options);
    ASSERT_TRUE(effort.has_value());
    EXPECT_EQ(effort->games, 6u);
    EXPECT_TRUE(schedule.finished());
    outcomes.push_back(outcome(schedule));
  }
  EXPECT_EQ(outcomes[0], outcomes[1]);
}

class CheckpointFile : public testing::Test {
 protected:
  CheckpointFile() : path(testing::TempDir() + "match-" + std::to_string(::getpid()) + ".txt") {
    std::remove(path.c_str());
  }
  ~CheckpointFile() override { std::remove(path.c_str()); }
  std::string path;
  std::vector<SeriesDesc> plan{short_series(1, 6)};
};

TEST_F(CheckpointFile, LetsAKilledRunGoOnToTheSameTotals) {
  Schedule whole(plan);
  ASSERT_TRUE(play_all(whole, {}).has_value());
  {
    auto opened = Checkpoint::open(path, plan);
    ASSERT_TRUE(opened.has_value()) << opened.error();
    for (const std::uint64_t game : {0u, 3u, 4u}) {
      ASSERT_TRUE(opened->checkpoint->append({0, game}, plan[0].digest(),
                                             play_game(whole.game({0, game})).result));
    }
  }
  // A last line truncated by a power failure.
  std::ofstream(path, std::ios::app) << "0 5 " << plan[0].digest() << ' '
                                     << encode_result(made_up(whole.game({0, 5}))).substr(0, 20);
  auto opened = Checkpoint::open(path, plan);
  ASSERT_TRUE(opened.has_value()) << opened.error();
  EXPECT_EQ(opened->lines.size(), 3u);
  EXPECT_EQ(opened->unreadable, 1);
  Schedule resumed(plan);
  for (auto& line : opened->lines) resumed.know(line.id, line.result);
  ExecutorOptions options;
  options.checkpoint = opened->checkpoint.get();
  const auto effort = play_all(resumed, options);
  ASSERT_TRUE(effort.has_value());
  EXPECT_EQ(effort->games, 3u);
  EXPECT_EQ(outcome(resumed), outcome(whole));
  opened->checkpoint.reset();
  const auto again = Checkpoint::open(path, plan);
  ASSERT_TRUE(again.has_value());
  EXPECT_EQ(again->lines.size(), 6u);
}

TEST_F(CheckpointFile, OfOtherMatchesIsRefused) {
  ASSERT_TRUE(Checkpoint::open(path, plan).has_value());
  const auto other = Checkpoint::open(path, {short_series(2, 6)});
  ASSERT_FALSE(other.has_value());
  EXPECT_NE(other.error().find("other matches"), std::string::npos);
  EXPECT_FALSE(Checkpoint::open("/no/such/folder/file", plan).has_value());
}

// As after a change of a level: the same matches, another fingerprint.
TEST_F(CheckpointFile, OfAnotherVersionOfTheGameIsRefused) {
  ASSERT_TRUE(Checkpoint::open(path, plan).has_value());
  std::string head;
  std::getline(std::ifstream(path), head);
  const auto rewrite = [&](const std::string& text) { std::ofstream(path) << text; };
  const std::size_t at = head.rfind(' ') + 1;
  rewrite(head.substr(0, at) + "123\n");
  const auto changed = Checkpoint::open(path, plan);
  ASSERT_FALSE(changed.has_value());
  EXPECT_NE(changed.error().find("another version of the game, whose players"), std::string::npos);
  rewrite("space-foosball-match checkpoint 1; game 12; 1 series 5\n");
  const auto older = Checkpoint::open(path, plan);
  ASSERT_FALSE(older.has_value());
  EXPECT_NE(older.error().find("another version"), std::string::npos);
}

TEST_F(CheckpointFile, OfAnotherKindIsRefusedAndLeftAsItIs) {
  for (const std::string text : {"series,game\n1,2\n", "no line", "\n"}) {
    std::ofstream(path) << text;
    const auto opened = Checkpoint::open(path, plan);
    ASSERT_FALSE(opened.has_value()) << text;
    EXPECT_NE(opened.error().find("is no checkpoint"), std::string::npos) << opened.error();
    std::stringstream after;
    after << std::ifstream(path).rdbuf();
    EXPECT_EQ(after.str(), text);
  }
}

// Killed at any byte: complete lines are read, and the run continues.
TEST_F(CheckpointFile, CutOffAnywhereIsGoneOnFrom) {
  {
    auto opened = Checkpoint::open(path, plan);
    ASSERT_TRUE(opened.has_value());
    const Schedule whole(plan);
    for (const std::uint64_t game : {0u, 1u, 2u})
      ASSERT_TRUE(
          opened->checkpoint->append({0, game}, plan[0].digest(), made_up(whole.game({0, game}))));
  }
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  const std::string all = text.str();
  for (std::size_t size = 0; size <= all.size(); size += 17) {
    std::ofstream(path) << all.substr(0, size);
    const auto lines =
        std::count(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(size), '\n');
    {
      auto opened = Checkpoint::open(path, plan);
      ASSERT_TRUE(opened.has_value()) << size << ": " << opened.error();
      // A line without its newline may still be complete.
      ASSERT_GE(static_cast<long>(opened->lines.size()), std::max(0l, lines - 1)) << size;
      ASSERT_LE(static_cast<long>(opened->lines.size()), std::max(0l, lines)) << size;
      ASSERT_TRUE(opened->checkpoint->append({0, 5}, plan[0].digest(), {}));
    }
    auto again = Checkpoint::open(path, plan);
    ASSERT_TRUE(again.has_value()) << size;
    ASSERT_FALSE(again->lines.empty()) << size;
    EXPECT_EQ(again->lines.back().id.game, 5u) << size;
  }
}

TEST_F(CheckpointFile, IsOneRunsAtATime) {
  const auto first = Checkpoint::open(path, plan);
  ASSERT_TRUE(first.has_value());
  const auto second = Checkpoint::open(path, plan);
  ASSERT_FALSE(second.has_value());
  EXPECT_NE(second.error().find("another run has"), std::string::npos);
}

TEST(GameFingerprint, TellsPlayersAndLayouts) {
  const auto of = [](const char* player, foosball::Layout layout) {
    SeriesDesc desc;
    desc.players = {player, player};
    desc.layout = layout;
    return game_fingerprint({desc});
  };
  using foosball::Layout;
  EXPECT_EQ(of("3", Layout::paper), of("3", Layout::paper));
  EXPECT_NE(of("3", Layout::paper), of("3", Layout::tournament));
  EXPECT_NE(of("3", Layout::tournament), of("2", Layout::tournament));
  EXPECT_EQ(of("3@patience=1", Layout::paper), of("3", Layout::paper)) << "its text is the series'";
}

// A rank believed lost returns a game that another has played since.
TEST(Schedule, TakesEachGameOnce) {
  Schedule schedule({short_series(1, 6)});
  const auto first = schedule.next(), second = schedule.next();
  ASSERT_TRUE(first && second);
  std::vector<JobId> kept;
  ExecutorOptions options;
  options.taken = [&](const GameDesc&, JobId id, const GameResult&) { kept.push_back(id); };
  const auto play = [&](JobId id) {
    ASSERT_TRUE(keep(schedule, options, id, made_up(schedule.game(id))));
  };
  play(*second);  // waits for the first
  play(*second);
  play(*first);
  play(*first);
  play(*second);
  EXPECT_EQ(kept, (std::vector<JobId>{*second, *first}));
  EXPECT_EQ(schedule.series()[0].taken(), 2u);
  while (!schedule.finished()) play(*schedule.next());
  EXPECT_EQ(kept.size(), 6u);
  for (std::uint64_t game = 0; game < 6; ++game) play({0, game});
  EXPECT_EQ(kept.size(), 6u);
}

}  // namespace
}  // namespace match
