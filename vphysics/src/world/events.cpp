#include "world/events.h"

namespace vp {

void Events::emit(const Colliders& colliders, ContactEvent::Kind kind, const ColliderPair& pair,
                  const Vec3& point, const Vec3& normal, double approach, double impulse,
                  double time) {
  const Collider &a = colliders[pair.a], &b = colliders[pair.b];
  add({kind, a.sensor || b.sensor, colliders.id(pair.a), colliders.id(pair.b), a.user_data,
       b.user_data, point, normal, approach, impulse, time});
}

void Events::touch(const Colliders& colliders, Contact& c, bool touching) {
  c.touching = touching;
  const auto kind = touching ? ContactEvent::Kind::begin : ContactEvent::Kind::end;
  emit(colliders, kind, {c.key, c.a, c.b}, touching && c.count > 0 ? c.position[0] : Vec3{}, {},
       0.0, 0.0, 0.0);
}

// Keeps the events sorted by time. Only swept sensors between two impacts arrive out of order.
void Events::add(const ContactEvent& event) {
  auto position = events_.end();
  while (position != events_.begin() && std::prev(position)->time > event.time) --position;
  events_.insert(position, event);
}

void Events::report_destroyed(const Colliders& colliders) {
  const auto user_data = [&](ColliderId id) {
    const Collider* c = colliders.find(id);
    return c ? c->user_data : 0;
  };
  for (const DestroyedPair& pair : destroyed) {
    add({ContactEvent::Kind::end,
         pair.sensor,
         pair.a,
         pair.b,
         user_data(pair.a),
         user_data(pair.b),
         {},
         {},
         0.0,
         0.0,
         0.0});
  }
  destroyed.clear();
}

}  // namespace vp
