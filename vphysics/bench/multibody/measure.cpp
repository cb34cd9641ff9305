#include "measure.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace vp::bench {
namespace {

constexpr std::uint64_t kSeed = 2024;
// A batch of calls is long compared with the cost of reading the clock, and short compared with a
// time slice.
constexpr double kBatchSeconds = 200e-6;
// An engine that takes longer than this for one call is not timed [s].
constexpr double kLongestCall = 0.5;
constexpr std::size_t kFewestRounds = 5;
// Agreement is checked for all states, or as many as fit into this time, but at least two.
constexpr double kComparingSeconds = 1.0;

// Enough to be random, few enough to stay in the cache with the engine; a multiple of 16 lanes.
int states_for(const BenchModel& model) {
  return model.velocities() > 128 ? 16 : 64;
}

double now() {
  using Clock = std::chrono::steady_clock;
  return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

struct Runner {
  std::size_t figure;
  std::function<double(std::size_t)> call;
  std::size_t inputs;  // number of different states or packs
  int states_a_call;
  std::size_t calls = 1, next = 0;
};

// Receives all results, so that the compiler cannot remove their computation.
volatile double sink;

double time_of_calls(Runner& runner, std::size_t calls) {
  double sum = 0.0;
  const double begun = now();
  for (std::size_t i = 0; i < calls; ++i) {
    sum += runner.call(runner.next);
    if (++runner.next == runner.inputs) runner.next = 0;
  }
  const double took = now() - begun;
  sink = sum;
  return took;
}

// Runs one batch of calls of each runner in turn, repeatedly. The first call of a batch is not
// timed: it finds the caches as the other engines have left them, and a long chain has one call per
// batch.
void round_robin(std::vector<Runner>& runners, double seconds, std::vector<Figure>& figures) {
  for (auto it = runners.begin(); it != runners.end();) {
    double once = time_of_calls(*it, 1);  // warms up
    once = std::min(once, time_of_calls(*it, 1));
    if (once > kLongestCall) {
      figures[it->figure].missing = fmt::format("a call takes {:.1f} s", once);
      it = runners.erase(it);
      continue;
    }
    it->calls = static_cast<std::size_t>(std::max(1.0, kBatchSeconds / once));
    ++it;
  }
  const double end = now() + seconds;
  for (std::size_t round = 0; round < kFewestRounds || now() < end; ++round) {
    for (Runner& runner : runners) {
      time_of_calls(runner, 1);
      const double took = time_of_calls(runner, runner.calls);
      const double states = static_cast<double>(runner.calls) * runner.states_a_call;
      figures[runner.figure].rounds.push_back(took * 1e6 / states);
    }
  }
}

// The maximum difference, relative to the largest number of b.
double difference(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() != b.size()) return std::numeric_limits<double>::infinity();
  double off = 0.0, scale = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!std::isfinite(a[i]) || !std::isfinite(b[i]))
      return std::numeric_limits<double>::infinity();
    off = std::max(off, std::fabs(a[i] - b[i]));
    scale = std::max(scale, std::fabs(b[i]));
  }
  return off / scale;
}

double worst_difference(Engine& engine, Engine& ours, Metric metric, std::size_t states) {
  double worst = 0.0;
  const double end = now() + kComparingSeconds;
  for (std::size_t i = 0; i < states && (i < 2 || now() < end); ++i) {
    worst = std::max(worst, difference(engine.result(metric, i), ours.result(metric, i)));
  }
  return worst;
}

// The maximum difference of a batch from the results of its states computed one by one.
double worst_difference(Batch& batch, BatchCall call,
                        const std::function<std::vector<double>(std::size_t)>& alone) {
  double worst = 0.0;
  for (std::size_t pack = 0; pack < batch.packs(); ++pack) {
    for (int lane = 0; lane < batch.lanes(); ++lane) {
      const std::size_t state =
          pack * static_cast<std::size_t>(batch.lanes()) + static_cast<std::size_t>(lane);
      worst = std::max(worst, difference(batch.result(call, pack, lane), alone(state)));
    }
  }
  return worst;
}

