#include "foosball/assists.h"

#include <algorithm>
#include <cmath>

namespace foosball {
namespace {

// A ball that approaches more slowly counts as not approaching [m/s].
constexpr double kComes = 0.4;
// Assumed speed of a ball that does not approach [m/s]: orders the rods by distance.
constexpr double kStray = 0.5;
// Additional time for a rod that the ball has passed or leaves [s].
constexpr double kPassed = 0.5;
// Men are lowered only while the ball is further from their rod [m]: in front of the ball they
// would drive it towards their own goal.
constexpr double kClear = 0.12;
// A ball at rest at the feet must not be swept aside: the rod waits for its hand [m], [m/s].
constexpr double kAtFeet = 0.030, kAtRest = 0.30;
// Range in which a foot strikes, ahead of the axis [m], and the largest lateral speed of the ball
// [m/s].
constexpr double kStrikeFrom = -0.030, kStrikeTo = 0.060, kTame = 2.0;
constexpr double kSteepest = 0.8;  // tangent of the most oblique shot considered
constexpr double kShade = 0.028;   // goalie and defence each cover one side of the shot [m]

constexpr double team_of(int team, double along) {
  return attack_sign(team) * along;
}

// Reflects y once at the side walls.
double bounced(const TableSpec& table, double y) {
  const double wall = 0.5 * table.width - table.ball_radius;
  const double once = y > wall ? 2.0 * wall - y : y < -wall ? -2.0 * wall - y : y;
  return std::clamp(once, -wall, wall);
}

// One kTick towards the goal; brakes early enough to stop there.
void slide_towards(double goal, double& position, double& rate) {
  const double error = goal - position;
  const double stopping = std::sqrt(1.8 * kAssistAcceleration * std::fabs(error));
  const double speed = std::min({kAssistRate, stopping, std::fabs(error) / kTick});
  constexpr double kMax = kAssistAcceleration * kTick;
  rate += std::clamp(std::copysign(speed, error) - rate, -kMax, kMax);
  position += rate * kTick;
}

double towards(double from, double to, double max) {
  return from + std::clamp(to - from, -max, max);
}

}  // namespace

Assists::Assists(int team, Layout layout, std::uint8_t rods, const AssistChoice& choice)
    : team_(team), table_(&table_spec(layout)), mine_(rods), choice_(choice) {
  reach_ = field_reach(*table_, seen_);
}

Assists::Ball Assists::ball_of(const AssistView& view) const {
  return {team_of(team_, view.ball.x), team_of(team_, view.ball.y), team_of(team_, view.velocity.x),
          team_of(team_, view.velocity.y)};
}

double Assists::rod_x(int rod) const {
  return team_of(team_, table_->rods[rod].x);
}

double Assists::reach_of(const CharacterBody& body) const {
  if (!(body == seen_)) {
    seen_ = body;
    reach_ = field_reach(*table_, body);
  }
  return reach_;
}

// --- automatic rod -------------------------------------------------------------------------------

// Time until the ball is within reach of the rod's feet [s]: 0 while it is.
double Assists::time_to_act(int rod, const Ball& ball, double reach) const {
  const double ahead = ball.x - rod_x(rod);
  const double beyond = std::fabs(ahead) - reach;
  const double approach_speed = ahead > 0.0 ? -ball.vx : ball.vx;
  if (beyond <= 0.0) return approach_speed < -kComes ? std::max(0.0, -0.1 * approach_speed) : 0.0;
  if (approach_speed > kComes) return beyond / approach_speed;
  return beyond / kStray + (approach_speed < -kComes ? kPassed : 0.0);
}

int Assists::rod_to_take(const AssistView& view, const AssistHand& hand, int now) const {
  if (!choice_.automatic_rod || !view.ball_in_play || hand.strikes) return now;
  const Ball ball = ball_of(view);
  const bool have = now >= 0 && (mine_ >> now & 1) != 0;
  const double reach = reach_of(view.bodies[team_]);
  const auto time = [&](int rod) { return time_to_act(rod, ball, reach); };
  int best = have ? now : -1;
  double min = have ? time(now) - kSoonerBy : 1e9;
  for (const int rod : rods_of_team(*table_, team_)) {  // in order from the team's own goal
    if ((mine_ >> rod & 1) == 0 || rod == now || time(rod) >= min) continue;
    min = time(rod);
    best = rod;
  }
  return best;
}

// --- goalie follows ------------------------------------------------------------------------------

// Where a man should stand: in the path of an approaching ball, otherwise between ball and goal.
double Assists::guard_y(int rod, const Ball& ball) const {
  const double ahead = ball.x - rod_x(rod);
  if (ball.vx < -kComes && ahead > 0.0) return bounced(*table_, ball.y - ball.vy * ahead / ball.vx);
  const bool goalie = table_->rods[rod].line == Line::goalie;
  const double shade = goalie ? kShade : -kShade;
  const double to_goal = std::max(ball.x + 0.5 * table_->length, table_->ball_radius);
  const double y = ball.y + (shade - ball.y) * std::clamp(ahead / to_goal, 0.0, 1.0);
  const double mouth = 0.5 * table_->goal_width;
  return goalie ? std::clamp(y, -mouth, mouth) : y;
}

// The slide that brings a man to y: the man who comes nearest to it, then the one with the shortest
// slide.
double Assists::slide_for(int rod, double y, double from) const {
  const RodSpec& spec = table_->rods[rod];
  double best = from, min = 1e9;
  for (int man = 0; man < spec.men; ++man) {
    const double target = y - man_offset(spec, man);
    const double slide = std::clamp(target, -spec.slide_limit, spec.slide_limit);
    const double cost = 10.0 * std::fabs(target - slide) + std::fabs(slide - from);
    if (cost >= min) continue;
    min = cost;
    best = slide;
  }
  return best;
}

void Assists::follow(int rod, const AssistView& view, const RodTarget& from, int ticks) {
  Rod& own = rods_[rod];
  if (!own.follows) {
    const RodState& is = view.rods[rod];
    own.follows = true;
    own.slide = team_of(team_, from.live ? from.slide : is.slide);
    own.angle = from.live ? from.angle : is.angle;
    own.rate = 0.0;
  }
  const Ball ball = ball_of(view);
  const double ahead = ball.x - rod_x(rod);
  const bool at_feet = std::fabs(ahead) < kAtFeet && std::fabs(ball.vx) < kAtRest;
  const bool covers = view.ball_in_play && ahead > -kAtFeet && !at_feet;
  const double goal = covers ? slide_for(rod, guard_y(rod, ball), own.slide) : own.slide;
  const bool clear = !view.ball_in_play || std::fabs(ahead) > kClear;
  constexpr double kTurn = 2.0 * vp::kPi;
  const double rest =
      std::copysign(kTurn * std::floor(std::fabs(own.angle) / kTurn + 0.5), own.angle);
  for (int tick = 0; tick < ticks; ++tick) slide_towards(goal, own.slide, own.rate);
  if (clear) own.angle = towards(own.angle, rest, kSettleRate * kTick * ticks);
}

// --- aim -----------------------------------------------------------------------------------------

// Distance between the nearest man in the way and the line from the ball to (goal line, target).
double Assists::clearance(const AssistView& view, const Ball& ball, double target) const {
  const double run = 0.5 * table_->length - ball.x;
  double min = 0.06;  // a wider lane is not better
  for (int rod = 0; rod < kRods; ++rod) {
    const RodSpec& spec = table_->rods[rod];
    const double ahead = rod_x(rod) - ball.x;
    if (spec.team == team_ || ahead < 0.03) continue;
    const double y = ball.y + (target - ball.y) * ahead / run;
    for (int man = 0; man < spec.men; ++man) {
      const double at = man_offset(spec, man) + team_of(team_, view.rods[rod].slide);
      min = std::min(min, std::fabs(at - y));
    }
  }
  return min;
}

// The slide at which the foot sends the ball to the least guarded target, among those near the
// person's aim. A flat foot sends the ball straight on. Its edge, for a direction at angle a from
// the axis of play, touches the ball r sin a beyond the foot's side.
double Assists::aimed_slide(int rod, const AssistView& view, double slide) const {
  const Ball ball = ball_of(view);
  const RodSpec& spec = table_->rods[rod];
  const double ahead = ball.x - rod_x(rod), height = view.ball.z;
  const bool there = view.ball_in_play && ahead > kStrikeFrom && ahead < kStrikeTo &&
                     height < 2.5 * table_->ball_radius && std::fabs(ball.vy) < kTame;
  if (!there) return slide;
  const double half_foot = 0.5 * view.bodies[team_].foot_width;
  const int man = man_nearest(spec, ball.y - slide);
  const double beside = man_offset(spec, man) + slide - ball.y;  // offset of the foot from the ball
  const double run = 0.5 * table_->length - ball.x;
  const double post = 0.5 * table_->goal_width - table_->ball_radius;
  double best = 0.0, max = -1e9;
  const auto consider = [&](double target, double foot, double bonus) {
    const double worth = bonus + clearance(view, ball, target) +
                         (std::fabs(target) < post ? 0.03 : 0.0) - 2.0 * std::fabs(foot - beside);
    if (worth <= max) return;
    max = worth;
    best = foot;
  };
  const double flat = 0.6 * half_foot;
  consider(ball.y, std::clamp(beside, -flat, flat), 0.015);  // straight on: the most reliable
  for (const double share : {0.9, 0.45, 0.0, -0.45, -0.9}) {
    const double tangent = (share * post - ball.y) / run;
    if (std::fabs(tangent) > kSteepest) continue;
    const double sine = tangent / std::sqrt(1.0 + tangent * tangent);
    if (std::fabs(sine) < 0.04) continue;
    consider(share * post, -std::copysign(half_foot + table_->ball_radius * std::fabs(sine), sine),
             0.0);
  }
  const double off = best - beside;
  return std::fabs(off) < kAimReach ? slide + std::clamp(off, -kAimPull, kAimPull) : slide;
}

void Assists::pull(int rod, const AssistView& view, double slide, bool strikes, int ticks) {
  Rod& own = rods_[rod];
  const double goal = strikes ? aimed_slide(rod, view, slide) - slide : 0.0;
  own.pull = towards(own.pull, goal, kAimRate * kTick * ticks);
}

// --- all assists ---------------------------------------------------------------------------------

std::array<RodTarget, kRods> Assists::steer(const AssistView& view, const AssistHand& hand,
                                            int ticks) {
  std::array<RodTarget, kRods> targets = hand.targets;
  following_ = 0;
  for (int rod = 0; rod < kRods; ++rod) {
    if ((mine_ >> rod & 1) == 0) continue;
    Rod& own = rods_[rod];
    const Line line = table_->rods[rod].line;
    const bool held = (hand.held >> rod & 1) != 0;
    const bool guards = line == Line::goalie || line == Line::defence;
    RodTarget& target = targets[rod];
    if (choice_.goalie_follows && guards && !held) {
      follow(rod, view, target, ticks);
      following_ |= static_cast<std::uint8_t>(1u << rod);
      target = {team_of(team_, own.slide), own.angle, team_of(team_, own.rate), 0.0, true};
    } else {
      own.follows = false;
    }
    const double slide = team_of(team_, target.slide);
    pull(rod, view, slide, choice_.aim && held && hand.strikes && target.live, ticks);
    if (own.pull == 0.0) continue;
    const double limit = table_->rods[rod].slide_limit;
    target.slide = team_of(team_, std::clamp(slide + own.pull, -limit, limit));
  }
  return targets;
}

}  // namespace foosball
