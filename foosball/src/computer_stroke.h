// A stroke: what a hand does to a ball at its man's foot, as a short script of both axes. The same
// code plays it on the table and in imagination (computer_foresight.h).
//
// Two kinds. A shot or a pass: the foot is drawn back behind the ball, then strikes. A slide shot
// (push or pull shot): the foot hangs beside the ball, drives it along the rod, goes behind it and
// strikes while it rolls.
#pragma once

#include "computer_hand.h"
#include "computer_level.h"
#include "foosball/table.h"

namespace foosball {

// Swings [rad] from the hanging foot, forward positive.
inline constexpr double kDrawn = -0.95;      // foot drawn back; its sole is then above the ball
inline constexpr double kDrawnOver = -1.15;  // ... and clear of a ball that lies under it
inline constexpr double kThrough = 0.80;     // the end of a strike

struct Stroke {
  double offset = 0.0;  // of the foot's centre from the ball's, once set up [m]
  double power = 1.0;   // of the strike, fraction of the full rate
  bool beside = false;  // a slide shot
  bool pass = false;    // meant for the next rod
  // Slide shots.
  double beside_swing = 0.0;   // brings the foot level with the ball [rad]
  double push = 0.0;           // slide while the foot drives the ball [m], signed
  double push_rate = 0.0;      // [m/s]
  int push_ticks = 0;          // then the foot goes behind the ball
  double draw_swing = -0.5;    // so far back [rad]
  int draw_ticks = 0;          // and strikes after so many ticks,
  double strike_shift = 0.0;   // so far from where it was set up [m]
  double strike_offset = 0.0;  // aimed beside the rolling ball's centre by this [m]
};

class StrokeRun {
 public:
  enum class Phase { push, draw, strike, over };

  // From where the hand has set the foot up.
  void begin(const Stroke& stroke, const HandAxis& slide, double level);
  Phase phase() const { return phase_; }
  Stroke& stroke() { return stroke_; }
  // One tick; the strike's instant is late by `late` ticks (motor noise).
  void step(HandAxis& slide, HandAxis& swing, const Temperament& t, int late);

 private:
  void strike(HandAxis& slide, HandAxis& swing, const Temperament& t);

  Stroke stroke_;
  Phase phase_ = Phase::over;
  int ticks_ = 0;  // in this phase
  double from_ = 0.0, level_ = 0.0;
};

// By eye: the offset that sends the ball along the tangent `slope`, for a foot's half width. A flat
// foot sends the ball straight on; its edge, at an angle a from the axis of play, touches the ball
// r sin a beyond the foot's side.
double edge_offset(double slope, double half_foot, double ball_radius);

// A ball far ahead is met by a foot already rising, which would lift it off the table: the further
// ahead [m], the softer, so that the part of the speed that goes upwards stays small.
double power_at(const TableSpec& table, double ahead);

}  // namespace foosball
