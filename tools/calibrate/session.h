// A calibration of the cabinet from beginning to end: rod after rod, each led by a guide, fitted,
// and kept as soon as it fits. Knows no window and no device: frames and keys are handed in.
#pragma once

#include <array>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "cabinet/calibration_fit.h"
#include "cabinet/calibration_guide.h"
#include "cabinet/device.h"
#include "foosball/table.h"
#include "wire/device_frame.h"

namespace calibrate {

enum class RodState {
  open,     // not calibrated in this session
  guided,   // its guide asks
  fitted,   // and kept
  refused,  // its run could not be fitted: problem() says why
};

// For the live trace: counts since the session began.
struct TracePoint {
  double seconds;  // of the controller's clock, since the session began
  double slide, spin;
};

struct SessionOptions {
  foosball::Layout layout = foosball::Layout::tournament;
  std::vector<int> rods{0, 1, 2, 3, 4, 5, 6, 7};                // in this order
  cabinet::Calibration start = cabinet::nominal_calibration();  // of the rods that are left alone
};

class Session {
 public:
  explicit Session(const SessionOptions& options);

  void hear(const wire::DeviceFrame& frame);
  // What the controller's line is like now; error: errno of an attempt to open it.
  void line_is(cabinet::DeviceState state, int error);
  cabinet::DeviceState line() const { return line_; }
  int line_error() const { return line_error_; }
  // This rod was started again: frames were missing, and with them counts.
  bool interrupted() const { return interrupted_; }
  // The one key that everything can be done with: what is next is done. At the start of a rod it
  // marks; where its guide waits it marks by force; after a fit it goes on to the next rod, after a
  // refusal it begins the rod anew.
  void confirm();
  void back();            // the step before once more; after a fit: the rod anew
  void next_rod(int by);  // leaves this rod as it is; wraps round

  int rod() const { return rods_[at_]; }
  const std::vector<int>& rods() const { return rods_; }
  RodState state(int rod) const { return states_[index(rod)]; }
  const cabinet::CalibrationGuide& guide() const { return guide_; }
  const std::optional<cabinet::RodFit>& fit() const { return fits_[index(rod())]; }
  const std::string& problem() const { return problems_[index(rod())]; }
  bool all_fitted() const;

  // With what fits so far.
  const cabinet::Calibration& calibration() const { return calibration_; }
  // Counted up with each rod that has come to fit: there is something to keep.
  int kept() const { return kept_; }

  bool sensor_answers() const { return heard_ && (last_.present >> rod() & 1) != 0; }
  // The rod that is moved instead of this one, or -1.
  int other_rod_moves() const;
  const std::deque<TracePoint>& trace() const { return trace_; }  // of this rod, kTraceSeconds
  std::uint64_t frames() const { return frames_; }

  static constexpr double kTraceSeconds = 10.0;

 private:
  static std::size_t index(int rod) { return static_cast<std::size_t>(rod); }
  void begin_rod();
  void hear_increments(const wire::DeviceFrame& frame, double seconds);
  void fit_run();

  foosball::Layout layout_;
  std::vector<int> rods_;
  std::size_t at_ = 0;
  cabinet::Calibration calibration_;
  cabinet::CalibrationGuide guide_;
  std::array<RodState, cabinet::kRods> states_{};
  std::array<std::optional<cabinet::RodFit>, cabinet::kRods> fits_;
  std::array<std::string, cabinet::kRods> problems_;
  int kept_ = 0;

  wire::DeviceFrame last_{};
  cabinet::DeviceState line_ = cabinet::DeviceState::missing;
  int line_error_ = 0;
  bool heard_ = false, interrupted_ = false;
  std::uint64_t frames_ = 0;
  double seconds_ = 0;
  std::deque<TracePoint> trace_;
  std::array<double, cabinet::kRods> moved_{};  // [counts] lately, fading
};

}  // namespace calibrate
