// Games: the same desc gives the same game, and its recording replays.
#include "match/game.h"

#include <gtest/gtest.h>

#include "foosball/computer_player.h"
#include "match/codec.h"
#include "match/player.h"
#include "server/playback.h"

namespace match {
namespace {

GameDesc short_game() {
  GameDesc game;
  game.players = {"classic:0.9", "one-rod:classic:0.5"};
  game.seed = 5;
  game.max_ticks = 12000;
  return game;
}

TEST(Game, OfTheSameDescIsTheSameToTheBitRecordedOrNot) {
  const PlayedGame a = play_game(short_game()), b = play_game(short_game(), Recording::on);
  EXPECT_EQ(a.result, b.result);
  EXPECT_TRUE(a.journal.empty());
  GameDesc other = short_game();
  other.variant = 1;
  EXPECT_NE(play_game(other).result.state_hash, a.result.state_hash);
}

TEST(Game, RecordingReplaysToTheSameMatch) {
  PlayedGame played = play_game(short_game(), Recording::on);
  auto playback = server::Playback::from_bytes(std::move(played.journal), "a game");
  ASSERT_TRUE(playback.has_value()) << playback.error();
  auto replayed = foosball::Match::create((*playback)->match());
  while (const wire::JournalTick* tick = (*playback)->next(*replayed)) {
    server::step_recorded(*replayed, *tick);
  }
  EXPECT_EQ((*playback)->verdict(), server::Playback::Verdict::same)
      << (*playback)->verdict_sentence();
  EXPECT_EQ(replayed->state_hash(), played.result.state_hash);
  EXPECT_GE((*playback)->hashes_checked(), 12u);
}

TEST(Game, OfAnIdleSideMovesNoneOfItsRods) {
  GameDesc game = short_game();
  game.players = {"classic", "idle"};
  const auto s = play_game(game).result.statistics;
  EXPECT_GT(s.hand_ticks[0], 0u);
  EXPECT_EQ(s.hand_ticks[7], 0u);
  EXPECT_EQ(s.moving_ticks[1][0], s.play_ticks);
}

TEST(Game, OfALevelIsPlayedWithTheValuesOfJudgmentThatItsNameHas) {
  GameDesc game = short_game();
  const auto hash = [&](const std::string& player) {
    game.players[0] = player;
    return play_game(game).result.state_hash;
  };
  const std::uint64_t usual = hash("5");
  EXPECT_EQ(hash("5@"), usual);
  EXPECT_EQ(hash("5:gambler@shot_bar=" +
                 std::to_string(foosball::judgment_of(5, foosball::PlayStyle::gambler).shot_bar)),
            usual)
      << "its own value";
  EXPECT_NE(hash("5@hands_goalie=0,hands_defense=0.2"), usual);
}

// The assist moves goalie and defence.
TEST(Player, OneRodHasMidfieldOrAttackInHandNeverBoth) {
  GameDesc game = short_game();
  game.players = {"one-rod:classic:0.9", "classic"};
  const auto s = play_game(game).result.statistics;
  const auto& hands = s.hand_ticks;
  EXPECT_GT(hands[3], 0u);
  EXPECT_GT(hands[5], 0u);
  EXPECT_LE(hands[3] + hands[5], s.play_ticks);
  EXPECT_EQ(s.moving_ticks[0][4], 0u);
}

TEST(Player, ThatIsNoneIsNamedWithWhatMayBeGiven) {
  for (const char* name : {"", "clasic", "classic:2", "classic:x", "classic:0.5 ", "classic:nan",
                           "idle:1", "one-rod:nobody", "5@shot_bar=2", "classic@shot_bar=0.3",
                           "idle@", "one-rod:5@bar=1", "spinner:"}) {
    const auto player = make_player({name, 0, 1});
    if (std::string(name) == "spinner:") {
      EXPECT_TRUE(player.has_value());
      continue;
    }
    ASSERT_FALSE(player.has_value()) << name;
    EXPECT_GT(player.error().size(), 20u);
  }
}

TEST(Codec, KeepsAResultAndRefusesAnyLineThatWasChanged) {
  const GameResult result = play_game(short_game()).result;
  const std::string line = encode_result(result);
  const auto decoded = decode_result(line);
  ASSERT_TRUE(decoded.has_value());
  EXPECT_EQ(*decoded, result);
  for (std::size_t length = 0; length < line.size(); ++length) {
    EXPECT_FALSE(decode_result(line.substr(0, length)).has_value()) << length;
  }
  for (std::size_t at = 0; at < line.size(); ++at) {
    std::string changed = line;
    changed[at] = changed[at] == '7' ? '8' : '7';
    EXPECT_FALSE(decode_result(changed).has_value()) << at;
  }
}

}  // namespace
}  // namespace match
