#include "agreement.h"

#include <fmt/format.h>

#include "scenes/touchstone.h"

namespace rigid {
namespace {

constexpr int kRate = 240;

// How an engine's final state differs from the expected one; empty: within the tolerances.
std::string judge(const scenes::Touchstone& stone, const Figure& figure, double& worst) {
  if (!figure.missing.empty()) return figure.missing;
  if (figure.ended != "finished") return figure.ended;
  std::string wrong;
  for (const scenes::Expectation& e : stone.expectations) {
    const double off = e.off(figure.poses);
    worst = std::max(worst, off);
    if (!(off <= e.tolerance) && wrong.empty()) {
      wrong = fmt::format("{}: off by {:.2g} m", e.what, off);
    }
  }
  return wrong;
}

}  // namespace

std::vector<Agreement> agreement(const Plan& plan) {
  Plan one = plan;
  one.rates = {kRate};
  std::vector<Agreement> all;
  for (const bool joined : {false, true}) {
    const auto stone = joined ? scenes::joined_touchstone() : scenes::touchstone();
    one.scenes = {stone.scene.name};
    const auto figures = measure(one, [](const std::string&) {});
    for (std::size_t i = 0; i < figures.size(); ++i) {
      if (!joined) all.push_back({figures[i].engine});
      (joined ? all[i].wrong_joints : all[i].wrong) = judge(stone, figures[i], all[i].worst);
    }
  }
  return all;
}

std::string agreement_table(const std::vector<Agreement>& all) {
  std::string out = "\nWhat is known in closed form, at 240 Hz\n";
  for (const Agreement& a : all) {
    out += fmt::format("  {:<30}", a.engine);
    if (!a.wrong.empty()) {
      out += a.wrong + "\n";
      continue;
    }
    out += fmt::format("within {:.3f} m{}\n", a.worst,
                       a.wrong_joints.empty() ? "" : "; joints: " + a.wrong_joints);
  }
  return out;
}

Plan of_those_who_agree(Plan plan, const std::vector<Agreement>& all) {
  for (const Agreement& a : all) {
    if (!a.wrong.empty()) plan.left_out[a.engine] = a.wrong;
    if (!a.wrong_joints.empty()) plan.left_out_of_joints[a.engine] = a.wrong_joints;
  }
  return plan;
}

}  // namespace rigid
