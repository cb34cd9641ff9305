// All of a match that is not the world: what is saved, hashed and restored beside it.
#pragma once

#include <array>
#include <cstdint>

#include "foosball/match.h"
#include "gestures.h"
#include "moved_rods.h"
#include "referee.h"
#include "spin_watch.h"
#include "ticks.h"

namespace foosball {

// A score that fits a byte and no match reaches.
inline constexpr int kMaxScore = 99;
static_assert(kMostGoals <= kMaxScore);
inline constexpr int kMostSetsToWin = (kMostSets + 1) / 2;
inline constexpr int kMaxCount = 250;           // of fouls and time-outs; counted no further
inline constexpr double kMaxDuration = 3600.0;  // [s]
// A rod turned further than this [rad] has been held by nobody: two million revolutions.
inline constexpr double kMaxAngle = 1e7;
inline constexpr double kServeDelay = 0.5;  // [s] for the eye to find the new ball
// So long men may fill every place for the ball before the other side has it.
inline constexpr double kServeWait = 5.0;  // [s]
// A goal waits so long at most for the rod that shot to stop or to have gone round (15).
inline constexpr double kReview = 0.3;  // [s]
// Bit rod * kMaxMenOnRod + man.
inline constexpr std::uint64_t kAllMen = (std::uint64_t{1} << (kRods * kMaxMenOnRod)) - 1;

// A man's touch of the ball.
struct Touch {
  int rod = 0, man = 0;
  std::uint64_t tick = 0;  // MatchState::tick at its beginning
  bool any = false;        // since the ball was put in play

  template <class Archive, class Self>
  static void visit(Archive& archive, Self& self) {
    archive.choice(self.rod, kRods);
    archive.choice(self.man, kMaxMenOnRod);
    archive.count(self.tick, kMaxTicks);
    archive.flag(self.any);
  }
};

// What is played, and by what.
struct Game {
  Mode mode = Mode::match;
  Rules rules;
  std::uint64_t challenge = 0;  // what a challenge is drawn from, again at each start; else 0

  bool operator==(const Game&) const = default;

  template <class Archive, class Self>
  static void visit(Archive& archive, Self& self);
};

// Each number in its range, and together a match that can end.
bool playable(const Rules& rules);

// What the score is made of.
struct Tally {
  std::array<int, kTeams> score{};      // goals in this set
  std::array<int, kTeams> sets{};       // won
  std::array<int, kTeams> time_outs{};  // taken in this set
  std::array<int, kTeams> jars{};       // in the match
  std::uint64_t set_ticks = 0;          // of play in this set
  bool golden_goal = false;             // the next goal decides
  bool set_over = false;                // at a ceremony: a new set follows

  template <class Archive, class Self>
  static void visit(Archive& archive, Self& self) {
    for (int team = 0; team < kTeams; ++team) {
      archive.choice(self.score[team], kMaxScore + 1);
      archive.choice(self.sets[team], kMostSetsToWin + 1);
      archive.choice(self.time_outs[team], kMaxCount + 1);
      archive.choice(self.jars[team], kMaxCount + 1);
    }
    archive.count(self.set_ticks, kMaxTicks);
    archive.flag(self.golden_goal);
    archive.flag(self.set_over);
  }
};

struct MatchState {
  std::uint64_t tick = 0;
  Game game, next;  // in hand; from the next logo on
  Screen screen = Screen::logo;
  bool paused = false;
  Tally tally;
  std::array<int, kTeams> character{1, 1};  // where there are two to choose from
  std::array<int, kTeams> built{1, 1};      // the characters that the world was made with
  int first = 0;  // the team whose side the world was made from: who served first (table_world.h)
  std::array<bool, kTeams> confirmed{};
  std::array<bool, kTeams> computer{};  // plays the team
  bool attract = false;
  int rung = 0;  // of the ladder
  std::uint64_t screen_ticks = 0;
  std::uint64_t play_ticks = 0;
  int last_scorer = 0;

