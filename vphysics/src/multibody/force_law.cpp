#include "multibody/force_law.h"

#include <algorithm>
#include <cmath>

namespace vp::detail {

double Ramp::at(double w) const {
  if (slope == kUnbounded) return w < w0 ? highest : lowest;
  return std::clamp(slope * (w0 - w), lowest, highest);
}

void ForceLaw::add(Ramp ramp) {
  if (ramp.highest - ramp.lowest <= 1e-15 * std::fabs(ramp.w0) * ramp.slope) {
    ramp.slope = kUnbounded;
  }
  ramps_[count_++] = ramp;
}

// The value just left or right of w.
double ForceLaw::sum(double w, bool from_left) const {
  double total = 0.0;
  for (std::size_t i = 0; i < count_; ++i) {
    const Ramp& r = ramps_[i];
    const bool here = r.slope == kUnbounded && w == r.w0;
    total += here ? (from_left ? r.highest : r.lowest) : r.at(w);
  }
  return total;
}

// The linear piece that contains `inside`.
ForceLaw::Line ForceLaw::line_at(double inside) const {
  Line line{0.0, 0.0};
  for (std::size_t i = 0; i < count_; ++i) {
    const Ramp& r = ramps_[i];
    const double p = r.at(inside);
    if (r.slope == kUnbounded || p == r.lowest || p == r.highest) {
      line.alpha += p;
    } else {
      line.alpha += r.slope * r.w0;
      line.beta += r.slope;
    }
  }
  return line;
}

ForceLawPoint ForceLaw::on_line(const Line& line, double z, double D) const {
  const double p = (line.alpha - line.beta * z) / (1.0 + D * line.beta);
  return {z + D * p, p, false, line.alpha, line.beta};
}

ForceLaw::Corners ForceLaw::corners() const {
  Corners out{};
  const auto put = [&](double w) { out.w[out.count++] = w; };
  for (std::size_t i = 0; i < count_; ++i) {
    const Ramp& r = ramps_[i];
    if (r.slope == kUnbounded) {
      put(r.w0);
    } else if (r.slope > 0.0) {
      if (r.highest < kUnbounded) put(r.w0 - r.highest / r.slope);
      if (r.lowest > -kUnbounded) put(r.w0 - r.lowest / r.slope);
    }
  }
  std::sort(out.w.begin(), out.w.begin() + static_cast<std::ptrdiff_t>(out.count));
  return out;
}

double ForceLaw::Corners::inside(std::size_t i) const {
  if (count == 0) return 0.0;
  if (i == 0) return w[0] - 1.0 - std::fabs(w[0]);
  if (i == count) return w[count - 1] + 1.0 + std::fabs(w[count - 1]);
  return 0.5 * (w[i - 1] + w[i]);
}

// Along the law from left to right, w - D p increases: finds the first corner that is not left of
// z.
ForceLawPoint ForceLaw::intersect(double z, double D) const {
  const Corners at = corners();
  for (std::size_t i = 0; i < at.count; ++i) {
    const double c = at.w[i];
    if (z < c - D * sum(c, true)) return on_line(line_at(at.inside(i)), z, D);
    if (z <= c - D * sum(c, false)) return {c, (c - z) / D, true, 0.0, 0.0};
  }
  return on_line(line_at(at.inside(at.count)), z, D);
}

double ForceLaw::velocity_for(double p) const {
  const Corners at = corners();
  for (std::size_t i = 0; i <= at.count; ++i) {
    if (i == at.count || p > sum(at.w[i], true)) {
      const Line line = line_at(at.inside(i));
      if (line.beta > 0.0) return (line.alpha - p) / line.beta;
      return i == at.count ? kUnbounded : at.w[i];
    }
    if (p >= sum(at.w[i], false)) return at.w[i];
  }
  return 0.0;  // not reached
}

double ForceLaw::clamped_impulse(double p) const {
  double lowest = 0.0, highest = 0.0;
  for (std::size_t i = 0; i < count_; ++i) {
    const Ramp& r = ramps_[i];
    if (!(r.slope > 0.0)) continue;
    lowest += r.lowest;
    highest += r.highest;
  }
  return std::clamp(p, lowest, highest);
}

double ForceLaw::part_of_first(double w, double p) const {
  const Ramp& r = ramps_[0];
  const bool free = r.slope == kUnbounded && w == r.w0;
  const double high = free ? r.highest : r.at(w), low = free ? r.lowest : r.at(w);
  // The part of the other ramps lies between these two values.
  const double max_value = sum(w, true) - high, min_value = sum(w, false) - low;
  return std::clamp(std::clamp(std::clamp(0.0, low, high), p - max_value, p - min_value), r.lowest,
                    r.highest);
}

}  // namespace vp::detail
