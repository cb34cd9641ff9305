#include "classic_tactics.h"

#include <algorithm>
#include <cmath>

namespace foosball {
namespace {

// Swings [rad], feet forward positive.
constexpr double kDrawn = -0.95;      // foot drawn back: its sole is above the ball
constexpr double kDrawnOver = -1.15;  // ... and clear of a ball under it
constexpr double kThrough = 0.80;     // end of a strike
constexpr double kLifted = 1.40;      // feet clear of a shot from behind

// Range in which a ball can be struck, ahead of the axis [m]: from just behind the hanging foot to
// where the foot can still meet the ball below its top.
constexpr double kStrikeFrom = -0.030, kStrikeTo = 0.058;
constexpr double kScrapeFrom = -0.062;  // a ball at rest behind the foot is hooked from above

// Faster balls [m/s] are blocked instead of struck.
constexpr double kTameApproach = 0.6, kTame = 1.6, kResting = 0.15;

// The feet of the widest and the narrowest character differ from this by 3 mm: the player does not
// know.
constexpr double kHalfFoot = 0.012;  // [m]
constexpr double kSteepest = 0.8;    // tangent of the most oblique shot considered

double lerp(double a, double b, double t) {
  return a + (b - a) * t;
}

// Minimum distance between the men in the way and the line from the ball to (goal line, target).
double clearance(const TableSpec& table, const Sighting& now, int team, double target) {
  const double run = 0.5 * table.length - now.ball.x;
  double min = 0.2;
  for (int rod = 0; rod < kRods; ++rod) {
    const RodSpec& spec = table.rods[rod];
    const double ahead = attack_sign(team) * spec.x - now.ball.x;
    const bool lifted = std::fabs(within_half_turn(now.swing[rod])) > 1.0;
    if (spec.team == team || ahead < 0.03 || lifted) continue;
    const double y = now.ball.y + (target - now.ball.y) * ahead / run;
    for (int man = 0; man < spec.men; ++man) {
      min = std::min(min, std::fabs(man_offset(spec, man) + now.slide[rod] - y));
    }
  }
  return min;
}

}  // namespace

Temper temper_of(double skill) {
  const double s = std::clamp(skill, 0.0, 1.0);
  return {.delay = lerp(0.25, 0.07, s),
          .aim_error = lerp(0.008, 0.0015, s),
          .pause_low = lerp(0.5, 0.05, s),
          .pause_high = lerp(1.2, 0.30, s),
          .slide = {lerp(0.6, 2.2, s), lerp(10.0, 45.0, s)},
          .swing = {lerp(10.0, 25.0, s), lerp(200.0, 900.0, s)},
          .strike = {lerp(40.0, 120.0, s), lerp(1500.0, 9000.0, s)}};
}

void RodTactics::adopt(double slide, double swing) {
  slide_.adopt(slide);
  swing_.adopt(swing);
  stance_ = Stance::watch;
}

double RodTactics::level() const {
  return 2.0 * vp::kPi * std::floor(swing_.position() / (2.0 * vp::kPi) + 0.5);
}

void RodTactics::play(const TableSpec& table, const Sighting& now, const Temper& temper,
                      Random& random) {
  since_ += kTick;
  const Stance before = stance_;
  switch (stance_) {
    case Stance::watch:
      watch(table, now, temper, random);
      break;
    case Stance::wind_up:
      wind_up(table, now, temper);
      break;
    case Stance::strike:
      strike(temper);
      break;
    case Stance::recover:
      recover(table, now, temper);
      break;
  }
  if (stance_ != before) since_ = 0.0;
  slide_.move(goal_slide_, temper.slide);
}

// --- guarding ------------------------------------------------------------------------------------

void RodTactics::watch(const TableSpec& table, const Sighting& now, const Temper& temper,
                       Random& random) {
  if (!now.ball_in_play) {
    goal_slide_ = 0.0;
    swing_.move(level(), temper.swing);
    return;
  }
  if (can_strike(table, now)) {
    take_aim(table, now, temper, random);
    stance_ = Stance::wind_up;
    return;
  }
  const bool behind = now.ball.x < x(table) + kStrikeFrom;
  goal_slide_ = slide_for(table, behind ? now.ball.y : guard_y(table, now));
  swing_to(table, now, level() + (behind ? kLifted : 0.0), temper.swing);
}

// A foot that comes down in front of the ball would drive it towards its own goal. With the ball in
// its way it comes down slowly enough to only rest against it.
void RodTactics::swing_to(const TableSpec& table, const Sighting& now, double goal,
                          const AxisLimits& limits) {
  constexpr double kGently = 2.0;  // [rad/s]; 0.15 m/s at the foot
  const bool comes_back = swing_.position() > goal + 0.05;
  const bool gently = comes_back && ball_before_foot(table, now);
  swing_.move(goal, {gently ? kGently : limits.rate, limits.acceleration});
}

bool RodTactics::ball_before_foot(const TableSpec& table, const Sighting& now) const {
  const double ahead = now.ball.x - x(table);
  const double reach = table.rod_height + table.ball_radius;
  if (!now.ball_in_play || ahead < -table.ball_radius || ahead > reach) return false;
  if (now.ball.z > 4.0 * table.ball_radius) return false;
  constexpr double kAir = 0.015;  // [m], margin for the delay of sight
  const RodSpec& rod = spec(table);
  for (int man = 0; man < rod.men; ++man) {
    const double beside = now.ball.y - man_offset(rod, man) - slide_.position();
    if (std::fabs(beside) < kHalfFoot + table.ball_radius + kAir) return true;
  }
  return false;
}

// Where a man should stand: in the path of an approaching ball, otherwise between ball and goal
// (goalie, defence) or level with the ball.
double RodTactics::guard_y(const TableSpec& table, const Sighting& now) const {
  const double ahead = now.ball.x - x(table);
  if (now.velocity.x < -0.4) {
    return y_after(table, now.ball.y, now.velocity.y, std::max(0.0, ahead) / -now.velocity.x);
  }
  const Line line = spec(table).line;
  if (line == Line::midfield || line == Line::attack) return now.ball.y;
  // Goalie and defence each shift to one side, so that together they cover the goal mouth.
  const double shade = line == Line::goalie ? 0.028 : -0.028;
  const double to_goal = now.ball.x + 0.5 * table.length;
  const double y = now.ball.y + (shade - now.ball.y) * ahead / to_goal;
  const double mouth = 0.5 * table.goal_width;
  return line == Line::goalie ? std::clamp(y, -mouth, mouth) : y;
}

// The slide that brings a man to y: the man who comes nearest to it, then the one with the shortest
// slide.
double RodTactics::slide_for(const TableSpec& table, double y) const {
  const RodSpec& rod = spec(table);
  double best = slide_.position();
  double min = 1e9;
  for (int man = 0; man < rod.men; ++man) {
    const double target = y - man_offset(rod, man);
    const double slide = std::clamp(target, -rod.slide_limit, rod.slide_limit);
    const double cost = 10.0 * std::fabs(target - slide) + std::fabs(slide - slide_.position());
    if (cost < min) {
      min = cost;
      best = slide;
    }
  }
  return best;
}

// --- striking ------------------------------------------------------------------------------------

bool RodTactics::can_strike(const TableSpec& table, const Sighting& now) const {
  const double ahead = now.ball.x - x(table);
  const double speed = vp::norm(now.velocity);
  if (now.ball.z > 2.5 * table.ball_radius || speed > kTame) return false;
  if (now.velocity.x < -kTameApproach) return false;
  const double from = speed < kResting ? kScrapeFrom : kStrikeFrom;
  return ahead > from && ahead < kStrikeTo;
}

// Chooses the least guarded of a few targets, and the foot's offset beside the ball. A flat foot
// sends the ball straight on. Its edge, for a direction at angle a from the axis of play, touches
// the ball r sin a beyond the foot's side.
void RodTactics::take_aim(const TableSpec& table, const Sighting& now, const Temper& temper,
                          Random& random) {
  const double run = 0.5 * table.length - now.ball.x;
  const double post = 0.5 * table.goal_width - table.ball_radius;
  double best = -1e9, tangent = 0.0;
  const auto consider = [&](double target) {
    const double slope = (target - now.ball.y) / run;
    if (std::fabs(slope) > kSteepest) return;
    const double on_goal = std::fabs(target) < post ? 0.03 : 0.0;
    const double worth = std::min(0.06, clearance(table, now, team_, target)) + on_goal -
                         0.02 * std::fabs(slope) + 0.01 * random.unit();
    if (worth > best) {
      best = worth;
      tangent = slope;
    }
  };
  consider(now.ball.y);
  for (const double share : {-0.9, -0.45, 0.0, 0.45, 0.9}) consider(share * post);

  const double sine = tangent / std::sqrt(1.0 + tangent * tangent);
  const bool flat = std::fabs(sine) < 0.04;
  aim_ = flat ? random.between(-0.6, 0.6) * kHalfFoot
              : -std::copysign(kHalfFoot + table.ball_radius * std::fabs(sine), sine);
  aim_ += temper.aim_error * random.bell();
  pause_ = random.between(temper.pause_low, temper.pause_high);
  // A ball beside or behind the foot: the foot steps aside, towards the centre, before it draws
  // back.
  const bool hooked = now.ball.x - x(table) < 0.5 * table.ball_radius;
  aside_ = hooked ? std::copysign(0.045, -now.ball.y) : 0.0;
}

void RodTactics::wind_up(const TableSpec& table, const Sighting& now, const Temper& temper) {
  const double ahead = now.ball.x - x(table);
  const bool lost = !now.ball_in_play || ahead < kScrapeFrom - 0.01 || ahead > kStrikeTo + 0.01 ||
                    vp::norm(now.velocity) > 1.5 * kTame;
  if (lost) {
    stance_ = Stance::recover;
    return;
  }
  const double drawn = level() + (aside_ == 0.0 ? kDrawn : kDrawnOver);
  const bool is_drawn = swing_.position() < drawn + 0.05;
  if (is_drawn) aside_ = 0.0;
  const bool aside_yet =
      std::fabs(now.slide[rod_] - slide_.position()) < 0.01 && since_ > 0.12;  // [s]
  constexpr double kLead = 0.03;  // [s], time from the decision to the hit
  const double ball_y = y_after(table, now.ball.y, now.velocity.y, kLead);
  goal_slide_ = slide_for(table, ball_y + (aside_ != 0.0 ? aside_ : aim_));
  if (aside_ == 0.0 || aside_yet) swing_.move(drawn, temper.swing);

  const bool aligned = std::fabs(goal_slide_ - slide_.position()) < 0.003;
  const bool ready = is_drawn && aligned && since_ > pause_;
  constexpr double kPatience = 0.6;  // [s] after the pause: then it strikes anyway
  if (ready || since_ > pause_ + kPatience) {
    stance_ = Stance::strike;
    power_ = power_for(table, ahead);
  }
}

// A ball far ahead is met by a foot that already rises, and would leave the table. The further
// ahead, the lower the power, so that the upward part of the speed stays small.
double RodTactics::power_for(const TableSpec& table, double ahead) const {
  constexpr double kLift = 0.11;  // upward fraction at full power that stays on the table
  constexpr double kMin = 0.25;
  const double rise = std::max(0.0, ahead - 0.010 - table.ball_radius);
  const double arm = table.rod_height - table.ball_radius;
  const double sine = rise / std::sqrt(rise * rise + arm * arm);
  return sine > kLift ? std::max(kMin, kLift / sine) : 1.0;
}

void RodTactics::strike(const Temper& temper) {
  swing_.swing(level() + 2.0, {power_ * temper.strike.rate, temper.strike.acceleration});
  if (swing_.position() > level() + kThrough) stance_ = Stance::recover;
}

void RodTactics::recover(const TableSpec& table, const Sighting& now, const Temper& temper) {
  swing_to(table, now, level(), temper.strike);
  if (std::fabs(swing_.position() - level()) < 0.1) stance_ = Stance::watch;
}

}  // namespace foosball
