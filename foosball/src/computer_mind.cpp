#include "computer_mind.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace foosball {
namespace {

constexpr int kGoalie = 0, kDefence = 1, kMidfield = 2, kAttack = 3;

}  // namespace

ComputerMind::ComputerMind(int team, const Temperament& t, std::uint64_t seed)
    : team_(team),
      t_(t),
      random_(seed),
      hands_(2, static_cast<int>(std::lround(t.hand_travel / kTick))) {
  rods_.reserve(4);
}

void ComputerMind::set_table(Layout layout, const TeamBodies& bodies) {
  table_ = &table_spec(layout);
  LaneView lanes;
  for (std::size_t team = 0; team < kTeams; ++team) {
    lanes.half_foot[team] = 0.5 * bodies[team].foot_width;
  }
  model_ = {table_, team_, lanes.half_foot};
  const auto indices = rods_of_team(*table_, team_);
  for (std::size_t line = 0; line < indices.size(); ++line) {
    ComputerRod rod(*table_, team_, indices[line], lanes,
                    foot_of(bodies[static_cast<std::size_t>(team_)]), t_.judgment);
    if (line < rods_.size()) {
      rod.adopt(rods_[line].slide().position(), rods_[line].swing().position());
      rods_[line] = rod;
    } else {
      rods_.push_back(rod);
    }
  }
}

void ComputerMind::keep_to(std::uint8_t lines) {
  lines_ = lines;
  for (int line = 0; line < 4; ++line) {
    if (!may_hold(line)) hands_.leave(line);
  }
}

void ComputerMind::rest() {
  passed_ = {};
  hands_.let_go();
  for (ComputerRod& rod : rods_) rod.give_up();
}

void ComputerMind::play(const Sighting& seen, const Tuning& tuning, bool own_serve,
                        const std::optional<BallGuess>& forecast) {
  own_serve_ = own_serve;
  Sighting now = seen;
  for (int line = 0; line < 4; ++line) {  // the state of its own hands is known without delay
    if (!may_hold(line)) continue;
    ComputerRod& rod = rods_[static_cast<std::size_t>(line)];
    now.slide[static_cast<std::size_t>(rod.index())] = rod.slide().position();
    now.swing[static_cast<std::size_t>(rod.index())] = rod.swing().position();
    now.slide_rate[static_cast<std::size_t>(rod.index())] = 0.0;
  }
  constexpr double kFurther = 0.02;  // [s], extrapolation beyond now
  for (std::size_t rod = 0; rod < kRods; ++rod) {
    const double limit = table_->rods[rod].slide_limit;
    const double there =
        now.slide[rod] + t_.judgment.men_keep_on * (now.age + kFurther) * now.slide_rate[rod];
    now.slide[rod] = std::clamp(there, -limit, limit);
  }
  guess_ball(now, tuning, forecast);
  if (now.ball_in_play && !was_in_play_) side_ = random_.unit() < 0.5 ? -1.0 : 1.0;
  now.goal_counts = !is_fresh_serve(now);
  was_in_play_ = now.ball_in_play;
  hands_.pass_time();
  std::array<bool, 4> busy{};
  for (int line = 0; line < 4; ++line) busy[static_cast<std::size_t>(line)] = rods_[line].busy();
  const Lines lines = controlled_lines(target_lines(now));
  hands_.want(lines[0], lines[1], busy);
  for (int line = 0; line < 4; ++line) {
    ComputerRod& rod = rods_[static_cast<std::size_t>(line)];
    if (hands_.holds(line)) {
      rod.play(now, guard_y(line, now), t_, random_);
    } else {
      rod.rest();
    }
  }
  note_strokes(now);
}

// True while the ball is still at the midfield that served it: no second man has touched it.
bool ComputerMind::is_fresh_serve(const Sighting& now) {
  constexpr double kAtFeet = 0.06, kLeft = 0.10;  // distance from the axis [m]
  const double ahead = std::fabs(now.ball.x - rods_[kMidfield].x());
  if (!now.ball_in_play) return fresh_serve_ = false;
  if (!was_in_play_) fresh_serve_ = ahead < kAtFeet && vp::norm(now.velocity) < 0.1;
  if (ahead > kLeft) fresh_serve_ = false;
  return fresh_serve_;
}

