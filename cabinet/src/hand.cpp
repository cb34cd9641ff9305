#include "cabinet/hand.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cabinet {
namespace {

constexpr double kKeyRate = 1.2;      // [m/s] slide rate after the ramp: the goal's width in 0.17 s
constexpr double kKeyRamp = 12.0;     // [m/s^2]: a tap moves a few mm, full rate after 0.1 s
constexpr double kPadRate = 1.5;      // [m/s] at full deflection
constexpr double kKeySwingRate = 60;  // [rad/s]: a foot at 72 mm hits at 4.3 m/s
constexpr double kPadSwingRate = 140;  // [rad/s]: the fastest rotation by a person
constexpr double kStrikes = 6.0;       // [rad/s] below this, a rod is only being adjusted
// Max step after a stalled window [s], so that it does not fling the rods. A window with 10 frames
// per second does not count as stalled.
constexpr double kLongestStep = 0.11;
constexpr int kMaxTaps = 4;  // per poll

// A mouse reports at least every 8 ms. A poll without events this long after the last movement
// means that the hand is at rest. With a longer hold, the rate would drive the rod past where the
// hand stopped.
constexpr std::int64_t kReportUs = 8'000;
constexpr std::int64_t kRateHoldUs = 9'000;

double finite(double value) {
  return std::isfinite(value) ? value : 0;
}

float axis(float value) {
  return std::isfinite(value) ? std::clamp(value, -1.0f, 1.0f) : 0;
}

// 0 inside the dead zone, then linear from 0 to 1, so that nothing jumps at its boundary.
double outside_dead_zone(float value) {
  const float beyond = std::max(std::abs(value) - kStickDeadZone, 0.0f) / (1 - kStickDeadZone);
  return std::copysign(beyond, value);
}

double larger(double a, double b) {
  return std::abs(a) >= std::abs(b) ? a : b;
}

double towards(double from, double to, double step) {
  return from + std::clamp(to - from, -step, step);
}

}  // namespace

Hand::Hand(const HandOptions& options)
    : options_(options),
      lines_{Line{.rate{kReportUs, kRateHoldUs}}, Line{.rate{kReportUs, kRateHoldUs}},
             Line{.rate{kReportUs, kRateHoldUs}}, Line{.rate{kReportUs, kRateHoldUs}}} {
  for (int away = 0; away < 4 && !options_.has[line_]; ++away) line_ = (line_ + 3) % 4;
}

void Hand::slide_by(Line& line, double metres, double limit) {
  line.slide = std::clamp(line.slide + metres, -limit, limit);  // no wind-up beyond the stop
  line.moved = true;
}

void Hand::mouse_moved(double right_px, double forward_px) {
  const double right = finite(right_px), forward = finite(forward_px);
  if (right == 0 && forward == 0) return;
  Line& line = lines_[line_];
  slide_by(line, options_.slide_sign * options_.metres_per_pixel * right,
           options_.slide_limit[line_]);
  if (forward == 0) return;
  line.angle += options_.angle_sign * options_.radians_per_pixel * forward;
  line.swinging = false;  // mouse motion overrides a flick
}

void Hand::choose(int line) {
  if (line >= 0 && line < 4 && options_.has[line]) line_ = line;
}

void Hand::cycle(int steps) {
  const int way = steps > 0 ? 1 : -1;
  for (int left = std::min(std::abs(steps), 4); left > 0; --left) {
    int next = line_ + way;
    while (next >= 0 && next < 4 && !options_.has[next]) next += way;
    if (next >= 0 && next < 4) line_ = next;
  }
}

void Hand::key_axis(double slide, double spin) {
  key_slide_ = std::clamp(finite(slide), -1.0, 1.0);
  key_spin_ = std::clamp(finite(spin), -1.0, 1.0);
}

void Hand::key_taps(int slide, int spin) {
  slide_taps_ = std::clamp(slide, -kMaxTaps, kMaxTaps);
  spin_taps_ = std::clamp(spin, -1, 1);
}

void Hand::pad(const PadState& state) {
  const bool previous = state.previous_rod && !pad_.previous_rod;
  const bool next = state.next_rod && !pad_.next_rod;
  cycle((next ? 1 : 0) - (previous ? 1 : 0));
  pad_ = {axis(state.left_x),  axis(state.left_y), axis(state.right_x),
          axis(state.right_y), state.previous_rod, state.next_rod};
}

