#include "computer_rod.h"

#include <algorithm>
#include <cmath>

namespace foosball {
namespace {

// Swings [rad] relative to the hanging foot, forward positive.
constexpr double kLifted = -1.57;    // back, clear of a ball from behind
constexpr double kSoleAbove = 1.05;  // |swing| at which the sole is above a ball on the field
constexpr double kFoot = 0.073;      // axis to sole [m]

// While a hand follows an approaching ball, it ignores smaller errors [m].
constexpr double kClose = 0.004;

}  // namespace

ComputerRod::ComputerRod(const TableSpec& table, int team, int index, const LaneView& lanes,
                         const Foot& foot, const Judgment& judgment)
    : table_(&table),
      foot_(foot),
      team_(team),
      index_(index),
      x_(attack_sign(team) * table.rods[static_cast<std::size_t>(index)].x),
      judgment_(judgment),
      lanes_(lanes) {
  lanes_.team = team;
  lanes_.from_rod = index;
  lanes_.risk_cost = judgment.risk_cost;
  lanes_.feet_stay_up = judgment.feet_stay_up;
  lanes_.far_worth = judgment.far_worth;
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
  struck_ = false;
  receives_ = 0;
  stroke_ago_ = 1e9;
  adopt(slide_.position(), swing_.position());
}

void ComputerRod::enter(Act act) {
  act_ = act;
  since_ = 0.0;
}

void ComputerRod::play(const Sighting& now, double guard_y, const Temperament& t, Random& random) {
  since_ += kTick;
  turned_ += kTick;
  stroke_ago_ += kTick;
  struck_ = false;
  if (receives_ > 0) --receives_;
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
      scoop(now, t);
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
  if (receives_ > 0 && ahead(now) < 0.02) return receive(now, t);
  if (pinches(now)) return step_aside(now);
  // The sooner an approaching ball arrives, the more closely the rod follows it.
  const bool comes =
      now.velocity.x < -(spec().line == Line::goalie ? 0.08 : 0.3) && ahead(now) > 0.0;
  const bool soon = comes && ahead(now) < -judgment_.soon * now.velocity.x + 0.03;
  const double to = slide_for(guard_y);
  if (is_behind_feet(now) && angle() > -kSoleAbove) {
    goal_ = slide_.position();
  } else if (soon) {
    if (std::fabs(to - goal_) > kClose) goal_ = to;
  } else if (std::fabs(now.velocity.y) < judgment_.calm) {
    follow(to);
  }
  constexpr double kBehind = -0.045;  // [m]
  const double goal = level() + (ahead(now) < kBehind || is_behind_feet(now) ? kLifted : 0.0);
  if (goal < swing_.position()) {
    swing_back(goal, now, t.swing);
  } else {
    swing_.move(goal, t.swing);
  }
}

// A ball at rest above the field is pinned between a man and a wall.
bool ComputerRod::pinches(const Sighting& now) const {
  constexpr double kHigh = 0.045, kNear = 0.060;  // [m]
  return now.ball.z > kHigh && std::fabs(ahead(now)) < kNear && vp::norm(now.velocity) < 0.05;
}

// Feet that touched such a ball from the side would push it towards the own goal: they swing up
// first.
bool ComputerRod::is_behind_feet(const Sighting& now) const {
  constexpr double kFarthest = -0.075, kNearest = -0.012, kLow = 0.06;  // [m]
  return ahead(now) > kFarthest && ahead(now) < kNearest && now.ball.z < kLow;
}

double ComputerRod::slide_for(double y, int* man_out) const {
  double best = slide_.position();
  double min = 1e9;
  for (int man = 0; man < spec().men; ++man) {
    const double target = y - man_offset(spec(), man);
    const double slide = std::clamp(target, -spec().slide_limit, spec().slide_limit);
    const double cost = 10.0 * std::fabs(target - slide) + std::fabs(slide - slide_.position());
    if (cost >= min) continue;
    min = cost;
    best = slide;
    if (man_out != nullptr) *man_out = man;
  }
  return best;
}

// Moves the rod to its goal as a calm hand does: ignores errors of a few millimetres, and limits
// reversals.
void ComputerRod::follow(double goal) {
  const double position = slide_.position();
  const double off = goal - position;
  const bool moving = std::fabs(goal_ - position) > 0.001;
  if (!moving && std::fabs(off) <= judgment_.still) return;
  const bool turns = off * (goal_ - position) < 0.0 || (!moving && off * slide_.rate() <= 0.0);
  if (turns && std::fabs(off) <= judgment_.turn_far && turned_ <= judgment_.turn_wait) return;
  if (turns) turned_ = 0.0;
  goal_ = goal;
}

// --- the foot and the ball -----------------------------------------------------------------------

// Swings back to the goal while no ball is in the sweep; otherwise the men step aside first. After
// a stroke the foot stays where it is until the player has seen the result: a swing back could
// drive a missed ball towards the own goal.
void ComputerRod::swing_back(double goal, const Sighting& now, const AxisLimits& limits) {
  if (now.guessed && stroke_ago_ < now.age) return swing_.move(swing_.position(), limits);
  if (!ball_in_sweep(goal, now)) {
    return swing_.move(goal, {std::min(limits.rate, safe_rate(now)), limits.acceleration});
  }
  swing_.move(swing_.position(), limits);
  step_aside(now);
}

// Limit of the swing's rate [rad/s]. While the ball's position is uncertain, a foot that swings
// back may meet it: the rate is low enough not to drive it towards the own goal.
double ComputerRod::safe_rate(const Sighting& now) const {
  constexpr double kSure = 0.01, kReach = 0.09, kHigh = 0.10;  // [m]
  constexpr double kGently = 3.0, kFreely = 1e3;
  // A slow ball may have reversed. For a fast ball the feet must be up in time.
  constexpr double kSlow = 1.5;                               // [m/s]
  constexpr double kDoubtOfSlow = 0.20, kDoubtOfFast = 0.05;  // upper bounds [m]
  const bool slow = vp::norm(now.velocity) < kSlow;
  const double doubt = std::min(now.doubt, slow ? kDoubtOfSlow : kDoubtOfFast);
  const double foot = kFoot * std::clamp(angle(), 0.0, 1.0);  // ahead of the axis [m]
  const bool may_meet = ahead(now) < foot + doubt && ahead(now) > -kReach - doubt;
  return doubt > kSure && may_meet && now.ball.z < kHigh ? kGently : kFreely;
}

// True if a foot that swings back to the goal could meet the ball from the front.
bool ComputerRod::ball_in_sweep(double goal, const Sighting& now) const {
  constexpr double kHigh = 0.10;  // [m]
  if (!now.ball_in_play || now.ball.z > kHigh) return false;
  const double hang = level();
  // Distance of the foot ahead of the axis. The sine is a series, identical on all platforms.
  const auto foot = [&](double swing) {
    const double s = std::clamp(swing - hang, -kSoleAbove, kSoleAbove);
    return kFoot * s * (1.0 - s * s / 6.0 * (1.0 - s * s / 20.0));
  };
  const double front = foot(swing_.position()) + 0.012;
  const double back = foot(goal) - table_->ball_radius - 0.012;
  for (const double lead : {0.0, 0.03, 0.06}) {  // [s]
    const double distance = ahead(now) + lead * now.velocity.x;
    if (distance > front || distance < back) continue;
    const double y = y_after(*table_, now.ball.y, now.velocity.y, lead);
    for (int man = 0; man < spec().men; ++man) {
      if (std::fabs(man_y(man) - y) < clear(now)) return true;
    }
  }
  return false;
}

// Distance beside the ball at which a foot can pass it [m].
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
  // A ball that rolls along behind the feet may pass first: otherwise the feet would not get clear
  // of it.
  constexpr double kRolls = 0.15, kMargin = 0.004;  // [m/s], [m]
  const bool passes_behind = ahead(now) < -(foot_.half_depth + table_->ball_radius + kMargin);
  const bool lets_past = passes_behind && std::fabs(now.velocity.y) > kRolls;
  const double to = lets_past ? -now.velocity.y : off == 0.0 ? -now.ball.y : off;
  const double side = aside * side_of(to);
  double goal = slide_.position() - off + side;
  if (std::fabs(goal) > spec().slide_limit) {
    // Goes to the other side, but not through the ball unless it has waited long enough.
    constexpr double kWaits = 0.5;  // [s]
    goal = passes_behind || since_ > kWaits ? goal - 2.0 * side : slide_.position();
  }
  goal_ = goal;
}

}  // namespace foosball