// Estimates the current ball. The effect of an own stroke is known before it is seen.
void ComputerMind::guess_ball(Sighting& now, const Tuning& tuning,
                              const std::optional<BallGuess>& forecast) {
  BallGuess ball{now.ball, now.velocity};
  double age = now.age;
  if (sent_ticks_ >= 0) {
    ++sent_ticks_;
    const double since = sent_ticks_ * kTick;
    if (since < now.age && now.ball_in_play) {
      ball = sent_;
      age = since;
    } else {
      sent_ticks_ = -1;
    }
  }
  now.guessed = !forecast;
  now.doubt = forecast ? 0.0 : age * vp::norm(ball.velocity);
  ball = forecast ? *forecast : advance(model_, tuning, now, ball, age);
  now.ball = ball.position;
  now.velocity = ball.velocity;
}

// Records the ball that a foot has just sent off: its velocity and the receiver are known.
void ComputerMind::note_strokes(const Sighting& now) {
  passed_ = {};
  for (const ComputerRod& rod : rods_) {
    if (!rod.struck()) continue;
    sent_ = {now.ball, rod.sent_velocity()};
    sent_ticks_ = 0;
    const PassPlan& pass = rod.sent_to();
    if (pass.rod < 0) continue;
    passed_ = {rod.index(), pass.rod, pass.man};
    for (ComputerRod& to : rods_) {
      if (to.index() != pass.rod) continue;
      to.expect_pass(pass.man, pass.y, (to.x() - now.ball.x) / rod.sent_velocity().x);
    }
  }
}

// The two most important lines.
ComputerMind::Lines ComputerMind::target_lines(const Sighting& now) const {
  if (!now.ball_in_play) {
    return own_serve_ ? Lines{kMidfield, kDefence} : Lines{kDefence, kGoalie};
  }
  for (int line = 0; line < 4; ++line) {
    if (!rods_[static_cast<std::size_t>(line)].has_ball() || !hands_.holds(line)) continue;
    switch (line) {
      case kGoalie:
        return {kGoalie, kDefence};
      case kDefence:
        return {kDefence, kMidfield};
      case kMidfield:
        return {kMidfield, kAttack};
      default:
        return {kAttack, kDefence};
    }
  }
  for (const int line : {kMidfield, kAttack}) {
    const ComputerRod& rod = rods_[static_cast<std::size_t>(line)];
    if (rod.expects_pass() && hands_.holds(line)) return {line, kDefence};
  }
  const Judgment& j = t_.judgment;
  const double soon = now.ball.x + j.hands_ahead * std::clamp(now.velocity.x, -3.0, 3.0);
  const bool fast = now.velocity.x < -j.hands_fast && now.ball.x < j.hands_fast_within;
  if (fast) return {kDefence, kGoalie};
  if (soon < j.hands_goalie) return {kGoalie, kDefence};
  if (soon < j.hands_defense) return {kDefence, kGoalie};
  if (soon < j.hands_midfield) return {kMidfield, kGoalie};
  if (soon < j.hands_loose) return {kDefence, kGoalie};
  if (soon < j.hands_attack) return {kAttack, kDefence};
  return t_.stays_home ? Lines{kDefence, kGoalie} : Lines{kAttack, kDefence};
}

// The requested lines that it may hold. A team mate's line is replaced by the nearest own one.
ComputerMind::Lines ComputerMind::controlled_lines(const Lines& target) const {
  Lines own{ComputerHands::kNone, ComputerHands::kNone};
  std::size_t count = 0;
  for (const int line : target) {
    if (may_hold(line)) own[count++] = line;
  }
  for (const int missing : target) {
    if (may_hold(missing)) continue;
    int nearest = ComputerHands::kNone;
    for (int line = 0; line < 4; ++line) {
      if (!may_hold(line) || line == own[0]) continue;
      const bool nearer =
          nearest == ComputerHands::kNone || std::abs(line - missing) < std::abs(nearest - missing);
      if (nearer) nearest = line;
    }
    if (count < own.size()) own[count++] = nearest;
  }
  return own;
}

