// Contact events: who begins or ends to touch, or was hit, in a step.
#pragma once

#include <span>
#include <vector>

#include "world/collider.h"
#include "world/pair_record.h"

namespace vp {

class Events {
 public:
  // Pairs that touched when one of the two was destroyed; the next step reports their ends.
  std::vector<DestroyedPair> destroyed;

  std::span<const ContactEvent> all() const { return events_; }
  void clear() { events_.clear(); }
  void reserve(std::size_t count) { events_.reserve(count); }
  void emit(const Colliders& colliders, ContactEvent::Kind kind, const ColliderPair& pair,
            const Vec3& point, const Vec3& normal, double approach, double impulse, double time);
  void report_destroyed(const Colliders& colliders);

 private:
  void add(const ContactEvent& event);

  std::vector<ContactEvent> events_;  // of the last step
};

}  // namespace vp
