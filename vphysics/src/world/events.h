// Contact events of a step: begin, end and hit.
#pragma once

#include <span>
#include <vector>

#include "world/collider.h"
#include "world/contact.h"

namespace vp {

// A pair that touched when one of the two was destroyed; the next step reports its end. It does not
// store user_data, which belongs to the user and is in no snapshot.
struct DestroyedPair {
  ColliderId a, b;
  bool sensor = false;
};

// Begin, end or hit of a part's contact at the end of a step.
struct PartEvent {
  std::uint32_t aggregate, part;
  double approach_speed, impulse;
  Vec3 point, normal;
};

class Events {
 public:
  std::vector<PartEvent> part_events;  // of this step: one event for each aggregate (touches.cpp)
  // Pairs that touched when one of the two was destroyed; the next step reports their ends.
  std::vector<DestroyedPair> destroyed;

  std::span<const ContactEvent> all() const { return events_; }
  void clear() { events_.clear(); }
  void reserve(std::size_t count) { events_.reserve(count); }
  void emit(const Colliders& colliders, ContactEvent::Kind kind, const ColliderPair& pair,
            const Vec3& point, const Vec3& normal, double approach, double impulse, double time);
  // A contact of the sub-stepped solver begins or ends.
  void touch(const Colliders& colliders, Contact& contact, bool touching);
  void report_destroyed(const Colliders& colliders);

 private:
  void add(const ContactEvent& event);

  std::vector<ContactEvent> events_;  // of the last step
};

}  // namespace vp
