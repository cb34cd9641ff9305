// All of a match that is not the world: what is saved, hashed and restored beside it.
#pragma once

#include <array>
#include <cstdint>

#include "foosball/match.h"
#include "gestures.h"
#include "referee.h"

namespace foosball {

struct MatchState {
  std::uint64_t tick = 0;
  Screen screen = Screen::logo;
  bool paused = false;
  std::array<int, kTeams> score{};
  std::array<int, kTeams> character{1, 1};
  std::array<int, kTeams> built{1, 1};  // the characters that the world was made with
  int first = 0;  // the team whose side the world was made from: who served first (table_world.h)
  std::array<bool, kTeams> confirmed{};
  std::uint64_t screen_ticks = 0;
  std::uint64_t play_ticks = 0;
  int last_scorer = 0;

  // The ball.
  bool ball_in_play = false;
  bool ball_parked = true;     // else it lies where it is: in play, or in the goal it went into
  int serve_rod = 0;           // the rod at which the ball is to be put in play, and
  std::uint64_t serve_in = 0;  // after how many ticks; counts while the ball is not in play
  int last_server = 0;         // team
  int last_toucher = 0;        // team
  bool served = false;         // from a midfield: two men must touch before a goal counts
  std::uint64_t touched = 0;   // men that touched since the ball was put in play: bit rod * 5 + man
  BallTouches touching;        // the parts of men in contact with the ball now
  DeadBallWatch dead_ball;

  // The rods: where each is held while no hand is on it.
  std::array<RodTarget, kRods> hold{};
  std::array<RodGestures, kRods> gestures{};

  std::uint64_t random = 0;

  template <class Archive, class Self>
  static void visit(Archive& archive, Self& self);
};

// A score that fits a byte and no match reaches.
inline constexpr int kMaxScore = 99;
inline constexpr double kMaxDuration = 3600.0;  // [s]
// A rod turned further than this [rad] has been held by nobody: two million revolutions.
inline constexpr double kMaxAngle = 1e7;

template <class Archive, class Self>
void MatchState::visit(Archive& archive, Self& self) {
  archive.count(self.tick);
  archive.choice(self.screen, kScreens);
  archive.flag(self.paused);
  for (int team = 0; team < kTeams; ++team) {
    archive.choice(self.score[team], kMaxScore + 1);
    archive.choice(self.character[team], kCharacters);
    archive.choice(self.built[team], kCharacters);
    archive.flag(self.confirmed[team]);
  }
  archive.choice(self.first, kTeams);
  archive.count(self.screen_ticks);
  archive.count(self.play_ticks);
  archive.choice(self.last_scorer, kTeams);

  archive.flag(self.ball_in_play);
  archive.flag(self.ball_parked);
  archive.choice(self.serve_rod, kRods);
  archive.count(self.serve_in);
  archive.choice(self.last_server, kTeams);
  archive.choice(self.last_toucher, kTeams);
  archive.flag(self.served);
  archive.count(self.touched);
  BallTouches::visit(archive, self.touching);
  DeadBallWatch::visit(archive, self.dead_ball);

  for (int rod = 0; rod < kRods; ++rod) {
    auto& hold = self.hold[rod];
    archive.flag(hold.live);
    archive.real(hold.slide, -1.0, 1.0);
    archive.real(hold.angle, -2.0 * kMaxAngle, 2.0 * kMaxAngle);
    RodGestures::visit(archive, self.gestures[rod]);
  }
  archive.count(self.random);
}

}  // namespace foosball
