#include "rod_tracker.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "rod_limits.h"

namespace cabinet {
namespace {

// If the fastest hand can move half a wrap of the counts within a gap, the difference of the counts
// is ambiguous. This takes 3.7 s at 8 counts/mm, 0.75 s at 1000 dpi, 63 ms at 12000 cpi.
constexpr double kFastestSurface = 1.1;  // [m/s] of a rod's surface: 140 rad/s on 16 mm
// After a longer gap, the hand has done something else.
constexpr std::int64_t kLongestGapUs = 2'000'000;
constexpr std::int64_t kShortestGapUs = 50'000;  // a dozen lost frames are never a new run

std::int64_t longest_gap_us(const Calibration& calibration) {
  double metres = std::numeric_limits<double>::infinity();  // per count of the finest sensor
  for (const RodCalibration& rod : calibration.rods) {
    metres = std::min({metres, std::hypot(rod.m[0][0], rod.m[0][1]),
                       std::hypot(rod.m[1][0], rod.m[1][1]) * kRodRadius});
  }
  const double us =
      std::min(32767 * metres / kFastestSurface * 1e6, static_cast<double>(kLongestGapUs));
  return std::max(static_cast<std::int64_t>(us), kShortestGapUs);
}

// A restarted micro-controller is accepted if it has been up for less than this ...
constexpr std::uint32_t kBootUs = 10'000'000;
// ... or if nothing was accepted for longer than kLongestGapUs of the host's clock. For over half
// an hour, the device's clock, as a signed difference, appears to run backwards. After that long,
// the difference means nothing, not even that a frame follows.
constexpr std::int64_t kHalfClockUs = std::int64_t{1} << 31;
// ... and if this many frames followed each other: fewer could be late duplicates.
constexpr int kStraysOfNewRun = 4;

// The time between two runs of a device is unknown. This is long enough for every motion to end.
constexpr std::int64_t kBetweenRunsUs = 1'000'000;

std::int32_t elapsed_us(const wire::DeviceFrame& from, const wire::DeviceFrame& to) {
  return static_cast<std::int32_t>(to.time_us - from.time_us);
}

int sequence_step(const wire::DeviceFrame& from, const wire::DeviceFrame& to) {
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(to.sequence - from.sequence));
}

int increment(std::uint16_t from, std::uint16_t to) {
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(to - from));
}

template <class Part, class Of, std::size_t... I>
std::array<Part, kRods> of_each(const Calibration& calibration, const Of& of,
                                std::index_sequence<I...>) {
  return {Part(of(calibration.rods[I]))...};
}
template <class Part, class Of>
std::array<Part, kRods> of_each(const Calibration& calibration, const Of& of) {
  return of_each<Part>(calibration, of, std::make_index_sequence<kRods>());
}

}  // namespace

RodTracker::RodTracker(const Calibration& calibration, const std::array<double, kRods>& slide_limit)
    : slide_limit_(slide_limit),
      longest_gap_us_(longest_gap_us(calibration)),
      integrators_(of_each<RodIntegrator>(calibration, std::identity())),
      filters_(of_each<StateFilter>(calibration, count_of)),
      index_(of_each<IndexReference>(calibration, std::identity())) {}

void RodTracker::calibrate(const Calibration& calibration) {
  longest_gap_us_ = longest_gap_us(calibration);
  integrators_ = of_each<RodIntegrator>(calibration, std::identity());
  filters_ = of_each<StateFilter>(calibration, count_of);
  index_ = of_each<IndexReference>(calibration, std::identity());
  have_last_ = false;
}

bool RodTracker::follows(const wire::DeviceFrame& last, const wire::DeviceFrame& frame) const {
  const std::int32_t elapsed = elapsed_us(last, frame);
  return sequence_step(last, frame) > 0 && elapsed >= 0 && elapsed <= longest_gap_us_;
}

void RodTracker::hold() {
  for (int rod = 0; rod < kRods; ++rod) {
    filters_[rod].rest();
    stand(rod);
    if (rods_[rod].status == RodStatus::live) rods_[rod].status = RodStatus::held;
  }
}

// Rests at the last report.
void RodTracker::stand(int rod) {
  RodInput& input = rods_[rod];
  input.slide = measured_[rod].slide;
  input.angle = measured_[rod].angle;
  input.slide_ahead = input.angle_ahead = 0;
  input.slide_rate = input.angle_rate = 0;
}

