// From a device's frames to rods: which frames count, how far each rod moved, how fast.
//
// Counts are cumulative and wrap: an increment is the 16-bit difference, so that a lost frame loses
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
  // slide_limit: |slide| never passes it [m]; 0 means no limit. A handle pushed to its end stop is
  // thereby brought back to zero error, as a rod turned past its index mark is in its angle.
  RodTracker(const Calibration& calibration, const std::array<double, kRods>& slide_limit);

  // False: stale, counted and dropped. arrived_us: when the frame came, as far as is known; at
  // most now_us, and on the same clock.
  bool accept(const wire::DeviceFrame& frame, std::int64_t arrived_us, std::int64_t now_us,
              SourceCounters& counters);
  // Moves the rods on to where they are now, by the reports of before.
  void predict(std::int64_t now_us);
  // The device is gone or silent: rods that were live are held, at once and with zero rates.
  void hold();
  // The next frame is of another run of the device: it moves nothing.
  void forget_base() { have_last_ = false; }
  // From the next run on; the rods stay where they are.
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
  std::int64_t longest_gap_us_;  // over which counts are trusted
  std::array<RodIntegrator, kRods> integrators_;
  std::array<RodMotion, kRods> measured_{};  // as of the last report
  RodInputs rods_{};
  RodCounts counts_{};
  std::array<StateFilter, kRods> filters_;
  std::array<IndexReference, kRods> index_;
  ClockMap clock_;
  wire::DeviceFrame last_{};
  bool have_last_ = false;
  std::int64_t accepted_us_ = 0;     // the host's clock at last_
  std::array<bool, kRods> based_{};  // last_ holds counts from which this rod may go on
  std::int64_t clock_us_ = 0;        // the device's clock without its wraps, at last_
  wire::DeviceFrame stray_{};        // the last frame that did not follow
  int strays_ = 0;                   // how many in a row followed each other
};

}  // namespace cabinet
