#include "core/pad_haptics.h"

#include "wire/enums.h"

namespace client {

std::vector<cabinet::HapticPulse> PadHaptics::feel(std::span<const wire::EventSnapshot> events,
                                                   const wire::Snapshot& scene,
                                                   const foosball::Characters& characters,
                                                   const foosball::Tuning& tuning,
                                                   std::uint8_t rods, std::int64_t now_us) {
  std::vector<cabinet::HapticPulse> pulses;
  if (scene.attract) return pulses;
  for (const wire::EventSnapshot& event : events) {
    const bool mine = event.kind == number(wire::EventKind::man_hit) && event.rod < wire::kRods &&
                      (rods >> event.rod & 1) != 0;
    if (!mine || event.team >= wire::kTeamCount) continue;
    const auto& body = foosball::nearest(characters, scene.character[event.team]).body;
    const auto felt = cabinet::haptic_pulse(event.rod, static_cast<double>(event.value),
                                            body.restitution * tuning.man_restitution);
    if (!felt) continue;
    if (const auto pulse = limiter_.admit(*felt, now_us)) pulses.push_back(*pulse);
  }
  return pulses;
}

}  // namespace client
