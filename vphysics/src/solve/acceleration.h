// Anderson acceleration of a solve that converges slowly.
//
// A ball that is pinched between a man and the field hands its load to and fro: from one sweep (a
// round forward, one backward) to the next the impulses' change shrinks by as little as 0.5 %. With
// x_k the impulses before sweep k, f_k what it changes, and dx, df the differences of the last few
// of both, the change that is left is least where
//     minimize |f_k - df c|,   x_(k+1) = x_k + f_k - (dx + df) c
// in the norm of energy: each row's change squared times its response. Impulses stay within their
// bounds; cones of friction are kept by the rounds that follow. Where the sweep after such a step
// changes no less than the one before it, what slides or touches has changed: the step is taken
// back, and the differences are forgotten. Source: Walker and Ni 2011.
#pragma once

#include <array>

#include "solve/contact_solver.h"

namespace vp::solve {

class Acceleration {
 public:
  explicit Acceleration(const StepContext& context) : s_(context) {}

  // After each second round; how many have been done, and how many there may be.
  void after_sweep(int done, int rounds);

 private:
  // Of contacts and joints together. With more, nothing is accelerated.
  static constexpr std::size_t kMaxRows = 64;
  // Differences that are kept. With 4 the pinched balls of matches take 23 rounds on the mean, with
  // 3 28; without, most are not done after 96.
  static constexpr std::size_t kDepth = 4;
  using Rows = std::array<double, kMaxRows>;

  void begin();
  void read(Rows& impulses) const;
  double product(const Rows& a, const Rows& b) const;
  void remember(const Rows& f);
  void forget();
  std::array<double, kDepth> coefficients(const Rows& f) const;
  void add(const Rows& change) const;

  const StepContext& s_;
  std::size_t rows_ = 0;              // more than kMaxRows: nothing is done
  std::size_t known_ = 0, next_ = 0;  // differences; the oldest is written over
  bool has_last_ = false, changed_ = false;
  double last_energy_ = 0.0;  // of f
  Rows x_, response_;         // x: the impulses before the sweep that is going on
  Rows last_x_, last_f_;
  std::array<Rows, kDepth> dx_, df_;
};

}  // namespace vp::solve
