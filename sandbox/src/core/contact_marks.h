// Where bodies touch, from the events of a world's steps: a pair is there from its begin to its
// end, and its point goes with the first of the two bodies. One point a pair, since events tell no
// more.
#pragma once

#include <compare>
#include <map>
#include <span>
#include <vector>

#include "vphysics/world.h"

namespace sandbox {

struct ContactMark {
  vp::Vec3 point, normal;  // world frame; the normal is unit
  double strength;         // 1 just after a hit, then fading to 0
};

class ContactMarks {
 public:
  // After each step. bodies: by the user data of colliders.
  void update(const vp::World& world, std::span<const vp::BodyId> bodies, double dt);
  void clear() { touching_.clear(); }
  std::size_t size() const { return touching_.size(); }
  std::vector<ContactMark> marks(const vp::World& world) const;

 private:
  struct Pair {
    vp::ColliderId a, b;
    auto operator<=>(const Pair&) const = default;
  };
  struct Touch {
    vp::BodyId body;                   // of a
    vp::Vec3 point_body, normal_body;  // in its frame
    double hit_at;                     // by clock_ [s]
  };
  std::map<Pair, Touch> touching_;
  double clock_ = 0.0;
};

}  // namespace sandbox
