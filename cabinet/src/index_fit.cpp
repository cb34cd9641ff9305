// The angle of the fitted calibration is ahead of the feet by `zero`, and more with each turn
// (drift). In this angle, pass i of the mark, with direction d_i (1 forward, -1 back) and rate v_i
// [rad/s], has its middle at
//   middle_i = mark + 2 pi k_i + drift middle_i + d_i lag + v_i delay        k_i an integer
// When the feet are straight down for the j-th time, the rod is at
//   angle_j = known_j + drift angle_j + zero
// The mark is at mark - zero. The delay, from the sensor's reports to the switch, matters only in
// fast turns. It is fitted so that the lag is only the switch's own, and then dropped, as is the
// drift. The method is least squares with priors for any switch, repeated once without outliers.
#include "index_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "calibration_check.h"
#include "index_pass.h"

namespace cabinet {
namespace {

using Kind = CalibrationMark::Kind;

constexpr double kLag = 0.03, kDelay = 0.010;  // [rad], [s] deviations of the priors
constexpr double kScaleDrift = 0.002;          // [rad / rad] deviation of the prior
constexpr double kNoise = 0.02;                // [rad] initial deviation of a pass in a fast turn
constexpr double kMinNoise = 0.002;            // [rad]
constexpr double kFarOff = 2.5;                // [rms of the residuals]
constexpr int kMinPasses = 3;                  // in each direction
constexpr double kMaxSpread = 0.06;            // [rad] of middles or widths of the same mark

struct FeetDown {
  double angle, known;  // [rad]
};
struct Seen {
  std::vector<IndexPass> passes;
  std::vector<FeetDown> feet;
};

double first_angle(const std::vector<CalibrationMark>& marks) {
  const auto first = std::ranges::find(marks, Kind::angle, &CalibrationMark::kind);
  return first == marks.end() ? 0 : first->value;
}

Seen see(const CalibrationRun& run, const RodCalibration& calibration) {
  Seen seen;
  RodIntegrator rod(calibration);
  IndexPasses passes;
  RodMotion at{0, first_angle(run.marks)};
  std::size_t done = 0;
  for (const CalibrationMark& mark : run.marks) {
    for (; done < mark.at; ++done) {
      const CountIncrement& c = run.increments[done];
      const auto seconds = static_cast<double>(c.seconds);
      const RodMotion moved = rod.add(c.slide, c.spin, seconds, at.angle);
      at = {at.slide + moved.slide, at.angle + moved.angle};
      if (const auto pass = passes.add(c.mark, at, moved.angle, seconds))
        seen.passes.push_back(*pass);
    }
    if (mark.kind == Kind::angle) seen.feet.push_back({at.angle, mark.value});
  }
  return seen;
}

struct Fit {
  double mark, zero, drift, lag, delay;
  double deviation = 0;                 // [rad] of mark - zero
  double width = 0;                     // [rad]
  double spread = 0, width_spread = 0;  // [rad] rms
};

double wrong(const IndexPass& pass, const Fit& fit) {
  const double middle = fit.mark + fit.drift * pass.middle + std::copysign(fit.lag, pass.turned) +
                        fit.delay * pass.turned / pass.seconds;
  return std::remainder(pass.middle - middle, 2 * M_PI);
}

// Normal equations for mark, zero, drift, lag and delay.
struct Equations {
  using Row = Eigen::Matrix<double, 1, 5>;
  Eigen::Matrix<double, 5, 5> normal = Eigen::Matrix<double, 5, 5>::Zero();
  Eigen::Matrix<double, 5, 1> right = Eigen::Matrix<double, 5, 1>::Zero();

