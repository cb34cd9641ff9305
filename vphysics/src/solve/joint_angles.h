// Joint coordinates, W lanes at a time: rotations of bodies, angles between frames, swing and
// twist.
//
// Coordinates of a joint. a's frame has the origin p_a and the axes R_a, b's p_b and R_b. r are the
// arms from the centres of mass, d = p_b - p_a:
//
//   c_i = e_i . d,  e_i a's axis                        along e_i
//   c_i' = e_i . (v_b + w_b x r_b - v_a) - ((r_a + d) x e_i) . w_a
//
// Rotation, in a's frame, with R = R_a^T R_b, whose third column is (sin s k_y, -sin s k_x, cos s),
// s the swing about the unit vector k perpendicular to z, r = s k, w = R_a^T (w_b - w_a):
//
//   r'     = [k k^T + s cot(s) g g^T - g r_g z^T] w,  g = (k_y, -k_x),  r_g = s
//   twist  = atan2(R_10 - R_01, R_00 + R_11),  twist' = (z_a + z_b) . w / (1 + cos s)
//
// Source: for swing and twist, Shoemake, Fiber Bundle Twist Reduction, Graphics Gems IV, 1994.
#pragma once

#include "solve/joint_block.h"
#include "solve/lanes.h"

namespace vp::solve {

// atan2(y, x) in [-pi, pi]; 0 for (0, 0).
template <int W>
Lanes<W> angle_of(const Lanes<W>& y, const Lanes<W>& x) {
  using F = Lanes<W>;
  constexpr float kPiF = static_cast<float>(kPi);
  const F ay = abs(y), ax = abs(x);
  const F large = larger(ax, ay), small = smaller(ax, ay);
  // atan(t) = pi / 4 + atan((t - 1) / (t + 1)). The remaining argument is below tan(pi / 8), where
  // seven terms of the series suffice.
  const LaneMask<W> far = small > F(0.41421356f) * large;
  const F top = select(far, small - large, small), bottom = select(far, small + large, large);
  const F t = select(bottom > F(0.0f), top / bottom, F(0.0f)), s = t * t;
  F sum = F(1.0f / 13.0f);
  for (const int n : {11, 9, 7, 5, 3, 1}) sum = F(1.0f / static_cast<float>(n)) - s * sum;
  F angle = t * sum + select(far, F(0.25f * kPiF), F(0.0f));
  angle = select(ay > ax, F(0.5f * kPiF) - angle, angle);
  angle = select(x < F(0.0f), F(kPiF) - angle, angle);
  return select(y < F(0.0f), -angle, angle);
}

// Rotates u by a unit quaternion (q, w) and subtracts u.
template <class F>
Vec3T<F> rotated_minus(const Vec3T<F>& q, const F& w, const Vec3T<F>& u) {
  const Vec3T<F> t = F(2.0f) * cross(q, u);
  return w * t + cross(q, t);
}

// The quaternion of the rotation vector theta; its sign does not matter.
template <int W>
void quaternion_of(const Vec3T<Lanes<W>>& theta, Vec3T<Lanes<W>>& q, Lanes<W>& w) {
  using F = Lanes<W>;
  constexpr float kPass = 12582912.0f;  // 1.5 * 2^23: adding it rounds to an integer
  const F size = sqrt(dot(theta, theta)), half = F(0.5f) * size;
  const F turns = (half * F(static_cast<float>(1.0 / kPi)) + F(kPass)) - F(kPass);
  // pi as the sum of a short number and a remainder, so that a few revolutions lose no precision.
  const F r = (half - turns * F(3.140625f)) - turns * F(9.67653589793e-4f), s = r * r;
  const auto series = [&](int first) {  // of x^k / k!, every other k from first + 10 down
    F sum(1.0f);
    for (int k = first + 10; k > first; k -= 2) sum = F(1.0f) - s * sum / F(k * (k - 1));
    return sum;
  };
  const F sine = series(1);  // over r
  w = series(0);
  q = select(turns == F(0.0f), F(0.5f) * sine, r * sine / larger(size, F(1e-20f))) * theta;
}

template <int W>
struct StepMotionLanes {
  using F = Lanes<W>;
  using V = Vec3T<F>;
  V q, displacement;
  F w;
  template <class Row>
  static StepMotionLanes of(const Row& row) {
    F r[8];
    lanes::gather8<W>(row, r);
    return {{r[0], r[1], r[2]}, {r[4], r[5], r[6]}, r[3]};
  }
  V less(const V& u) const { return rotated_minus(q, w, u); }
  V rotated(const V& u) const { return u + less(u); }
};

// Axes of both frames at the current poses, and the measures between them.
template <int W>
struct Frames {
  using F = Lanes<W>;
  using V = Vec3T<F>;
  V ax, ay, az, bx, by, bz;

  template <class C>
  Frames(const C& c, const AxesPart& axes, const StepMotionLanes<W>& a, const StepMotionLanes<W>& b)
      : ax(a.rotated(c.get(axes.a_x))),
        ay(a.rotated(c.get(axes.a_y))),
        az(cross(ax, ay)),
        bx(b.rotated(c.get(axes.b_x))),
        by(),
        bz(b.rotated(c.get(axes.b_z))) {
    by = cross(bz, bx);
  }
  V world(const V& u) const { return u.x * ax + u.y * ay + u.z * az; }
  F twist() const { return angle_of<W>(dot(ay, bx) - dot(ax, by), dot(ax, bx) + dot(ay, by)); }
  V twist_axis() const { return (F(1.0f) / larger(F(1.0f) + dot(az, bz), F(1e-3f))) * (az + bz); }
};

// The swing vector and its derivatives, in a's frame.
template <int W>
struct Swing {
  using F = Lanes<W>;
  using V = Vec3T<F>;
  F x, y;
  V by_x, by_y;

  explicit Swing(const Frames<W>& f) {
    const F bx = dot(f.ax, f.bz), by = dot(f.ay, f.bz), cosine = dot(f.az, f.bz);
    const F sine = sqrt(bx * bx + by * by), angle = angle_of<W>(sine, cosine), s = angle * angle;
    // s / sin(s) and (1 - s cot(s)) / s^2
    const LaneMask<W> near = angle < F(0.3f);
    const F ratio = select(near, F(1.0f) + s * (F(1.0f / 6.0f) + s * F(7.0f / 360.0f)),
                           angle / larger(sine, F(1e-6f)));
    const F curve = select(near, F(1.0f / 3.0f) + s * (F(1.0f / 45.0f) + s * F(2.0f / 945.0f)),
                           (F(1.0f) - ratio * cosine) / larger(s, F(1e-6f)));
    x = -(ratio * by);
    y = ratio * bx;
    const V g{y, -x, F(0.0f)};
    by_x = V{F(1.0f), F(0.0f), -y} - (curve * y) * g;
    by_y = V{F(0.0f), F(1.0f), x} + (curve * x) * g;
  }
};

}  // namespace vp::solve
