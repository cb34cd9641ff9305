// Contact events: who begins or ends to touch, or was hit, in a step.
#pragma once

#include <span>
#include <vector>

#include "world/collider.h"
#include "world/contact.h"

namespace vp {

// A pair that touched when one of the two was destroyed; the next step reports its end. user_data
// is not kept: it is the user's and no snapshot carries it.
struct DestroyedPair {
  ColliderId a, b;
  bool sensor = false;
};

// Of a part's contact, at the end of a step: it begins or ends to touch, or was hit.
struct PartEvent {
  std::uint32_t aggregate, part;
  double approach_speed, impulse;
  Vec3 point, normal;
};

class Events {
 public:
  std::vector<PartEvent> part_events;  // of this step: one event for each whole (touches.cpp)
  // Pairs that touched when one of the two was destroyed; the next step reports their ends.
  std::vector<DestroyedPair> destroyed;

  std::span<const ContactEvent> all() const { return events_; }
  void clear() { events_.clear(); }
  void reserve(std::size_t count) { events_.reserve(count); }
  void emit(const Colliders& colliders, ContactEvent::Kind kind, const ColliderPair& pair,
            const Vec3& point, const Vec3& normal, double approach, double impulse, double time);
  // A contact of the sub-stepped solver begins or ends to touch.
  void touch(const Colliders& colliders, Contact& contact, bool touching);
  void report_destroyed(const Colliders& colliders);

 private:
  void add(const ContactEvent& event);

  std::vector<ContactEvent> events_;  // of the last step
};

}  // namespace vp
