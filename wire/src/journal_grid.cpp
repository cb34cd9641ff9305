// The journal's grid: converts SI units to integer units, and back.
#include <algorithm>
#include <cmath>
#include <limits>

#include "quantise.h"
#include "wire/journal.h"

namespace wire {
namespace {

constexpr double kSlide = 1e7, kAngle = 1e6, kSlideRate = 1e6, kAngleRate = 1e3;  // per unit

// value * per_unit, rounded to the nearest integer, saturating at +-limit.
std::int64_t whole(double value, double per_unit, std::int64_t limit) {
  constexpr double kBeyond = 1e10;  // above any limit, and far from overflow
  return nearest_step(std::clamp(value, -kBeyond, kBeyond) * per_unit, 1.0, -limit, limit);
}

std::int32_t whole32(double value, double per_unit) {
  return static_cast<std::int32_t>(
      whole(value, per_unit, std::numeric_limits<std::int32_t>::max()));
}

}  // namespace

JournalRod quantise_rod(const RodTargetValues& v) {
  if (!std::isfinite(v.slide) || !std::isfinite(v.angle) || !std::isfinite(v.slide_rate) ||
      !std::isfinite(v.angle_rate)) {
    return {};
  }
  JournalRod rod;
  rod.slide_100nm = whole32(v.slide, kSlide);
  rod.angle_urad = whole(v.angle, kAngle, kJournalAngleLimit);
  rod.slide_rate_um_s = whole32(v.slide_rate, kSlideRate);
  rod.angle_rate_mrad_s = whole32(v.angle_rate, kAngleRate);
  rod.live = v.live;
  return rod;
}

// Division instead of multiplication by 1e-7: it gives the nearest double on every machine, so that
// quantising the result again is exact.
RodTargetValues dequantise_rod(const JournalRod& rod) {
  return {rod.slide_100nm / kSlide, static_cast<double>(rod.angle_urad) / kAngle,
          rod.slide_rate_um_s / kSlideRate, rod.angle_rate_mrad_s / kAngleRate, rod.live};
}

}  // namespace wire
