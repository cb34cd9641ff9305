// Follows each pulse from the server's command to the driver of its motor.
#pragma once

#include <cstdint>
#include <deque>
#include <span>

#include "match_run.h"

namespace cabinet_bench {

class PulseWatch {
 public:
  // A packet to the controller; packets other than pulses are ignored.
  void commanded(std::span<const std::uint8_t> packet, cabinet::DeviceFraming framing,
                 std::int64_t now_us);
  void written(const MotorWrite& write);
  void passed(std::int64_t now_us);
  const PulseCounts& counts() const { return counts_; }

 private:
  static constexpr std::int64_t kMaxUs = 20'000;  // a pulse that has not begun by then is missing

  struct Pulse {
    std::int64_t us;
    int amplitude;
    bool runs_already;     // its motor already runs at this amplitude
    std::uint64_t writes;  // number of writes before it
  };
  struct Motor {
    std::deque<Pulse> waiting;
    int amplitude = 0;        // in the driver's register
    std::int64_t end_us = 0;  // deadline for the motor to stop
  };
  PerRod<Motor> motors_;
  std::uint64_t writes_ = 0;  // to all motors
  PulseCounts counts_;
};

}  // namespace cabinet_bench
