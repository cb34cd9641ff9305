#include "computer_stroke.h"

#include <algorithm>
#include <cmath>

namespace foosball {

void StrokeRun::begin(const Stroke& stroke, const HandAxis& slide, double level) {
  stroke_ = stroke;
  phase_ = stroke.beside ? Phase::push : Phase::strike;
  ticks_ = 0;
  from_ = slide.position();
  level_ = level;
}

void StrokeRun::step(HandAxis& slide, HandAxis& swing, const Temperament& t, int late) {
  ++ticks_;
  switch (phase_) {
    case Phase::push:
      slide.move(from_ + stroke_.push, {stroke_.push_rate, t.slide.acceleration});
      swing.move(level_ + stroke_.beside_swing, t.swing);
      if (ticks_ >= stroke_.push_ticks) phase_ = Phase::draw, ticks_ = 0;
      break;
    case Phase::draw:
      slide.move(from_ + stroke_.strike_shift, t.slide);
      swing.move(level_ + stroke_.draw_swing, t.swing);
      if (ticks_ >= stroke_.draw_ticks + late) phase_ = Phase::strike, ticks_ = 0;
      break;
    case Phase::strike:
      strike(slide, swing, t);
      break;
    case Phase::over:
      break;
  }
}

void StrokeRun::strike(HandAxis& slide, HandAxis& swing, const Temperament& t) {
  slide.move(from_ + (stroke_.beside ? stroke_.strike_shift : 0.0), t.slide);
  swing.swing(level_ + 2.0, {stroke_.power * t.strike_rate, t.strike_acceleration});
  if (swing.position() > level_ + kThrough) phase_ = Phase::over;
}

double edge_offset(double slope, double half_foot, double ball_radius) {
  const double sine = slope / std::sqrt(1.0 + slope * slope);
  if (std::fabs(sine) < 0.04) return 0.0;
  return -std::copysign(half_foot + ball_radius * std::fabs(sine), sine);
}

double power_at(const TableSpec& table, double ahead) {
  constexpr double kLift = 0.11;  // upward share of a full strike that still stays on the table
  constexpr double kLeast = 0.25;
  const double rise = std::max(0.0, ahead - 0.010 - table.ball_radius);
  const double arm = table.rod_height - table.ball_radius;
  const double sine = rise / std::sqrt(rise * rise + arm * arm);
  return sine > kLift ? std::max(kLeast, kLift / sine) : 1.0;
}

}  // namespace foosball
