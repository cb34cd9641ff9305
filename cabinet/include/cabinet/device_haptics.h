// Sends haptic pulses to a cabinet's controller, as packets from host to device.
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

// Encodes a pulse as a packet for a controller. Returns the number of bytes written to out; 0:
// none.
using HapticEncoder = std::function<std::size_t(const HapticPulse&, std::span<std::byte> out)>;

// The motors of one controller. Sends each pulse as a packet. device must outlive this object.
class DeviceHaptics final : public HapticSink {
 public:
  DeviceHaptics(DeviceSource& device, HapticEncoder encode)
      : device_(device), encode_(std::move(encode)) {}
  void pulse(const HapticPulse& pulse) override;
  const DeviceSource& device() const { return device_; }
  std::uint64_t sent() const { return sent_; }
  std::uint64_t unsent() const { return unsent_; }  // not connected, or its line was full

 private:
  DeviceSource& device_;
  HapticEncoder encode_;
  std::uint64_t sent_ = 0, unsent_ = 0;
};

// Encodes the command of wire/device_command.h for a line of this framing.
HapticEncoder command_encoder(DeviceFraming framing);

// The motors of all controllers: sends each pulse to those that currently have the rod. The devices
// must outlive this object.
class CabinetHaptics final : public HapticSink {
 public:
  void add(DeviceSource& device);
  void pulse(const HapticPulse& pulse) override;

 private:
  std::vector<DeviceHaptics> devices_;
};

}  // namespace cabinet
