// The state of a match without its world: saved, hashed and restored together with it.
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

// Fits a byte, and no match reaches it.
inline constexpr int kMaxScore = 99;
static_assert(kMaxGoals <= kMaxScore);
inline constexpr int kMaxSetsToWin = (kMaxSets + 1) / 2;
inline constexpr int kMaxCount = 250;           // of fouls and time-outs; counting stops there
inline constexpr double kMaxDuration = 3600.0;  // [s]
// Bound on a rod's angle [rad]: no hand reaches two million revolutions.
inline constexpr double kMaxAngle = 1e7;
inline constexpr double kServeDelay = 0.5;  // [s], so that the eye finds the new ball
// Maximum time for which a team's men may block every place of the ball. Then the other team gets
// it.
inline constexpr double kServeWait = 5.0;  // [s]
// Maximum time for which a goal waits until the rod that shot stops or completes a spin (15).
inline constexpr double kReview = 0.3;  // [s]
// Bit rod * kMaxMenOnRod + man.
inline constexpr std::uint64_t kAllMen = (std::uint64_t{1} << (kRods * kMaxMenOnRod)) - 1;

// A man's touch of the ball.
struct Touch {
  int rod = 0, man = 0;
  std::uint64_t tick = 0;  // MatchState::tick at its beginning
  bool any = false;        // true: there was a touch since the ball was put in play

  template <class Archive, class Self>
  static void visit(Archive& archive, Self& self) {
    archive.choice(self.rod, kRods);
    archive.choice(self.man, kMaxMenOnRod);
    archive.count(self.tick, kMaxTicks);
    archive.flag(self.any);
  }
};

// The mode and the rules of a match.
struct Game {
  Mode mode = Mode::match;
  Rules rules;
  std::uint64_t challenge = 0;  // seed of a challenge, used again at each start; otherwise 0

  bool operator==(const Game&) const = default;

  template <class Archive, class Self>
  static void visit(Archive& archive, Self& self);
};

// Each number is in its range, and such a match can end.
bool playable(const Rules& rules);

// The counts behind the score.
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
      archive.choice(self.sets[team], kMaxSetsToWin + 1);
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
  Game game, next;  // current; from the next logo on
  Screen screen = Screen::logo;
  bool paused = false;
  Tally tally;
  std::array<int, kTeams> character{1, 1};  // if there are at least two to choose from
  std::array<int, kTeams> built{1, 1};      // characters of the current world
  int first = 0;  // team whose side the world was built from: the first server (table_world.h)
  std::array<bool, kTeams> confirmed{};
  std::array<bool, kTeams> computer{};  // a computer plays the team
  bool attract = false;
  int rung = 0;  // of the ladder
  std::uint64_t screen_ticks = 0;
  std::uint64_t play_ticks = 0;
  int last_scorer = 0;

  // Hands.
  MovedRods moved_rods;
  std::uint64_t idle_ticks = 0;                      // since a person last moved a rod
  std::array<std::uint64_t, kTeams> absent_ticks{};  // with the ball in play, since a hand of the
                                                     // team (a person's or not) last moved a rod

  // Ball.
  bool ball_in_play = false;
  bool ball_parked = true;        // false: it is in play, or in the goal after it scored
  bool ball_in_goal = false;      // it has scored, or a goal is under review (review_ticks)
  int serve_rod = 0;              // rod of the next serve
  int serve_man = -1;             // man of the next serve; -1: the middle one
  std::uint64_t serve_in = 0;     // ticks until the serve; counts while the ball is not in play
  std::uint64_t serve_waits = 0;  // ticks for which men have blocked the place
  int last_server = 0;            // team
  int last_toucher = 0;           // team
  bool served = false;            // from a midfield: a goal counts after touches by two men
  std::uint64_t touched = 0;      // men who touched it since it was put in play: bit rod * 5 + man
  BallTouches touching;           // parts of men that touch the ball now
  Touch touch;                    // the latest
  std::array<Touch, kTeams> touch_of{};  // the latest of each team
  bool shot_pending = false;             // not yet decided whether the touch was a shot
  BallWatch watch;
  std::uint64_t review_ticks = 0;  // waiting time of a goal for the rod that shot

  // Stops.
  std::uint64_t time_out_left = 0;  // ticks; 0: none
  int time_out_team = 0;
  std::array<bool, kTeams> ready{};  // in a time-out: requests to continue
  bool fouled = false;
  Foul last_foul{};
  int last_foul_team = 0;

  // Last goal and shot.
  Shot last_goal, last_shot;
  bool last_goal_own = false;
  // Training: where the ball is served. feed_man -1: not requested; then it is decided by the team
  // whose push began.
  int feed_rod = 0, feed_man = -1;

  // Rods: targets of those without a hand.
  std::array<RodTarget, kRods> hold{};
  std::array<RodGestures, kRods> gestures{};
  std::array<SpinWatch, kRods> spins{};
  std::array<bool, kRods> beyond{};  // the hand presses the rod against its stop

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

// Bodies of the men in the world.
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
  archive.choice(rules.sets_to_win, kMaxSetsToWin + 1);
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
    archive.real(value, field.min, field.max);
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
