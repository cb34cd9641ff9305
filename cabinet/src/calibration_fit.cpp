#include "cabinet/calibration_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <optional>

#include "calibration_check.h"
#include "index_fit.h"

namespace cabinet {
namespace {

using Kind = CalibrationMark::Kind;
// Parameters of RodCalibration, scaled to order 1 or below.
using Numbers = Eigen::Matrix<double, kFitted, 1>;

// Cauchy scales [deviations]: first almost least squares, which a poor start cannot mislead, down
// to 2.385, which has 95 % of its efficiency and a low weight for outliers.
constexpr double kCauchy[] = {100, 10, 2.385};
constexpr double kOutlier = 5.0;  // [deviations]
// Of all marks: with more, the good ones cannot be identified.
constexpr double kMaxOutliers = 0.25;
constexpr double kWeakGain = 0.1;  // deviation from zero, so that a poor run has a solution
constexpr double kBandUnit = 100;  // [counts / s] unit of the dead band
constexpr int kIterations = 60;
constexpr int kPriorRows = 2 + 2 + 2 + 1;

// Required accuracy of a fit.
constexpr double kScaleDeviation = 0.004;  // relative: 0.8 mm per stroke of 200 mm
constexpr double kGainDeviation = 0.01;
constexpr double kMaxSlideRms = 1e-3;    // [m]
constexpr double kMaxAngleRms = 0.0875;  // [rad] 5 degrees
constexpr std::size_t kMinSlideMarks = 9, kMinAngleMarks = 4;

struct Scale {
  double slide, angle;  // [m / count], [rad / count]: units of m
};

RodCalibration calibration_of(const Numbers& n, const Scale& scale) {
  return {.m = {{n[0] * scale.slide, n[1] * scale.slide}, {n[2] * scale.angle, n[3] * scale.angle}},
          .slide_gain = {n[4], n[5]},
          .spin_gain = {n[6], n[7]},
          .dead_band = n[8] * kBandUnit};
}

// The mark of a residual and the previous mark of its kind.
struct Difference {
  std::size_t from, to;  // indices in run.marks
};

std::vector<Difference> differences(const CalibrationRun& run) {
  std::vector<Difference> all;
  std::optional<std::size_t> last[2];
  for (std::size_t i = 0; i < run.marks.size(); ++i) {
    auto& before = last[run.marks[i].kind == Kind::slide ? 0 : 1];
    if (before) all.push_back({*before, i});
    before = i;
  }
  return all;
}

double first_angle(const CalibrationRun& run) {
  for (const CalibrationMark& mark : run.marks) {
    if (mark.kind == Kind::angle) return mark.value;
  }
  return 0;
}

// The rod's slide or angle at each mark, according to its kind.
std::vector<double> integrate(const CalibrationRun& run, const RodCalibration& calibration) {
  std::vector<double> at_mark;
  RodIntegrator rod(calibration);
  double slide = 0, angle = first_angle(run);
  std::size_t done = 0;
  for (const CalibrationMark& mark : run.marks) {
    for (; done < mark.at; ++done) {
      const CountIncrement& c = run.increments[done];
      const RodMotion moved = rod.add(c.slide, c.spin, static_cast<double>(c.seconds), angle);
      slide += moved.slide;
      angle += moved.angle;
    }
    at_mark.push_back(mark.kind == Kind::slide ? slide : angle);
  }
  return at_mark;
}

class Problem {
 public:
  Problem(const CalibrationRun& run, const MountPriors& priors)
      : run_(run), priors_(priors), differences_(differences(run)) {}

  const std::vector<Difference>& rows() const { return differences_; }
  Eigen::Index marks() const { return static_cast<Eigen::Index>(differences_.size()); }

  // Of the difference of both marks.
  double deviation(const Difference& d) const {
    return std::sqrt(2.0) *
           (run_.marks[d.to].kind == Kind::slide ? priors_.stop_error : priors_.angle_error);
  }

  // In deviations: first the marks, then the priors.
  Eigen::VectorXd residuals(const Numbers& n, const Scale& scale) const {
    const std::vector<double> at = integrate(run_, calibration_of(n, scale));
    Eigen::VectorXd r(marks() + kPriorRows);
    Eigen::Index row = 0;
    for (const Difference& d : differences_) {
      const double known = run_.marks[d.to].value - run_.marks[d.from].value;
      r[row++] = (at[d.to] - at[d.from] - known) / deviation(d);
    }
    const double turn = scale.angle * priors_.rod_radius / scale.slide;
    const Eigen::Vector2d along(n[0], n[1]), around = turn * Eigen::Vector2d(n[2], n[3]);
    const double squared = n[0] * n[0] + n[1] * n[1];
    r[row++] = (around.norm() - along.norm()) / std::sqrt(squared) / priors_.axis_scale;
    r[row++] = along.dot(around) / squared / priors_.right_angle;
    const double ratio = 1 + priors_.optical_distance / priors_.rod_radius;
    for (int i = 0; i < 2; ++i) {
      r[row++] = (n[6 + i] - ratio * n[4 + i]) / priors_.gain_ratio;
      r[row++] = n[4 + i] / kWeakGain;
    }
    r[row++] = n[8] * kBandUnit / priors_.dead_band;
    return r;
  }

