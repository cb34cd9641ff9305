// A scalar that counts operations: the paper's Table 3.
//
// Counts as in the paper: a subtraction is an addition, divisions are counted separately, sign
// changes and comparisons are not counted.
#pragma once

#include <type_traits>

#include "vphysics/lie/scalar.h"

namespace vp {

struct OperationCount {
  long multiplications = 0, additions = 0, divisions = 0, others = 0;  // others: sqrt, sin and cos
  bool operator==(const OperationCount&) const = default;
};

class Count {
 public:
  Count() = default;
  template <class S>
  requires std::is_arithmetic_v<S> Count(S value) : value_(static_cast<double>(value)) {}
  double value() const { return value_; }

  // Operations of this thread so far.
  static OperationCount& done() {
    static thread_local OperationCount count;
    return count;
  }

  friend Count operator-(const Count& a) { return Count(-a.value_); }
  friend Count operator+(const Count& a, const Count& b) {
    ++done().additions;
    return Count(a.value_ + b.value_);
  }
  friend Count operator-(const Count& a, const Count& b) {
    ++done().additions;
    return Count(a.value_ - b.value_);
  }
  friend Count operator*(const Count& a, const Count& b) {
    ++done().multiplications;
    return Count(a.value_ * b.value_);
  }
  friend Count operator/(const Count& a, const Count& b) {
    ++done().divisions;
    return Count(a.value_ / b.value_);
  }
  Count& operator+=(const Count& b) { return *this = *this + b; }
  Count& operator-=(const Count& b) { return *this = *this - b; }
  Count& operator*=(const Count& b) { return *this = *this * b; }

  friend constexpr bool operator==(const Count& a, const Count& b) { return a.value_ == b.value_; }
  friend constexpr auto operator<=>(const Count& a, const Count& b) {
    return a.value_ <=> b.value_;
  }

 private:
  double value_ = 0.0;
};

// The operations of f with counting scalars.
template <class F>
OperationCount count_operations(const F& f) {
  const OperationCount before = Count::done();
  f();
  const OperationCount& after = Count::done();
  return {after.multiplications - before.multiplications, after.additions - before.additions,
          after.divisions - before.divisions, after.others - before.others};
}

inline Count sqrt(const Count& a) {
  ++Count::done().others;
  return Count(std::sqrt(a.value()));
}
inline SinCosT<Count> sin_cos(const Count& x) {
  Count::done().others += 2;
  const auto [s, c] = sin_cos(x.value());
  return {Count(s), Count(c)};
}
inline Count arc_tangent(const Count& y, const Count& x) {
  ++Count::done().others;
  return Count(arc_tangent(y.value(), x.value()));
}

}  // namespace vp
