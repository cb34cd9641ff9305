// Constraints between two frames a and b, by their relative pose and velocity:
//
//   T = T_a_b = T_world_a^-1 T_world_b,   T' = T [W],   W = V_b - Ad_(T^-1) V_a   in frame b
//
// A constraint has the residual phi(T) and its rate f(T, W), linear in W. The rows of J are f for
// each unit W, transformed to the two links. With dual numbers, T with derivative T' and W with its
// rate at zero joint accelerations, the derivative of f is the bias: no second derivatives are
// coded by hand.
#include <array>
#include <cmath>
#include <string>

#include "vphysics/lie/dual.h"
#include "vphysics/multibody/constraint.h"

namespace vp {
namespace {

using Dual = DualT<double>;

template <class T>
Vec3T<T> z_axis() {
  return {T(0), T(0), T(1)};
}

struct BallLoop {
  static constexpr std::size_t kRows = 3;
  template <class T>
  std::array<T, 3> rate(const SE3T<T>& X, const se3T<T>& W) const {
    const Vec3T<T> p = X.rotate(W.v);
    return {p.x, p.y, p.z};
  }
  std::array<double, 3> residual(const SE3& X) const {
    const Vec3& p = X.position();
    return {p.x, p.y, p.z};
  }
};

// With c the z axis of b in frame a: the stereographic image 2 (-c_y, c_x) / (1 + c_z) of the
// rotation from one axis to the other.
struct HingeLoop {
  static constexpr std::size_t kRows = 5;
  template <class T>
  std::array<T, 5> rate(const SE3T<T>& X, const se3T<T>& W) const {
    const Vec3T<T> p = X.rotate(W.v), c = X.rotation().cz;
    const Vec3T<T> c1 = X.rotate(cross(W.w, z_axis<T>()));
    const T s = T(2) / (T(1) + c.z), s1 = T(-0.5) * s * s * c1.z;
    return {p.x, p.y, p.z, -(s * c1.y + s1 * c.y), s * c1.x + s1 * c.x};
  }
  std::array<double, 5> residual(const SE3& X) const {
    const Vec3 p = X.position(), c = X.rotation().cz;
    const double s = 2.0 / (1.0 + c.z);
    return {p.x, p.y, p.z, -s * c.y, s * c.x};
  }
};

// Log(T)' = J_r^-1(Log T) W, which is the derivative of the residual Log T.
struct WeldLoop {
  static constexpr std::size_t kRows = 6;
  template <class T>
  std::array<T, 6> rate(const SE3T<T>& X, const se3T<T>& W) const {
    const se3T<T> r = right_jacobian_inverse(Log(X)) * W;
    return {r.w.x, r.w.y, r.w.z, r.v.x, r.v.y, r.v.z};
  }
  std::array<double, 6> residual(const SE3& X) const {
    const se3 r = Log(X);
    return {r.w.x, r.w.y, r.w.z, r.v.x, r.v.y, r.v.z};
  }
};

struct Bar {
  static constexpr std::size_t kRows = 1;
  double length;
  template <class T>
  std::array<T, 1> rate(const SE3T<T>& X, const se3T<T>& W) const {
    return {dot(X.position(), X.rotate(W.v)) / T(length)};
  }
  std::array<double, 1> residual(const SE3& X) const {
    const double d = norm(X.position());
    return {(d - length) * (d + length) / (2 * length)};
  }
};

Vec3T<Dual> with_derivative(const Vec3& a, const Vec3& rate) {
  Vec3T<Dual> out{Dual(a.x), Dual(a.y), Dual(a.z)};
  for (int i = 0; i < 3; ++i) out[i].derivative[0] = rate[i];
  return out;
}
se3T<Dual> with_derivative(const se3& V, const se3& rate) {
  return {with_derivative(V.w, rate.w), with_derivative(V.v, rate.v)};
}
SE3T<Dual> moving(const SE3& X, const se3& W) {
  const Mat3& R = X.rotation();
  const Mat3 R1 = R * skew(W.w);
  return {Mat3T<Dual>{with_derivative(R.cx, R1.cx), with_derivative(R.cy, R1.cy),
                      with_derivative(R.cz, R1.cz)},
          with_derivative(X.position(), X.rotate(W.v))};
}

bool finite_pose(const SE3& X) {
  const Mat3& R = X.rotation();
  return is_finite(R.cx) && is_finite(R.cy) && is_finite(R.cz) && is_finite(X.position());
}

template <class Loop>
class Closure final : public Constraint {
 public:
  Closure(const Attachment& a, const Attachment& b, const Loop& loop) : a_(a), b_(b), loop_(loop) {}

