#include "haptic_desk.h"

namespace server {

// A demonstration match causes no pulses.
void HapticDesk::feel(std::span<const foosball::Event> events, const foosball::MatchView& view,
                      const RodDesk& desk, std::int64_t now_us) {
  if (!on_ || view.attract) return;
  for (const foosball::Event& event : events) {
    if (event.kind != foosball::EventKind::man_hit) continue;
    const RodDriver driver = desk.driver(event.rod);
    if (driver != RodDriver::cabinet && driver != RodDriver::client) continue;
    const double restitution = view.bodies[event.team].restitution * view.tuning.man_restitution;
    const auto felt = cabinet::haptic_pulse(event.rod, event.value, restitution);
    const auto pulse = felt ? limiter_.admit(*felt, now_us) : std::nullopt;
    if (!pulse) continue;
    ++pulses_;
    if (driver == RodDriver::cabinet) {
      if (cabinet_ != nullptr) cabinet_->pulse(*pulse);
    } else if (clients_) {
      clients_(desk.client_of(event.rod), *pulse);
    }
  }
}

}  // namespace server
