#include "report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>

namespace vp::bench {
namespace {

constexpr const char* kOurs = "Virtual Physics";
constexpr const char* kMuJoCo = "MuJoCo";
constexpr const char* kBatches[] = {"double4", "double8", "float8", "float16"};

// A third of the time of Pinocchio's forward dynamics, half of RBDL's inverse dynamics, 0.7 of
// Pinocchio's mass matrix. Expressed as fractions of MuJoCo's times, which are measured in the same
// run.
struct ShareGoal {
  const char* metric;
  double bound;
};
constexpr ShareGoal kFractions[] = {{"forward", 0.19}, {"inverse", 0.15}, {"mass", 0.28}};
// Half of the time of Pinocchio's derivatives of forward dynamics, as fractions of MuJoCo's forward
// dynamics.
struct DerivativeGoal {
  const char* model;
  double bound;
};
constexpr DerivativeGoal kDerivativeShares[] = {
    {"arm7", 0.81}, {"quadruped", 0.97}, {"humanoid", 1.10}};
constexpr const char* kDerivativesBy[] = {"double", "double4", "double8", "float8", "float16"};
constexpr const char* kDerivativeCalls[] = {"forward_derivatives", "inverse_derivatives"};
constexpr ShareGoal kBatchShares[] = {{"double8", 0.045}, {"float16", 0.024}};
constexpr const char* kShareModels[] = {"arm7", "quadruped", "humanoid", "chain10"};
// The time per joint of the slowest of the three chains is at most 15% above that of the fastest.
constexpr const char* kChains[] = {"chain10", "chain100", "chain1000"};
constexpr double kChainSpread = 1.15;
constexpr double kCompileSeconds = 5.0, kCompileMegabytes = 500.0;

// A metric without its "_us".
std::string stem_of(const std::string& metric) {
  return metric.substr(0, metric.size() - 3);
}

std::string batch_metric(const std::string& batch) {
  return "forward_batch_" + batch + "_us";
}

void add_share(const std::vector<Figure>& figures, const std::string& model,
               const std::string& metric, const std::string& of, double bound,
               std::vector<Goal>& out) {
  const auto share = ratio(find(figures, model, kOurs, metric), find(figures, model, kMuJoCo, of));
  if (!share) return;
  const std::string stem = stem_of(metric);
  out.push_back({model, stem + "_of_mujoco", stem + " of MuJoCo's " + stem_of(of), *share, bound,
                 "of MuJoCo's"});
}

void add_chains(const std::vector<Figure>& figures, const std::string& metric,
                std::vector<Goal>& out) {
  double least = 0.0, most = 0.0;
  for (const char* chain : kChains) {
    const Figure* f = find(figures, chain, kOurs, metric);
    if (!f || f->rounds.empty()) return;
    // The chains are not timed in the same iterations. Disturbances only add time, so the low
    // percentile is compared.
    const double a_joint = f->p10() / make_model(chain).velocities();
    least = least == 0.0 ? a_joint : std::min(least, a_joint);
    most = std::max(most, a_joint);
  }
  const std::string stem = stem_of(metric);
  out.push_back({"chains", stem + "_spread", stem + " a joint, dearest chain to cheapest",
                 most / least, kChainSpread, "of the cheapest"});
}

// Four digits, without an exponent.
std::string us(double value) {
  const int digits = value < 10 ? 3 : value < 100 ? 2 : value < 1000 ? 1 : 0;
  return fmt::format("{:.{}f}", value, digits);
}

std::string cell(const Figure* f) {
  if (!f) return "";
  if (!f->missing.empty() || f->rounds.empty()) return "-";
  return fmt::format("{} ({})", us(f->median()), us(f->p10()));
}

std::vector<const char*> engine_names(const Plan& plan) {
  std::vector<const char*> names;
  for (const EngineKind& kind : kEngines) {
    if (std::count(plan.engines.begin(), plan.engines.end(), kind.option))
      names.push_back(kind.name);
  }
  return names;
}

// A table of models and columns; cell_of returns the content of a cell.
template <class Cell>
std::string grid(const std::string& title, const Plan& plan,
                 const std::vector<const char*>& columns, const Cell& cell_of) {
  std::string out = title + "\n" + fmt::format("{:<11}", "");
  for (const char* column : columns) out += fmt::format("{:>18}", column);
  out += "\n";
  for (const std::string& model : plan.models) {
    out += fmt::format("{:<11}", model);
    for (const char* column : columns) out += fmt::format("{:>18}", cell_of(model, column));
    out += "\n";
  }
  return out + "\n";
}

// Why cells are empty: each reason of an engine once, with the models.
std::string reasons(const std::vector<Figure>& figures) {
  struct Reason {
    std::string engine, why;
    std::vector<std::string> where;
  };
  std::vector<Reason> all;
  const auto add_once = [](std::vector<std::string>& list, const std::string& word) {
    if (!std::count(list.begin(), list.end(), word)) list.push_back(word);
  };
  for (const Figure& f : figures) {
    if (f.missing.empty()) continue;
    auto it = std::find_if(all.begin(), all.end(), [&](const Reason& r) {
      return r.engine == f.engine && r.why == f.missing;
    });
    if (it == all.end()) it = all.insert(it, {f.engine, f.missing, {}});
    add_once(it->where, f.model);
  }
  std::string out = all.empty() ? "" : "where there is a dash:\n";
  for (const Reason& r : all) {
    out += fmt::format("  {}: {} ({})\n", r.engine, r.why, fmt::join(r.where, ", "));
  }
  return out + "\n";
}

}  // namespace

std::vector<Goal> goals(const std::vector<Figure>& figures, const CompileCost* compile) {
  std::vector<Goal> out;
  for (const ShareGoal& goal : kFractions) {
    const std::string metric = std::string(goal.metric) + "_us";
    for (const char* model : kShareModels)
      add_share(figures, model, metric, metric, goal.bound, out);
  }
  for (const ShareGoal& goal : kBatchShares) {
    for (const char* model : kShareModels) {
      add_share(figures, model, batch_metric(goal.metric), "forward_us", goal.bound, out);
    }
  }
  for (const char* scalar : {"double", "double8"}) {
    for (const DerivativeGoal& goal : kDerivativeShares) {
      add_share(figures, goal.model, fmt::format("forward_derivatives_{}_us", scalar), "forward_us",
                goal.bound, out);
    }
  }
  add_chains(figures, "forward_us", out);
  add_chains(figures, "inverse_us", out);
  for (const char* batch : kBatches) add_chains(figures, batch_metric(batch), out);
  if (compile) {
    out.push_back({"user's program", "compile_s", "compiles and links, the fastest of three",
                   compile->seconds, kCompileSeconds, "s"});
    out.push_back({"user's program", "compile_mb", "memory of its compiler", compile->megabytes,
                   kCompileMegabytes, "MB"});
  }
  return out;
}

std::string agreement_table(const std::vector<Figure>& figures, const Plan& plan) {
  std::string out;
  for (const Metric metric : kMetrics) {
    const std::string name = name_of(metric);
    out +=
        grid(name + ": largest difference from Virtual Physics, of the largest number", plan,
             engine_names(plan), [&](const std::string& model, const char* engine) {
               const Figure* f = find(figures, model, engine, name + "_us");
               return f && f->difference ? fmt::format("{:.1e}", *f->difference) : std::string("-");
             });
  }
  return out;
}

std::string times_table(const std::vector<Figure>& figures, const Plan& plan) {
  std::string out;
  for (const Metric metric : kMetrics) {
    const std::string name = name_of(metric);
    out += grid(name + ": us a call, median (10th percentile)", plan, engine_names(plan),
                [&](const std::string& model, const char* engine) {
                  return cell(find(figures, model, engine, name + "_us"));
                });
  }
  return out + reasons(figures);
}

std::string batch_table(const std::vector<Figure>& figures, const Plan& plan) {
  if (!std::count(plan.engines.begin(), plan.engines.end(), kEngines[0].option)) return "";
  std::string out = grid(
      "forward in batches, Virtual Physics: us a state, median (10th percentile)", plan,
      {std::begin(kBatches), std::end(kBatches)}, [&](const std::string& model, const char* batch) {
        return cell(find(figures, model, kOurs, batch_metric(batch)));
      });
  for (const std::string call : kDerivativeCalls) {
    out += grid(
        call + " of one state and of packs, Virtual Physics: us a state, median (10th percentile)",
        plan, {std::begin(kDerivativesBy), std::end(kDerivativesBy)},
        [&](const std::string& model, const char* scalar) {
          return cell(find(figures, model, kOurs, fmt::format("{}_{}_us", call, scalar)));
        });
  }
  return out;
}

std::string goals_table(const std::vector<Goal>& goals) {
  std::string out = "goals\n";
  for (const Goal& g : goals) {
    out += fmt::format("{:<15}{:<52}{:>8.3g}  goal {:>5.3g} {:<16}{}\n", g.subject, g.what, g.value,
                       g.bound, g.unit, g.met() ? "met" : "short");
  }
  const auto met = std::count_if(goals.begin(), goals.end(), [](const Goal& g) { return g.met(); });
  return out + fmt::format("{} of {} goals met\n", met, goals.size());
}

std::string csv(const std::vector<Figure>& figures, const std::vector<Goal>& goals) {
  std::string out = "subject,engine,metric,value,unit\n";
  const auto row = [&](const std::string& subject, const std::string& engine,
                       const std::string& metric, const std::string& value, const char* unit) {
    out += fmt::format("{},{},{},{},{}\n", subject, engine, metric, value, unit);
  };
  for (const Figure& f : figures) {
    if (!f.rounds.empty()) {
      row(f.model, f.engine, f.metric, us(f.median()), "us");
      row(f.model, f.engine, f.metric + "_p10", us(f.p10()), "us");
    }
    if (f.difference) {
      row(f.model, f.engine, stem_of(f.metric) + "_difference",
          fmt::format("{:.2g}", *f.difference), "of the largest");
    }
  }
  for (const Goal& g : goals) {
    row(g.subject, kOurs, g.metric, fmt::format("{:.3g}", g.value), g.unit);
    row(g.subject, "goal", g.metric, fmt::format("{:.3g}", g.bound), g.unit);
  }
  return out;
}

}  // namespace vp::bench
