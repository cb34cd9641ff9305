// W lanes of a block of joints, as the passes read and write them.
#pragma once

#include <algorithm>

#include "solve/block_lanes.h"
#include "solve/joint_block.h"

namespace vp::solve {

constexpr int factor_index(int i, int j) {
  return i * (i + 1) / 2 + j;  // j <= i
}

// kRows, kLocked: the numbers of rows and of locked rows in the form, without those of a point, or
// kAnyRows: the form is known at run time only. With known numbers the compiler unrolls all loops
// over rows and keeps the rows in registers.
inline constexpr int kAnyRows = -1;

template <int W, class BLOCK, int kRows = kAnyRows, int kLocked = kAnyRows>
class JointLanes : public BlockLanes<W, BLOCK> {
 public:
  using Base = BlockLanes<W, BLOCK>;
  using F = Lanes<W>;
  using V = Vec3T<F>;
  static constexpr int kPoint = BLOCK::kPointRows, kOthers = BLOCK::kOtherRows, kAll = BLOCK::kAll;

  JointLanes(BLOCK& joints, int at, BodyState* states, const JointForm& form)
      : Base(joints, at, states), form_(form) {}
  using Base::block;
  using Base::get;
  using Base::put;

  // The minimum tells the compiler that the count is within the arrays.
  int others() const {
    if constexpr (kRows >= 0) return kRows;
    return std::min<int>(form_.rows, kOthers);
  }
  int count() const { return kPoint + others(); }
  int locked() const {
    if constexpr (kLocked >= 0) return kPoint + kLocked;
    return kPoint + std::min<int>(form_.locked, kOthers);
  }
  const JointForm& form() const { return form_; }
  // Whether row i is linear: along an axis, not about it.
  bool is_along(int i) const { return BLOCK::kAxes && kPoint == 0 && form_.slot[i] < kSwingX; }
  V speed_of_point() const {
    const PointPart& point = block().point;
    return Base::v_b + cross(Base::w_b, get(point.arm_b)) - Base::v_a -
           cross(Base::w_a, get(point.arm_a));
  }

  // The speeds J v of the rows.
  void speeds(F* u) const {
    if constexpr (kPoint > 0) {
      const V v = speed_of_point();
      u[0] = v.x;
      u[1] = v.y;
      u[2] = v.z;
    }
    const V turning = Base::w_b - Base::w_a;
    for (int i = 0; i < others(); ++i) {
      if constexpr (BLOCK::kAxes) {
        const V axis = get(block().jacobian[i]);
        u[kPoint + i] = is_along(i) ? dot(axis, speed_of_point()) : dot(axis, turning);
      } else {
        const TwelvePart& J = block().jacobian[i];
        u[kPoint + i] = dot(get(J.linear_a), Base::v_a) + dot(get(J.angular_a), Base::w_a) +
                        dot(get(J.linear_b), Base::v_b) + dot(get(J.angular_b), Base::w_b);
      }
    }
  }
  // Applies impulses of all rows to the bodies.
  void apply_impulse(const F* p) {
    V linear_a, angular_a, linear_b, angular_b;
    if constexpr (kPoint > 0) {
      const PointPart& point = block().point;
      linear_b = {p[0], p[1], p[2]};
      linear_a = -linear_b;
      angular_a = -cross(get(point.arm_a), linear_b);
      angular_b = cross(get(point.arm_b), linear_b);
    }
    for (int i = 0; i < others(); ++i) {
      const F& x = p[kPoint + i];
      if constexpr (BLOCK::kAxes) {
        const V p_axis = x * get(block().jacobian[i]);
        if (is_along(i)) {
          linear_a -= p_axis;
          linear_b += p_axis;
          angular_a -= cross(get(block().point.arm_a), p_axis);
          angular_b += cross(get(block().point.arm_b), p_axis);
        } else {
          angular_a -= p_axis;
          angular_b += p_axis;
        }
      } else {
        const TwelvePart& J = block().jacobian[i];
        linear_a += x * get(J.linear_a);
        angular_a += x * get(J.angular_a);
        linear_b += x * get(J.linear_b);
        angular_b += x * get(J.angular_b);
      }
    }
    Base::apply_impulse(linear_a, angular_a, linear_b, angular_b);
  }
  F impulse(int i) const {
    if constexpr (kPoint > 0) {
      const Field3& p = block().point.impulse;
      if (i < kPoint) return get(i == 0 ? p.x : i == 1 ? p.y : p.z);
    }
    return get(block().rows[i - kPoint].impulse);
  }
  void set_impulse(int i, const F& x) {
    if constexpr (kPoint > 0) {
      Field3& p = block().point.impulse;
      if (i < kPoint) return put(i == 0 ? p.x : i == 1 ? p.y : p.z, x);
    }
    put(block().rows[i - kPoint].impulse, x);
  }
  // Includes the impulse of the limits.
  F all_impulse(int i) const {
    const F p = impulse(i);
    return i < locked() ? p : p + get(block().bounds[i - kPoint].stop);
  }
  F rate(int i) const {
    if constexpr (kPoint > 0) {
      if (i < kPoint) return get(block().point.rate);
    }
    return get(block().rows[i - kPoint].rate);
  }
  F loss(int i) const {
    if constexpr (kPoint > 0) {
      if (i < kPoint) return get(block().point.loss);
    }
    return get(block().rows[i - kPoint].loss);
  }
  F relaxes(int i) const {
    if constexpr (kPoint > 0) {
      if (i < kPoint) return get(block().point.relaxes);
    }
    return get(block().rows[i - kPoint].relaxes);
  }

 private:
  const JointForm& form_;
};

}  // namespace vp::solve
