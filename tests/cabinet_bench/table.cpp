#include "table.h"

#include <cmath>
#include <numeric>

#include "foosball/table.h"

namespace cabinet_bench {

Table::Table(Mounting mounting, Marks marks, double counts_per_mm, std::uint32_t seed)
    : marks_(marks), random_(seed) {
  for (cabinet_test::Mount& mount : mounts_) {
    mount.counts_per_mm = counts_per_mm;
    if (mounting == Mounting::drawn) mount = cabinet_test::drawn_mount(random_, counts_per_mm);
  }
  if (has_marks()) draw_marks(seed);
}

// With a separate generator: a table with marks has the same sensors as one without.
void Table::draw_marks(std::uint32_t seed) {
  std::mt19937 random(seed + 1000);
  for (std::size_t rod = 0; rod < mounts_.size(); ++rod) {
    mounts_[rod].mark = cabinet_test::drawn_mark(random, near_stop(rod));
    mounts_[rod].mark.angle /= 4;
  }
}

double Table::near_stop(std::size_t rod) {
  const foosball::RodSpec& spec = foosball::table_spec(foosball::Layout::tournament).rods[rod];
  return -foosball::push_sign(spec.team) * spec.slide_limit;
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
    const bool on = cabinet_test::switched_on(mounts_[rod].mark, under(rod),
                                              std::midpoint(poses_[rod].slide, to[rod].slide),
                                              std::midpoint(poses_[rod].angle, to[rod].angle));
    under_ = static_cast<std::uint8_t>((under_ & ~(1u << rod)) | (on ? 1u : 0u) << rod);
  }
  ++ms_;
  poses_ = to;
}

void Table::pass(Controller& controller) const {
  if (has_marks()) controller.show_marks(under_);
  controller.advance(surfaces_);
}

void Table::forget_turns() {
  for (Pose& pose : poses_) pose.angle = std::remainder(pose.angle, 2 * M_PI);
}

}  // namespace cabinet_bench
