#include "state_filter.h"

#include <algorithm>
#include <cmath>

namespace cabinet {
namespace {

// Max jitter of a mouse's report, in both directions: loop time of its firmware and of ours.
constexpr double kJitterUs = 200;
constexpr double kDrift = 0.004;      // relative, of the period: a ceramic resonator
constexpr double kSynchronous = 1.1;  // [frames] a shorter report period counts as synchronous
constexpr double kShortestUs = 500, kLongestUs = 16'000;
// PS/2 at 200 or 100 reports a second, USB at 125 to 1000.
constexpr std::array<double, 6> kPeriodsUs = {1'000, 2'000, 4'000, 5'000, 8'000, 10'000};
constexpr int kRun = 16;             // reports, enough to resolve the period through frames of 4 ms
constexpr double kFastCounts = 3.0;  // per report: at this speed no report is empty
constexpr double kSlowCounts = 1.5;  // below it, the rate spans the time since the previous count
constexpr double kSlowUs = 100e3;
// A hand's limits: 14 N m on the minimum inertia of a rod with its hand; 350 N on its mass.
constexpr std::array<double, 2> kMaxAcceleration = {300, 14'000};  // [m/s^2], [rad/s^2]
// Assumed braking, since a steadily moving hand may brake at any moment. It costs a steady motion
// 0.75 mm and 1.4 degrees at the end of 5 ms (1 mm and 2 degrees are allowed), and reduces a rod's
// overshoot past a hand that stops within 10 ms by a quarter.
constexpr std::array<double, 2> kBraking = {60, 2'000};  // [m/s^2], [rad/s^2]
constexpr double kBrakingShare = 0.2;  // ... but at most this fraction of a rate per period

double nominal_period(double us) {
  return *std::ranges::min_element(kPeriodsUs, {}, [us](double p) { return std::abs(p - us); });
}

}  // namespace

RodMotion count_of(const RodCalibration& calibration) {
  const auto& m = calibration.m;
  return {std::hypot(m[0][0], m[0][1]), std::hypot(m[1][0], m[1][1])};
}

void StateFilter::rest() {
  moving_ = false;
  known_ = 0;
  lines_ = {};
}

// A sensor that reports in every frame is polled for it.
bool StateFilter::synchronous() const {
  return !stamped_ && period_us_ < kSynchronous * interval_us_;
}

// Bounds the time of the report: after one frame, until the next, and a whole number of periods
// after the previous report.
void StateFilter::locate(const Bounds& frames, bool fast) {
  const Bounds possible{frames.after_us - kJitterUs, frames.until_us};
  if (located_) learn_period(frames.until_us, fast);
  const double since = possible.after_us - bounds_.until_us;
  const double periods = std::max(1.0, std::ceil(since / period_us_));
  if (stamped_ || synchronous()) {
    bounds_ = {frames.until_us, frames.until_us};
    return;
  }
  const double drift = kDrift * periods * period_us_;
  const Bounds expected{bounds_.after_us + periods * period_us_ - drift,
                        bounds_.until_us + periods * period_us_ + drift};
  const Bounds both{std::max(possible.after_us, expected.after_us),
                    std::min(possible.until_us, expected.until_us)};
  bounds_ = located_ && both.after_us <= both.until_us ? both : possible;
}

// A sensor's driver sets its rate to one of a few values. Its own clock is off by less than kDrift.
void StateFilter::learn_period(double until_us, bool fast) {
  const double gap = until_us - seen_us_;
  if (gap < 0.5 * period_us_) {  // no sensor reports early
    period_us_ = nominal_period(gap);
    run_ = 0;
  }
  run_ = fast && gap < kLongestUs ? run_ + 1 : 0;
  if (run_ == 1) run_began_us_ = until_us;
  if (run_ <= kRun) return;
  period_us_ = nominal_period((until_us - run_began_us_) / kRun);
  run_ = 0;
}

void StateFilter::append(double time_us, const std::array<double, 2>& step) {
  const Report before = report(0);
  newest_ = (newest_ + 1) % kReports;
  known_ = std::min(known_ + 1, kReports);
  reports_[newest_] = {time_us, {before.position[0] + step[0], before.position[1] + step[1]}};
}

// Number of previous reports on the line from the first of them to the last report.
int StateFilter::steady_reports(int axis) const {
  const Report& last = report(0);
  int steady = 1;
  for (int first = 2; first < known_; ++first) {
    const Report& from = report(first);
    const double slope =
        (last.position[axis] - from.position[axis]) / (last.time_us - from.time_us);
    const double noise = count_[axis] + std::abs(slope) * kJitterUs;
    for (int k = 1; k < first; ++k) {
      const double on_line = last.position[axis] + slope * (report(k).time_us - last.time_us);
      if (std::abs(report(k).position[axis] - on_line) > noise) return steady;
    }
    steady = first;
  }
  return steady;
}

StateFilter::Line StateFilter::line(int axis) const {
  if (known_ < 2) return {};
  const int steady = steady_reports(axis);
  const Report &now = report(0), &from = report(steady);
  const double rate =
      1e6 * (now.position[axis] - from.position[axis]) / (now.time_us - from.time_us);
  if (steady >= 3 || known_ < 3) {
    const double braking =
        std::min(kBraking[axis], kBrakingShare * std::abs(rate) / (1e-6 * period_us_));
    return {rate, -std::copysign(braking, rate)};
  }
  const Report &one = report(1), &two = report(2);
  const double first =
      1e6 * (now.position[axis] - one.position[axis]) / (now.time_us - one.time_us);
  const double second =
      1e6 * (one.position[axis] - two.position[axis]) / (one.time_us - two.time_us);
  const double bound = kMaxAcceleration[axis];
  const double acceleration =
      std::clamp(2e6 * (first - second) / (now.time_us - two.time_us), -bound, bound);
  const double last = first + 0.5e-6 * acceleration * (now.time_us - one.time_us);
  if (last * first < 0) return {};  // it has come to rest since
  return {last, acceleration};
}

// Whether the next report would have arrived by this frame.
bool StateFilter::due(double frame_us) const {
  if (synchronous()) return frame_us > bounds_.until_us;
  return frame_us >= bounds_.until_us + period_us_ + kJitterUs;
}

void StateFilter::update(double d_slide, double d_angle, std::int64_t frame_us) {
  const auto now = static_cast<double>(frame_us);
  const Bounds frames{started_ ? frame_us_ : now - interval_us_, now};
  const double elapsed = frames.until_us - frames.after_us;
  if (elapsed > 0) interval_us_ += 0.25 * (std::min(elapsed, kLongestUs) - interval_us_);
  frame_us_ = now;
  started_ = true;
  if (d_slide == 0 && d_angle == 0) {
    if (moving_ && due(now)) rest();
    return;
  }
  const double counts = std::max(std::abs(d_slide) / count_[0], std::abs(d_angle) / count_[1]);
  const double last = bounds_.middle();
  const bool gap = elapsed > 1.5 * std::max(period_us_, interval_us_);  // frames were lost
  locate(frames, counts > kFastCounts && !gap);
  const double time = bounds_.middle();
  if (gap || !moving_) {
    const bool slow = counts < kSlowCounts && located_ && time - last < kSlowUs;
    reports_[newest_].time_us = gap ? frames.after_us : slow ? last : time - period_us_;
    known_ = 1;
    moving_ = true;
    if (!gap && !slow) {  // also at rest one period earlier
      const Report stood = reports_[newest_];
      reports_[newest_].time_us -= period_us_;
      append(stood.time_us, {0, 0});
    }
  }
  // Several reports may have the same time: those before are moved apart, since rates divide by the
  // time between two.
  double latest = time - kShortestUs;
  for (int k = 0; k < known_ && report(k).time_us > latest; ++k, latest -= kShortestUs)
    report(k).time_us = latest;
  append(time, {d_slide, d_angle});
  located_ = true;
  seen_us_ = now;
  lines_ = {line(0), line(1)};
}

RodAhead StateFilter::at(std::int64_t time_us) const {
  if (!moving_) return {};
  const Report& last = report(0);
  // Limit of the extrapolation if no more frames arrive: beyond the next report, the motion is
  // unknown.
  const double until = last.time_us + std::max(period_us_, interval_us_) + interval_us_;
  const double time = std::max(static_cast<double>(time_us), frame_us_);
  const double s = 1e-6 * (std::clamp(time, last.time_us, until) - last.time_us);
  std::array<double, 2> ahead{}, rate{};
  for (int axis = 0; axis < 2; ++axis) {
    const Line& line = lines_[axis];
    const bool brakes = line.rate * line.acceleration < 0;
    const double t = brakes ? std::min(s, -line.rate / line.acceleration) : s;
    ahead[axis] = t * (line.rate + 0.5 * line.acceleration * t);
    rate[axis] = t < s || time > until ? 0 : line.rate + line.acceleration * t;
  }
  return {ahead[0], ahead[1], rate[0], rate[1]};
}

}  // namespace cabinet
