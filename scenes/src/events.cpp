// The events of a scene, in their order.
#include <algorithm>
#include <cmath>
#include <tuple>

#include "scenes/scene.h"

namespace scenes {
namespace {

struct Span {
  double from, until;
};
Span span_of(const Scene& scene, const Joint& joint) {
  const Body& a = scene.bodies[static_cast<std::size_t>(joint.a)];
  const Body& b = scene.bodies[static_cast<std::size_t>(joint.b)];
  return {std::max(a.from, b.from), std::min(a.until, b.until)};
}

}  // namespace

bool exists(const Scene& scene, const Joint& joint, double time) {
  const Span span = span_of(scene, joint);
  return span.from <= time && time < span.until;
}

std::vector<Event> events_of(const Scene& scene) {
  std::vector<Event> events;
  const auto add = [&](const Span& span, Event::Kind added, Event::Kind removed, std::size_t i) {
    if (!(span.from < span.until)) return;
    if (span.from > 0.0) events.push_back({span.from, added, static_cast<int>(i)});
    if (std::isfinite(span.until)) events.push_back({span.until, removed, static_cast<int>(i)});
  };
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    add({body.from, body.until}, Event::Kind::add_body, Event::Kind::remove_body, i);
  }
  for (std::size_t i = 0; i < scene.joints.size(); ++i) {
    add(span_of(scene, scene.joints[i]), Event::Kind::add_joint, Event::Kind::remove_joint, i);
  }
  for (std::size_t i = 0; i < scene.launches.size(); ++i) {
    events.push_back({scene.launches[i].time, Event::Kind::launch, static_cast<int>(i)});
  }
  std::stable_sort(events.begin(), events.end(), [](const Event& a, const Event& b) {
    return std::tie(a.time, a.kind) < std::tie(b.time, b.kind);
  });
  return events;
}

}  // namespace scenes
