#include "core/contact_marks.h"

#include <algorithm>

namespace sandbox {
namespace {

constexpr double kFade = 0.4;  // [s] a hit is seen

}  // namespace

void ContactMarks::update(const vp::World& world, std::span<const vp::BodyId> bodies, double dt) {
  clock_ += dt;
  for (const vp::ContactEvent& event : world.contact_events()) {
    if (event.sensor) continue;
    const Pair pair{event.a, event.b};
    if (event.kind == vp::ContactEvent::Kind::end) {
      touching_.erase(pair);
      continue;
    }
    if (event.user_data_a >= bodies.size()) continue;
    const vp::BodyId body = bodies[event.user_data_a];
    if (!world.contains(body)) continue;
    const vp::SE3 T = world.pose(body);
    const bool hit = event.kind == vp::ContactEvent::Kind::hit;
    const auto [at, fresh] = touching_.try_emplace(pair, Touch{body, {}, {}, clock_ - kFade});
    at->second.point_body = inverse_times(T, event.point);
    at->second.normal_body = T.unrotate(event.normal);
    if (hit || fresh) at->second.hit_at = clock_;
  }
}

std::vector<ContactMark> ContactMarks::marks(const vp::World& world) const {
  std::vector<ContactMark> out;
  out.reserve(touching_.size());
  for (const auto& [pair, touch] : touching_) {
    if (!world.contains(touch.body)) continue;
    const vp::SE3 T = world.pose(touch.body);
    out.push_back({T * touch.point_body, T.rotate(touch.normal_body),
                   std::max(0.0, 1.0 - (clock_ - touch.hit_at) / kFade)});
  }
  return out;
}

}  // namespace sandbox