  // The hands.
  MovedRods moved_rods;
  std::uint64_t idle_ticks = 0;                      // since a person last moved a rod
  std::array<std::uint64_t, kTeams> absent_ticks{};  // with the ball in play, since a hand of the
                                                     // team, a person's or not, last moved a rod

  // The ball.
  bool ball_in_play = false;
  bool ball_parked = true;        // else it lies where it is: in play, or in the goal it went into
  bool ball_in_goal = false;      // it has scored, or is about to (review_ticks)
  int serve_rod = 0;              // the rod at which the ball is to be put in play,
  int serve_man = -1;             // the man, or -1: the middle one; and
  std::uint64_t serve_in = 0;     // after how many ticks; counts while the ball is not in play
  std::uint64_t serve_waits = 0;  // ticks for which men have filled the place
  int last_server = 0;            // team
  int last_toucher = 0;           // team
  bool served = false;            // from a midfield: two men must touch before a goal counts
  std::uint64_t touched = 0;  // men that touched since the ball was put in play: bit rod * 5 + man
  BallTouches touching;       // the parts of men in contact with the ball now
  Touch touch;                // the last
  std::array<Touch, kTeams> touch_of{};  // the last of each team
  bool shot_pending = false;             // it has not been told whether that was a shot
  BallWatch watch;
  std::uint64_t review_ticks = 0;  // for so long the goal waits for the rod that shot to stop

  // Stops.
  std::uint64_t time_out_left = 0;  // ticks; 0: none
  int time_out_team = 0;
  std::array<bool, kTeams> ready{};  // in a time-out: wants to go on
  bool fouled = false;
  Foul last_foul{};
  int last_foul_team = 0;

  // What was last seen.
  Shot last_goal, last_shot;
  bool last_goal_own = false;
  // Training: where the ball is served. No man: nobody has asked, and it is whose push began.
  int feed_rod = 0, feed_man = -1;

  // The rods: where each is held while no hand is on it.
  std::array<RodTarget, kRods> hold{};
  std::array<RodGestures, kRods> gestures{};
  std::array<SpinWatch, kRods> spins{};
  std::array<bool, kRods> beyond{};  // the hand has pushed the rod against its stop

  std::uint64_t random = 0;
  Tuning tuning;

  template <class Archive, class Self>
  static void visit(Archive& archive, Self& self);

