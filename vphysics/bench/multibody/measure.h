// Checks that the engines agree, then measures their times.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine.h"

namespace vp::bench {

// Maximum difference, relative to the largest number of the result, over all states.
inline constexpr double kAgreement = 1e-9;
// In float a result has at most 7 digits, and forward dynamics of a long chain loses most of them.
// A larger difference is not rounding error.
inline constexpr double kAgreementFloat = 1e-2;
// For derivatives compared with difference quotients of numbers that agree to rounding.
inline constexpr double kAgreementQuotients = 1e-7;

// The result of one engine for one metric of one model.
struct Figure {
  std::string model, engine, metric;   // metric: "forward_us", "forward_batch_double4_us",
                                       // "forward_derivatives_double_us", ...
  std::string missing{};               // why there is no result; empty: there are times
  std::optional<double> difference{};  // relative difference from our result; none for ours
  std::vector<double> rounds{};        // time per state of each iteration [us]

  double median() const;
  double p10() const;
};

struct Plan {
  std::vector<std::string> models;
  std::vector<std::string> engines;  // options of kEngines
  double seconds = 60.0;             // in total
};

// Returns the results in the order of the plan: every engine for every metric, ours also for
// batches. said: receives progress messages.
std::vector<Figure> measure(const Plan& plan, const std::function<void(const std::string&)>& said);

const Figure* find(const std::vector<Figure>& figures, const std::string& model,
                   const std::string& engine, const std::string& metric);
// The median over the iterations of a's time divided by b's time in the same iteration: a temporary
// slowdown of the machine affects both. Empty if one of them has no times.
std::optional<double> ratio(const Figure* a, const Figure* b);

}  // namespace vp::bench
