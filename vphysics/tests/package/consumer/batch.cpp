// Two rods let go at once, one level and one that hangs, as lanes of one call.
#include <cstdio>
#include <vector>

#include "rod.h"

int main() {
  const auto model = make_rod();
  if (!model) return 1;
  using Pack = vp::PackT<double, 4>;
  vp::DataT<Pack> data(*model);
  std::vector<Pack> q(1), v(1), tau(1), a(1);
  q[0].set(1, vp::kPi / 2);
  if (!vp::forward_dynamics<Pack>(*model, data, q, v, tau, {}, a)) return 1;
  std::printf("level %.6f rad/s^2\nhanging %.6f rad/s^2\n", a[0][0], a[0][1]);
}
