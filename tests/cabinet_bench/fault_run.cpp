#include "fault_run.h"

#include <cmath>

#include "frames.h"

namespace cabinet_bench {
namespace {

// A hand that moves and rests for random times. Sometimes it moves further between two reports than
// a mouse can report.
class Wanderer {
 public:
  void step(std::mt19937& random, Surface& surface) {
    if (left_ms_-- <= 0) {
      const auto draw = [&](double max) {
        return std::uniform_real_distribution<double>(-max, max)(random);
      };
      left_ms_ = std::uniform_int_distribution<int>(20, 900)(random);
      const int kind = std::uniform_int_distribution<int>(0, 19)(random);
      const double fastest = kind < 5 ? 0 : kind < 19 ? 30 : 70;  // [counts/ms]
      slide_ = draw(fastest);
      spin_ = draw(fastest);
    }
    surface.slide += slide_;
    surface.spin += spin_;
  }

 private:
  int left_ms_ = 0;
  double slide_ = 0, spin_ = 0;
};

}  // namespace

FaultResult run_faults(Controller& controller, const FaultOptions& options) {
  std::mt19937 random(options.seed);
  std::exponential_distribution<double> wait(options.troubles_per_minute / 60'000);
  std::uniform_int_distribution<int> any_rod(0, cabinet::kRods - 1);
  PerRod<Surface> surfaces{};
  PerRod<Wanderer> hands;
  Frames frames(controller.framing());
  Ledger ledger;
  FaultResult result;
  constexpr double kQuietMs = 4'000;  // all sensors are initialised by then
  double next_ms = kQuietMs + wait(random);
  const double end_ms = kQuietMs + options.seconds * 1e3;
  for (double ms = 0; ms < end_ms; ++ms) {
    for (std::size_t rod = 0; rod < hands.size(); ++rod) hands[rod].step(random, surfaces[rod]);
    if (ms >= next_ms && ms < end_ms - kQuietMs) {
      next_ms = ms + wait(random);
      const std::string name = controller.trouble(any_rod(random), random);
      if (!name.empty()) ++result.troubles[name];
    }
    controller.advance(surfaces);
    for (int rod = 0; rod < cabinet::kRods; ++rod) ledger.told(rod, controller.take_told(rod));
    for (const Packet& packet : controller.take_packets()) {
      frames.take(packet.bytes,
                  [&](const wire::DeviceFrame& frame) { ledger.record(frame, packet.time_us); });
    }
  }
  result.totals = ledger.totals();
  result.violations = ledger.violations();
  return result;
}

}  // namespace cabinet_bench
