#include "table.h"

#include <cmath>

namespace cabinet_bench {

Table::Table(Mounting mounting, double counts_per_mm, std::uint32_t seed) : random_(seed) {
  for (cabinet_test::Mount& mount : mounts_) {
    mount.counts_per_mm = counts_per_mm;
    if (mounting == Mounting::drawn) mount = cabinet_test::drawn_mount(random_, counts_per_mm);
  }
}

void Table::move(const PerRod<Pose>& to) {
  for (std::size_t rod = 0; rod < to.size(); ++rod) {
    if (ms_ % kNoiseMs == 0) {
      std::normal_distribution<double> noise(0, mounts_[rod].noise);
      scale_[rod].slide = mounts_[rod].noise > 0 ? 1 + noise(random_) : 1.0;
      scale_[rod].spin = mounts_[rod].noise > 0 ? 1 + noise(random_) : 1.0;
    }
    const auto passed = cabinet_test::surface_counts(
        mounts_[rod], poses_[rod].slide, poses_[rod].angle, to[rod].slide, to[rod].angle);
    surfaces_[rod].slide += scale_[rod].slide * passed.slide;
    surfaces_[rod].spin += scale_[rod].spin * passed.spin;
  }
  ++ms_;
  poses_ = to;
}

void Table::forget_turns() {
  for (Pose& pose : poses_) pose.angle = std::remainder(pose.angle, 2 * M_PI);
}

}  // namespace cabinet_bench
