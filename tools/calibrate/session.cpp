#include "session.h"

#include <algorithm>
#include <cmath>

namespace calibrate {
namespace {

constexpr double kFade = 0.5;         // [s] decay time to 1/e of a rod's recent motion
constexpr double kMovesClearly = 60;  // [counts] of another rod, while this one rests
constexpr double kMovesBarely = 6;
constexpr std::int32_t kLongestGapUs = 500'000;

int increment(std::uint16_t from, std::uint16_t to) {
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(to - from));
}

cabinet::GuideOptions guide_options(foosball::Layout layout, int rod) {
  const foosball::TableSpec& table = foosball::table_spec(layout);
  const foosball::RodSpec& spec = table.rods[static_cast<std::size_t>(rod)];
  cabinet::GuideOptions options;
  options.reach = spec.slide_limit;
  options.push_side = foosball::push_sign(spec.team);
  options.forward_sign = -foosball::attack_sign(spec.team);
  return options;
}

}  // namespace

Session::Session(const SessionOptions& options)
    : layout_(options.layout), rods_(options.rods), calibration_(options.start) {
  begin_rod();
}

void Session::begin_rod() {
  guide_ = cabinet::CalibrationGuide(guide_options(layout_, rod()));
  states_[index(rod())] = RodState::guided;
  problems_[index(rod())].clear();
  trace_.clear();
}

void Session::line_is(cabinet::DeviceState state, int error) {
  line_ = state;
  line_error_ = error;
}

// After a restart of the controller or an absence of a sensor, the motion meanwhile is lost.
void Session::update(const wire::DeviceFrame& frame) {
  ++frames_;
  if (received_) {
    const auto elapsed = static_cast<std::int32_t>(frame.time_us - last_.time_us);
    const bool answered = (last_.present & frame.present) >> rod() & 1;
    const bool follows = elapsed > 0 && elapsed <= kLongestGapUs;
    if (follows) add_increments(frame, elapsed * 1e-6);
    if ((!follows || !answered) && states_[index(rod())] == RodState::guided && guide_.step() > 0) {
      begin_rod();
      interrupted_ = true;
    }
  }
  last_ = frame;
  received_ = true;
  if (states_[index(rod())] == RodState::guided && guide_.finished()) fit_run();
}

void Session::add_increments(const wire::DeviceFrame& frame, double seconds) {
  seconds_ += seconds;
  for (int r = 0; r < cabinet::kRods; ++r) {
    if (((last_.present & frame.present) >> r & 1) == 0) continue;
    const double slide = increment(last_.slide[r], frame.slide[r]),
                 spin = increment(last_.spin[r], frame.spin[r]);
    double& moved = moved_[index(r)];
    moved = moved * std::exp(-seconds / kFade) + std::hypot(slide, spin);
    if (r != rod()) continue;
    const TracePoint before = trace_.empty() ? TracePoint{} : trace_.back();
    trace_.push_back({seconds_, before.slide + slide, before.spin + spin});
    if (states_[index(r)] == RodState::guided)
      guide_.add({static_cast<std::int16_t>(slide), static_cast<std::int16_t>(spin),
                  static_cast<float>(seconds), (frame.index >> r & 1) != 0});
  }
  while (!trace_.empty() && trace_.front().seconds < seconds_ - kTraceSeconds) trace_.pop_front();
}

void Session::fit_run() {
  auto fitted = cabinet::fit_rod(guide_.run());
  if (!fitted) {
    states_[index(rod())] = RodState::refused;
    problems_[index(rod())] = fitted.error();
    return;
  }
  calibration_.rods[index(rod())] = fitted->calibration;
  fits_[index(rod())] = std::move(*fitted);
  states_[index(rod())] = RodState::fitted;
  ++kept_;
}

void Session::confirm() {
  switch (states_[index(rod())]) {
    case RodState::guided:
      if (!sensor_answers()) break;  // nothing would be counted
      interrupted_ = false;
      guide_.mark();
      if (guide_.finished()) fit_run();
      break;
    case RodState::fitted:
      if (!all_fitted()) next_rod(1);
      break;
    default:
      begin_rod();
  }
}

void Session::back() {
  if (states_[index(rod())] == RodState::guided) return guide_.back();
  begin_rod();
}

// Abandons an unfinished run of this rod.
void Session::next_rod(int by) {
  if (states_[index(rod())] == RodState::guided)
    states_[index(rod())] = fits_[index(rod())] ? RodState::fitted : RodState::open;
  const auto n = static_cast<int>(rods_.size());
  at_ = static_cast<std::size_t>(((static_cast<int>(at_) + by) % n + n) % n);
  if (states_[index(rod())] != RodState::fitted) begin_rod();
  trace_.clear();
}

bool Session::all_fitted() const {
  return std::ranges::all_of(rods_, [&](int r) { return states_[index(r)] == RodState::fitted; });
}

int Session::other_rod_moves() const {
  if (moved_[index(rod())] > kMovesBarely) return -1;
  const auto max = std::ranges::max_element(moved_);
  return *max > kMovesClearly ? static_cast<int>(max - moved_.begin()) : -1;
}

}  // namespace calibrate
