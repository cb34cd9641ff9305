#include "view/see_through.h"

#include <algorithm>
#include <cmath>

namespace sandbox {

// Slab test: clips the segment against the box's three pairs of planes, in the box's frame.
bool hides(const vp::Box& box, const vp::SE3& T_world_box, const vp::Vec3& a, const vp::Vec3& b) {
  const vp::Vec3 p = inverse_times(T_world_box, a), way = inverse_times(T_world_box, b) - p;
  double enter = 0.0, leave = 1.0;
  for (int i = 0; i < 3; ++i) {
    const double half = box.half_extents[i];
    if (way[i] == 0.0) {
      if (std::abs(p[i]) > half) return false;
      continue;
    }
    const double s = (-half - p[i]) / way[i], t = (half - p[i]) / way[i];
    enter = std::max(enter, std::min(s, t));
    leave = std::min(leave, std::max(s, t));
  }
  return enter <= leave;
}

bool hides_many(const vp::Box& box, const vp::SE3& T_world_box, const vp::Vec3& from,
                std::span<const vp::Vec3> points) {
  const auto hidden = std::count_if(points.begin(), points.end(), [&](const vp::Vec3& point) {
    return hides(box, T_world_box, from, point);
  });
  return 10 * hidden > static_cast<std::ptrdiff_t>(points.size());
}

}  // namespace sandbox
