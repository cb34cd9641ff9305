#include "multibody/principal.h"

#include <algorithm>
#include <cmath>

namespace vp::detail {

// Jacobi's method with rotations in a fixed order; eight sweeps reduce the off-diagonal to zero.
Principal principal_of(const Sym3& A) {
  double m[3][3] = {{A.xx, A.xy, A.zx}, {A.xy, A.yy, A.yz}, {A.zx, A.yz, A.zz}};
  double Q[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  constexpr int kPairs[3][2] = {{0, 1}, {1, 2}, {0, 2}};
  for (int sweep = 0; sweep < 8; ++sweep) {
    for (const auto& pair : kPairs) {
      const int i = pair[0], j = pair[1];
      if (m[i][j] == 0.0) continue;
      // The rotation by atan t that makes m[i][j] zero: t = cot - sqrt, the smaller of the two
      // solutions.
      const double cot = (m[j][j] - m[i][i]) / (2.0 * m[i][j]);
      const double t = (cot >= 0.0 ? 1.0 : -1.0) / (std::fabs(cot) + std::sqrt(cot * cot + 1.0));
      const double c = 1.0 / std::sqrt(t * t + 1.0), s = t * c;
      for (auto& row : m) {
        const double x = row[i], y = row[j];
        row[i] = c * x - s * y;
        row[j] = s * x + c * y;
      }
      for (int k = 0; k < 3; ++k) {
        const double x = m[i][k], y = m[j][k];
        m[i][k] = c * x - s * y;
        m[j][k] = s * x + c * y;
        const double u = Q[k][i], v = Q[k][j];
        Q[k][i] = c * u - s * v;
        Q[k][j] = s * u + c * v;
      }
    }
  }
  std::array<int, 3> order = {0, 1, 2};
  std::sort(order.begin(), order.end(), [&](int a, int b) { return m[a][a] < m[b][b]; });
  Principal out{};
  for (std::size_t k = 0; k < 3; ++k) {
    const int i = order[k];
    out.moments[k] = m[i][i];
    out.axes[k] = {Q[0][i], Q[1][i], Q[2][i]};
  }
  return out;
}

}  // namespace vp::detail