// The maximum difference of our derivatives by v from central difference quotients of accelerations
// or forces, which the peers confirm. These are quadratic in v, so the quotients have only rounding
// errors.
double worst_difference_by_velocity(const BenchModel& model, const std::vector<State>& states,
                                    Batch& one, BatchCall call) {
  constexpr double kStep = 1e-2;
  constexpr std::size_t kStates = 2;
  const Metric metric = call == BatchCall::forward_derivatives ? Metric::forward : Metric::inverse;
  double worst = 0.0;
  for (std::size_t state = 0; state < std::min(kStates, states.size()); ++state) {
    const std::size_t n = states[state].v.size();
    std::vector<State> beside;
    for (std::size_t k = 0; k < n; ++k) {
      for (const double step : {-kStep, kStep}) {
        beside.push_back(states[state]);
        beside.back().v[k] += step;
      }
    }
    const auto engine = make_ours(model, beside);
    if (!engine) return std::numeric_limits<double>::infinity();
    std::vector<double> quotients(n * n);
    for (std::size_t k = 0; k < n; ++k) {
      const std::vector<double> before = (*engine)->result(metric, 2 * k);
      const std::vector<double> after = (*engine)->result(metric, 2 * k + 1);
      for (std::size_t i = 0; i < n; ++i) {
        quotients[i * n + k] = (after[i] - before[i]) / (2.0 * kStep);
      }
    }
    const std::vector<double> all = one.result(call, state, 0);
    const auto by_v = all.begin() + static_cast<std::ptrdiff_t>(n * n);
    worst =
        std::max(worst, difference({by_v, by_v + static_cast<std::ptrdiff_t>(n * n)}, quotients));
  }
  return worst;
}

const char* name_of(BatchCall call) {
  switch (call) {
    case BatchCall::forward:
      return "forward_batch";
    case BatchCall::forward_derivatives:
      return "forward_derivatives";
    case BatchCall::inverse_derivatives:
      break;
  }
  return "inverse_derivatives";
}

struct Contender {
  const EngineKind* kind;
  std::unique_ptr<Engine> engine;
  std::string missing;
};

class ModelRun {
 public:
  ModelRun(const Plan& plan, const std::string& name)
      : model_(make_model(name)), states_(random_states(model_, states_for(model_), kSeed)) {
    for (const EngineKind& kind : kEngines) {
      if (std::find(plan.engines.begin(), plan.engines.end(), kind.option) == plan.engines.end())
        continue;
      MadeEngine made = kind.make(model_, states_);
      if (made) {
        contenders_.push_back({&kind, std::move(*made), ""});
      } else {
        contenders_.push_back({&kind, nullptr, made.error()});
      }
    }
    auto ours = make_ours(model_, states_);
    if (ours) ours_ = std::move(*ours);
  }

  void run(Metric metric, double seconds, std::vector<Figure>& figures) {
    std::vector<Runner> runners;
    const std::size_t first = figures.size();
    for (Contender& c : contenders_) {
      figures.push_back(compared(c, metric));
      if (!figures.back().missing.empty()) continue;
      runners.push_back(
          {figures.size() - 1,
           [engine = c.engine.get(), metric](std::size_t i) { return engine->call(metric, i); },
           states_.size(), 1});
    }
    if (metric == Metric::forward && has_ours()) {
      add_batches(BatchCall::forward, runners, figures);
      if (model_.velocities() <= kMostVelocitiesDifferentiated) {
        add_batches(BatchCall::forward_derivatives, runners, figures);
        add_batches(BatchCall::inverse_derivatives, runners, figures);
      }
    }
    if (contenders_.size() > 1 && !any_agrees(figures, first)) refuse_ours(runners, figures, first);
    round_robin(runners, seconds, figures);
  }

 private:
  static bool is_ours(const Contender& c) { return c.kind == &kEngines[0]; }
  bool has_ours() const {
    return ours_ && std::any_of(contenders_.begin(), contenders_.end(), is_ours);
  }

  // Compares the engine with ours before anything is timed.
  Figure compared(Contender& c, Metric metric) {
    Figure figure{.model = model_.name,
                  .engine = c.kind->name,
                  .metric = std::string(name_of(metric)) + "_us"};
    figure.missing = c.engine ? c.engine->lacks(metric) : c.missing;
    if (!figure.missing.empty() || is_ours(c)) return figure;
    if (!ours_) {
      figure.missing = "Virtual Physics has no such model";
      return figure;
    }
    figure.difference = worst_difference(*c.engine, *ours_, metric, states_.size());
    if (!(*figure.difference <= kAgreement)) figure.missing = differs_by(*figure.difference);
    return figure;
  }

