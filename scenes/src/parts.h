// Pieces that several scenes are made of.
#pragma once

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
// The index of what is added.
inline int add(Scene& scene, Body body) {
  scene.bodies.push_back(std::move(body));
  return static_cast<int>(scene.bodies.size()) - 1;
}
inline int add_floor(Scene& scene, const Material& material = {}) {
  return add(scene, fixed_body(Ground{}, SE3{}, material));
}
// A floor and four walls of 1 m around the square |x|, |y| <= side / 2, whose inside is what "in
// place" means.
void add_pit(Scene& scene, double side, double height);

// A right-handed turn about the axis [rad].
inline SE3 turned(const Vec3& rotation_vector, const Vec3& position) {
  return SE3(vp::Exp(rotation_vector), position);
}

}  // namespace scenes
