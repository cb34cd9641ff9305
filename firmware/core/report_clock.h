// Schedules a sample so that its report is ready just before the host polls for it. The host polls
// once a millisecond, at a constant phase except for its jitter. An earlier sample is older when it
// arrives; a later report waits a full millisecond.
//
// Times are in microseconds and wrap.
#ifndef FIRMWARE_CORE_REPORT_CLOCK_H
#define FIRMWARE_CORE_REPORT_CLOCK_H

#include <stdint.h>

namespace firmware {

class ReportClock {
 public:
  static constexpr uint16_t kPeriodUs = 1000;
  static constexpr uint16_t kTransferUs = 52;   // from the host's poll until it has 64 bytes
  static constexpr uint16_t kMinMarginUs = 12;  // by which the host may poll early
  static constexpr uint16_t kMaxMarginUs = 300;
  static constexpr uint16_t kMissedUs = 30;  // added to the margin for each late report
  static constexpr uint16_t kCalm = 16;    // reports in time after which the margin shrinks by 1 us
  static constexpr uint8_t kSettling = 8;  // reports to ignore after a silence

  void begin(uint32_t now_us) { next_us_ = now_us; }
  bool due(uint32_t now_us) const { return static_cast<int32_t>(now_us - next_us_) >= 0; }
  uint32_t next_us() const { return next_us_; }
  uint16_t margin_us() const { return margin_us_; }

  // Call when a due sample has ended and its report is ready. Schedules the next one a period
  // later, unless taken() corrects it. Any other delay counts as work, as it will recur.
  void sampled(uint32_t ready_us) {
    uint32_t work = ready_us - next_us_;
    if (work > kPeriodUs / 2) work = work_us_;  // an interruption, such as a write to flash
    if (work > work_us_) {
      // A report late for this reason says nothing about the host.
      if (work - work_us_ > kMinMarginUs) settling_ = kSettling;
      work_us_ = static_cast<uint16_t>(work);
    }
    next_us_ += kPeriodUs;
    // Skips the samples missed during an interruption.
    if (static_cast<int32_t>(ready_us - next_us_) >= 0) next_us_ = ready_us + kPeriodUs / 2;
  }

  // The host took a report at this time.
  void taken(uint32_t at_us) {
    const uint32_t interval = at_us - taken_us_;
    taken_us_ = at_us;
    if (interval >= kPeriodUs * 5 / 2) settling_ = kSettling;
    if (settling_ != 0) {
      --settling_;
    } else if (interval < kPeriodUs - 2 && interval > kPeriodUs / 2) {
      widen(static_cast<uint16_t>(kMinMarginUs + 2 * (kPeriodUs - interval)));
    } else if (interval > kPeriodUs * 3 / 2 && interval < kPeriodUs * 5 / 2) {
      widen(static_cast<uint16_t>(margin_us_ + kMissedUs));
    } else if (++calm_ == kCalm) {
      calm_ = 0;
      if (margin_us_ > kMinMarginUs) --margin_us_;
      if (work_us_ > 0) --work_us_;  // decays from the maximum; grows again if that is usual
    }
    next_us_ = at_us + kPeriodUs - kTransferUs - work_us_ - margin_us_;
  }

 private:
  void widen(uint16_t margin_us) {
    calm_ = 0;
    if (margin_us > kMaxMarginUs) margin_us = kMaxMarginUs;
    if (margin_us > margin_us_) margin_us_ = margin_us;
  }

  uint32_t next_us_ = 0;
  uint32_t taken_us_ = 0;
  uint16_t work_us_ = 0;
  uint16_t margin_us_ = kMinMarginUs;
  uint16_t calm_ = 0;
  uint8_t settling_ = kSettling;
};

}  // namespace firmware

#endif
