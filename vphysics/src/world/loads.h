// Forces and torques that the user has applied to bodies for the next step (forces.cpp).
#pragma once

#include <span>
#include <vector>

#include "world/body.h"

namespace vp {

// World frame. The torque is about the body's centre of mass.
struct BodyLoad {
  std::uint32_t body = 0;
  Vec3 force, torque;
};

// For bodies that are not links. An articulation stores the loads of its links.
class BodyLoads {
 public:
  std::span<const BodyLoad> all() const { return loads_; }
  const BodyLoad* of(const Body& body) const {
    return body.load == kNone ? nullptr : &loads_[body.load];
  }
  bool is_torqued(const Body& body) const {
    return body.load != kNone && !(loads_[body.load].torque == Vec3{});
  }
  // Of a dynamic body that is not a link, due to gravity and its load; w is 0 without a torque.
  Velocity acceleration(const Body& body, const Vec3& gravity) const;
  // Whether its load would be valid for this inertia and this pose.
  bool load_in_range(const Body& body, const Inertia& inertia, const SE3& T) const;

  void set(Bodies& bodies, std::uint32_t body, const Vec3& force, const Vec3& torque);
  // The body's centre of mass, the reference point of the torque, has moved by -arm.
  void shift(const Body& body, const Vec3& arm);
  void remove(Bodies& bodies, std::uint32_t body);
  void clear(Bodies& bodies);

 private:
  std::vector<BodyLoad> loads_;
};

// Whether a body that is not a link, at rest with rotation R, stays within 1e9 m/s and rad/s over
// the longest step.
bool load_in_range(const Body& body, const Mat3& R, const Vec3& force, const Vec3& torque);
inline constexpr const char* kLoadOutOfRange =
    "the forces that it has for the next step would then make it faster than 1e9 m/s or rad/s; "
    "apply them afterwards";

}  // namespace vp
