#include "index_reference.h"

#include <algorithm>
#include <cmath>

#include "state_filter.h"

namespace cabinet {
namespace {

constexpr double kDegree = M_PI / 180;
// Max angle step of a report at the edges: the angle of each edge is known to half of it, and the
// switch is read up to a millisecond late. 9 rad/s at 1000 reports a second.
constexpr double kMaxStep = 0.5 * kDegree;
// A coarse sensor has steps of a count, however slow the rod.
constexpr double kMaxCounts = 1.5;
// Tolerance of the width, as a fraction: a pass of similar width is of this mark, at its position
// along the rod.
constexpr double kMaxOff = 0.25, kMaxOffAngle = 3 * kDegree;
constexpr double kQuarterTurn = M_PI / 2;
// A man's foot, 75 mm from the axis, moves at 15 mm/s; one degree is corrected in 0.1 s.
constexpr double kRate = 0.2;
// The first correction may be half a turn: it takes half a second, so that no foot shoots a ball.
constexpr double kFirstRate = 6;  // [rad/s]
// Fraction of a pass's correction. The rest is left to the next one, which averages their errors.
constexpr double kShare = 0.7;

}  // namespace

IndexReference::IndexReference(const RodCalibration& calibration)
    : mark_(calibration.index),
      max_step_(std::max(kMaxStep, kMaxCounts * std::abs(count_of(calibration).angle))) {}

void IndexReference::lose() {
  passes_.forget();
  known_ = false;
  left_ = 0;
}

double IndexReference::frame(bool under, const RodMotion& at, double turned, double seconds) {
  if (!mark_) return 0;
  if (const auto pass = passes_.add(under, at, turned, seconds)) take(*pass);
  if (left_ == 0 || passes_.passing()) return 0;  // both edges must be in the same angle
  const double step = std::clamp(left_, -rate_ * seconds, rate_ * seconds);
  left_ -= step;
  return step;
}

void IndexReference::take(const IndexPass& pass) {
  const double off_width = std::abs(std::abs(pass.turned) - mark_->width);
  if (pass.step > max_step_ || off_width > std::max(kMaxOff * mark_->width, kMaxOffAngle)) return;
  const double middle = pass.middle - std::copysign(mark_->lag, pass.turned);
  const double wrong = std::remainder(mark_->angle - middle, 2 * M_PI);
  // The first correction is still in progress.
  const bool turning = rate_ == kFirstRate && left_ != 0;
  if (!known_ || turning) {
    known_ = true;
    left_ = wrong;
    rate_ = kFirstRate;
    return;
  }
  if (std::abs(wrong) > kQuarterTurn) {
    ++disagreements_;
    return;
  }
  left_ = kShare * wrong;
  rate_ = kRate;
}

}  // namespace cabinet
