// A sub-step's rotation of bodies that precess, W at a time: as free bodies, which conserves their
// angular momenta. world/free_rotation.h states the equations. Here each sub-step is one part, and
// the end velocity is corrected so that the angular momentum is conserved even where Newton's
// method has not converged. If the body would gain energy, since it rotates too fast for that, its
// angular velocity remains the same in its own frame instead.
#pragma once

#include "solve/joint_angles.h"
#include "solve/lanes.h"

namespace vp::solve {

// Of Newton's method: enough for single precision up to a rotation of 1 rad in a sub-step.
inline constexpr int kMidpointIterations = 3;
inline constexpr float kMaxGain = 1e-5f;  // of a sub-step, relative

// tan(x) / x at xx = x^2: continued fraction to x^5. Clamped at x = 1.
template <class F>
F tangent_ratio(const F& xx) {
  const F s = smaller(xx, F(1.0f));
  return (F(15.0f) - s) / (F(15.0f) - F(6.0f) * s);
}

// Solves  I (m - w) + b m x I m = 0  for m.
template <class F>
Vec3T<F> midpoint_rate(const Sym3T<F>& I, const Vec3T<F>& w, const F& b) {
  using V = Vec3T<F>;
  V m = w;
  for (int i = 0; i < kMidpointIterations; ++i) {
    const V L = I * m, f = I * (w - m) + b * cross(L, m);
    // The derivative by m is  I + b (m x I - L x).
    const auto column = [&](const V& axis) {
      const V of = I * axis;
      return of + b * (cross(m, of) - cross(L, axis));
    };
    const V x = column({F(1.0f), F(0.0f), F(0.0f)}), y = column({F(0.0f), F(1.0f), F(0.0f)}),
            z = column({F(0.0f), F(0.0f), F(1.0f)});
    const V yz = cross(y, z);
    const F determinant = dot(x, yz);
    const auto regular = abs(determinant) > F(0.0f);
    const F scale = select(regular, F(1.0f) / select(regular, determinant, F(1.0f)), F(0.0f));
    m += scale * V{dot(f, yz), dot(x, cross(f, z)), dot(x, cross(y, f))};
  }
  return m;
}

// The rotation vector of a unit quaternion (q, w), of at most pi.
template <int W>
Vec3T<Lanes<W>> rotation_vector_of(const Vec3T<Lanes<W>>& q, const Lanes<W>& w) {
  using F = Lanes<W>;
  const F sine = sqrt(dot(q, q));
  const F ratio = select(sine < F(0.02f), F(2.0f) + F(1.0f / 3.0f) * sine * sine,
                         F(2.0f) * angle_of<W>(sine, abs(w)) / larger(sine, F(0.01f)));
  return select(w < F(0.0f), -ratio, ratio) * q;
}

// A body's rotation q, w since the start of the step, and its angular velocity. Body axes are those
// that coincide with the world's at the start of the step.
template <int W>
struct PrecessingLanes {
  using F = Lanes<W>;
  using V = Vec3T<F>;
  V q;
  F w;
  V rate;  // world axes

  void rotate(const Sym3T<F>& I, const Sym3T<F>& inverse, float h) {
    const V before = rate + rotated_minus(-q, w, rate), L = I * before;
    const F half = F(0.5f * h);
    const F b = half * tangent_ratio(half * half * dot(before, before));
    const V middle = midpoint_rate(I, before, b);
    const V c = b * middle;
    const F s = F(1.0f) + dot(c, c);
    const V u = cross(L, c), end_L = L + (F(2.0f) / s) * (u + cross(u, c));  // rotated back
    V after = F(2.0f) * middle - before;
    after += inverse * (end_L - I * after);
    // False also for NaN.
    const auto fine = dot(after, end_L) <= F(1.0f + kMaxGain) * dot(before, L);
    after = {select(fine, after.x, before.x), select(fine, after.y, before.y),
             select(fine, after.z, before.z)};
    const F scale = F(1.0f) / sqrt(s);
    const V turned = w * c + q + cross(q, c);
    w = scale * (w - dot(q, c));
    q = scale * turned;
    rate = after + rotated_minus(q, w, after);
  }
  Sym3T<F> rotated(const Sym3T<F>& A) const {
    const V x{F(1.0f), F(0.0f), F(0.0f)}, y{F(0.0f), F(1.0f), F(0.0f)};
    const V ax = x + rotated_minus(q, w, x), ay = y + rotated_minus(q, w, y);
    return vp::rotated(Mat3T<F>{ax, ay, cross(ax, ay)}, A);
  }
};

}  // namespace vp::solve
