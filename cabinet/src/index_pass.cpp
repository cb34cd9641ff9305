#include "index_pass.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace cabinet {
namespace {

// A magnet is round: away from its centre along the rod, its mark is narrower. If the rod slides by
// at most this during a pass, both edges of a mark of 6 mm move by less.
constexpr double kStands = 0.5e-3;  // [m]
// [s] time constant of the decaying max of the reports' steps.
constexpr double kStepSeconds = 0.010;

}  // namespace

std::optional<IndexPass> IndexPasses::add(bool under, const RodMotion& at, double turned,
                                          double seconds) {
  step_ = std::max(std::abs(turned), step_ * std::exp(-seconds / kStepSeconds));
  since_entry_ += seconds;
  const bool before = std::exchange(under_, under);
  if (!std::exchange(known_, true) || before == under) return {};
  const RodMotion edge{at.slide, at.angle - 0.5 * turned};  // at the middle of the frame
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
