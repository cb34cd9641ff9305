// What a computer player sees: the table in its team's frame, with a person's delay, and a simple
// extrapolation of the ball to now.
//
// Team frame: own goal at -x; for team 1 it is the table's frame rotated by half a turn about z. A
// rod's swing is its angle with the feet forward (towards the opponent) positive.
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
  double age = 0.0;                                      // of the rods' state [s]
  // The ball is extrapolated from the view instead of simulated; doubt: its possible error [m].
  bool guessed = false;
  double doubt = 0.0;
  // False after a serve by the team until a second man has touched the ball (ITSF 4.2.2): a goal
  // would be a foul.
  bool goal_counts = true;
};

// Coordinates of a rod between the table's frame and a team's.
constexpr double team_slide(int team, double slide) {
  return attack_sign(team) * slide;
}
constexpr double team_swing(int team, double angle) {
  return -attack_sign(team) * angle;
}

// 1 or -1; 1 for both zeros, whose sign a mirrored match may exchange.
constexpr double side_of(double value) {
  return value < 0.0 ? -1.0 : 1.0;
}

// The angle [rad] modulo full turns. Most angles are in range; the remainder is slow.
inline double within_half_turn(double angle) {
  return std::fabs(angle) <= vp::kPi ? angle : std::remainder(angle, 2.0 * vp::kPi);
}

class ComputerSight {
 public:
  ComputerSight(int team, int delay_ticks);

  void look(const MatchView& view);
  void forget() { count_ = 0; }  // discards the views before an interruption
  // The rods as seen, and the ball extrapolated to now with the velocity that was seen.
  const Sighting& now() const { return now_; }
  // The view as it was now().age ago.
  const Sighting& seen() const { return seen_now_; }

 private:
  Sighting in_team_frame(const MatchView& view) const;

  int team_;
  std::vector<Sighting> seen_;  // ring buffer of the last delay ticks
  std::size_t next_ = 0;
  std::size_t count_ = 0;
  Sighting now_, seen_now_;
};

// y of a ball after a time, with bounces off the side walls.
double y_after(const TableSpec& table, double y, double vy, double time);

}  // namespace foosball
