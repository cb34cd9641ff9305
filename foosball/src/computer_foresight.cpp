#include "computer_foresight.h"

#include <algorithm>
#include <cmath>

#include "referee.h"

namespace foosball {
namespace {

constexpr int kFlight = 110;                     // ticks that the ball is followed after the strike
constexpr int kLongest = 330;                    // ticks of a trial, whatever happens
constexpr int kOpponentReacts = 120;             // ticks after which opponents follow the ball's y,
constexpr AxisLimits kOpponentSlide{1.5, 30.0};  // so fast
constexpr int kBestAgain = 4;                    // ideas that are tried again

}  // namespace

Foresight::Foresight(int team, const Temperament& t, std::uint64_t seed)
    : team_(team), t_(t), random_(seed) {
  ideas_.reserve(static_cast<std::size_t>(std::max(1, t.strokes)));
}

void Foresight::set_table(Layout layout, const std::array<int, kTeams>& characters) {
  world_ = std::make_unique<TableWorld>(layout, characters, team_);
  half_foot_ = 0.5 * character_spec(characters[team_]).foot_width;
  ideas_.clear();
  trial_ = -1;
}

void Foresight::consider(const Situation& situation) {
  situation_ = situation;
  ideas_.clear();
  trial_ = -1;
  running_new_ = false;
}

const Foresight::Idea* Foresight::best() const {
  const Idea* best = nullptr;
  for (const Idea& idea : ideas_) {
    if (idea.trials == 0) continue;
    if (best == nullptr || idea.worth() > best->worth()) best = &idea;
  }
  return best;
}

void Foresight::think(int ticks) {
  for (int i = 0; i < ticks; ++i) {
    if (trial_ < 0) start_trial();
    if (trial_ < 0) return;
    step_trial();
  }
}

// --- ideas ---------------------------------------------------------------------------------------

Stroke Foresight::invent() {
  const TableSpec& table = world_->table();
  const RodSpec& rod = table.rods[situation_.rod];
  const double ahead = situation_.ball.x - attack_sign(team_) * rod.x;
  const bool still = vp::norm(situation_.velocity) < 0.08;
  const bool attack = rod.line == Line::attack;
  const double dice = random_.unit();
  const double slide_share = attack ? 0.55 : rod.line == Line::midfield ? 0.25 : 0.10;
  const bool at_foot = ahead > -0.012 && ahead < 0.040;
  if (t_.slide_shots && still && at_foot && dice < slide_share) return invent_slide_shot(ahead);
  Stroke stroke;
  const double edge = half_foot_ + 0.75 * table.ball_radius;
  stroke.offset = random_.between(-edge, edge);
  stroke.pass = !attack && dice > 0.70;
  const double full = power_at(table, ahead);
  stroke.power = stroke.pass ? random_.between(0.08, 0.35) : full * random_.between(0.75, 1.0);
  return stroke;
}

Stroke Foresight::invent_slide_shot(double ahead) {
  const TableSpec& table = world_->table();
  Stroke stroke;
  stroke.beside = true;
  const double side = random_.unit() < 0.5 ? -1.0 : 1.0;
  stroke.offset = -side * (half_foot_ + table.ball_radius + 0.004);
  const double arm = table.rod_height - 0.012;
  const double sine = std::clamp(ahead / arm, -0.45, 0.45);
  stroke.beside_swing = sine + sine * sine * sine / 6.0;
  stroke.push_ticks = 40 + random_.below(70);
  stroke.push_rate = random_.between(0.3, std::min(1.4, t_.slide.rate));
  stroke.push = side * 0.25;
  stroke.draw_swing = random_.between(-0.75, -0.35) + std::min(0.0, stroke.beside_swing);
  stroke.draw_ticks = 25 + random_.below(50);
  const double edge = half_foot_ + 0.5 * table.ball_radius;
  stroke.strike_offset = random_.between(-edge, edge);
  stroke.power = random_.between(0.8, 1.0);
  return stroke;
}

// --- a trial -------------------------------------------------------------------------------------

// A new idea while there are few, then the best again until each has its trials.
void Foresight::start_trial() {
  if (static_cast<int>(ideas_.size()) < t_.strokes) {
    ideas_.push_back({invent()});
    trial_ = static_cast<int>(ideas_.size()) - 1;
    running_new_ = true;
    return place();
  }
  running_new_ = false;
  std::array<int, kBestAgain> best{};
  int found = 0;
  for (int i = 0; i < static_cast<int>(ideas_.size()); ++i) {
    int at = found < kBestAgain ? found++ : kBestAgain - 1;
    if (at == kBestAgain - 1 && found == kBestAgain && i >= kBestAgain &&
        ideas_[i].worth() <= ideas_[best[at]].worth()) {
      continue;
    }
    best[at] = i;
    for (; at > 0 && ideas_[best[at]].worth() > ideas_[best[at - 1]].worth(); --at) {
      std::swap(best[at], best[at - 1]);
    }
  }
  for (int i = 0; i < found; ++i) {
    if (ideas_[best[i]].trials >= t_.trials) continue;
    trial_ = best[i];
    return place();
  }
}

void Foresight::place() {
  const double level = 0.0;
  const Stroke& stroke = ideas_[trial_].stroke;
  const RodSpec& rod = world_->table().rods[situation_.rod];
  ticks_ = ticks_since_strike_ = 0;
  stray_ = t_.aim_error * random_.bell();
  late_ = static_cast<int>(std::lround(t_.timing_error * random_.bell() / kTick));
  for (int r = 0; r < kRods; ++r) {
    // A rod that hits its stop is seen a little beyond it.
    const double limit = world_->table().rods[r].slide_limit;
    slide_[r].adopt(std::clamp(situation_.slide[r], -limit, limit));
    swing_[r].adopt(situation_.swing[r]);
  }
  const double foot = situation_.ball.y + stroke.offset + stray_;
  slide_[situation_.rod].adopt(
      std::clamp(foot - man_offset(rod, situation_.man), -rod.slide_limit, rod.slide_limit));
  const double drawn = situation_.ball.x - attack_sign(team_) * rod.x < 0.010 ? kDrawnOver : kDrawn;
  swing_[situation_.rod].adopt(level + (stroke.beside ? stroke.beside_swing : drawn));
  for (int r = 0; r < kRods; ++r) {
    world_->set_rod(r, {team_slide(team_, slide_[r].position()),
                        team_swing(team_, swing_[r].position()), 0.0, 0.0});
    drive(r, slide_[r], swing_[r]);
  }
  const double s = attack_sign(team_);
  world_->set_ball({s * situation_.ball.x, s * situation_.ball.y, situation_.ball.z},
                   {s * situation_.velocity.x, s * situation_.velocity.y, 0.0});
  run_.begin(stroke, slide_[situation_.rod], level);
}

void Foresight::drive(int rod, const HandAxis& slide, const HandAxis& swing) {
  world_->drive(rod, {team_slide(team_, slide.position()), team_swing(team_, swing.position()),
                      team_slide(team_, slide.rate()), team_swing(team_, swing.rate()), true});
}

void Foresight::step_trial() {
  const double s = attack_sign(team_);
  const BallState state = world_->ball();
  const vp::Vec3 at = state.pose.position();
  const vp::Vec3 ball{s * at.x, s * at.y, at.z};
  const vp::Vec3 velocity{s * state.velocity.x, s * state.velocity.y, state.velocity.z};

  const StrokeRun::Phase before = run_.phase();
  HandAxis& slide = slide_[situation_.rod];
  HandAxis& swing = swing_[situation_.rod];
  run_.step(slide, swing, t_, late_);
  if (before == StrokeRun::Phase::push && run_.phase() == StrokeRun::Phase::draw) {
    aim_at_rolling_ball();
  }
  if (run_.phase() == StrokeRun::Phase::strike || run_.phase() == StrokeRun::Phase::over) {
    ++ticks_since_strike_;
  }
  drive(situation_.rod, slide, swing);
  move_receiver(ball, velocity);
  if (ticks_ >= kOpponentReacts) move_opponents(ball);
  const bool sane = world_->step();
  ++ticks_;

  if (!sane) return finish_trial(-1.0);
  if (const auto scorer = goal_by(world_->table(), at)) {
    return finish_trial(*scorer == team_ ? 1.0 : -1.2);
  }
  if (out_of_table(world_->table(), at)) return finish_trial(-0.2);
  if (ticks_since_strike_ >= kFlight || ticks_ >= kLongest) {
    finish_trial(worth_of(ball, velocity));
  }
}

// Where the foot must be when it strikes: where the ball will be by then.
void Foresight::aim_at_rolling_ball() {
  const double s = attack_sign(team_);
  const BallState ball = world_->ball();
  Stroke& stroke = run_.stroke();
  constexpr double kStrikeTime = 0.012;  // [s] from the strike's beginning to the ball
  const double lead = stroke.draw_ticks * kTick + kStrikeTime;
  const double moved = s * ball.pose.position().y + s * ball.velocity.y * lead - situation_.ball.y;
  stroke.strike_shift = moved - stroke.offset + stroke.strike_offset;
  Stroke& kept = ideas_[trial_].stroke;
  if (ideas_[trial_].trials == 0) kept.strike_shift = stroke.strike_shift;
  stroke.strike_shift = kept.strike_shift;  // what was planned, not what noise would need
}

void Foresight::move_receiver(const vp::Vec3& ball, const vp::Vec3& velocity) {
  if (situation_.receiver < 0 || velocity.x < 0.2) return;
  const TableSpec& table = world_->table();
  const RodSpec& rod = table.rods[situation_.receiver];
  const double way = attack_sign(team_) * rod.x - ball.x;
  if (way < 0.0) return;
  const double y = y_after(table, ball.y, velocity.y, way / velocity.x);
  double best = slide_[situation_.receiver].position(), nearest = 1.0;
  for (int man = 0; man < rod.men; ++man) {
    const double goal = y - man_offset(rod, man);
    const double off = std::fabs(goal - slide_[situation_.receiver].position());
    if (std::fabs(goal) > rod.slide_limit || off >= nearest) continue;
    nearest = off;
    best = goal;
  }
  slide_[situation_.receiver].move(best, t_.slide);
  drive(situation_.receiver, slide_[situation_.receiver], swing_[situation_.receiver]);
}

void Foresight::move_opponents(const vp::Vec3& ball) {
  const TableSpec& table = world_->table();
  for (int r = 0; r < kRods; ++r) {
    const RodSpec& rod = table.rods[r];
    if (rod.team == team_) continue;
    const double goal = std::clamp(situation_.slide[r] + ball.y - situation_.ball.y,
                                   -rod.slide_limit, rod.slide_limit);
    slide_[r].move(goal, kOpponentSlide);
    drive(r, slide_[r], swing_[r]);
  }
}

void Foresight::finish_trial(double worth) {
  Idea& idea = ideas_[trial_];
  idea.sum += worth;
  ++idea.trials;
  trial_ = -1;
  running_new_ = false;
}

// --- judgement -----------------------------------------------------------------------------------

// Who can play on from here: the rod nearest to the ball.
double Foresight::worth_of(const vp::Vec3& ball, const vp::Vec3& velocity) const {
  const TableSpec& table = world_->table();
  const double speed = vp::norm(velocity);
  const double sure = speed < 1.0 ? 1.0 : speed < 2.5 ? 0.6 : 0.3;
  int nearest = 0;
  double least = 10.0;
  for (int r = 0; r < kRods; ++r) {
    const double off = std::fabs(attack_sign(team_) * table.rods[r].x - ball.x);
    if (off < least) least = off, nearest = r;
  }
  const RodSpec& rod = table.rods[nearest];
  const double forward = ball.x - situation_.ball.x;  // [m]
  if (rod.team != team_) {
    const double danger = rod.line == Line::attack ? 2.5 : rod.line == Line::midfield ? 1.0 : 0.5;
    return -t_.loss_cost * danger * sure + 0.1 * forward;
  }
  if (nearest == situation_.rod) return t_.keep_worth * sure + 0.1 * forward;
  if (rod.line == Line::attack) return t_.pass_worth * sure;
  if (rod.line == Line::midfield) return 0.3 * t_.pass_worth * sure;
  return 0.1 * forward;
}

}  // namespace foosball
