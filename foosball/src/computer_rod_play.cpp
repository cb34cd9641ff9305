// The rod with the ball: it draws a foot behind the ball, waits for a lane, aims and strikes,
// passes, or scoops a ball forward from behind its feet.
#include <algorithm>
#include <array>
#include <cmath>

#include "computer_rod.h"

namespace foosball {
namespace {

// Swings [rad] relative to the hanging foot, forward positive.
constexpr double kDrawn = -0.95;      // behind the ball, with the sole above it
constexpr double kDrawnOver = -1.25;  // ... and clear of a ball under it

// Range in which a ball can be played, ahead of the axis [m]: from just behind the hanging foot to
// where the foot can still meet the ball below its top.
constexpr double kFrom = -0.030, kTo = 0.058;
constexpr double kScoopFrom = -0.062;    // a ball at rest behind the foot is scooped forward:
constexpr double kScoopTo = -0.030;      // a strike from above would pin it, or send it back
constexpr double kScoopBeside = 0.0115;  // distance of the ball's centre beyond the foot's edge [m]
constexpr double kScoopMin = 2.0, kScoopMax = 4.0;  // rate of the swing [rad/s]
constexpr double kHookFrom = -0.042;  // a ball less far behind leaves at a known slope
struct Hook {
  double beside, rate;  // [m], [rad/s]
  double slope, speed;  // of the ball; [m/s]
};
// Measured on the simulated table, both layouts, with a ball 30 to 40 mm behind the axis.
constexpr std::array<Hook, 2> kHooks{{{0.005, 20.0, 0.48, 1.6}, {0.008, 35.0, 0.72, 2.4}}};

constexpr double kPassSpeed = 2.2;   // [m/s]
constexpr double kCatch = 0.6;       // a foot tilted forward holds a ball from behind
constexpr double kPassRate = 24.4;   // [rad/s], gives kPassSpeed
constexpr double kHookPower = 0.11;  // ball speed [m/s] per swing rate [rad/s]

constexpr double kBesideFoot = 0.032;  // [m] ahead of the axis

constexpr double kResting = 0.15;  // [m/s]
constexpr double kSettled = 0.05;  // [rad], tolerance of the drawn swing

}  // namespace

// --- playing the ball ----------------------------------------------------------------------------

// The fastest ball from the front [m/s] that is played without stopping it first: it can roll
// through under a foot that is drawn back. The goalie has nobody behind; hinged men strike a
// rolling ball less reliably.
double ComputerRod::approach() const {
  const bool careful =
      spec().line == Line::goalie || (spec().line == Line::defence && hinged_men(table_->layout));
  return careful ? judgment_.stop_first : judgment_.tame_approach;
}

bool ComputerRod::can_control(const Sighting& now) const {
  const double distance = ahead(now);
  const double speed = vp::norm(now.velocity);
  if (now.ball.z > 2.5 * table_->ball_radius || speed > judgment_.tame_speed) return false;
  if (now.velocity.x < -approach()) return false;
  const double from = speed < kResting ? kScoopFrom : kFrom;
  if (distance <= from || distance >= kTo) return false;
  int man = 0;
  const double slide = slide_for(now.ball.y, &man);
  return std::fabs(man_offset(spec(), man) + slide - now.ball.y) < 0.02;
}

void ComputerRod::begin_control(const Sighting& now, const Temperament& t, Random& random) {
  slide_for(now.ball.y, &man_);
  over_ = planted_ = false;
  worth_ = -1e9;
  pause_ = random.between(t.pause_low, t.pause_high);
  noise_ = t.aim_error * random.bell();
  feints_ = random.unit() < judgment_.feint;
  scoop_side_ = 0.0;
  pass_ = {};
  receives_ = 0;
  enter(Act::draw);
  draw(now, t, random);
}

bool ComputerRod::lost(const Sighting& now) const {
  const double distance = ahead(now);
  const bool rolls_home = spec().line == Line::goalie && now.velocity.x < -judgment_.stop_first;
  if (rolls_home && (distance < 0.0 || !over_)) return true;
  return !now.ball_in_play || distance < kScoopFrom - 0.01 || distance > kTo + 0.012 ||
         vp::norm(now.velocity) > 1.5 * judgment_.tame_speed;
}

// Where and when a stroke that starts now meets the ball.
Meeting ComputerRod::meeting(const Sighting& now, double rate, const Temperament& t) const {
  Meeting m{0.0, ahead(now), now.ball.y, rate};
  for (int step = 0; step < 2; ++step) {  // time and position depend on each other
    m.time = stroke_time(std::min(angle(), kDrawn + kSettled),
                         contact_swing(*table_, foot_, m.ahead), {m.rate, t.strike.acceleration});
    m.ahead = ahead(now) + m.time * now.velocity.x;
  }
  m.y = y_after(*table_, now.ball.y, now.velocity.y, m.time);
  return m;
}

// Rate of the chosen pass or shot. A clearance is played with reduced power.
double ComputerRod::chosen_rate(const Temperament& t) const {
  if (pass_.rod >= 0) return kPassRate;
  const bool clears = worth_ > -1e8 && worth_ < judgment_.clear_below;
  return t.strike.rate * (clears ? judgment_.clear_power : 1.0);
}

// The slide that brings the man with the ball to it, or another man if he cannot reach it.
double ComputerRod::square_to(const Meeting& m) {
  constexpr double kBeyond = 0.004;  // [m]
  if (std::fabs(m.y - man_offset(spec(), man_)) > spec().slide_limit + kBeyond) {
    slide_for(m.y, &man_);
  }
  return m.y - man_offset(spec(), man_);
}

// The foot moves behind the ball. Then it waits for a lane, follows the ball and strikes.
void ComputerRod::draw(const Sighting& now, const Temperament& t, Random& random) {
  if (lost(now)) return enter(Act::watch);
  const Meeting m = meeting(now, chosen_rate(t), t);
  const double square = square_to(m);
  const bool hooked = ahead(now) < 0.5 * table_->ball_radius;
  const double drawn = level() + (hooked ? kDrawnOver : kDrawn);
  if (!over_) return go_behind(now, square, drawn, t);
  swing_.move(drawn, t.swing);
  if (ahead(now) < kScoopTo) return prepare_scoop(now, square, t, random);
  scoop_side_ = 0.0;
  consider_lanes(now, t);
  // At the wall only a part of the foot meets the ball.
  const double limit = spec().slide_limit;
  const double turn = slope_ - natural_slope(foot_, *table_, m, now.velocity.y);
  const double aim =
      std::clamp(square + noise_ + foot_offset(foot_, *table_, m, turn), -limit, limit);
  constexpr double kFeintStep = 0.035, kFeintFor = 0.15;  // [m], [s]: offset in another direction
  if (feints_ && since_ < pause_ + kFeintFor) {
    goal_ = aim - side_of(slope_) * kFeintStep;
  } else {
    wait_for_ball(now, m, aim, t);
  }
}

// A sliding foot meets the ball at an uncertain place. So it stops ahead of a ball that rolls along
// the rod, and strikes when the ball arrives.
void ComputerRod::wait_for_ball(const Sighting& now, const Meeting& m, double aim,
                                const Temperament& t) {
  constexpr double kLead = 0.020;                     // [s]
  constexpr double kNear = 0.0005, kSurely = 0.0015;  // [m]
  const double vy = now.velocity.y;
  const double left = (goal_ - aim) * side_of(vy);  // remaining distance of the ball [m]
  const bool over = left < -kSurely || left > 2.0 * kLead * std::fabs(vy) + kSurely;
  if (planted_ && over) planted_ = false;
  if (!planted_) {
    goal_ = std::clamp(aim + kLead * vy, -spec().slide_limit, spec().slide_limit);
    planted_ = std::fabs(goal_ - slide_.position()) < std::max(0.001, 0.5 * t.aim_error);
  }
  if (since_ < pause_) return;
  const bool there = planted_ && (goal_ - aim) * side_of(vy) < kNear;
  strike_if_ready(now, m, there, t);
}

// A hanging foot beside the ball would push it away: it swings up before it comes near.
void ComputerRod::go_behind(const Sighting& now, double square, double drawn,
                            const Temperament& t) {
  const bool beside =
      ahead(now) < kBesideFoot && std::fabs(square - slide_.position()) > clear(now);
  goal_ = beside ? slide_.position() : square;
  if (swing_.position() > drawn + 0.03) {
    swing_back(drawn, now, t.swing);
  } else {
    over_ = true;
  }
}

void ComputerRod::prepare_scoop(const Sighting& now, double square, const Temperament& t,
                                Random& random) {
  if (scoop_side_ == 0.0 || !can_stand_beside(square, scoop_side_, scoop_beside_)) {
    choose_hook(now, square, t, random);
  }
  goal_ = beside_ball(square);
  if (std::fabs(goal_ - slide_.position()) < 0.002 && since_ >= pause_) enter(Act::scoop);
}

// The slide at which the chosen edge of the foot meets the ball.
double ComputerRod::beside_ball(double square) const {
  return square + noise_ + scoop_side_ * (lanes_.half_foot[team_] + scoop_beside_);
}

bool ComputerRod::can_stand_beside(double square, double side, double beside) const {
  return std::fabs(square + noise_ + side * (lanes_.half_foot[team_] + beside)) <=
         spec().slide_limit;
}

// Chooses how to play a ball behind the foot: as a pass to a man further ahead, along one of the
// slopes of the foot's edge, or softly.
void ComputerRod::choose_hook(const Sighting& now, double square, const Temperament& t,
                              Random& random) {
  scoop_side_ = random.unit() < 0.5 ? -1.0 : 1.0;
  if (!can_stand_beside(square, scoop_side_, kScoopBeside)) scoop_side_ = -scoop_side_;
  scoop_rate_ = random.between(kScoopMin, kScoopMax);
  scoop_beside_ = kScoopBeside;
  pass_ = {};
  slope_ = 0.0;
  if (ahead(now) < kHookFrom || vp::norm(now.velocity) > kResting) return;
  const double error = slope_error(false, t);
  constexpr double kWorthIt = 0.03;  // minimum value; below it, softly
  double best = kWorthIt;
  const double first = scoop_side_;
  for (const double side : {first, -first}) {
    for (const Hook& hook : kHooks) {
      if (!can_stand_beside(square, side, hook.beside)) continue;
      const double slope = -side * hook.slope;
      const PassPlan pass = pass_worth(now, slope, hook.speed, error, t);
      if (pass.worth <= best) continue;
      best = pass.worth;
      pass_ = pass;
      scoop_side_ = side;
      scoop_rate_ = hook.rate;
      scoop_beside_ = hook.beside;
      slope_ = slope;
      power_ = hook.speed / (kHookPower * t.strike.rate);
    }
  }
}

// The foot follows a ball that rolls along the rod, which would otherwise get pinned under it.
void ComputerRod::scoop(const Sighting& now, const Temperament& t) {
  const bool hooks = pass_.rod >= 0;
  goal_ = beside_ball(now.ball.y - man_offset(spec(), man_));
  swing_.move(level(), {scoop_rate_, hooks ? t.strike.acceleration : t.swing.acceleration});
  stroke_ago_ = 0.0;
  if (angle() <= -0.02 && since_ <= 1.0) return;
  if (hooks) {
    const double speed = kHookPower * power_ * t.strike.rate;
    sent_ = {speed, slope_ * speed, 0.0};
    struck_ = true;
  }
  enter(Act::watch);
}

// --- passes --------------------------------------------------------------------------------------

void ComputerRod::expect_pass(int man, double y, double time) {
  constexpr double kWaits = 0.30;  // [s], margin on the expected time
  receives_ = static_cast<int>(std::lround((time + kWaits) / kTick));
  man_ = man;
  receive_at_ = y - man_offset(spec(), man);
}

// The man stands where the ball will arrive, tilted forward over it.
void ComputerRod::receive(const Sighting& now, const Temperament& t) {
  constexpr double kComes = 0.2;  // [m/s]
  if (now.velocity.x > kComes && ahead(now) < -0.03) {
    const double y =
        y_after(*table_, now.ball.y, now.velocity.y, (-0.01 - ahead(now)) / now.velocity.x);
    receive_at_ = y - man_offset(spec(), man_);
  }
  goal_ = receive_at_;
  swing_.move(level() + kCatch, t.swing);
}

PassPlan ComputerRod::pass_worth(const Sighting& now, double slope, double speed,
                                 double slope_error, const Temperament& t) const {
  const Line line = spec().line;
  constexpr double kAtRest = 0.45;  // [m/s]; a faster ball keeps too much of its velocity
  if (line == Line::goalie || line == Line::attack || vp::norm(now.velocity) > kAtRest) return {};
  PassView view;
  view.lanes = lanes_;
  view.lanes.slope_error = slope_error;
  const Line to = line == Line::defence ? Line::midfield : Line::attack;
  view.to_rod = rods_of_team(*table_, team_)[static_cast<std::size_t>(to)];
  view.speed = speed;
  view.hand = t.slide.rate;
  view.sure = judgment_.pass_sure;
  constexpr double kFromServe = 0.4;  // when no shot may score yet
  view.value = now.goal_counts ? judgment_.pass_value : std::max(kFromServe, judgment_.pass_value);
  return pass_along(*table_, now, view, slope);
}

// The sighting with the ball at the meeting point; the men stay where they are now.
Sighting ComputerRod::met(const Sighting& now, const Meeting& m) const {
  Sighting then = now;
  then.ball.x = x_ + m.ahead;
  then.ball.y = m.y;
  return then;
}

// Evaluates all lanes at intervals, and the chosen one more often: it may close.
void ComputerRod::consider_lanes(const Sighting& now, const Temperament& t) {
  const int ticks = static_cast<int>(since_ / kTick);
  if (worth_ < -1e8 || ticks % 20 == 0) {
    choose_lane(now, t);
  } else if (ticks % 4 == 0) {
    const bool passes = pass_.rod >= 0;
    const Meeting m = meeting(now, chosen_rate(t), t);
    const Sighting then = met(now, m);
    worth_ = passes ? pass_worth(then, slope_, kPassSpeed, slope_error(false, t), t).worth
                    : shot_worth(then, m, slope_, t);
  }
}

void ComputerRod::strike_if_ready(const Sighting& now, const Meeting& m, bool aligned,
                                  const Temperament& t) {
  if (m.ahead > kTo - 0.004 && now.velocity.x > -0.05) return;  // the foot would miss the ball
  const double bar = judgment_.shot_bar * (1.0 - (since_ - pause_) / judgment_.patience);
  if (!(aligned && worth_ >= bar) && since_ <= pause_ + judgment_.patience + judgment_.late) return;
  power_ = m.rate / t.strike.rate;
  // The stroke goes through the ball and a little beyond; the braking distance is subtracted.
  constexpr double kMin = 0.08, kBeyond = 0.20;  // [rad]
  const double rest = 0.5 * m.rate * m.rate / t.strike.acceleration;
  through_ = std::max(kMin, contact_swing(*table_, foot_, m.ahead) + kBeyond - rest);
  sends_ = stroke_speed(foot_, *table_, m);
  enter(Act::strike);
}

// Error of the slope with the flat of the foot or with its edge [1].
double ComputerRod::slope_error(bool flat, const Temperament& t) const {
  constexpr double kFlatError = 0.012, kEdge = 50.0;  // kEdge: per metre of lateral error
  return flat ? kFlatError : kFlatError + kEdge * std::min(t.aim_error, judgment_.aim_belief);
}

double ComputerRod::shot_worth(const Sighting& then, const Meeting& m, double slope,
                               const Temperament& t) const {
  LaneView lanes = lanes_;
  lanes.hops = lifts_ball(foot_, *table_, m);
  const double turn = slope - natural_slope(foot_, *table_, m, then.velocity.y);
  lanes.slope_error = slope_error(std::fabs(turn) < kFlatSlope, t);
  return lane_worth(*table_, then, lanes, slope);
}

// True if the rod can reach the offset, and the ball leaves the wall.
bool ComputerRod::can_turn(const Meeting& m, double slope, double natural) const {
  const double wall = 0.5 * table_->width - table_->ball_radius - 0.02;  // it would rub along
  if (std::fabs(slope - natural) > kSteepest) return false;
  const double offset = foot_offset(foot_, *table_, m, slope - natural);
  if (std::fabs(m.y - man_offset(spec(), man_) + offset) > spec().slide_limit) return false;
  return !(slope * m.y > 0.0 && std::fabs(m.y) > wall);
}

// Chooses the best shot, or the best pass if its value is higher.
void ComputerRod::choose_lane(const Sighting& now, const Temperament& t) {
  constexpr double kStep = 0.05;
  const double keep = judgment_.keep_lane;
  const bool first = worth_ < -1e8;
  const bool passed = pass_.rod >= 0;
  const Meeting shot = meeting(now, t.strike.rate, t);
  const Sighting shot_at = met(now, shot);
  const double natural = natural_slope(foot_, *table_, shot, now.velocity.y);
  double slope = natural, best = shot_worth(shot_at, shot, slope, t);
  if (!first && !passed && std::fabs(slope_ - natural) < kStep) best += keep;
  for (int k = -15; k <= 15; ++k) {
    const double s = kStep * k;
    if (std::fabs(s - natural) < kStep || !can_turn(shot, s, natural)) continue;
    double worth = shot_worth(shot_at, shot, s, t);
    if (!first && !passed && std::fabs(s - slope_) < 1e-9) worth += keep;
    if (worth > best) {
      best = worth;
      slope = s;
    }
  }
  PassPlan plan;
  const Meeting soft = meeting(now, kPassRate, t);
  const Sighting soft_at = met(now, soft);
  const double softly = natural_slope(foot_, *table_, soft, now.velocity.y);
  const bool rolls = !lifts_ball(foot_, *table_, soft);
  for (int k = -15; rolls && k <= 15; ++k) {
    const double s = kStep * k;
    if (!can_turn(soft, s, softly)) continue;
    const bool flat = std::fabs(s - softly) < kFlatSlope;
    const PassPlan pass = pass_worth(soft_at, s, kPassSpeed, slope_error(flat, t), t);
    const double kept = !first && passed && std::fabs(s - slope_) < 1e-9 ? keep : 0.0;
    if (pass.worth + kept <= best) continue;
    best = pass.worth + kept;
    plan = pass;
    slope = s;
  }
  pass_ = plan;
  slope_ = slope;
  worth_ = best;
}

void ComputerRod::strike(const Temperament& t) {
  swing_.swing(level() + 2.0, {power_ * t.strike.rate, t.strike.acceleration});
  if (swing_.position() > level() + through_) {
    sent_ = {sends_, slope_ * sends_, 0.0};
    struck_ = true;
    enter(Act::brake);
  }
}

void ComputerRod::brake(const Temperament& t) {
  swing_.brake(t.strike);
  stroke_ago_ = 0.0;
  if (swing_.rate() <= 0.0) enter(Act::watch);
}

}  // namespace foosball
