// Tactics of the classic computer player for one rod: guards, lifts the feet to clear the way of
// its own shots, winds up and strikes. Everything is in the team's frame (computer_sight.h).
#pragma once

#include "computer_hand.h"
#include "computer_sight.h"
#include "random.h"

namespace foosball {

// The parameters that follow from a player's skill.
struct Temper {
  double delay;                  // reaction time [s]
  double aim_error;              // standard deviation of the foot's position at the hit [m]
  double pause_low, pause_high;  // time to think with the foot drawn back [s]
  AxisLimits slide, swing, strike;
};
Temper temper_of(double skill);  // clamped to [0, 1]

class RodTactics {
 public:
  RodTactics(int team, int rod) : team_(team), rod_(rod) {}

  void play(const TableSpec& table, const Sighting& now, const Temper& temper, Random& random);
  // Takes over the rod at its current position, which another hand may have set.
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
  double level() const;  // full turn nearest to the swing, at which the feet hang down

  int team_, rod_;
  HandAxis slide_, swing_;
  Stance stance_ = Stance::watch;
  double since_ = 0.0;  // in this stance [s]
  double pause_ = 0.0;  // before this strike [s]
  double aim_ = 0.0;    // offset of the foot's centre from the ball's [m]
  double aside_ = 0.0;  // sidestep while the foot swings back past a ball beside it [m]
  double power_ = 1.0;  // of this strike, as a fraction of the full rate
  double goal_slide_ = 0.0;
};

}  // namespace foosball
