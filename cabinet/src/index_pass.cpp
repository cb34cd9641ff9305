#include "index_pass.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace cabinet {
namespace {

// A magnet is round: further along the rod its mark is narrower. While the rod moves so far along
// itself both edges move by less, on a mark of 6 mm.
constexpr double kStands = 0.5e-3;      // [m]
constexpr double kStepSeconds = 0.010;  // [s] in which the steps of reports are forgotten, to 1/e

}  // namespace

std::optional<IndexPass> IndexPasses::add(bool under, const RodMotion& at, double turned,
                                          double seconds) {
  step_ = std::max(std::abs(turned), step_ * std::exp(-seconds / kStepSeconds));
  since_entry_ += seconds;
  const bool before = std::exchange(under_, under);
  if (!std::exchange(known_, true) || before == under) return {};
  const RodMotion edge{at.slide, at.angle - 0.5 * turned};  // in the middle of the frame
  if (under) {
    entered_ = Entry{edge, step_};
    since_entry_ = 0;
    return {};
  }
  const auto entry = std::exchange(entered_, std::nullopt);
  if (!entry || std::abs(edge.slide - entry->at.slide) > kStands) return {};
  return IndexPass{std::midpoint(entry->at.angle, edge.angle), edge.angle - entry->at.angle,
                   since_entry_, std::max(step_, entry->step)};
}

void IndexPasses::forget() {
  known_ = false;
  entered_.reset();
}

}  // namespace cabinet
