// How a computer player works one of its rods: guard, lift the feet out of its own shots' way, wind
// up and strike. All in the team's frame (computer_sight.h).
#pragma once

#include "computer_hand.h"
#include "computer_sight.h"
#include "random.h"

namespace foosball {

// What skill makes of a player.
struct Temper {
  double delay;                  // sight to hand [s]
  double aim_error;              // standard deviation of a foot's place at the hit [m]
  double pause_low, pause_high;  // thought spent with the foot drawn back [s]
  AxisLimits slide, swing, strike;
};
Temper temper_of(double skill);  // clamped to [0, 1]

class RodTactics {
 public:
  RodTactics(int team, int rod) : team_(team), rod_(rod) {}

  void play(const TableSpec& table, const Sighting& now, const Temper& temper, Random& random);
  // The hand takes the rod where it is, whoever moved it there.
  void adopt(double slide, double swing);

  HandAxis& slide() { return slide_; }
  HandAxis& swing() { return swing_; }

 private:
  enum class Stance { watch, wind_up, strike, recover };

  const RodSpec& spec(const TableSpec& table) const { return table.rods[rod_]; }
  double x(const TableSpec& table) const { return attack_sign(team_) * spec(table).x; }

  void watch(const TableSpec& table, const Sighting& now, const Temper& temper, Random& random);
  void wind_up(const TableSpec& table, const Sighting& now, const Temper& temper);
  void strike(const Temper& temper);
  void recover(const TableSpec& table, const Sighting& now, const Temper& temper);
  void swing_to(const TableSpec& table, const Sighting& now, double goal, const AxisLimits& limits);
  bool ball_before_foot(const TableSpec& table, const Sighting& now) const;

  bool can_strike(const TableSpec& table, const Sighting& now) const;
  void take_aim(const TableSpec& table, const Sighting& now, const Temper& temper, Random& random);
  double guard_y(const TableSpec& table, const Sighting& now) const;
  double slide_for(const TableSpec& table, double y) const;
  double power_for(const TableSpec& table, double ahead) const;
  double level() const;  // the full turn nearest to the swing, where the feet hang down

  int team_, rod_;
  HandAxis slide_, swing_;
  Stance stance_ = Stance::watch;
  double since_ = 0.0;  // in this stance [s]
  double pause_ = 0.0;  // before this strike [s]
  double aim_ = 0.0;    // foot's centre from the ball's [m]
  double aside_ = 0.0;  // sidestep while the foot goes back past a ball beside it [m]
  double power_ = 1.0;  // of this strike, share of the full rate
  double goal_slide_ = 0.0;
};

}  // namespace foosball
