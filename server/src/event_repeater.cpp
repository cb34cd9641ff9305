#include "event_repeater.h"

#include <algorithm>

namespace server {
namespace {

bool is_hit(foosball::EventKind kind) {
  return kind == foosball::EventKind::man_hit || kind == foosball::EventKind::wall_hit ||
         kind == foosball::EventKind::field_hit;
}

}  // namespace

wire::EventSnapshot to_wire(const foosball::Event& event, std::uint32_t id) {
  wire::EventSnapshot out;
  out.id = id;
  out.kind = static_cast<std::uint8_t>(event.kind);
  out.team = event.team;
  out.rod = event.rod;
  out.man = event.man;
  out.value = static_cast<float>(event.value);
  out.point = {static_cast<float>(event.point.x), static_cast<float>(event.point.y),
               static_cast<float>(event.point.z)};
  out.angle = static_cast<float>(event.angle);
  out.own = event.own;
  return out;
}

// A free slot; otherwise, for an event that is not a hit, the slot of the oldest hit; otherwise
// none.
EventRepeater::Slot* EventRepeater::place_for(foosball::EventKind kind) {
  const auto free = std::find_if(slots_.begin(), slots_.end(), [](auto& s) { return s.left == 0; });
  if (free != slots_.end()) return &*free;
  if (is_hit(kind)) return nullptr;
  Slot* oldest = nullptr;
  for (Slot& slot : slots_) {
    if (!is_hit(static_cast<foosball::EventKind>(slot.event.kind))) continue;
    if (oldest == nullptr || slot.event.id < oldest->event.id) oldest = &slot;
  }
  return oldest;
}

void EventRepeater::add(std::span<const foosball::Event> events) {
  for (const foosball::Event& event : events) {
    Slot* slot = place_for(event.kind);
    if (slot == nullptr || slot->left > 0) ++dropped_;
    if (slot == nullptr) continue;
    *slot = {to_wire(event, ++last_id_), kRepeats};
  }
}

void EventRepeater::fill(std::vector<wire::EventSnapshot>& out) {
  out.clear();
  for (Slot& slot : slots_) {
    if (slot.left == 0) continue;
    --slot.left;
    out.push_back(slot.event);
  }
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
}

}  // namespace server
