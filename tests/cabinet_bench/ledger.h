// Checks that a controller's counts equal those that its sensors reported, or that a fault was
// counted.
//
// The sensor's reported counts over time are known for each rod (the truth). The ledger tracks the
// offset of the frames' counts from them. It is 0 at first. After a counted loss the next frames
// define it. Between frames without a counted fault the offset must not change.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "controller.h"
#include "wire/device_frame.h"

namespace cabinet_bench {

class Ledger {
 public:
  struct Totals {
    std::uint64_t frames = 0;
    std::uint64_t exact = 0;   // of frames and rods: the counts equal the reported ones
    std::uint64_t behind = 0;  // ... or not decided yet: a loss whose fault is still awaited
    std::uint64_t absent = 0;  // ... or the frame says that the sensor does not answer
    std::uint64_t losses = 0;  // number of losses of counts that a fault in the frames explains
    std::uint64_t unexplained = 0;
    std::uint64_t errors = 0, resynchronised = 0, overflows = 0, absences = 0, restarts = 0;
  };

  void told(int rod, const std::vector<Told>& told);
  void record(const wire::DeviceFrame& frame, std::int64_t now_us);
  const Totals& totals() const { return totals_; }
  const std::vector<std::string>& violations() const { return violations_; }

  // Maximum age of a frame's counts: they were read before the frame was requested, and took time
  // on the line. Less than a mouse's 5 ms, so that a lost report does not look like a late one.
  static constexpr std::int64_t kOldUs = 4'000;
  // Maximum time from a loss until its error is counted.
  static constexpr std::int64_t kCountedUs = 60'000;
  // Maximum time until an absent sensor is known to be absent.
  static constexpr std::int64_t kMissedUs = 1'600'000;

 private:
  struct Offset {  // of the frames' counts from the reported ones, modulo 2^16
    std::uint16_t slide = 0, spin = 0;
    bool operator==(const Offset&) const = default;
  };
  struct Rod {
    std::deque<Told> told;            // the last report older than kOldUs, and all later ones
    std::vector<Offset> offsets{{}};  // consistent with all frames since the last loss
    std::int64_t good_us = 0;         // the last consistent frame
    std::int64_t fault_us = -1;       // the last fault counted for this rod
    bool present = false, lost = false;
    bool back = false;  // it was absent in the previous frame
  };

  void note_faults(const wire::DeviceFrame& frame, std::int64_t now_us);
  void judge(int rod, const wire::DeviceFrame& frame, std::int64_t now_us);
  static bool agrees(Rod& rod, Offset counts);
  static std::vector<Offset> possible(const Rod& rod, Offset counts);
  bool explained(const Rod& rod) const;

  PerRod<Rod> rods_{};
  std::optional<wire::DeviceFrame> last_;
  std::deque<std::int64_t> errors_us_;  // times of frames that counted an error of any rod
  Totals totals_;
  std::vector<std::string> violations_;
};

}  // namespace cabinet_bench
