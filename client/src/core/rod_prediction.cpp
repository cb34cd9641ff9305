#include "client/rod_prediction.h"

#include <algorithm>
#include <cmath>

#include "wire/enums.h"

namespace client {
namespace {

constexpr std::int64_t kTickUs = 1000;
static_assert(foosball::kTick == 1e-6 * kTickUs);
constexpr std::int64_t kLongestGapUs = 200'000;  // after a longer stall the prediction restarts

// Units of disagreement; clamped, because a blocked rod must not determine the lag alone.
constexpr double kSlideUnit = 0.002;  // [m]
constexpr double kAngleUnit = 0.05;   // [rad]
constexpr double kMaxDisagreement = 16.0;
constexpr float kForget = 0.985f;      // decay of the disagreement per frame: about a second
constexpr float kEnoughToTell = 2.0f;  // minimum spread of the disagreement over the lags

double squared(double x) {
  return x * x;
}

// A man this far from his rod is blocked [rad]; a closer man follows the prediction the more. A hit
// of the ball sets a free man back by less than half of it.
constexpr float kHeld = 0.25f;
float share_of_lead(float apart) {
  constexpr float kTurn = 6.2831853f;
  const float nearest = std::fabs(std::remainder(apart, kTurn));
  return std::clamp(2.0f - 2.0f * nearest / kHeld, 0.0f, 1.0f);
}

// Signed distance outside the range [low, high].
double beyond(double value, double low, double high) {
  return value < low ? value - low : value > high ? value - high : 0.0;
}

}  // namespace

RodPrediction::RodPrediction(foosball::Layout layout) : table_(foosball::table_spec(layout)) {
  for (std::size_t i = 0; i < rods_.size(); ++i) rods_[i].index = static_cast<int>(i);
}

const RodPrediction::Pose& RodPrediction::past(const Rod& rod, int ms_ago) const {
  return rod.history[static_cast<std::size_t>(tick_ - ms_ago) % rod.history.size()];
}

void RodPrediction::restart(Rod& rod, const wire::RodSnapshot& server) {
  rod.state = {server.slide, server.angle, 0.0, 0.0};
  rod.offset = {};
  rod.history.fill({server.slide, server.angle});
}

void RodPrediction::advance(Rod& rod, const wire::InputRod& hand,
                            const foosball::CharacterBody& body, std::int64_t ticks) {
  const foosball::RodSpec& spec = table_.rods[static_cast<std::size_t>(rod.index)];
  const foosball::RodInertia inertia = foosball::rod_inertia(table_, spec, body, tuning_);
  const foosball::RodTarget target{hand.slide, hand.angle, hand.slide_rate, hand.angle_rate, true};
  for (std::int64_t i = 1; i <= ticks; ++i) {
    rod.state = foosball::step_rod(spec, inertia, rod.state, target);
    rod.history[static_cast<std::size_t>(tick_ + i) % rod.history.size()] = {rod.state.slide,
                                                                             rod.state.angle};
  }
}

void RodPrediction::score_lags(const wire::Snapshot& server) {
  for (int ms = 0; ms <= kLongestLagMs; ++ms) {
    float& score = disagreement_[static_cast<std::size_t>(ms)];
    score *= kForget;
    for (const Rod& rod : rods_) {
      if (!rod.predicted) continue;
      const wire::RodSnapshot& seen = server.rods[static_cast<std::size_t>(rod.index)];
      const Pose& then = past(rod, ms);
      const double angle = wire::unwrap_angle(seen.angle, then.angle);
      score += static_cast<float>(std::min(squared((seen.slide - then.slide) / kSlideUnit) +
                                               squared((angle - then.angle) / kAngleUnit),
                                           kMaxDisagreement));
    }
  }
  const auto [best, worst] = std::minmax_element(disagreement_.begin(), disagreement_.end());
  if (*worst - *best > kEnoughToTell) lag_ms_ = static_cast<int>(best - disagreement_.begin());
}

void RodPrediction::correct(Rod& rod, const wire::RodSnapshot& server, double seconds) {
  Pose low = past(rod, lag_ms_), high = low;
  const int from = std::max(lag_ms_ - kLagMarginMs, 0);
  for (int ms = from; ms <= lag_ms_ + kLagMarginMs; ++ms) {
    const Pose& then = past(rod, ms);
    low = {std::min(low.slide, then.slide), std::min(low.angle, then.angle)};
    high = {std::max(high.slide, then.slide), std::max(high.angle, then.angle)};
  }
  const double angle = wire::unwrap_angle(server.angle, past(rod, lag_ms_).angle);
  const double share = 1.0 - std::exp(-seconds / kCorrectionS);
  rod.offset.slide += share * (beyond(server.slide, low.slide, high.slide) - rod.offset.slide);
  rod.offset.angle += share * (beyond(angle, low.angle, high.angle) - rod.offset.angle);
}

void RodPrediction::update(const std::array<wire::InputRod, 8>& hand, const wire::Snapshot& server,
                           std::int64_t now_us) {
  const bool gap = !started_ || now_us < clock_us_ || now_us - clock_us_ > kLongestGapUs;
  const std::int64_t ticks = gap ? 0 : (now_us - clock_us_) / kTickUs;
  const double seconds = gap ? 0.0 : 1e-6 * static_cast<double>(now_us - updated_us_);
  clock_us_ = gap ? now_us : clock_us_ + ticks * kTickUs;
  updated_us_ = now_us;
  started_ = true;
  for (Rod& rod : rods_) {
    const auto i = static_cast<std::size_t>(rod.index);
    const wire::RodSnapshot& seen = server.rods[i];
    const bool predicted = hand[i].driven && !server.paused &&
                           seen.status == number(wire::RodStatus::live) &&
                           seen.source == number(wire::RodSource::client);
    if (gap || !predicted || !rod.predicted) restart(rod, seen);
    rod.predicted = predicted;
    const auto team = static_cast<std::size_t>(table_.rods[i].team);
    const foosball::Character& character = foosball::nearest(characters_, server.character[team]);
    if (predicted) advance(rod, hand[i], character.body, ticks);
  }
  tick_ += ticks;
  score_lags(server);
  for (Rod& rod : rods_) {
    if (rod.predicted) correct(rod, server.rods[static_cast<std::size_t>(rod.index)], seconds);
  }
}

void RodPrediction::apply(wire::Snapshot& scene) const {
  for (const Rod& rod : rods_) {
    if (!rod.predicted) continue;
    const foosball::RodSpec& spec = table_.rods[static_cast<std::size_t>(rod.index)];
    wire::RodSnapshot& drawn = scene.rods[static_cast<std::size_t>(rod.index)];
    const auto slide = static_cast<float>(
        std::clamp(rod.state.slide + rod.offset.slide, -spec.slide_limit, spec.slide_limit));
    const auto angle = static_cast<float>(rod.state.angle + rod.offset.angle);
    const float moved = slide - drawn.slide, half_turn = 0.5f * (angle - drawn.angle);
    const float hand = drawn.angle;
    drawn.slide = slide;
    drawn.angle = angle;
    drawn.slide_rate = static_cast<float>(rod.state.slide_rate);
    drawn.angle_rate = static_cast<float>(rod.state.angle_rate);
    // Each man moves with his rod: q' = (rotation about y) q. A blocked man (he is hinged,
    // Layout::paper) stays where the server has him: the prediction's lead would rotate him through
    // the obstacle.
    for (wire::ManState& man : scene.men) {
      if (man.rod != rod.index) continue;
      man.body.position[1] += moved;
      const auto [x, y, z, w] = man.body.orientation;
      const float share = share_of_lead(2.0f * std::atan2(y, w) - hand);
      const float s = std::sin(share * half_turn), c = std::cos(share * half_turn);
      man.body.orientation = {c * x + s * z, c * y + s * w, c * z - s * x, c * w - s * y};
    }
  }
}

}  // namespace client