 private:
  template <class Archive, class Self>
  static void visit_ball(Archive& archive, Self& self);
  template <class Archive, class Self>
  static void visit_stops(Archive& archive, Self& self);
};

// Of the men that the world is made with.
inline TeamBodies bodies_of(const MatchDesc& desc, const MatchState& state) {
  return {desc.characters[static_cast<std::size_t>(state.built[0])].body,
          desc.characters[static_cast<std::size_t>(state.built[1])].body};
}

template <class Archive, class R>
void visit_rules(Archive& archive, R& rules) {
  archive.choice(rules.set, kRuleSets);
  archive.choice(rules.goals_to_win, kMaxScore + 1);
  archive.choice(rules.max_goals, kMaxScore + 1);
  archive.choice(rules.lead, kMaxScore + 1);
  archive.choice(rules.sets_to_win, kMostSetsToWin + 1);
  archive.real(rules.match_seconds, 0.0, kMaxDuration);
  archive.flag(rules.golden_goal);
  archive.flag(rules.change_sides);
  archive.real(rules.dead_ball_seconds, 0.0, kMaxDuration);
  archive.real(rules.still_seconds, 0.0, kMaxDuration);
  archive.real(rules.possession_midfield_seconds, 0.0, kMaxDuration);
  archive.real(rules.possession_seconds, 0.0, kMaxDuration);
  archive.choice(rules.time_outs, kMaxCount + 1);
  archive.real(rules.time_out_seconds, 0.0, kMaxDuration);
  archive.choice(rules.spin, kSpinRules);
  archive.flag(rules.jarring);
  archive.real(rules.ceremony_seconds, 0.0, kMaxDuration);
  archive.real(rules.end_seconds, 0.0, kMaxDuration);
  archive.real(rules.idle_seconds, 0.0, kMaxDuration);
  archive.real(rules.attract_seconds, 0.0, kMaxDuration);
}

template <class Archive, class Self>
void Game::visit(Archive& archive, Self& self) {
  archive.choice(self.mode, kModes);
  visit_rules(archive, self.rules);
  archive.any(self.challenge);
}

template <class Archive, class S>
void visit_shot(Archive& archive, S& shot) {
  archive.choice(shot.team, kTeams);
  archive.choice(shot.rod, kRods);
  archive.choice(shot.man, kMaxMenOnRod);
  archive.real(shot.speed, 0.0, 1e4);
  archive.real(shot.angle, -7.0, 7.0);
}

template <class Archive, class Self>
void MatchState::visit(Archive& archive, Self& self) {
  archive.count(self.tick, kMaxTicks);
  Game::visit(archive, self.game);
  Game::visit(archive, self.next);
  archive.choice(self.screen, kScreens);
  archive.flag(self.paused);
  Tally::visit(archive, self.tally);
  for (int team = 0; team < kTeams; ++team) {
    archive.choice(self.character[team], kMaxCharacters);
    archive.choice(self.built[team], kMaxCharacters);
    archive.flag(self.confirmed[team]);
    archive.flag(self.computer[team]);
  }
  archive.choice(self.first, kTeams);
  archive.flag(self.attract);
  archive.choice(self.rung, kLadderRungs);
  archive.count(self.screen_ticks, kMaxTicks);
  archive.count(self.play_ticks, kMaxTicks);
  archive.choice(self.last_scorer, kTeams);
  MovedRods::visit(archive, self.moved_rods);
  archive.count(self.idle_ticks, kMaxTicks);
  for (auto& ticks : self.absent_ticks) archive.count(ticks, kMaxTicks);
  visit_ball(archive, self);
  visit_stops(archive, self);
  for (int rod = 0; rod < kRods; ++rod) {
    auto& hold = self.hold[rod];
    archive.flag(hold.live);
    archive.real(hold.slide, -1.0, 1.0);
    archive.real(hold.angle, -2.0 * kMaxAngle, 2.0 * kMaxAngle);
    RodGestures::visit(archive, self.gestures[rod]);
    SpinWatch::visit(archive, self.spins[rod]);
    archive.flag(self.beyond[rod]);
  }
  archive.any(self.random);
  visit_fields(self.tuning, [&](const TuningField& field, auto& value) {
    archive.real(value, field.least, field.most);
  });
}

template <class Archive, class Self>
void MatchState::visit_ball(Archive& archive, Self& self) {
  archive.flag(self.ball_in_play);
  archive.flag(self.ball_parked);
  archive.flag(self.ball_in_goal);
  archive.choice(self.serve_rod, kRods);
  archive.man(self.serve_man, kMaxMenOnRod);
  archive.count(self.serve_in, ticks_of(kServeDelay));
  archive.count(self.serve_waits, ticks_of(kServeWait));
  archive.choice(self.last_server, kTeams);
  archive.choice(self.last_toucher, kTeams);
  archive.flag(self.served);
  archive.count(self.touched, kAllMen);
  BallTouches::visit(archive, self.touching);
  Touch::visit(archive, self.touch);
  for (auto& touch : self.touch_of) Touch::visit(archive, touch);
  archive.flag(self.shot_pending);
  BallWatch::visit(archive, self.watch);
  archive.count(self.review_ticks, ticks_of(kReview) + 1);
}

template <class Archive, class Self>
void MatchState::visit_stops(Archive& archive, Self& self) {
  archive.count(self.time_out_left, ticks_of(kMaxDuration));
  archive.choice(self.time_out_team, kTeams);
  for (auto& ready : self.ready) archive.flag(ready);
  archive.flag(self.fouled);
  archive.choice(self.last_foul, kFouls);
  archive.choice(self.last_foul_team, kTeams);
  visit_shot(archive, self.last_goal);
  visit_shot(archive, self.last_shot);
  archive.flag(self.last_goal_own);
  archive.choice(self.feed_rod, kRods);
  archive.man(self.feed_man, kMaxMenOnRod);
}

}  // namespace foosball
