// Haptic pulses to a cabinet's controller, as packets against the way of its frames.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

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
  DeviceHaptics(DeviceSource& device, HapticEncoder encode)
      : device_(device), encode_(std::move(encode)) {}
  void pulse(const HapticPulse& pulse) override;
  const DeviceSource& device() const { return device_; }
  std::uint64_t sent() const { return sent_; }
  std::uint64_t unsent() const { return unsent_; }  // nothing attached, or its line was full

 private:
  DeviceSource& device_;
  HapticEncoder encode_;
  std::uint64_t sent_ = 0, unsent_ = 0;
};

// The command of wire/device_command.h, as a line of this framing carries it.
HapticEncoder command_encoder(DeviceFraming framing);

// The motors of all controllers: each pulse to those that have its rod at this time. They must
// outlive it.
class CabinetHaptics final : public HapticSink {
 public:
  void add(DeviceSource& device);
  void pulse(const HapticPulse& pulse) override;

 private:
  std::vector<DeviceHaptics> devices_;
};

}  // namespace cabinet