void Hand::adopt(int rod, double slide, double angle) {
  if (!std::isfinite(slide) || !std::isfinite(angle)) return;
  for (int i = 0; i < 4; ++i) {
    Line& line = lines_[i];
    if (options_.rods[i] != rod || line.moved) continue;
    line.slide = std::clamp(slide, -options_.slide_limit[i], options_.slide_limit[i]);
    line.angle = angle;
    line.sent_slide = line.slide;  // an adopted pose is not motion: no rate
    line.sent_angle = line.angle;
  }
}

void Hand::release() {
  for (Line& line : lines_) line.moved = line.swinging = false;
}

void Hand::place(int rod, double slide, double angle) {
  if (!std::isfinite(slide) || !std::isfinite(angle)) return;
  for (int i = 0; i < 4; ++i) {
    Line& line = lines_[i];
    if (options_.rods[i] != rod) continue;
    line.slide = line.sent_slide =
        std::clamp(slide, -options_.slide_limit[i], options_.slide_limit[i]);
    line.angle = line.sent_angle = angle;
    line.moved = true;
    line.swinging = false;
  }
}

bool Hand::strikes() const {
  const RodInput& rod = rods_[options_.rods[line_]];
  return swing_wanted() != 0 || spin_taps_ != 0 || std::abs(rod.angle_rate) > kStrikes;
}

int Hand::active_line() const {
  return line_;
}
int Hand::active_rod() const {
  return options_.rods[line_];
}

double Hand::swing_wanted() const {
  return larger(key_spin_, outside_dead_zone(pad_.right_y));
}

void Hand::drive_slide(double seconds) {
  // The key's ramp: rises with kKeyRamp, and drops to zero at once on release or reversal.
  if (key_slide_ == 0 || key_slide_ * key_rate_ < 0) key_rate_ = 0;
  key_rate_ = towards(key_rate_, key_slide_ * kKeyRate, kKeyRamp * seconds);
  const double stick = larger(outside_dead_zone(pad_.left_x), outside_dead_zone(pad_.left_y));
  const double way = larger(key_rate_, stick * kPadRate) * seconds + kTapSlide * slide_taps_;
  slide_taps_ = 0;
  if (way == 0) return;
  slide_by(lines_[line_], options_.slide_sign * way, options_.slide_limit[line_]);
}

void Hand::drive_swing(int index, double seconds) {
  Line& line = lines_[index];
  const bool tapped = index == line_ && spin_taps_ != 0 && swing_wanted() == 0;
  const double wanted = tapped ? spin_taps_ : index == line_ ? swing_wanted() : 0;
  if (wanted != 0 && !line.swinging) {
    constexpr double turn = 2 * std::numbers::pi;
    line.rest_angle = turn * std::round(line.angle / turn);
    line.swinging = line.moved = true;
  }
  if (!line.swinging) return;
  const bool by_stick = key_spin_ == 0 && wanted != 0;
  const double target = line.rest_angle + options_.angle_sign * wanted * kSwing;
  // A tap ends before the next poll, so this poll applies the full flick.
  const double reach = (by_stick ? kPadSwingRate : kKeySwingRate) * seconds;
  line.angle = tapped ? target : towards(line.angle, target, reach);
  if (wanted == 0 && line.angle == line.rest_angle) line.swinging = false;
}

void Hand::poll(std::int64_t now_us) {
  const double elapsed = started_ ? static_cast<double>(now_us - last_us_) * 1e-6 : 0;
  const double seconds = std::clamp(elapsed, 0.0, kLongestStep);
  started_ = true;
  last_us_ = now_us;
  ++counters_.frames;

  drive_slide(seconds);
  for (int i = 0; i < 4; ++i) {
    drive_swing(i, seconds);
    if (i == line_) spin_taps_ = 0;
    Line& line = lines_[i];
    line.rate.update(line.slide - line.sent_slide, line.angle - line.sent_angle, now_us);
    line.sent_slide = line.slide;
    line.sent_angle = line.angle;
    if (!options_.has[i]) continue;
    rods_[options_.rods[i]] = {
        line.slide, line.angle,     line.rate.slide_rate(), line.rate.angle_rate(),
        now_us,     RodStatus::live};
  }
}

const RodInputs& Hand::rods() const {
  return rods_;
}
const SourceCounters& Hand::counters() const {
  return counters_;
}
const std::string& Hand::name() const {
  return name_;
}

}  // namespace cabinet