// Where a man should stand: in the path of an approaching ball, otherwise where he covers the goal
// (goalie, defence) or level with the ball.
double ComputerMind::guard_y(int line, const Sighting& now) const {
  const double distance = now.ball.x - rods_[static_cast<std::size_t>(line)].x();
  const double vx = now.velocity.x;
  const bool from_front =
      (vx < -t_.judgment.guard_path || (vx < -0.08 && distance < 0.15 && line == kGoalie)) &&
      distance > 0.0;
  if (from_front) return y_after(*table_, now.ball.y, now.velocity.y, distance / -vx);
  if (line == kMidfield || line == kAttack || distance < 0.0) return now.ball.y;
  return cover_y(line, now);
}

// Fraction of the distance from the ball to the goal line that is in front of the line's rod [1].
double ComputerMind::to_goal(int line, const Sighting& now) const {
  const double run = now.ball.x + 0.5 * table_->length;
  return (now.ball.x - rods_[static_cast<std::size_t>(line)].x()) / run;
}

// The team mate's man (goalie or defence) covers a part of the goal mouth. This is the centre of
// the larger remaining part, projected to the rod.
double ComputerMind::beside_mate(int line, const Sighting& now) const {
  const ComputerRod& mate = rods_[static_cast<std::size_t>(line == kDefence ? kGoalie : kDefence)];
  const double mouth = 0.5 * table_->goal_width - table_->ball_radius;
  const double share = to_goal(mate.spec().line == Line::goalie ? kGoalie : kDefence, now);
  double target = 0.0;
  if (share > 0.02) {
    double shadow = 1e9;  // on the goal line, of the man who covers the most central part [m]
    for (int man = 0; man < mate.spec().men; ++man) {
      const double y =
          man_offset(mate.spec(), man) + now.slide[static_cast<std::size_t>(mate.index())];
      const double at = now.ball.y + (y - now.ball.y) / share;
      if (std::fabs(at) < std::fabs(shadow)) shadow = at;
    }
    const double half =
        (model_.half_foot[static_cast<std::size_t>(team_)] + 0.9 * table_->ball_radius) / share;
    const double right = std::clamp(shadow - half, -mouth, mouth) + mouth;
    const double left = mouth - std::clamp(shadow + half, -mouth, mouth);
    if (right > left) target = -mouth + 0.5 * right;
    if (left > right) target = mouth - 0.5 * left;
  }
  return now.ball.y + (target - now.ball.y) * to_goal(line, now);
}

// Defence and goalie each cover a part of the goal mouth as seen from the ball: side by side from
// one post if that covers it all, otherwise around its centre.
double ComputerMind::cover_y(int line, const Sighting& now) const {
  if (!may_hold(kDefence) || !may_hold(kGoalie)) return beside_mate(line, now);
  const double mouth = 0.5 * table_->goal_width - table_->ball_radius;
  const auto share = [&](int l) { return to_goal(l, now); };
  // Half the width on the goal line that a man covers.
  const double half_foot = model_.half_foot[static_cast<std::size_t>(team_)];
  const auto hides = [&](int l) {
    return share(l) > 0.02 ? (half_foot + 0.9 * table_->ball_radius) / share(l) : 0.0;
  };
  const double defence = std::min(mouth, hides(kDefence));
  const double goalie = std::min(mouth, hides(kGoalie));
  const bool all = defence + goalie >= mouth;
  double target = 0.0;
  if (line == kDefence) {
    target = all ? -mouth + defence : -goalie;
  } else {
    target = all ? mouth - goalie : defence;
  }
  target *= side_;
  return now.ball.y + (target - now.ball.y) * share(line);
}

}  // namespace foosball
