#include "client/interpolator.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

namespace client {
namespace {

glm::vec3 vec(const std::array<float, 3>& a) {
  return {a[0], a[1], a[2]};
}
std::array<float, 3> array(const glm::vec3& v) {
  return {v.x, v.y, v.z};
}
glm::quat quat(const std::array<float, 4>& q) {
  return {q[3], q[0], q[1], q[2]};
}
std::array<float, 4> array(const glm::quat& q) {
  return {q.x, q.y, q.z, q.w};
}

bool jumped(const std::array<float, 3>& a, const std::array<float, 3>& b, double span_s) {
  return glm::length(vec(b) - vec(a)) > 0.03 + kJumpSpeed * span_s;
}

// If a ball bounced within a long interval, the velocities at its ends imply a much longer path
// than the actual one, and the curve would overshoot through a wall. A straight line is then
// closer.
bool curve_is_wild(float from, float to, float slope_from, float slope_to) {
  const float room = 3.0f * std::abs(to - from) + 0.004f;
  return std::abs(slope_from) > room || std::abs(slope_to) > room;
}

float hermite(float from, float to, float rate_from, float rate_to, float s, float span) {
  const float m0 = rate_from * span, m1 = rate_to * span;
  if (span > 0.0025f && curve_is_wild(from, to, m0, m1)) return from + (to - from) * s;
  const float s2 = s * s, s3 = s2 * s;
  return (2 * s3 - 3 * s2 + 1) * from + (s3 - 2 * s2 + s) * m0 + (3 * s2 - 2 * s3) * to +
         (s3 - s2) * m1;
}

std::array<float, 3> mix(const std::array<float, 3>& a, const std::array<float, 3>& b, float s) {
  return array(vec(a) + (vec(b) - vec(a)) * s);
}

wire::RodSnapshot interpolate(const wire::RodSnapshot& a, const wire::RodSnapshot& b, float s,
                              float span) {
  wire::RodSnapshot rod = a;
  rod.slide = hermite(a.slide, b.slide, a.slide_rate, b.slide_rate, s, span);
  // The angle is sent modulo many turns. It continues across the end of that range without turning
  // back.
  const auto onward = static_cast<float>(wire::unwrap_angle(b.angle, a.angle));
  rod.angle = s < 1.0f ? a.angle + (onward - a.angle) * s : b.angle;
  rod.slide_rate = a.slide_rate + (b.slide_rate - a.slide_rate) * s;
  rod.angle_rate = a.angle_rate + (b.angle_rate - a.angle_rate) * s;
  return rod;
}

}  // namespace

wire::PoseVelocity interpolate(const wire::PoseVelocity& a, const wire::PoseVelocity& b,
                               double share, double span_s) {
  if (jumped(a.position, b.position, span_s)) return share < 1.0 ? a : b;
  const auto s = static_cast<float>(share), span = static_cast<float>(span_s);
  wire::PoseVelocity pose;
  for (std::size_t i = 0; i < 3; ++i) {
    pose.position[i] =
        hermite(a.position[i], b.position[i], a.linear_velocity[i], b.linear_velocity[i], s, span);
  }
  pose.orientation = array(glm::slerp(quat(a.orientation), quat(b.orientation), s));
  pose.linear_velocity = mix(a.linear_velocity, b.linear_velocity, s);
  pose.angular_velocity = mix(a.angular_velocity, b.angular_velocity, s);
  return pose;
}

wire::Snapshot interpolate(const wire::Snapshot& a, const wire::Snapshot& b, double share,
                           double span_s) {
  const auto s = static_cast<float>(share), span = static_cast<float>(span_s);
  wire::Snapshot scene = share < 1.0 ? a : b;
  scene.screen_seconds = a.screen == b.screen
                             ? a.screen_seconds + (b.screen_seconds - a.screen_seconds) * s
                             : scene.screen_seconds;
  scene.ball =
      a.ball_in_play == b.ball_in_play ? interpolate(a.ball, b.ball, share, span_s) : scene.ball;
  for (std::size_t i = 0; i < scene.rods.size(); ++i)
    scene.rods[i] = interpolate(a.rods[i], b.rods[i], s, span);
  for (std::size_t i = 0; i < std::min(a.men.size(), b.men.size()); ++i) {
    if (a.men[i].rod != b.men[i].rod || a.men[i].man != b.men[i].man) continue;
    scene.men[i].body = interpolate(a.men[i].body, b.men[i].body, share, span_s);
  }
  return scene;
}

wire::PoseVelocity extrapolate(const wire::PoseVelocity& last, double seconds) {
  const auto t = static_cast<float>(seconds);
  wire::PoseVelocity pose = last;
  pose.position = array(vec(last.position) + vec(last.linear_velocity) * t);
  const glm::vec3 spin = vec(last.angular_velocity);
  const float rate = glm::length(spin);
  if (rate > 1e-6f)
    pose.orientation =
        array(glm::normalize(glm::angleAxis(rate * t, spin / rate) * quat(last.orientation)));
  return pose;
}

wire::Snapshot extrapolate(const wire::Snapshot& last, double seconds) {
  wire::Snapshot scene = last;
  scene.ball = extrapolate(last.ball, seconds);
  for (wire::RodSnapshot& rod : scene.rods) {
    rod.slide += rod.slide_rate * static_cast<float>(seconds);
    rod.angle += rod.angle_rate * static_cast<float>(seconds);
  }
  for (wire::ManState& man : scene.men) man.body = extrapolate(man.body, seconds);
  return scene;
}

}  // namespace client
