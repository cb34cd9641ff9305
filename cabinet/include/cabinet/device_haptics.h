// Haptic pulses to a cabinet's controller, as packets against the way of its frames.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>

#include "cabinet/device_source.h"
#include "cabinet/haptics.h"

namespace cabinet {

// The packet that tells a controller of a pulse; the bytes written to out, 0: none. What it looks
// like is the device command's to say.
using HapticEncoder = std::function<std::size_t(const HapticPulse&, std::span<std::byte> out)>;

// The motors of one controller: pulses as packets against the way of its frames. device must
// outlive it.
class DeviceHaptics final : public HapticSink {
 public:
  static constexpr std::size_t kMaxPacket = 64;  // bytes; a HID report

  DeviceHaptics(DeviceSource& device, HapticEncoder encode)
      : device_(device), encode_(std::move(encode)) {}
  void pulse(const HapticPulse& pulse) override;
  std::uint64_t sent() const { return sent_; }
  std::uint64_t unsent() const { return unsent_; }  // nothing attached, or its line was full

 private:
  DeviceSource& device_;
  HapticEncoder encode_;
  std::uint64_t sent_ = 0, unsent_ = 0;
};

}  // namespace cabinet
