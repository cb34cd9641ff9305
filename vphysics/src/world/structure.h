// The digest of all that a world is made of: every constant bit for bit. What calls may change
// later (poses, velocities, joint states, drives) is in the snapshot instead; user_data is the
// user's, may be an address, and moves nothing, so it is in neither.
#pragma once

#include <bit>
#include <concepts>
#include <cstdint>

#include "world/impl.h"

namespace vp {

class Structure {
 public:
  explicit Structure(std::uint64_t& digest) : digest_(digest) {}

  template <std::unsigned_integral T>
  void add(T word) {
    digest_ = mixed(digest_, word);
  }
  void add(double x) { add(std::bit_cast<std::uint64_t>(x)); }
  void add(const Vec3& a) {
    for (const double x : {a.x, a.y, a.z}) add(x);
  }
  void add(const SE3& T) {
    const Mat3& R = T.rotation();
    for (const Vec3* v : {&R.cx, &R.cy, &R.cz, &T.position()}) add(*v);
  }
  void add(const Inertia& J) {
    const Sym3& I = J.rotational();
    add(J.mass());
    add(J.first_moment());
    for (const double x : {I.xx, I.yy, I.zz, I.xy, I.yz, I.zx}) add(x);
  }
  void add(const WorldDesc& desc) {
    add(desc.gravity);
    add(desc.restitution_threshold);
    add(desc.contact_slop);
    add(static_cast<std::uint64_t>(desc.velocity_iterations));
    add(static_cast<std::uint64_t>(desc.max_impacts_per_step));
  }
  void add(const BodyDesc& desc) {
    add(static_cast<std::uint64_t>(desc.motion));
    add(static_cast<std::uint64_t>(desc.continuous));
    add(desc.inertia);
    add(desc.linear_damping);
    add(desc.angular_damping);
  }
  void add(const ColliderDesc& desc) {
    add(static_cast<std::uint64_t>(desc.shape.index()));
    if (const auto* s = std::get_if<Sphere>(&desc.shape)) {
      add(s->radius);
    } else if (const auto* b = std::get_if<Box>(&desc.shape)) {
      add(b->half_extents);
    } else if (const auto* c = std::get_if<Capsule>(&desc.shape)) {
      add(c->radius);
      add(c->half_length);
    }
    add(desc.T_body_shape);
    for (const double x :
         {desc.material.friction, desc.material.restitution, desc.material.rolling_friction}) {
      add(x);
    }
    add(desc.filter.category);
    add(desc.filter.mask);
    add(static_cast<std::uint64_t>(desc.sensor));
  }
  void add(const LinkDesc& desc) {
    add(static_cast<std::uint64_t>(desc.joint));
    add(desc.T_parent_joint);
    add(desc.inertia);
    for (int i = 0; i < 2; ++i) {
      for (const double x :
           {desc.armature[i], desc.joint_damping[i], desc.limit[i].lower, desc.limit[i].upper}) {
        add(x);
      }
    }
  }

 private:
  std::uint64_t& digest_;
};

}  // namespace vp
