// Computes rod motion from a device's frames: which frames are valid, how far each rod moved, and
// how fast.
//
// Counts are cumulative and wrap. An increment is a 16-bit difference, so a lost frame loses
// nothing as long as a rod moves less than 32767 counts between two accepted frames.
#pragma once

#include <array>
#include <cstdint>

#include "cabinet/calibration.h"
#include "cabinet/rod_input.h"
#include "clock_map.h"
#include "index_reference.h"
#include "state_filter.h"
#include "wire/device_frame.h"

namespace cabinet {

class RodTracker {
 public:
  // slide_limit: |slide| is clamped to it [m]; 0: no limit. So a handle at its end stop gets zero
  // error, just as a pass of the index mark corrects the angle.
  RodTracker(const Calibration& calibration, const std::array<double, kRods>& slide_limit);

  // False: the frame is stale; it is counted and dropped. arrived_us: arrival time of the frame, as
  // far as known; at most now_us, on the same clock.
  bool accept(const wire::DeviceFrame& frame, std::int64_t arrived_us, std::int64_t now_us,
              SourceCounters& counters);
  // Extrapolates the rods to now from previous reports.
  void predict(std::int64_t now_us);
  // The device is disconnected or silent: live rods become held at once, with zero rates.
  void hold();
  // The next frame is from another run of the device and moves nothing.
  void forget_base() { have_last_ = false; }
  // Applies from the next run on; the rods keep their poses.
  void calibrate(const Calibration& calibration);

  const RodInputs& rods() const { return rods_; }
  const RodCounts& counts() const { return counts_; }
  const RodMotion& measured(int rod) const { return measured_[rod]; }  // as of the last report
  std::uint32_t last_frame_time_us() const { return last_.time_us; }

 private:
  bool follows(const wire::DeviceFrame& last, const wire::DeviceFrame& frame) const;
  bool starts_new_run(const wire::DeviceFrame& frame, std::int64_t silent_us);
  RodMotion motion(int rod, const wire::DeviceFrame& frame, SourceCounters& counters);
  void stand(int rod);
  void advance(int rod, const wire::DeviceFrame& frame, std::int64_t now_us,
               SourceCounters& counters);

  std::array<double, kRods> slide_limit_;
  std::int64_t longest_gap_us_;  // max interval over which increments are valid
  std::array<RodIntegrator, kRods> integrators_;
  std::array<RodMotion, kRods> measured_{};  // as of the last report
  RodInputs rods_{};
  RodCounts counts_{};
  std::array<StateFilter, kRods> filters_;
  std::array<IndexReference, kRods> index_;
  ClockMap clock_;
  wire::DeviceFrame last_{};
  bool have_last_ = false;
  std::int64_t accepted_us_ = 0;     // host time of last_
  std::array<bool, kRods> based_{};  // last_ has counts from which this rod's increments are valid
  std::int64_t clock_us_ = 0;        // the device's clock without wrapping, at last_
  wire::DeviceFrame stray_{};        // the last frame that did not follow last_
  int strays_ = 0;                   // number of such frames in a row that follow each other
};

}  // namespace cabinet