void RodTracker::predict(std::int64_t now_us) {
  const std::int64_t device_us = clock_.device_us(now_us);
  for (int rod = 0; rod < kRods; ++rod) {
    RodInput& input = rods_[rod];
    if (input.status != RodStatus::live) continue;
    show_ahead(measured_[rod], filters_[rod].at(device_us), slide_limit_[rod], input);
  }
}

// A frame that does not follow the last accepted one is a late duplicate, or the first of a new run
// (a restart, or a gap too long to trust). In a new run, the frames follow each other.
bool RodTracker::starts_new_run(const wire::DeviceFrame& frame, std::int64_t silent_us) {
  const bool in_row = strays_ > 0 && sequence_step(stray_, frame) == 1 && follows(stray_, frame);
  strays_ = in_row ? strays_ + 1 : 1;
  stray_ = frame;
  const bool later = elapsed_us(last_, frame) > longest_gap_us_ || silent_us > kLongestGapUs;
  return strays_ >= kStraysOfNewRun && (later || frame.time_us < kBootUs);
}

bool RodTracker::accept(const wire::DeviceFrame& frame, std::int64_t arrived_us,
                        std::int64_t now_us, SourceCounters& counters) {
  const std::int64_t silent_us = now_us - accepted_us_;
  if (have_last_ && (silent_us > kHalfClockUs || !follows(last_, frame))) {
    if (!starts_new_run(frame, silent_us)) {
      ++counters.stale;
      return false;
    }
    have_last_ = false;
  }
  if (have_last_) {
    counters.lost += static_cast<std::uint64_t>(sequence_step(last_, frame) - 1);
    clock_us_ += elapsed_us(last_, frame);
  } else {
    based_.fill(false);
    clock_us_ += kBetweenRunsUs;
    clock_.reset();
  }
  strays_ = 0;
  ++counters.frames;
  counters.overflows += static_cast<std::uint64_t>(std::popcount(frame.overflow));
  counters.line_errors += frame.quality;
  clock_.frame(clock_us_, arrived_us);
  for (int rod = 0; rod < kRods; ++rod) advance(rod, frame, now_us, counters);
  predict(now_us);
  last_ = frame;
  accepted_us_ = now_us;
  have_last_ = true;
  return true;
}

// Motion since the last frame. Zero if it is impossible: a sensor dazzled by light, or half of the
// counts' range, whose sign is ambiguous.
RodMotion RodTracker::motion(int rod, const wire::DeviceFrame& frame, SourceCounters& counters) {
  constexpr int kHalfRange = -32768;
  const int slide = increment(last_.slide[rod], frame.slide[rod]);
  const int spin = increment(last_.spin[rod], frame.spin[rod]);
  const double seconds = elapsed_us(last_, frame) * 1e-6;
  const RodMotion moved = integrators_[rod].add(slide, spin, seconds, measured_[rod].angle);
  if (slide != kHalfRange && spin != kHalfRange && possible(moved, seconds)) {
    counts_[rod].slide += slide;
    counts_[rod].spin += spin;
    return moved;
  }
  ++counters.impossible;
  return {0, 0};
}

void RodTracker::advance(int rod, const wire::DeviceFrame& frame, std::int64_t now_us,
                         SourceCounters& counters) {
  RodInput& input = rods_[rod];
  if ((frame.present >> rod & 1) == 0) {  // this mouse was unplugged; the others continue
    filters_[rod].rest();
    stand(rod);
    if (input.status == RodStatus::live) input.status = RodStatus::held;
    based_[rod] = false;
    return;
  }
  const bool follows = std::exchange(based_[rod], true);
  const RodMotion moved = follows ? motion(rod, frame, counters) : RodMotion{0, 0};
  const double seconds = follows ? elapsed_us(last_, frame) * 1e-6 : 0;
  if (!follows) index_[rod].lose();

  filters_[rod].update(moved.slide, moved.angle, clock_us_);
  RodMotion& measured = measured_[rod];
  measured.slide += moved.slide;
  if (slide_limit_[rod] > 0) {
    measured.slide = std::clamp(measured.slide, -slide_limit_[rod], slide_limit_[rod]);
  }
  measured.angle += moved.angle;
  const bool under = (frame.index >> rod & 1) != 0;
  const std::uint64_t disagreements = index_[rod].disagreements();
  measured.angle += index_[rod].frame(under, measured, moved.angle, seconds);
  counters.index_disagreements[rod] += index_[rod].disagreements() - disagreements;
  input.angle_known = index_[rod].known();
  input.time_us = now_us;
  input.status = RodStatus::live;
}

}  // namespace cabinet