  int rows() const override { return static_cast<int>(Loop::kRows); }

  Expected<void> check(const Model& model) const override {
    const auto invalid = [](std::string why) {
      return tl::make_unexpected(Error{Errc::invalid_argument, std::move(why)});
    };
    for (const Attachment* side : {&a_, &b_}) {
      if (side->link != kWorld && (side->link < 0 || side->link >= model.links())) {
        return invalid("a loop is closed at link " + std::to_string(side->link) +
                       ", which is not in the model");
      }
      if (!finite_pose(side->T_link_frame)) {
        return invalid("the frames at which a loop is closed must be finite");
      }
    }
    if (a_.link == b_.link) return invalid("a loop must be closed between two links, not one");
    if constexpr (requires { loop_.length; }) {
      if (!(loop_.length > 0.0 && loop_.length < 1e300)) {
        return invalid("a bar's length must be positive; for none, close a ball");
      }
    }
    return {};
  }

  void evaluate(const ConstraintView& at, const ConstraintRows& out) const override {
    const SE3 X = Inv(a_.T_link_frame) * (at.T_between(a_.link, b_.link) * b_.T_link_frame);
    const se3 V_a = InvAd(X, InvAd(a_.T_link_frame, at.velocity(a_.link)));
    const se3 A_a = InvAd(X, InvAd(a_.T_link_frame, at.bias(a_.link)));
    const se3 W = InvAd(b_.T_link_frame, at.velocity(b_.link)) - V_a;
    // The rate of Ad_(T^-1) V_a is Ad_(T^-1) V_a' - ad_W Ad_(T^-1) V_a.
    const se3 W1 = InvAd(b_.T_link_frame, at.bias(b_.link)) - A_a + ad(W, V_a);

    const auto residual = loop_.residual(X);
    const auto rates = loop_.rate(moving(X, W), with_derivative(W, W1));
    std::array<dse3, Loop::kRows> F{};
    for (int k = 0; k < 6; ++k) {
      se3 unit{};
      (k < 3 ? unit.w : unit.v)[k % 3] = 1.0;
      const auto column = loop_.rate(X, unit);
      for (std::size_t i = 0; i < Loop::kRows; ++i) (k < 3 ? F[i].m : F[i].f)[k % 3] = column[i];
    }
    for (std::size_t i = 0; i < Loop::kRows; ++i) {
      out.residual[i] = residual[i];
      out.bias[i] = rates[i].derivative[0];
      at.add(out, i, b_.link, InvdAd(b_.T_link_frame, F[i]));
      at.add(out, i, a_.link, -1.0 * InvdAd(a_.T_link_frame * X, F[i]));
    }
  }

 private:
  Attachment a_, b_;
  Loop loop_;
};

template <class Loop>
ConstraintPtr closure(const Attachment& a, const Attachment& b, const Loop& loop) {
  return std::make_shared<Closure<Loop>>(a, b, loop);
}

}  // namespace

ConstraintPtr close_ball(const Attachment& a, const Attachment& b) {
  return closure(a, b, BallLoop{});
}
ConstraintPtr close_hinge(const Attachment& a, const Attachment& b) {
  return closure(a, b, HingeLoop{});
}
ConstraintPtr close_weld(const Attachment& a, const Attachment& b) {
  return closure(a, b, WeldLoop{});
}
ConstraintPtr keep_distance(const Attachment& a, const Attachment& b, double length) {
  return closure(a, b, Bar{length});
}

}  // namespace vp
