// Operation counts of the paper's Table 3 and of equation (6). A test bounds them; ./bench
// operations prints them.
#pragma once

#include <vector>

#include "vphysics/lie.h"
#include "vphysics/lie/count.h"

namespace vp::test {

struct OperationRow {
  const char* name;
  OperationCount ours;
  long paper_multiplications, paper_additions;

  // The paper counts a division as a multiplication.
  long multiplications() const { return ours.multiplications + ours.divisions; }
};

inline std::vector<OperationRow> count_operations_of_the_paper() {
  const se3T<Count> V{{0.1, 0.2, 0.3}, {1, 2, 3}};
  const SE3T<Count> A = Exp(V);
  const InertiaT<Count> rigid{2, Vec3T<Count>{1, 2, 3}};
  const AInertiaT<Count> articulated = rigid;
  SE3T<Count> f[2] = {A, A};
  InertiaT<Count> I[2] = {rigid, rigid};
  AInertiaT<Count> J[2] = {I[0], I[1]};
  se3T<Count> S[2] = {V, V};
  dse3T<Count> eta;
  const int i = 1;
  const auto equation_6 = [&] {
    eta = J[i] * S[i];
    // clang-format off
    J[i-1] = I[i-1]
    + (J[i] - (eta*eta) / (S[i]*eta)) .Xform(Inv(f[i]));
    // clang-format on
  };
  return {
      {"Ad(T) V", count_operations([&] { (void)Ad(A, V); }), 24, 18},
      {"ad(V) V", count_operations([&] { (void)ad(V, V); }), 18, 12},
      {"Inertia * V", count_operations([&] { (void)(rigid * V); }), 24, 18},
      {"Inertia.Xform", count_operations([&] { (void)rigid.Xform(A); }), 101, 66},
      {"AInertia.Xform", count_operations([&] { (void)articulated.Xform(A); }), 294, 210},
      {"equation (6)", count_operations(equation_6), 360, 269},
  };
}

}  // namespace vp::test