  // Square roots of the Cauchy weights of the marks; priors have weight 1.
  Eigen::VectorXd weights(const Eigen::VectorXd& r, double cauchy) const {
    Eigen::VectorXd w = Eigen::VectorXd::Ones(r.size());
    for (Eigen::Index i = 0; i < marks(); ++i) w[i] = 1 / std::hypot(1.0, r[i] / cauchy);
    return w;
  }
  double cost(const Eigen::VectorXd& r, double cauchy) const {
    double sum = r.tail(kPriorRows).squaredNorm();
    for (Eigen::Index i = 0; i < marks(); ++i) {
      sum += cauchy * cauchy * std::log1p(r[i] * r[i] / (cauchy * cauchy));
    }
    return sum;
  }

  Eigen::MatrixXd derivative(const Numbers& n, const Scale& scale) const {
    // For parameters of order 1: rounding and curvature errors below 1e-9.
    constexpr double kStep = 1e-5;
    Eigen::MatrixXd j(marks() + kPriorRows, kFitted);
    for (int i = 0; i < kFitted; ++i) {
      Numbers high = n, low = n;
      high[i] += kStep;
      low[i] -= kStep;
      j.col(i) = (residuals(high, scale) - residuals(low, scale)) / (2 * kStep);
    }
    return j;
  }