  void add(const Row& row, double value, double deviation) {
    normal += row.transpose() * row / (deviation * deviation);
    right += row.transpose() * value / (deviation * deviation);
  }
};

void measure_spread(const std::vector<IndexPass>& passes, Fit& fit) {
  const auto n = static_cast<double>(passes.size());
  for (const IndexPass& pass : passes) fit.width += std::abs(pass.turned) / n;
  double squares = 0, width_squares = 0;
  for (const IndexPass& pass : passes) {
    squares += std::pow(wrong(pass, fit), 2);
    width_squares += std::pow(std::abs(pass.turned) - fit.width, 2);
  }
  fit.spread = std::sqrt(squares / n);
  fit.width_spread = std::sqrt(width_squares / n);
}

Fit solve(const Seen& seen, double noise, double feet_error) {
  Equations equations;
  const double about = seen.passes.front().middle;
  for (const IndexPass& pass : seen.passes) {
    Equations::Row row;
    row << 1, 0, pass.middle, std::copysign(1.0, pass.turned), pass.turned / pass.seconds;
    equations.add(row, std::remainder(pass.middle - about, 2 * M_PI), noise);
  }
  for (const FeetDown& feet : seen.feet) {
    Equations::Row row;
    row << 0, 1, feet.angle, 0, 0;
    equations.add(row, feet.angle - feet.known, feet_error);
  }
  const double known[] = {kScaleDrift, kLag, kDelay};
  for (int i = 0; i < 3; ++i) equations.add(Equations::Row::Unit(2 + i), 0, known[i]);

  const Eigen::Matrix<double, 5, 5> covariance = equations.normal.inverse();
  const Eigen::Matrix<double, 5, 1> x = covariance * equations.right;
  Fit fit{.mark = about + x[0], .zero = x[1], .drift = x[2], .lag = x[3], .delay = x[4]};
  fit.deviation = std::sqrt(covariance(0, 0) + covariance(1, 1) - 2 * covariance(0, 1));
  measure_spread(seen.passes, fit);
  return fit;
}

// A pass during which the rod turned back says nothing about the mark.
void drop_turned_back(std::vector<IndexPass>& passes) {
  std::vector<double> widths;
  widths.reserve(passes.size());
  for (const IndexPass& pass : passes) widths.push_back(std::abs(pass.turned));
  std::ranges::sort(widths);
  const double typical = widths.empty() ? 0 : widths[widths.size() / 2];
  std::erase_if(passes,
                [&](const IndexPass& pass) { return std::abs(pass.turned) < 0.5 * typical; });
}

bool both_ways(const std::vector<IndexPass>& passes) {
  const auto forward = std::ranges::count_if(passes, [](const auto& p) { return p.turned > 0; });
  return forward >= kMinPasses &&
         static_cast<std::ptrdiff_t>(passes.size()) - forward >= kMinPasses;
}

}  // namespace

void fit_index(const CalibrationRun& run, const MountPriors& priors, RodFit& fit) {
  Seen seen = see(run, fit.calibration);
  fit.index_passes = static_cast<int>(seen.passes.size());
  drop_turned_back(seen.passes);
  if (!both_ways(seen.passes)) return;
  const Fit first = solve(seen, kNoise, priors.angle_error);
  const double max = std::max(kFarOff * first.spread, kNoise);
  std::erase_if(seen.passes, [&](const IndexPass& p) { return std::abs(wrong(p, first)) > max; });
  if (!both_ways(seen.passes)) return;
  const Fit mark = solve(seen, std::max(first.spread, kMinNoise), priors.angle_error);
  if (!(mark.spread <= kMaxSpread && mark.width_spread <= kMaxSpread)) return;
  RodCalibration marked = fit.calibration;
  marked.index = IndexMark{std::remainder(mark.mark - mark.zero, 2 * M_PI), mark.width, mark.lag};
  if (check_rod(marked)) return;
  fit.calibration = marked;
  // The rod's eccentricity adds an error once per turn, which is known as well as its gain.
  fit.index_deviation = std::hypot(mark.deviation, fit.deviation[6], fit.deviation[7]);
}

}  // namespace cabinet
