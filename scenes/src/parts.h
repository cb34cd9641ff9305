// Parts that several scenes use.
#pragma once

#include <cmath>
#include <utility>

#include "scenes/scene.h"

namespace scenes {

inline Body body_of(const Shape& shape, const SE3& pose, const Material& material = {},
                    double density = 1000.0) {
  Body body;
  body.T_world_body = pose;
  body.parts.push_back({shape, SE3{}, density, material});
  return body;
}
inline Body fixed_body(const Shape& shape, const SE3& pose, const Material& material = {}) {
  Body body = body_of(shape, pose, material);
  body.motion = Motion::fixed;
  return body;
}
// Returns the index of the added body.
inline int add(Scene& scene, Body body) {
  scene.bodies.push_back(std::move(body));
  return static_cast<int>(scene.bodies.size()) - 1;
}
inline int add_floor(Scene& scene, const Material& material = {}) {
  return add(scene, fixed_body(Ground{}, SE3{}, material));
}
// A floor and four walls of 1 m around the square |x|, |y| <= side / 2. Bodies within this square
// are in place.
void add_pit(Scene& scene, double side, double height);

// A figure of kRagdollBodies bodies. It stands on the frame's origin with z up and faces x.
void add_ragdoll(Scene& scene, const SE3& T_world_ground);

// A prism over a regular polygon about the z axis. Its first corner is in the direction of x.
Hull prism(double radius, double bottom, double height, int sides);

// Launches the body at each time k / kKnots with the velocity that takes it to the next point of
// the path. At these times it is on the path, between them on chords.
inline constexpr double kKnots = 60.0;  // [1/s]: at 60 Hz a chord is one step
template <class Path>
void follow(Scene& scene, int body, const Path& path) {
  const int knots = static_cast<int>(std::lround(scene.seconds * kKnots));
  for (int k = 0; k < knots; ++k) {
    const Vec3 velocity = kKnots * (path((k + 1) / kKnots) - path(k / kKnots));
    if (k == 0) scene.bodies[static_cast<std::size_t>(body)].velocity = velocity;
    scene.launches.push_back({k / kKnots, body, velocity, {}});
  }
}

// A right-handed rotation by a rotation vector [rad].
inline SE3 turned(const Vec3& rotation_vector, const Vec3& position) {
  return SE3(vp::Exp(rotation_vector), position);
}

}  // namespace scenes