  static std::string differs_by(double difference) {
    return fmt::format("differs by {:.1e}", difference);
  }

  static bool any_agrees(const std::vector<Figure>& figures, std::size_t first) {
    return std::any_of(figures.begin() + static_cast<std::ptrdiff_t>(first), figures.end(),
                       [](const Figure& f) {
                         return f.engine != kEngines[0].name && f.difference && f.missing.empty();
                       });
  }
  // If no peer agrees, rejects our results.
  static void refuse_ours(std::vector<Runner>& runners, std::vector<Figure>& figures,
                          std::size_t first) {
    for (std::size_t i = first; i < figures.size(); ++i) {
      if (figures[i].engine == kEngines[0].name) figures[i].missing = "no peer agrees";
    }
    std::erase_if(runners, [&](const Runner& r) { return !figures[r.figure].missing.empty(); });
  }

  // Batches run in the same iterations as forward dynamics: goals compare them with a peer's times.
  void add_batches(BatchCall call, std::vector<Runner>& runners, std::vector<Figure>& figures) {
    if (batches_.empty()) batches_ = make_batches(model_, states_);
    for (const auto& batch : batches_) {
      const bool one = batch->lanes() == 1;
      if (one && call == BatchCall::forward) continue;  // measured as an engine
      Figure figure{.model = model_.name,
                    .engine = kEngines[0].name,
                    .metric = fmt::format("{}_{}_us", name_of(call), batch->name())};
      figure.difference = one ? worst_difference_by_velocity(model_, states_, *batch, call)
                              : worst_difference(*batch, call, [&](std::size_t state) {
                                  return call == BatchCall::forward
                                             ? ours_->result(Metric::forward, state)
                                             : batches_[0]->result(call, state, 0);
                                });
      const double bound = batch->single() ? kAgreementFloat
                           : one           ? kAgreementQuotients
                                           : kAgreement;
      if (*figure.difference <= bound) {
        runners.push_back({figures.size(),
                           [b = batch.get(), call](std::size_t i) { return b->call(call, i); },
                           batch->packs(), batch->lanes()});
      } else {
        figure.missing = differs_by(*figure.difference);
      }
      figures.push_back(std::move(figure));
    }
  }

  BenchModel model_;
  std::vector<State> states_;
  std::vector<Contender> contenders_;
  std::unique_ptr<Engine> ours_;
  std::vector<std::unique_ptr<Batch>> batches_;
};

double quantile(std::vector<double> x, double share) {
  if (x.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto at =
      x.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(x.size() - 1));
  std::nth_element(x.begin(), at, x.end());
  return *at;
}

}  // namespace

const char* name_of(Metric metric) {
  switch (metric) {
    case Metric::forward:
      return "forward";
    case Metric::inverse:
      return "inverse";
    case Metric::mass:
      break;
  }
  return "mass";
}

double Figure::median() const {
  return quantile(rounds, 0.5);
}
double Figure::p10() const {
  return quantile(rounds, 0.1);
}

std::vector<Figure> measure(const Plan& plan, const std::function<void(const std::string&)>& said) {
  std::vector<Figure> figures;
  // Forward dynamics has more to run: the batches and the derivatives.
  constexpr double kForwardShares = 4.0;
  const double share =
      plan.seconds / static_cast<double>(plan.models.size()) / (kForwardShares + 2.0);
  for (const std::string& name : plan.models) {
    ModelRun run(plan, name);
    for (const Metric metric : kMetrics) {
      said(fmt::format("{}, {}", name, name_of(metric)));
      run.run(metric, metric == Metric::forward ? kForwardShares * share : share, figures);
    }
  }
  return figures;
}

const Figure* find(const std::vector<Figure>& figures, const std::string& model,
                   const std::string& engine, const std::string& metric) {
  for (const Figure& f : figures) {
    if (f.model == model && f.engine == engine && f.metric == metric) return &f;
  }
  return nullptr;
}

std::optional<double> ratio(const Figure* a, const Figure* b) {
  if (!a || !b) return {};
  std::vector<double> ratios;
  for (std::size_t i = 0; i < std::min(a->rounds.size(), b->rounds.size()); ++i) {
    ratios.push_back(a->rounds[i] / b->rounds[i]);
  }
  if (ratios.empty()) return {};
  return quantile(ratios, 0.5);
}

}  // namespace vp::bench
