#include "cabinet/rate_filter.h"

#include <algorithm>

namespace cabinet {
namespace {

// Gain of a new instantaneous rate: halves the jitter of 5 ms reports seen through 4 ms frames, and
// follows a flick in two reports. A smaller gain is smoother and slower.
constexpr double kGain = 0.6;
// Min time between two increments: a stopped clock must not give infinite rates.
constexpr std::int64_t kMinIntervalUs = 500;

}  // namespace

void RateFilter::rest() {
  moving_ = false;
  slide_rate_ = angle_rate_ = 0;
}

void RateFilter::update(double d_slide, double d_angle, std::int64_t time_us) {
  const std::int64_t since_update = started_ ? time_us - updated_us_ : report_us_;
  updated_us_ = time_us;
  started_ = true;
  if (moving_ && time_us - moved_us_ > hold_us_) {
    moving_ = false;
    slide_rate_ = angle_rate_ = 0;
  }
  if (d_slide == 0 && d_angle == 0) return;

  const std::int64_t interval =
      std::max(moving_ ? time_us - moved_us_ : std::max(since_update, report_us_), kMinIntervalUs);
  const double seconds = static_cast<double>(interval) * 1e-6;
  const double gain = moving_ ? kGain : 1.0;
  slide_rate_ += gain * (d_slide / seconds - slide_rate_);
  angle_rate_ += gain * (d_angle / seconds - angle_rate_);
  moved_us_ = time_us;
  moving_ = true;
}

}  // namespace cabinet
