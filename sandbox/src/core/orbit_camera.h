// A camera that orbits a point. Lengths in metres, angles in radians, z up. Double precision,
// because worlds may be large: drawing is relative to the target.
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "vphysics/lie.h"

namespace sandbox {

struct Ray {
  vp::Vec3 origin, direction;  // unit
};

class OrbitCamera {
 public:
  // This fraction of the picture's width is covered, from its left; the target is at the centre of
  // the rest.
  void leave_free(double share);
  // Fits a whole box into the free part, seen from the present yaw and pitch. screen: [px]
  void fit(const vp::Vec3& low, const vp::Vec3& high, const glm::ivec2& screen);
  void look_from(double yaw, double pitch);  // the pitch is clamped short of straight up and down

  // By a motion of the pointer [px]. pan(): points at the target's depth follow the pointer.
  void orbit(const glm::dvec2& pixels);
  void pan(const glm::dvec2& pixels, const glm::ivec2& screen);
  void zoom(double steps);  // of the wheel; positive: closer
  void scale_distance(double factor);

  vp::Vec3 eye() const;
  const vp::Vec3& target() const { return target_; }
  double distance() const { return distance_; }
  vp::Vec3 forward() const;  // unit
  // Through a pixel, counted from the top left of the picture.
  Ray ray(const glm::dvec2& pixel, const glm::ivec2& screen) const;

  // For positions relative to the target.
  glm::mat4 view() const;
  glm::mat4 projection(const glm::ivec2& screen) const;

 private:
  vp::Vec3 right() const;
  vp::Vec3 up() const;

  vp::Vec3 target_;
  double distance_ = 10.0;
  double yaw_ = -1.1, pitch_ = 0.42;
  double covered_ = 0.0;
};

}  // namespace sandbox
