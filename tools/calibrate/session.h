// A complete calibration of the cabinet: rod by rod, each led by a guide, fitted, and stored as
// soon as the fit succeeds. Independent of window and device: frames and keys are arguments.
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
  guided,   // its guide is asking for motions
  fitted,   // and stored
  refused,  // the fit of its run failed: problem() says why
};

// For the live trace: counts since the session began.
struct TracePoint {
  double seconds;  // of the controller's clock, since the session began
  double slide, spin;
};

struct SessionOptions {
  foosball::Layout layout = foosball::Layout::tournament;
  std::vector<int> rods{0, 1, 2, 3, 4, 5, 6, 7};                // in this order
  cabinet::Calibration start = cabinet::nominal_calibration();  // of rods not calibrated
};

class Session {
 public:
  explicit Session(const SessionOptions& options);

  void update(const wire::DeviceFrame& frame);
  // Sets the state of the controller's line. error: errno of an attempt to open it.
  void line_is(cabinet::DeviceState state, int error);
  cabinet::DeviceState line() const { return line_; }
  int line_error() const { return line_error_; }
  // This rod was restarted, because frames and their counts were missing.
  bool interrupted() const { return interrupted_; }
  // The single key that suffices for a calibration. At the start of a rod it marks; where its guide
  // waits, it forces the mark; after a fit it goes to the next rod; after a failed fit it restarts
  // the rod.
  void confirm();
  void back();            // repeats the previous step; after a fit: restarts the rod
  void next_rod(int by);  // leaves this rod unchanged; wraps around

  int rod() const { return rods_[at_]; }
  const std::vector<int>& rods() const { return rods_; }
  RodState state(int rod) const { return states_[index(rod)]; }
  const cabinet::CalibrationGuide& guide() const { return guide_; }
  const std::optional<cabinet::RodFit>& fit() const { return fits_[index(rod())]; }
  const std::string& problem() const { return problems_[index(rod())]; }
  bool all_fitted() const;

  // With the successful fits so far.
  const cabinet::Calibration& calibration() const { return calibration_; }
  // Increases with each successful fit: there is something to store.
  int kept() const { return kept_; }

  bool sensor_answers() const { return received_ && (last_.present >> rod() & 1) != 0; }
  // The rod that moves instead of this one, or -1.
  int other_rod_moves() const;
  const std::deque<TracePoint>& trace() const { return trace_; }  // of this rod, over kTraceSeconds
  std::uint64_t frames() const { return frames_; }

  static constexpr double kTraceSeconds = 10.0;

 private:
  static std::size_t index(int rod) { return static_cast<std::size_t>(rod); }
  void begin_rod();
  void add_increments(const wire::DeviceFrame& frame, double seconds);
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
  bool received_ = false, interrupted_ = false;
  std::uint64_t frames_ = 0;
  double seconds_ = 0;
  std::deque<TracePoint> trace_;
  std::array<double, cabinet::kRods> moved_{};  // recent motion [counts], decaying
};

}  // namespace calibrate
