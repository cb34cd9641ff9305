#include "cabinet/haptics.h"

#include <algorithm>
#include <cmath>

#include "cabinet/device_haptics.h"

namespace cabinet {
namespace {

constexpr float kWeakest = 0.08f;   // below, no motor starts
constexpr double kSoftShare = 0.5;  // of the strength, of a man of restitution 0

}  // namespace

std::optional<HapticPulse> haptic_pulse(int rod, double impulse, double restitution) {
  if (rod < 0 || rod >= kRods || !(impulse >= kSoftestFelt)) return std::nullopt;
  const double hardness = restitution > 0.0 ? std::min(restitution, 1.0) : 0.0;
  const double share =
      std::min(std::log(impulse / kSoftestFelt) / std::log(kHardestFelt / kSoftestFelt), 1.0);
  const double strength =
      (kWeakest + (1.0 - kWeakest) * share) * (kSoftShare + (1.0 - kSoftShare) * hardness);
  // Soft ones last longer, and so do hard hits.
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

}  // namespace cabinet
