#include "computer_stroke.h"

#include <algorithm>
#include <cmath>

namespace foosball {
namespace {

// Distance of the ball behind the point where a hanging foot would meet it [m]. The larger it is,
// the more the stroke comes from above and presses the ball onto the field.
double behind(const Foot& foot, const TableSpec& table, double ahead) {
  return std::clamp(foot.half_depth + table.ball_radius - ahead, 0.0, 0.055);
}

}  // namespace

Foot foot_of(const CharacterBody& body) {
  return {0.5 * body.foot_width, 0.5 * body.foot_depth};
}

double contact_swing(const TableSpec& table, const Foot& foot, double ahead) {
  // Solves ahead * cos(s) - height * sin(s) = half_depth + radius by Newton's method. Sine and
  // cosine are series, identical on all platforms.
  const double height = table.rod_height - table.ball_radius;
  const double away = foot.half_depth + table.ball_radius;
  double s = (ahead - away) / height;
  for (int step = 0; step < 3; ++step) {
    const double s2 = s * s;
    const double sine = s * (1.0 - s2 / 6.0 * (1.0 - s2 / 20.0));
    const double cosine = 1.0 - s2 / 2.0 * (1.0 - s2 / 12.0);
    s += (ahead * cosine - height * sine - away) / (ahead * sine + height * cosine);
  }
  return std::clamp(s, -1.0, 0.6);
}

double stroke_time(double from, double contact, const AxisLimits& stroke) {
  constexpr double kLag = 0.0013;  // [s]: a tick until the hand moves, and the foot's delay
  constexpr double kEarly = 0.04;  // [rad]: the ball leaves before the contact swing is reached
  const double distance = std::max(0.0, contact - kEarly - from);
  const double gathering = 0.5 * stroke.rate * stroke.rate / stroke.acceleration;
  if (distance < gathering) return kLag + std::sqrt(2.0 * distance / stroke.acceleration);
  return kLag + stroke.rate / stroke.acceleration + (distance - gathering) / stroke.rate;
}

bool lifts_ball(const Foot& foot, const TableSpec& table, const Meeting& meeting) {
  constexpr double kRise = 0.001;  // [m]
  return meeting.ahead > foot.half_depth + table.ball_radius + kRise;
}

double stroke_speed(const Foot& foot, const TableSpec& table, const Meeting& meeting) {
  constexpr double kSpeed = 0.110, kSoft = 0.090;  // [m/s] per [rad/s] of the stroke
  constexpr double kSoftRate = 30.0;               // [rad/s]
  constexpr double kPressed = 120.0;               // [1/m^2]
  const double d = behind(foot, table, meeting.ahead);
  return (meeting.rate < kSoftRate ? kSoft : kSpeed) * meeting.rate * (1.0 - kPressed * d * d);
}

double natural_slope(const Foot& foot, const TableSpec& table, const Meeting& meeting, double vy) {
  const double d = behind(foot, table, meeting.ahead);
  const double kept = 0.73 - d * (3.5 + 65.0 * d);
  return kept * vy / stroke_speed(foot, table, meeting);
}

double foot_offset(const Foot& foot, const TableSpec& table, const Meeting& meeting, double slope) {
  // An edge at distance u from the centre deflects the ball by the slope 49/m u + 6.1e4/m^3 u^3;
  // more if the stroke comes from above.
  constexpr double kTurn = 49.0, kCubic = 6.1e4;
  const double d = behind(foot, table, meeting.ahead);
  const double steeper = 1.0 + d * d * (120.0 + 29000.0 * d * d);
  const double turn = std::min(std::fabs(slope), kSteepest) / steeper;
  if (std::fabs(slope) < kFlatSlope) return 0.0;
  double u = turn / kTurn;
  for (int step = 0; step < 3; ++step) {
    u -= (u * (kTurn + kCubic * u * u) - turn) / (kTurn + 3.0 * kCubic * u * u);
  }
  return -std::copysign(foot.half_width + u, slope);
}

}  // namespace foosball
