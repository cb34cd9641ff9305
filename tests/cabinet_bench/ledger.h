// Whether a controller's counts are those that its sensors have told, or else a fault was counted.
//
// Of each rod it is known which counts the sensor has told until when (the truth), and how far the
// frames' counts are off from them: 0 at first, and after a loss that was counted whatever the next
// frames say. Between frames without a counted fault that difference may not change.
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
    std::uint64_t exact = 0;   // of frames and rods: the counts are those that were told
    std::uint64_t behind = 0;  // ... or not known yet: a loss whose fault is still awaited
    std::uint64_t absent = 0;  // ... or the frame says that the sensor does not answer
    std::uint64_t losses = 0;  // times that counts were missing, explained by a fault in the frames
    std::uint64_t unexplained = 0;
    std::uint64_t errors = 0, resynchronised = 0, overflows = 0, absences = 0, restarts = 0;
  };

  void told(int rod, const std::vector<Told>& told);
  void heard(const wire::DeviceFrame& frame, std::int64_t now_us);
  const Totals& totals() const { return totals_; }
  const std::vector<std::string>& violations() const { return violations_; }

  // A frame's counts are as old as this at most: made before it was asked for, and on the line.
  // Less than a mouse's 5 ms, so that a lost report does not look like a late one.
  static constexpr std::int64_t kOldUs = 4'000;
  // An error is counted no later than this after the loss.
  static constexpr std::int64_t kCountedUs = 60'000;
  // A sensor that is gone is known to be within this.
  static constexpr std::int64_t kMissedUs = 1'600'000;

 private:
  struct Offset {  // of the frames' counts from those that were told, modulo 2^16
    std::uint16_t slide = 0, spin = 0;
    bool operator==(const Offset&) const = default;
  };
  struct Rod {
    std::deque<Told> told;            // the last one that is older than kOldUs, and those after it
    std::vector<Offset> offsets{{}};  // those that all frames since the last loss agree with
    std::int64_t good_us = 0;         // the last frame that agreed
    std::int64_t fault_us = -1;       // the last that was counted for this rod
    bool present = false, lost = false;
    bool back = false;  // it was absent in the frame before
  };

  void note_faults(const wire::DeviceFrame& frame, std::int64_t now_us);
  void judge(int rod, const wire::DeviceFrame& frame, std::int64_t now_us);
  static bool agrees(Rod& rod, Offset counts);
  static std::vector<Offset> possible(const Rod& rod, Offset counts);
  bool explained(const Rod& rod) const;

  PerRod<Rod> rods_{};
  std::optional<wire::DeviceFrame> last_;
  std::deque<std::int64_t> errors_us_;  // frames that counted an error of whatever rod
  Totals totals_;
  std::vector<std::string> violations_;
};

}  // namespace cabinet_bench
