#include "cabinet/haptics.h"

#include <algorithm>
#include <cmath>

#include "cabinet/device_haptics.h"
#include "wire/device_command.h"

namespace cabinet {
namespace {

constexpr float kWeakest = 0.08f;   // below it, no motor starts
constexpr double kSoftShare = 0.5;  // fraction of full strength for a man of restitution 0

}  // namespace

std::optional<HapticPulse> haptic_pulse(int rod, double impulse, double restitution) {
  if (rod < 0 || rod >= kRods || !(impulse >= kSoftestFelt)) return std::nullopt;
  const double hardness = restitution > 0.0 ? std::min(restitution, 1.0) : 0.0;
  const double share =
      std::min(std::log(impulse / kSoftestFelt) / std::log(kHardestFelt / kSoftestFelt), 1.0);
  const double strength =
      (kWeakest + (1.0 - kWeakest) * share) * (kSoftShare + (1.0 - kSoftShare) * hardness);
  // Soft men and hard hits give longer pulses.
  const double length = 0.5 * share + 0.5 * (1.0 - hardness);
  const double ms = kShortestPulseMs + (kLongestPulseMs - kShortestPulseMs) * length;
  return HapticPulse{rod, static_cast<float>(strength), static_cast<std::uint16_t>(ms)};
}

std::optional<HapticPulse> HapticLimiter::admit(const HapticPulse& pulse, std::int64_t now_us) {
  if (pulse.rod < 0 || pulse.rod >= kRods) return std::nullopt;
  Rod& rod = rods_[static_cast<std::size_t>(pulse.rod)];
  if (now_us < rod.until_us && pulse.strength <= rod.strength) return std::nullopt;
  const double elapsed_ms = 1e-3 * static_cast<double>(std::max<std::int64_t>(0, now_us - rod.us));
  rod.spent_ms = std::max(0.0, rod.spent_ms - kMeanPower * elapsed_ms);
  rod.us = now_us;
  HapticPulse out = pulse;
  out.strength = std::clamp(out.strength, 0.0f, 1.0f);
  out.ms = std::min(out.ms, kLongestPulseMs);
  if (out.ms == 0) return std::nullopt;
  const double left_ms = kPulseEnergyMs - rod.spent_ms;
  out.strength = std::min(out.strength, static_cast<float>(std::sqrt(left_ms / out.ms)));
  if (!(out.strength >= 0.5f * kWeakest)) return std::nullopt;
  const auto strength = static_cast<double>(out.strength);
  rod.spent_ms = std::min(kPulseEnergyMs, rod.spent_ms + strength * strength * out.ms);
  rod.until_us = now_us + 1000 * out.ms;
  rod.strength = out.strength;
  return out;
}

void DeviceHaptics::pulse(const HapticPulse& pulse) {
  std::array<std::byte, kMaxPacket> packet;
  const std::size_t size = encode_ ? encode_(pulse, packet) : 0;
  if (size == 0 || size > packet.size()) return;
  ++(device_.send(std::span(packet).first(size)) ? sent_ : unsent_);
}

HapticEncoder command_encoder(DeviceFraming framing) {
  return [framing](const HapticPulse& pulse, std::span<std::byte> out) -> std::size_t {
    wire::DeviceCommand command{};
    command.kind = wire::kPulseCommand;
    command.rod = static_cast<std::uint8_t>(pulse.rod);
    command.amplitude =
        static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(pulse.strength, 0.0f, 1.0f)));
    command.duration_ms = pulse.ms;
    if (!wire::valid_device_command(command)) return 0;
    std::array<std::uint8_t, wire::kDeviceCommandBytes> plain{};
    wire::encode_device_command(command, plain.data());
    auto* bytes = reinterpret_cast<std::uint8_t*>(out.data());
    if (framing == DeviceFraming::cobs) return wire::cobs_encode(plain.data(), plain.size(), bytes);
    // Report ID 0: there is only one report.
    std::ranges::fill(out.first(1 + wire::kDeviceReportBytes), std::byte{0});
    std::ranges::copy(plain, bytes + 1);
    return 1 + wire::kDeviceReportBytes;
  };
}

void CabinetHaptics::add(DeviceSource& device) {
  devices_.emplace_back(device, command_encoder(device.framing()));
}

void CabinetHaptics::pulse(const HapticPulse& pulse) {
  if (pulse.rod < 0 || pulse.rod >= kRods) return;
  for (DeviceHaptics& haptics : devices_) {
    const RodInput& rod = haptics.device().rods()[static_cast<std::size_t>(pulse.rod)];
    if (rod.status == RodStatus::live) haptics.pulse(pulse);
  }
}

}  // namespace cabinet