 private:
  const CalibrationRun& run_;
  MountPriors priors_;
  std::vector<Difference> differences_;
};

// Linear least squares on the sums of counts between two marks, without gains and dead band. Empty
// if the run does not move in both directions.
std::optional<RodCalibration> linear_fit(const CalibrationRun& run) {
  Eigen::Matrix2d normal[2] = {Eigen::Matrix2d::Zero(), Eigen::Matrix2d::Zero()};
  Eigen::Vector2d right[2] = {Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};
  for (const Difference& d : differences(run)) {
    Eigen::Vector2d counts(0, 0);
    for (std::size_t i = run.marks[d.from].at; i < run.marks[d.to].at; ++i) {
      counts += Eigen::Vector2d(run.increments[i].slide, run.increments[i].spin);
    }
    const int row = run.marks[d.to].kind == Kind::slide ? 0 : 1;
    normal[row] += counts * counts.transpose();
    right[row] += counts * (run.marks[d.to].value - run.marks[d.from].value);
  }
  RodCalibration rod{};
  for (int row = 0; row < 2; ++row) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> spread(normal[row]);
    if (!(spread.eigenvalues()[0] > 1e4)) return {};  // a hundred counts in the weaker direction
    const Eigen::Vector2d m = normal[row].ldlt().solve(right[row]);
    rod.m[row][0] = m[0];
    rod.m[row][1] = m[1];
  }
  return rod;
}

// Levenberg-Marquardt.
void minimize(const Problem& problem, const Scale& scale, double cauchy, Numbers& n) {
  double damping = 1e-3;
  Eigen::VectorXd r = problem.residuals(n, scale);
  for (int i = 0; i < kIterations; ++i) {
    const Eigen::VectorXd w = problem.weights(r, cauchy);
    const Eigen::MatrixXd j = w.asDiagonal() * problem.derivative(n, scale);
    const Eigen::MatrixXd a = j.transpose() * j;
    const Numbers g = j.transpose() * w.cwiseProduct(r);
    bool better = false;
    while (!better && damping < 1e12) {
      Eigen::MatrixXd damped = a;
      damped.diagonal() *= 1 + damping;
      const Numbers step = -damped.ldlt().solve(g);
      const Eigen::VectorXd there = problem.residuals(n + step, scale);
      better = problem.cost(there, cauchy) < problem.cost(r, cauchy);
      damping = better ? std::max(damping / 10, 1e-12) : damping * 10;
      if (!better) continue;
      n += step;
      r = there;
      if (step.norm() < 1e-8) return;
    }
    if (!better) return;
  }
}

std::string number(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::optional<std::string> check_run(const CalibrationRun& run) {
  std::size_t last = 0, count[2] = {0, 0};
  for (const CalibrationMark& mark : run.marks) {
    if (mark.at < last || mark.at > run.increments.size() || !std::isfinite(mark.value)) {
      return "has a mark out of order or out of the run; record it again";
    }
    last = mark.at;
    ++count[mark.kind == Kind::slide ? 0 : 1];
  }
  if (count[0] < kMinSlideMarks) {
    return "has " + std::to_string(count[0]) +
           " marks at the end stops, 9 are needed; push the rod from stop to stop, with the feet "
           "down and turned by an eighth more each time";
  }
  if (count[1] < kMinAngleMarks) {
    return "has " + std::to_string(count[1]) +
           " marks with the feet straight down, 4 are needed; hold the rod at a stop and turn it "
           "whole turns, both ways";
  }
  return {};
}

// Reports parameters that the run does not determine. Deviations are in units of the parameters.
std::optional<std::string> check_deviations(const RodFit& fit, const Scale& scale) {
  const auto& d = fit.deviation;
  if (d[4] > kGainDeviation || d[5] > kGainDeviation) {
    return "does not show whether the rod is eccentric; turn it by an eighth between two strokes, "
           "eight times";
  }
  if (d[0] / scale.slide > kScaleDeviation || d[1] / scale.slide > kScaleDeviation) {
    return "does not show what a count along the rod is; push the rod from stop to stop at several "
           "angles, and turn it at a stop";
  }
  if (d[2] / scale.angle > kScaleDeviation || d[3] / scale.angle > kScaleDeviation) {
    return "does not show what a count around the rod is; turn the rod five times and more with a "
           "mark before and after, both ways";
  }
  return {};
}

std::optional<std::string> check_residuals(const RodFit& fit) {
  const auto outliers = std::count_if(fit.residuals.begin(), fit.residuals.end(),
                                      [](const auto& r) { return r.outlier; });
  if (static_cast<double>(outliers) > kMaxOutliers * static_cast<double>(fit.residuals.size())) {
    return "does not agree with itself: " + std::to_string(outliers) + " of " +
           std::to_string(fit.residuals.size()) +
           " marks are far off; see that the sensor is fast and near the rod's surface, mark only "
           "when the rod rests, and calibrate again";
  }
  if (fit.slide_rms > kMaxSlideRms || fit.angle_rms > kMaxAngleRms) {
    return "leaves " + number("%.2f mm", fit.slide_rms * 1e3) + " and " +
           number("%.1f degrees", fit.angle_rms * 57.29578) +
           " rms, at most 1 mm and 5 degrees are accepted; clean sensor and rod, see that neither "
           "is loose, and calibrate again";
  }
  return {};
}

}  // namespace

tl::expected<RodFit, std::string> fit_rod(const CalibrationRun& run, const MountPriors& priors) {
  const auto refuse = [](const std::string& what) {
    return tl::unexpected("The calibration run " + what + ".");
  };
  if (const auto wrong = check_run(run)) return refuse(*wrong);
  const auto start = linear_fit(run);
  if (!start) {
    return refuse(
        "shows too few counts of one of the two motions; see that the sensor counts along and "
        "around the rod, and make strokes and turns");
  }
  if (const auto wrong = check_rod(*start)) return refuse(*wrong);

  const Problem problem(run, priors);
  const Scale scale{std::hypot(start->m[0][0], start->m[0][1]),
                    std::hypot(start->m[1][0], start->m[1][1])};
  Numbers n = Numbers::Zero();
  for (int i = 0; i < 2; ++i) {
    n[i] = start->m[0][i] / scale.slide;
    n[2 + i] = start->m[1][i] / scale.angle;
  }
  for (const double cauchy : kCauchy) minimize(problem, scale, cauchy, n);
  n[8] = std::max(n[8], 0.0);

  RodFit fit{};
  fit.calibration = calibration_of(n, scale);
  const Eigen::VectorXd r = problem.residuals(n, scale);
  const Eigen::MatrixXd j =
      problem.weights(r, std::end(kCauchy)[-1]).asDiagonal() * problem.derivative(n, scale);
  const Eigen::MatrixXd covariance =
      (j.transpose() * j).ldlt().solve(Eigen::MatrixXd::Identity(kFitted, kFitted));
  for (int i = 0; i < kFitted; ++i) {
    const double unit = i < 2 ? scale.slide : i < 4 ? scale.angle : i < 8 ? 1.0 : kBandUnit;
    fit.deviation[static_cast<std::size_t>(i)] = unit * std::sqrt(covariance(i, i));
  }
  double squares[2] = {0, 0};
  int counted[2] = {0, 0};
  for (std::size_t i = 0; i < problem.rows().size(); ++i) {
    const Difference& d = problem.rows()[i];
    const double deviations = r[static_cast<Eigen::Index>(i)];
    const double value = deviations * problem.deviation(d);
    const bool outlier = std::abs(deviations) > kOutlier;
    fit.residuals.push_back({run.marks[d.to], value, outlier});
    const int kind = run.marks[d.to].kind == Kind::slide ? 0 : 1;
    if (outlier) continue;
    squares[kind] += value * value;
    ++counted[kind];
  }
  fit.slide_rms = std::sqrt(squares[0] / std::max(counted[0], 1));
  fit.angle_rms = std::sqrt(squares[1] / std::max(counted[1], 1));
  if (const auto wrong = check_residuals(fit)) return refuse(*wrong);
  if (const auto wrong = check_deviations(fit, scale)) return refuse(*wrong);
  if (const auto wrong = check_rod(fit.calibration)) return refuse(*wrong);
  fit_index(run, priors, fit);
  return fit;
}

}  // namespace cabinet
