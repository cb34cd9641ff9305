#include "computer_forecast.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "table_world.h"

namespace foosball {
namespace {

// Bounds on the deviation of the ball from the prediction. Beyond kDrifts the second world starts.
// Beyond kSurprise the forecast becomes invalid.
constexpr double kDrifts = 0.001, kDriftsBy = 0.03;  // [m], [m/s]
constexpr double kSurprise = 0.008, kSurpriseBy = 0.4;

constexpr double kKeepsOn = 0.6;  // fraction of another's displacement: the hand may have stopped

// A world allocates in its first steps: in the very first one, and when the ball first touches
// something. The start of a run overwrites the resulting states of rods and ball.
void take_memory(TableWorld& world) {
  const double radius = world.table().ball_radius;
  world.set_ball({0.0, 0.0, radius}, {0.0, 0.0, -1.0});
  world.step();
  world.park_ball();
  world.step();
}

}  // namespace

struct BallForecast::Run {
  Run(Layout layout, const TeamBodies& bodies, int team, const Tuning& tuning, std::size_t memory)
      : world(TableWorld::InParts{}, layout, bodies, team, tuning), expected(memory) {}

  TableWorld world;
  std::vector<BallGuess> expected;  // ring buffer, by tick
  long tick = 0;                    // of the world's state
  long since = 0;                   // tick of the first prediction
  bool runs = false;
};

BallForecast::BallForecast(int team, int delay_ticks, int ticks)
    : team_(team),
      ticks_(std::max(3, ticks)),
      memory_(static_cast<std::size_t>(delay_ticks) + 1),
      targets_(memory_) {}
BallForecast::~BallForecast() = default;
BallForecast::BallForecast(BallForecast&&) noexcept = default;
BallForecast& BallForecast::operator=(BallForecast&&) noexcept = default;

void BallForecast::set_table(Layout layout, const TeamBodies& bodies, const Tuning& tuning) {
  const bool same = layout == layout_ && bodies == bodies_ && tuning == tuning_;
  if (same && is_built()) return;
  if (!same) {
    built_ = 0;
    begun_ = false;
  }
  layout_ = layout;
  bodies_ = bodies;
  tuning_ = tuning;
  build_part();
}

void BallForecast::build_part() {
  std::unique_ptr<Run>& run = built_ == 0 ? now_ : catching_up_;
  if (!begun_) {
    run = std::make_unique<Run>(layout_, bodies_, team_, tuning_, memory_);
    begun_ = true;
    return;
  }
  if (!run->world.is_built()) return run->world.build_part();
  take_memory(run->world);
  ++built_;
  begun_ = false;
}

void BallForecast::forget() {
  if (is_built()) now_->runs = catching_up_->runs = false;
}

std::size_t BallForecast::slot(long tick) const {
  return static_cast<std::size_t>(tick) % memory_;
}

long BallForecast::seen_tick(const Sighting& seen) const {
  return tick_ - std::lround(seen.age / kTick);
}

bool BallForecast::as_expected(const Run& run, const Sighting& seen, double metres,
                               double speed) const {
  const long tick = seen_tick(seen);
  if (!run.runs || tick < run.since) return false;
  if (tick > run.tick) return true;
  const BallGuess& expected = run.expected[slot(tick)];
  return vp::norm(expected.position - seen.ball) < metres &&
         vp::norm(expected.velocity - seen.velocity) < speed;
}

void BallForecast::see(const Sighting& seen) {
  spent_ = 0;
  seen_ = seen;
  if (!is_built()) return;
  if (!seen.ball_in_play) return forget();
  if (now_->runs && !as_expected(*now_, seen, kSurprise, kSurpriseBy)) now_->runs = false;
  if (catching_up_->runs && !as_expected(*catching_up_, seen, kSurprise, kSurpriseBy)) {
    catching_up_->runs = false;
  }
  if (!catching_up_->runs && !as_expected(*now_, seen, kDrifts, kDriftsBy)) {
    start(*catching_up_, seen);
  }
  if (!catching_up_->runs) return;
  while (catching_up_->tick < tick_ && spent_ < ticks_ - 1) step(*catching_up_);
  if (catching_up_->tick < tick_) return;
  std::swap(now_, catching_up_);
  catching_up_->runs = false;
}

std::optional<BallGuess> BallForecast::ball() const {
  if (!is_built() || !now_->runs) return std::nullopt;
  return now_->expected[slot(tick_)];
}

void BallForecast::act(const RodTargets& targets, std::uint8_t own) {
  RodTargets& acted = targets_[slot(tick_)];
  for (const int rod : rods_of_team(table_spec(layout_), team_)) {
    acted[rod] = targets[rod];
    acted[rod].live = (own >> rod & 1) != 0;  // a rod without a hand stays where it was left
  }
  if (is_built() && now_->runs) step(*now_);
  ++tick_;
}

void BallForecast::start(Run& run, const Sighting& seen) {
  const double s = attack_sign(team_);
  for (int rod = 0; rod < kRods; ++rod) {
    run.world.set_rod(
        rod, {team_slide(team_, seen.slide[rod]), team_swing(team_, seen.swing[rod]),
              team_slide(team_, seen.slide_rate[rod]), team_swing(team_, seen.swing_rate[rod])});
  }
  run.world.set_ball({vp::SE3(vp::Vec3{s * seen.ball.x, s * seen.ball.y, seen.ball.z}),
                      {s * seen.velocity.x, s * seen.velocity.y, seen.velocity.z},
                      {s * seen.spin.x, s * seen.spin.y, seen.spin.z}});
  run.tick = run.since = seen_tick(seen);
  run.runs = true;
  run.expected[slot(run.tick)] = {seen.ball, seen.velocity};
}

void BallForecast::step(Run& run) {
  const double s = attack_sign(team_);
  const TableSpec& table = run.world.table();
  const double further = kKeepsOn * static_cast<double>(run.tick - seen_tick(seen_)) * kTick;
  for (int rod = 0; rod < kRods; ++rod) {
    const RodTarget& own = targets_[slot(run.tick)][rod];
    if (own.live) {
      run.world.drive(rod, own);
      continue;
    }
    const double limit = table.rods[rod].slide_limit;
    const double there = seen_.slide[rod] + further * seen_.slide_rate[rod];
    run.world.drive(rod, {team_slide(team_, std::clamp(there, -limit, limit)),
                          team_swing(team_, seen_.swing[rod]), 0.0, 0.0, true});
  }
  run.world.step();
  ++run.tick;
  ++spent_;
  const BallState& ball = run.world.ball();
  const vp::Vec3 p = ball.pose.position(), v = ball.velocity;
  run.expected[slot(run.tick)] = {{s * p.x, s * p.y, p.z}, {s * v.x, s * v.y, v.z}};
}

}  // namespace foosball
