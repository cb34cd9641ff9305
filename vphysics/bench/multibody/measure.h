// First that the engines agree, then how long they take.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine.h"

namespace vp::bench {

// Of the largest number of the result, over all states.
inline constexpr double kAgreement = 1e-9;
// In float a result has no more than 7 digits, and forward dynamics of a long chain loses most of
// them: what is told apart here from rounding is another answer.
inline constexpr double kAgreementFloat = 1e-2;
// A derivative from a quotient of numbers that agree to rounding.
inline constexpr double kAgreementQuotients = 1e-7;

// What one engine does at one metric of one model.
struct Figure {
  std::string model, engine, metric;   // metric: "forward_us", "forward_batch_double4_us",
                                       // "forward_derivatives_double_us", ...
  std::string missing{};               // why there is none; empty: there are times
  std::optional<double> difference{};  // from ours, relative; of ours: none
  std::vector<double> rounds{};        // us a state, one of each round

  double median() const;
  double p10() const;
};

struct Plan {
  std::vector<std::string> models;
  std::vector<std::string> engines;  // options of kEngines
  double seconds = 60.0;             // for all of it
};

// In the order of the plan; every engine has its figure for every metric, ours its batches too.
// said: told what is being done.
std::vector<Figure> measure(const Plan& plan, const std::function<void(const std::string&)>& said);

const Figure* find(const std::vector<Figure>& figures, const std::string& model,
                   const std::string& engine, const std::string& metric);
// The median over the rounds of what a takes of what b takes in the same round: whatever slows the
// machine for a while slows both. Nothing if one of them has no times.
std::optional<double> ratio(const Figure* a, const Figure* b);

}  // namespace vp::bench
