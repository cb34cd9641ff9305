#include "computer_mind.h"

#include <algorithm>
#include <cmath>

namespace foosball {
namespace {

constexpr int kGoalie = 0, kDefence = 1, kMidfield = 2, kAttack = 3;

constexpr double kLifted = 1.40;  // feet out of the way of a shot from behind [rad]
// A foot tilted over the ball presses it down, so that it stays: back towards a ball that comes
// from the front, forward towards one from behind.
constexpr double kTiltBack = -0.22, kTiltForward = 0.38;

// A hand that follows the ball holds still for less than this, and turns round no sooner than that
// unless it has far to go.
constexpr double kStill = 0.008;    // [m]
constexpr double kTurnWait = 0.40;  // [s]
constexpr double kFar = 0.045;      // [m]

constexpr double kReach = 0.075;  // of a foot, fore and aft of its axis [m]

}  // namespace

double OwnRod::level() const {
  return 2.0 * vp::kPi * std::floor(swing.position() / (2.0 * vp::kPi) + 0.5);
}

ComputerMind::ComputerMind(int team, const Temperament& t, std::uint64_t seed)
    : team_(team),
      t_(t),
      random_(seed),
      foresight_(team, t, seed ^ 0x5bd1e995u),
      hands_(t.hands, static_cast<int>(std::lround(t.hand_travel / kTick))) {}

void ComputerMind::set_table(Layout layout, const std::array<int, kTeams>& characters) {
  table_ = &table_spec(layout);
  half_foot_ = 0.5 * character_spec(characters[team_]).foot_width;
  const auto indices = rods_of_team(*table_, team_);
  for (std::size_t line = 0; line < rods_.size(); ++line) {
    rods_[line].index = indices[line];
    rods_[line].x = attack_sign(team_) * table_->rods[indices[line]].x;
  }
  if (t_.think_ticks > 0) foresight_.set_table(layout, characters);
}

double ComputerMind::man_y(int line, int man) const {
  return man_offset(spec(line), man) + rods_[line].slide.position();
}

void ComputerMind::rest() {
  act_ = Act::none;
  fed_ = false;
  hands_.let_go();
}

void ComputerMind::play(const Sighting& now) {
  time_ += kTick;
  since_ += kTick;
  hands_.pass_time();
  if (!now.ball_in_play && act_ != Act::none && act_ != Act::stroke) enter(Act::recover);
  if (act_ == Act::none && now.ball_in_play) {
    for (int line = 0; line < 4 && act_ == Act::none; ++line) {
      if (hands_.holds(line) && can_control(line, now)) begin_control(line, now);
    }
  }
  assign_hands(now);
  for (int line = 0; line < 4; ++line) {
    if (!hands_.holds(line)) {
      rods_[line].slide.adopt(rods_[line].slide.position());
      rods_[line].swing.adopt(rods_[line].swing.position());
    } else if (act_ != Act::none && line == line_) {
      control(now);
    } else {
      guard(line, now);
    }
  }
}

// --- hands ---------------------------------------------------------------------------------------

void ComputerMind::assign_hands(const Sighting& now) {
  std::array<bool, 4> busy{};
  if (act_ != Act::none) busy[static_cast<std::size_t>(line_)] = true;
  const auto lines = wanted_lines(now);
  hands_.want(lines[0], lines[1], busy);
}

// The two rods that matter most, the more urgent first.
std::array<int, 2> ComputerMind::wanted_lines(const Sighting& now) const {
  if (!now.ball_in_play) return {kMidfield, kDefence};
  const double x = now.ball.x, vx = now.velocity.x;
  if (act_ != Act::none) {
    switch (line_) {
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
  if (fed_) return {kAttack, kMidfield};
  const double soon = x + 0.10 * std::clamp(vx, -3.0, 3.0);
  if (vx < -1.2 && x < 0.30) return {kDefence, kGoalie};
  if (soon < -0.45) return {kGoalie, kDefence};
  if (soon < -0.15) return {kDefence, kGoalie};
  if (soon < 0.0) return {kMidfield, kDefence};
  if (soon < 0.15)
    return t_.stays_home ? std::array{kDefence, kGoalie} : std::array{kDefence, kMidfield};
  if (soon < 0.30) return {kAttack, kDefence};
  return t_.stays_home ? std::array{kDefence, kMidfield} : std::array{kAttack, kDefence};
}

// --- guarding ------------------------------------------------------------------------------------

void ComputerMind::guard(int line, const Sighting& now) {
  if (!now.ball_in_play) {
    follow(line, 0.0);
    rods_[line].swing.move(rods_[line].level(), t_.swing);
    return;
  }
  follow(line, slide_for(line, guard_y(line, now)));
  swing_while_guarding(line, now);
}

// Where a man should stand: in the path of a ball that comes, else between ball and goal (defence)
// or level with the ball.
double ComputerMind::guard_y(int line, const Sighting& now) const {
  const double way = ahead(line, now);
  const double vx = now.velocity.x;
  const bool from_front = vx < -0.35 && way > 0.0;
  const bool from_behind = vx > 0.35 && way < 0.0;
  if (from_front || from_behind) {
    return y_after(table(), now.ball.y, now.velocity.y, way / -vx);
  }
  if (line == kMidfield || line == kAttack) return now.ball.y;
  // Goalie and defence each shade one side, so that together they cover the mouth.
  const double shade = line == kGoalie ? 0.028 : -0.028;
  const double to_goal = now.ball.x + 0.5 * table().length;
  const double y = now.ball.y + (shade - now.ball.y) * way / to_goal;
  const double mouth = 0.5 * table().goal_width;
  return line == kGoalie ? std::clamp(y, -mouth, mouth) : y;
}

void ComputerMind::swing_while_guarding(int line, const Sighting& now) {
  OwnRod& rod = rods_[line];
  const double way = ahead(line, now);
  if (way > -0.035) return lower(line, rod.level() + kTiltBack, now);
  const bool receives = fed_ && line == kAttack;
  const double goal = rod.level() + (receives ? kTiltForward : kLifted);
  if (goal >= rod.swing.position()) {
    rod.swing.move(goal, t_.swing);
  } else {
    lower(line, goal, now);
  }
}

// A foot that comes down from the front of a ball would send it towards its own goal: it steps
// aside first.
void ComputerMind::lower(int line, double swing, const Sighting& now) {
  OwnRod& rod = rods_[line];
  const bool back = swing < rod.swing.position() - 0.02;
  if (!back || !ball_under(line, now)) return rod.swing.move(swing, t_.swing);
  rod.swing.move(rod.swing.position(), t_.swing);
  int man = 0;
  slide_for(line, now.ball.y, &man);
  const double off = man_y(line, man) - now.ball.y;
  const double side = std::copysign(0.055, off == 0.0 ? -now.ball.y : off);
  const double limit = spec(line).slide_limit;
  double goal = rod.slide.position() - off + side;
  if (std::fabs(goal) > limit) goal -= 2.0 * side;
  rod.goal = std::clamp(goal, -limit, limit);
}

// The ball lies, or soon will, where a foot that swings back would meet it.
bool ComputerMind::ball_under(int line, const Sighting& now) const {
  if (now.ball.z > 0.07) return false;
  for (const double lead : {0.0, 0.06}) {  // [s]
    const double way = ahead(line, now) + lead * now.velocity.x;
    const double y = now.ball.y + lead * now.velocity.y;
    if (std::fabs(way) > kReach + table().ball_radius) continue;
    for (int man = 0; man < spec(line).men; ++man) {
      if (std::fabs(man_y(line, man) - y) < half_foot_ + table().ball_radius + 0.008) return true;
    }
  }
  return false;
}

// The slide that brings the best man to y: nearest to it, then least moved.
double ComputerMind::slide_for(int line, double y, int* man_out) const {
  const RodSpec& rod = spec(line);
  double best = rods_[line].slide.position();
  double least = 1e9;
  for (int man = 0; man < rod.men; ++man) {
    const double wanted = y - man_offset(rod, man);
    const double slide = std::clamp(wanted, -rod.slide_limit, rod.slide_limit);
    const double cost =
        10.0 * std::fabs(wanted - slide) + std::fabs(slide - rods_[line].slide.position());
    if (cost >= least) continue;
    least = cost;
    best = slide;
    if (man_out != nullptr) *man_out = man;
  }
  return best;
}

// Brings the rod to where it is wanted as a calm hand does: not for a few millimetres, and not to
// and fro.
void ComputerMind::follow(int line, double goal) {
  OwnRod& rod = rods_[line];
  const double position = rod.slide.position();
  const double off = goal - position;
  const bool moving = std::fabs(rod.goal - position) > 0.001;
  if (moving || std::fabs(off) > kStill) {
    const bool turns =
        off * (rod.goal - position) < 0.0 || (!moving && off * rod.slide.rate() <= 0.0);
    if (!turns || std::fabs(off) > kFar || time_ - rod.turned_at > kTurnWait) {
      if (turns) rod.turned_at = time_;
      rod.goal = goal;
    }
  }
  rod.slide.move(rod.goal, t_.slide);
}

}  // namespace foosball
