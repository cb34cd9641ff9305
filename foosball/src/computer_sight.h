// What a computer player sees: the table turned so that its own goal is at -x, with a person's
// delay, and the guess of where the ball is now.
//
// Team frame: for team 1 the table's turned half a revolution about z. A rod's swing is the angle
// with the feet forward (towards the opponent) positive.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "foosball/match.h"

namespace foosball {

struct Sighting {
  bool ball_in_play = false;
  vp::Vec3 ball, velocity, spin;  // [m], [m/s], [rad/s]
  std::array<double, kRods> slide{}, swing{};
  std::array<double, kRods> slide_rate{}, swing_rate{};  // [m/s], [rad/s]
  double age = 0.0;                                      // of what was seen of the rods [s]
  // The ball is not simulated but guessed on from where it was seen; how far off it may be [m].
  bool guessed = false;
  double doubt = 0.0;
  // False after an own serve until a second man has touched the ball (ITSF 4.2.2): such a goal is a
  // foul.
  bool goal_counts = true;
};

// Coordinates of a rod between the table's frame and a team's.
constexpr double team_slide(int team, double slide) {
  return attack_sign(team) * slide;
}
constexpr double team_swing(int team, double angle) {
  return -attack_sign(team) * angle;
}

// 1 or -1; the same for either zero, which a mirrored match may have exchanged.
constexpr double side_of(double value) {
  return value < 0.0 ? -1.0 : 1.0;
}

// The angle [rad] less its full turns; most have none, and the remainder is slow.
inline double within_half_turn(double angle) {
  return std::fabs(angle) <= vp::kPi ? angle : std::remainder(angle, 2.0 * vp::kPi);
}

class ComputerSight {
 public:
  ComputerSight(int team, int delay_ticks);

  void look(const MatchView& view);
  void forget() { count_ = 0; }  // what was seen before an interruption
  // The rods as seen, and the ball carried on to now from where and how fast it was seen.
  const Sighting& now() const { return now_; }
  // As it was seen, now().age ago.
  const Sighting& seen() const { return seen_now_; }

 private:
  Sighting in_team_frame(const MatchView& view) const;

  int team_;
  std::vector<Sighting> seen_;  // a ring of the last delay ticks
  std::size_t next_ = 0;
  std::size_t count_ = 0;
  Sighting now_, seen_now_;
};

// y of a ball after a time, bounced off the side walls.
double y_after(const TableSpec& table, double y, double vy, double time);

}  // namespace foosball
