#include "computer_rod.h"

#include <algorithm>
#include <cmath>

namespace foosball {
namespace {

// Swings [rad] from the hanging foot, forward positive.
constexpr double kLifted = -1.57;     // back, out of the way of a ball from behind
constexpr double kDrawn = -0.95;      // behind the ball; the sole is then above it
constexpr double kDrawnOver = -1.25;  // ... and clear of a ball that lies under it
constexpr double kSoleAbove = 1.05;   // |swing| from which the sole is above a ball on the field
constexpr double kFoot = 0.073;       // axis to sole [m]

// Where a ball can be played, ahead of the axis [m]: from just behind the hanging foot to as far as
// the foot still meets the ball below its top.
constexpr double kFrom = -0.030, kTo = 0.058;
constexpr double kScoopFrom = -0.062;    // a ball at rest behind the foot is scooped forward:
constexpr double kScoopTo = -0.030;      // struck from above it would only be pinned, or fly back
constexpr double kScoopBeside = 0.0115;  // by the foot's edge, so far beyond the foot [m],
constexpr double kScoopLeast = 4.0, kScoopMost = 12.0;  // and so gently [rad/s]

constexpr double kBesideFoot = 0.032;  // [m] ahead of the axis

// Faster balls [m/s] are blocked, not played.
constexpr double kTameApproach = 0.6, kTame = 1.6, kResting = 0.15;

// A hand that follows the ball holds still for less than this, and turns round no sooner than that
// unless it has far to go.
constexpr double kCalm = 0.9;       // a ball that rolls along the rods faster is not followed [m/s]
constexpr double kStill = 0.012;    // [m]
constexpr double kTurnWait = 0.30;  // [s]
constexpr double kFar = 0.060;      // [m]
constexpr double kClose = 0.004;    // of a ball that comes soon [m]

// A ball far ahead is met by a foot already rising, which would lift it off the table: the further
// ahead [m], the softer.
double power_at(const TableSpec& table, double ahead) {
  constexpr double kLift = 0.11;  // upward share of a full strike that still stays on the table
  constexpr double kLeast = 0.4;
  const double rise = std::max(0.0, ahead - 0.010 - table.ball_radius);
  const double arm = table.rod_height - table.ball_radius;
  const double sine = rise / std::sqrt(rise * rise + arm * arm);
  return sine > kLift ? std::max(kLeast, kLift / sine) : 1.0;
}

// From the drawn foot to the hit [s].
double strike_time(const AxisLimits& strike) {
  const double way = -kDrawn;
  const double gathering = 0.5 * strike.rate * strike.rate / strike.acceleration;
  constexpr double kLag = 0.001;
  if (way < gathering) return kLag + std::sqrt(2.0 * way / strike.acceleration);
  return kLag + strike.rate / strike.acceleration + (way - gathering) / strike.rate;
}

}  // namespace

ComputerRod::ComputerRod(const TableSpec& table, int team, int index, const LaneView& lanes)
    : table_(&table),
      team_(team),
      index_(index),
      x_(attack_sign(team) * table.rods[static_cast<std::size_t>(index)].x),
      lanes_(lanes) {
  lanes_.team = team;
  lanes_.from_rod = index;
}

double ComputerRod::level() const {
  return 2.0 * vp::kPi * std::floor(swing_.position() / (2.0 * vp::kPi) + 0.5);
}

double ComputerRod::angle() const {
  return swing_.position() - level();
}

void ComputerRod::adopt(double slide, double swing) {
  slide_.adopt(slide);
  swing_.adopt(swing);
  goal_ = slide;
  enter(Act::watch);
}

void ComputerRod::rest() {
  adopt(slide_.position(), swing_.position());
}

void ComputerRod::enter(Act act) {
  act_ = act;
  since_ = 0.0;
}

void ComputerRod::play(const Sighting& now, double guard_y, const Temperament& t, Random& random) {
  since_ += kTick;
  turned_ += kTick;
  switch (act_) {
    case Act::watch:
      watch(now, guard_y, t, random);
      break;
    case Act::draw:
      draw(now, t, random);
      break;
    case Act::strike:
      strike(t);
      break;
    case Act::brake:
      brake(t);
      break;
    case Act::scoop:
      swing_.move(level(), {scoop_rate_, t.swing.acceleration});
      if (angle() > -0.02 || since_ > 0.5) enter(Act::watch);
      break;
  }
  goal_ = std::clamp(goal_, -spec().slide_limit, spec().slide_limit);
  slide_.move(goal_, t.slide);
}

// --- guarding ------------------------------------------------------------------------------------

void ComputerRod::watch(const Sighting& now, double guard_y, const Temperament& t, Random& random) {
  if (!now.ball_in_play) {
    follow(0.0);
    swing_.move(level(), t.swing);
    return;
  }
  if (can_control(now)) return begin_control(now, t, random);
  // The nearer in time a ball that comes, the closer it is followed.
  const bool comes = now.velocity.x < -0.3 && ahead(now) > 0.0;
  constexpr double kSoon = 0.20;  // [s]
  const bool soon = comes && ahead(now) < -kSoon * now.velocity.x + 0.03;
  const double to = slide_for(guard_y);
  if (soon) {
    if (std::fabs(to - goal_) > kClose) goal_ = to;
  } else if (std::fabs(now.velocity.y) < kCalm) {
    follow(to);
  }
  constexpr double kBehind = -0.045;  // [m]
  const double goal = level() + (ahead(now) < kBehind ? kLifted : 0.0);
  if (goal < swing_.position()) {
    swing_back(goal, now, t.swing);
  } else {
    swing_.move(goal, t.swing);
  }
}

double ComputerRod::slide_for(double y, int* man_out) const {
  double best = slide_.position();
  double least = 1e9;
  for (int man = 0; man < spec().men; ++man) {
    const double wanted = y - man_offset(spec(), man);
    const double slide = std::clamp(wanted, -spec().slide_limit, spec().slide_limit);
    const double cost = 10.0 * std::fabs(wanted - slide) + std::fabs(slide - slide_.position());
    if (cost >= least) continue;
    least = cost;
    best = slide;
    if (man_out != nullptr) *man_out = man;
  }
  return best;
}

// Brings the rod to where it is wanted as a calm hand does: not for a few millimetres, and not to
// and fro.
void ComputerRod::follow(double goal) {
  const double position = slide_.position();
  const double off = goal - position;
  const bool moving = std::fabs(goal_ - position) > 0.001;
  if (!moving && std::fabs(off) <= kStill) return;
  const bool turns = off * (goal_ - position) < 0.0 || (!moving && off * slide_.rate() <= 0.0);
  if (turns && std::fabs(off) <= kFar && turned_ <= kTurnWait) return;
  if (turns) turned_ = 0.0;
  goal_ = goal;
}

// --- the foot and the ball -----------------------------------------------------------------------

// Swings back to the goal, but only while no ball is in the sweep: else the men step aside first.
void ComputerRod::swing_back(double goal, const Sighting& now, const AxisLimits& limits) {
  if (!ball_in_sweep(goal, now)) return swing_.move(goal, limits);
  swing_.move(swing_.position(), limits);
  step_aside(now);
}

// Whether a foot on its way back to the goal could meet the ball from before it.
bool ComputerRod::ball_in_sweep(double goal, const Sighting& now) const {
  constexpr double kHigh = 0.10;  // [m]
  if (!now.ball_in_play || now.ball.z > kHigh) return false;
  const double hang = level();
  const auto foot =
      [&](double swing) {  // ahead of the axis; the sine's series, the same everywhere
        const double s = std::clamp(swing - hang, -kSoleAbove, kSoleAbove);
        return kFoot * s * (1.0 - s * s / 6.0 * (1.0 - s * s / 20.0));
      };
  const double front = foot(swing_.position()) + 0.012;
  const double back = foot(goal) - table_->ball_radius - 0.012;
  for (const double lead : {0.0, 0.03, 0.06}) {  // [s]
    const double way = ahead(now) + lead * now.velocity.x;
    if (way > front || way < back) continue;
    const double y = y_after(*table_, now.ball.y, now.velocity.y, lead);
    for (int man = 0; man < spec().men; ++man) {
      if (std::fabs(man_y(man) - y) < clear(now)) return true;
    }
  }
  return false;
}

// Beside a ball by this, a foot passes it [m].
double ComputerRod::clear(const Sighting& now) const {
  return lanes_.half_foot[team_] + table_->ball_radius + 0.008 + 0.02 * std::fabs(now.velocity.y);
}

void ComputerRod::step_aside(const Sighting& now) {
  int man = 0;
  for (int other = 1; other < spec().men; ++other) {
    if (std::fabs(man_y(other) - now.ball.y) < std::fabs(man_y(man) - now.ball.y)) man = other;
  }
  const double aside = lanes_.half_foot[team_] + table_->ball_radius + 0.018;  // [m]
  const double off = man_y(man) - now.ball.y;
  const double side = std::copysign(aside, off == 0.0 ? -now.ball.y : off);
  double goal = slide_.position() - off + side;
  if (std::fabs(goal) > spec().slide_limit) goal -= 2.0 * side;
  goal_ = goal;
}

// --- playing the ball ----------------------------------------------------------------------------

bool ComputerRod::can_control(const Sighting& now) const {
  const double way = ahead(now);
  const double speed = vp::norm(now.velocity);
  if (now.ball.z > 2.5 * table_->ball_radius || speed > kTame) return false;
  if (now.velocity.x < -kTameApproach) return false;
  const double from = speed < kResting ? kScoopFrom : kFrom;
  if (way <= from || way >= kTo) return false;
  int man = 0;
  const double slide = slide_for(now.ball.y, &man);
  return std::fabs(man_offset(spec(), man) + slide - now.ball.y) < 0.02;
}

void ComputerRod::begin_control(const Sighting& now, const Temperament& t, Random& random) {
  slide_for(now.ball.y, &man_);
  over_ = false;
  worth_ = -1e9;
  pause_ = random.between(t.pause_low, t.pause_high);
  noise_ = t.aim_error * random.bell();
  feints_ = random.unit() < t.feint;
  scoop_side_ = 0.0;
  enter(Act::draw);
  draw(now, t, random);
}

bool ComputerRod::lost(const Sighting& now) const {
  const double way = ahead(now);
  return !now.ball_in_play || way < kScoopFrom - 0.01 || way > kTo + 0.012 ||
         vp::norm(now.velocity) > 1.5 * kTame;
}

// The foot goes back behind the ball; then it waits for a lane, follows the ball and strikes.
void ComputerRod::draw(const Sighting& now, const Temperament& t, Random& random) {
  if (lost(now)) return enter(Act::watch);
  const double y = y_after(*table_, now.ball.y, now.velocity.y, strike_time(t.strike));
  const double square = y - man_offset(spec(), man_);
  const bool hooked = ahead(now) < 0.5 * table_->ball_radius;
  const double drawn = level() + (hooked ? kDrawnOver : kDrawn);
  if (!over_) return go_behind(now, square, drawn, t);
  swing_.move(drawn, t.swing);
  if (ahead(now) < kScoopTo) return prepare_scoop(square, random);
  consider_lanes(now, square, t);
  goal_ = square + noise_ +
          foot_offset(slope_ - natural_slope(now, t), lanes_.half_foot[team_], ahead(now));
  constexpr double kFeintStep = 0.035, kFeintFor = 0.15;  // [m], [s]: as if to play it elsewhere
  if (feints_ && since_ < pause_ + kFeintFor) {
    goal_ -= std::copysign(kFeintStep, slope_);
  } else if (since_ >= pause_) {
    strike_if_ready(now, t);
  }
}

// A foot that hangs beside the ball would push it away: it goes up before it comes near.
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

void ComputerRod::prepare_scoop(double square, Random& random) {
  if (scoop_side_ == 0.0) {
    scoop_side_ = random.unit() < 0.5 ? -1.0 : 1.0;
    scoop_rate_ = random.between(kScoopLeast, kScoopMost);
  }
  goal_ = square + noise_ + scoop_side_ * (lanes_.half_foot[team_] + kScoopBeside);
  if (std::fabs(goal_) > spec().slide_limit) scoop_side_ = -scoop_side_;
  if (std::fabs(goal_ - slide_.position()) < 0.002) enter(Act::scoop);
}

// All lanes now and then; whether the chosen one closes, more often.
void ComputerRod::consider_lanes(const Sighting& now, double square, const Temperament& t) {
  const int ticks = static_cast<int>(since_ / kTick);
  if (worth_ < -1e8 || ticks % 20 == 0) {
    choose_lane(now, square, t);
  } else if (ticks % 4 == 0) {
    worth_ = worth_of(now, slope_, t);
  }
}

void ComputerRod::strike_if_ready(const Sighting& now, const Temperament& t) {
  const double way = ahead(now);
  if (way > kTo - 0.004 && now.velocity.x > -0.05) return;  // the foot would miss it
  const bool aligned = std::fabs(goal_ - slide_.position()) < std::max(0.001, 0.5 * t.aim_error);
  const double bar = t.shot_bar * (1.0 - (since_ - pause_) / t.patience);
  constexpr double kLate = 0.5;  // [s] beyond the patience, then strike at what there is
  if (!(aligned && worth_ >= bar) && since_ <= pause_ + t.patience + kLate) return;
  constexpr double kShot = 0.25;  // worth from which it is a shot at goal
  power_ = power_at(*table_, way) * (worth_ < kShot ? t.clear_power : 1.0);
  enter(Act::strike);
}

// The slope at which a flat foot sends off a ball that rolls along the rod: it keeps most of that.
double ComputerRod::natural_slope(const Sighting& now, const Temperament& t) const {
  constexpr double kKept = 0.77, kSpeed = 0.11;  // ball's speed [m/s] for the foot's [rad/s]
  return kKept * now.velocity.y / (kSpeed * t.strike.rate);
}

double ComputerRod::worth_of(const Sighting& now, double slope, const Temperament& t) const {
  constexpr double kFlatError = 0.012, kEdge = 50.0;  // slope for a metre beside where it should be
  constexpr double kFlat = 0.01;
  constexpr double kBelieved = 0.0015;  // who aims worse does not know it [m]
  LaneView lanes = lanes_;
  const bool flat = std::fabs(slope - natural_slope(now, t)) < kFlat;
  lanes.slope_error = flat ? kFlatError : kFlatError + kEdge * std::min(t.aim_error, kBelieved);
  return lane_worth(*table_, now, lanes, slope);
}

void ComputerRod::choose_lane(const Sighting& now, double square, const Temperament& t) {
  constexpr double kStep = 0.05, kKeep = 0.05;
  const double wall = 0.5 * table_->width - table_->ball_radius - 0.02;  // it would only rub along
  const double natural = natural_slope(now, t);
  const bool first = worth_ < -1e8;
  double slope = natural, best = worth_of(now, slope, t);
  if (!first && std::fabs(slope_ - natural) < kStep) best += kKeep;
  for (int k = -15; k <= 15; ++k) {
    const double s = kStep * k;
    if (std::fabs(s - natural) < kStep || std::fabs(s - natural) > kSteepest) continue;
    const double offset = foot_offset(s - natural, lanes_.half_foot[team_], ahead(now));
    if (std::fabs(square + offset) > spec().slide_limit) continue;
    if (s * now.ball.y > 0.0 && std::fabs(now.ball.y) > wall) continue;
    double worth = worth_of(now, s, t);
    if (!first && std::fabs(s - slope_) < 1e-9) worth += kKeep;
    if (worth > best) {
      best = worth;
      slope = s;
    }
  }
  slope_ = slope;
  worth_ = best;
}

void ComputerRod::strike(const Temperament& t) {
  swing_.swing(level() + 2.0, {power_ * t.strike.rate, t.strike.acceleration});
  if (swing_.position() > level() + 0.08) {
    const double speed = 0.11 * power_ * t.strike.rate;
    sent_ = {speed, slope_ * speed, 0.0};
    enter(Act::brake);
  }
}

void ComputerRod::brake(const Temperament& t) {
  swing_.brake(t.strike);
  if (swing_.rate() <= 0.0) enter(Act::watch);
}

}  // namespace foosball
