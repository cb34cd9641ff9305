// A ball at the foot: the foot goes behind it, the player thinks, sets the foot up and plays.
#include <algorithm>
#include <cmath>

#include "computer_mind.h"

namespace foosball {
namespace {

// Where a ball can be played, ahead of the axis [m]: from just behind the hanging foot to as far as
// the foot still meets the ball below its top.
constexpr double kFrom = -0.030, kTo = 0.058;
constexpr double kScrapeFrom = -0.062;  // a ball at rest behind the foot is hooked from above

// Faster balls [m/s] are blocked, not played.
constexpr double kTameApproach = 0.5, kTame = 1.3, kResting = 0.15;
constexpr double kSteepest = 0.8;  // tangent of the most oblique shot by eye

}  // namespace

void ComputerMind::enter(Act act) {
  act_ = act;
  since_ = 0.0;
}

bool ComputerMind::can_control(int line, const Sighting& now) const {
  const double way = ahead(line, now);
  const double speed = vp::norm(now.velocity);
  if (now.ball.z > 2.5 * table().ball_radius || speed > kTame) return false;
  if (now.velocity.x < -kTameApproach) return false;
  const double from = speed < kResting ? kScrapeFrom : kFrom;
  if (way <= from || way >= kTo) return false;
  int man = 0;
  const double slide = slide_for(line, now.ball.y, &man);
  const double foot = man_offset(spec(line), man) + slide;
  return std::fabs(foot - now.ball.y) < 0.02;
}

void ComputerMind::begin_control(int line, const Sighting& now) {
  line_ = line;
  slide_for(line, now.ball.y, &man_);
  fed_ = false;
  held_ = 0.0;
  over_ = false;
  pause_ = random_.between(t_.pause_low, t_.pause_high);
  // A ball beside or behind the foot: step aside, towards the middle, before drawing back.
  const bool hooked = ahead(line, now) < 0.5 * table().ball_radius;
  aside_ = hooked ? std::copysign(0.048, -now.ball.y) : 0.0;
  enter(Act::draw);
  thinking_ = false;
}

// The slide that brings the man's foot to where the ball will be.
double ComputerMind::foot_slide(const Sighting& now, double lead) const {
  const double y = y_after(table(), now.ball.y, now.velocity.y, lead);
  return y - man_offset(spec(line_), man_);
}

void ComputerMind::control(const Sighting& now) {
  held_ += kTick;
  OwnRod& rod = rods_[line_];
  switch (act_) {
    case Act::draw:
      draw(now);
      break;
    case Act::set_up:
      set_up(now);
      break;
    case Act::feint:
      feint(now);
      break;
    case Act::stroke:
      run_.step(rod.slide, rod.swing, t_, late_);
      rod.goal = rod.slide.position();
      if (run_.phase() == StrokeRun::Phase::over) {
        fed_ = stroke_.pass;
        fed_at_ = time_;
        enter(Act::recover);
      }
      return;
    case Act::recover:
      recover(now);
      break;
    case Act::none:
      break;
  }
  const double limit = spec(line_).slide_limit;
  rod.goal = std::clamp(rod.goal, -limit, limit);
  rod.slide.move(rod.goal, t_.slide);
}

// The foot goes back, over a ball that lies beside or behind it, and waits behind the ball.
void ComputerMind::draw(const Sighting& now) {
  OwnRod& rod = rods_[line_];
  const double way = ahead(line_, now);
  const bool lost = !now.ball_in_play || way < kScrapeFrom - 0.01 || way > kTo + 0.012 ||
                    vp::norm(now.velocity) > 1.5 * kTame;
  if (lost) return enter(Act::recover);
  const double drawn = rod.level() + (aside_ == 0.0 ? kDrawn : kDrawnOver);
  if (rod.swing.position() < drawn + 0.05) over_ = true;
  const double foot = foot_slide(now, 0.03);
  rod.goal = foot + (over_ ? 0.0 : aside_);
  const bool beside = std::fabs(rod.goal - rod.slide.position()) < 0.010;
  if (over_ || aside_ == 0.0 || beside || since_ > 0.5) rod.swing.move(drawn, t_.swing);
  if (!over_) return;
  think(now);
  if (held_ > pause_ && choose(now)) {
    noise_ = t_.aim_error * random_.bell();
    late_ = static_cast<int>(std::lround(t_.timing_error * random_.bell() / kTick));
    enter(random_.unit() < t_.feint ? Act::feint : Act::set_up);
  }
}

void ComputerMind::think(const Sighting& now) {
  if (t_.think_ticks == 0) return;
  constexpr double kLead = 0.12;  // [s] until the foot is set up
  Situation s;
  s.rod = rods_[line_].index;
  s.man = man_;
  s.ball = {now.ball.x + kLead * now.velocity.x,
            y_after(table(), now.ball.y, now.velocity.y, kLead), table().ball_radius};
  s.velocity = {now.velocity.x, now.velocity.y, 0.0};
  s.slide = now.slide;
  s.swing = now.swing;
  for (const OwnRod& own : rods_) {
    s.slide[own.index] = own.slide.position();
    s.swing[own.index] = own.swing.position() - own.level();
  }
  s.receiver = receiver_of(line_);
  const Situation& before = foresight_.situation();
  double changed =
      std::max(std::fabs(s.ball.x - before.ball.x), std::fabs(s.ball.y - before.ball.y));
  for (int r = 0; r < kRods; ++r) {
    if (table().rods[r].team == team_) continue;
    changed = std::max(changed, 0.5 * std::fabs(s.slide[r] - before.slide[r]));
  }
  constexpr double kChanged = 0.010;  // [m]
  if (!thinking_ || changed > kChanged) foresight_.consider(s);
  thinking_ = true;
  foresight_.think(t_.think_ticks);
}

int ComputerMind::receiver_of(int line) const {
  return line < 3 && hands_.holds(line + 1) ? rods_[line + 1].index : -1;
}

// Whether a stroke is good enough for now; the bar sinks with time.
bool ComputerMind::choose(const Sighting& now) {
  if (t_.think_ticks == 0) {
    choose_by_eye(now);
    return true;
  }
  constexpr int kEnough = 6;
  const Foresight::Idea* best = foresight_.best();
  if (best == nullptr || foresight_.ideas() < std::min(kEnough, t_.strokes)) return false;
  const double bar = t_.shot_bar * (1.0 - held_ / t_.patience);
  const bool tried = best->trials >= t_.trials;
  if (held_ < t_.patience && (!tried || best->worth() < bar)) return false;
  stroke_ = best->stroke;
  return true;
}

// Least distance between the line from the ball to (goal line, target) and the men in the way.
double ComputerMind::clearance(const Sighting& now, double target) const {
  const double run = 0.5 * table().length - now.ball.x;
  double least = 0.2;
  for (int rod = 0; rod < kRods; ++rod) {
    const RodSpec& other = table().rods[rod];
    const double way = attack_sign(team_) * other.x - now.ball.x;
    const bool lifted = std::fabs(std::remainder(now.swing[rod], 2.0 * vp::kPi)) > 1.0;
    if (way < 0.03 || lifted) continue;
    const double y = now.ball.y + (target - now.ball.y) * way / run;
    for (int man = 0; man < other.men; ++man) {
      const double at = man_offset(other, man) + now.slide[rod];
      least = std::min(least, std::fabs(at - y));
    }
  }
  return least;
}

// The least guarded of a few targets.
void ComputerMind::choose_by_eye(const Sighting& now) {
  const double run = 0.5 * table().length - now.ball.x;
  const double post = 0.5 * table().goal_width - table().ball_radius;
  double best = -1e9, tangent = 0.0;
  const auto consider = [&](double target) {
    const double slope = (target - now.ball.y) / run;
    if (std::fabs(slope) > kSteepest) return;
    const double on_goal = std::fabs(target) < post ? 0.03 : 0.0;
    const double worth = std::min(0.06, clearance(now, target)) + on_goal -
                         0.02 * std::fabs(slope) + 0.01 * random_.unit();
    if (worth > best) {
      best = worth;
      tangent = slope;
    }
  };
  consider(now.ball.y);
  for (const double part : {-0.9, -0.45, 0.0, 0.45, 0.9}) consider(part * post);
  stroke_ = {};
  stroke_.offset = edge_offset(tangent, half_foot_, table().ball_radius);
  stroke_.power = power_at(table(), ahead(line_, now));
}

// The foot goes to where the stroke begins; the ball's own motion is followed until then.
void ComputerMind::set_up(const Sighting& now) {
  OwnRod& rod = rods_[line_];
  const double way = ahead(line_, now);
  const bool lost = !now.ball_in_play || way < kScrapeFrom - 0.01 || way > kTo + 0.015 ||
                    vp::norm(now.velocity) > 1.5 * kTame;
  if (lost) return enter(Act::recover);
  rod.goal = foot_slide(now, 0.02) + stroke_.offset + noise_;
  const bool there = std::fabs(rod.goal - rod.slide.position()) < 0.002;
  bool ready = there;
  if (stroke_.beside) {
    const double beside = rod.level() + stroke_.beside_swing;
    if (there || rod.swing.position() > beside - 0.3) rod.swing.move(beside, t_.swing);
    ready = there && std::fabs(rod.swing.position() - beside) < 0.02;
  }
  constexpr double kPatience = 0.45;  // [s], then play what there is, or think again
  if (ready || (since_ > kPatience && !stroke_.beside)) {
    run_.begin(stroke_, rod.slide, rod.level());
    enter(Act::stroke);
  } else if (since_ > kPatience) {
    over_ = false;
    aside_ = rod.slide.position() > foot_slide(now, 0.0) ? 0.048 : -0.048;
    enter(Act::draw);
  }
}

// A step to one side and back behind the ball, as if to play it elsewhere.
void ComputerMind::feint(const Sighting& now) {
  constexpr double kStep = 0.035, kFor = 0.14;  // [m], [s]
  rods_[line_].goal = foot_slide(now, 0.02) + (stroke_.offset > 0.0 ? -kStep : kStep);
  if (since_ > kFor) enter(Act::set_up);
}

// After a stroke the foot stays forward until the eye has seen where the ball went, then comes back
// beside a ball that has stayed.
void ComputerMind::recover(const Sighting& now) {
  OwnRod& rod = rods_[line_];
  rod.goal = rod.slide.position();
  const double hang = rod.level();
  if (std::fabs(rod.swing.rate()) > t_.swing.rate) {
    // Brakes as hard as it struck: with a calm hand's force the rod would go over the top.
    rod.swing.move(hang + kThrough, {t_.strike_rate, t_.strike_acceleration});
  } else if (since_ < t_.delay + 0.03 && rod.swing.position() > hang + 0.2) {
    rod.swing.move(hang + kThrough, {t_.swing.rate, t_.strike_acceleration});
  } else {
    lower(line_, hang, now);
  }
  const bool home = std::fabs(rod.swing.position() - hang) < 0.1;
  if (home || since_ > 1.0) enter(Act::none);
}

}  // namespace foosball
