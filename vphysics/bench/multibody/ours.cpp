// Virtual Physics: one state, and batches.
#include <array>
#include <cmath>

#include "engine.h"
#include "vphysics/multibody/derivatives.h"

namespace vp::bench {
namespace {

Expected<Model> build(const BenchModel& model) {
  ModelBuilder builder;
  for (const LinkSpec& link : model.links) {
    if (const auto added = builder.add(link); !added) return tl::make_unexpected(added.error());
  }
  return builder.build();
}

class Ours final : public Engine {
 public:
  Ours(Model model, const std::vector<State>& states)
      : model_(std::move(model)),
        data_(model_),
        states_(states),
        out_(static_cast<std::size_t>(model_.velocities())),
        M_(out_.size() * out_.size()) {}

  double call(Metric metric, std::size_t state) override {
    const State& s = states_[state];
    switch (metric) {
      case Metric::forward:
        if (!forward_dynamics<double>(model_, data_, s.q, s.v, s.tau, loads_, out_)) return kNaN;
        return out_.back();
      case Metric::inverse:
        inverse_dynamics<double>(model_, data_, s.q, s.v, s.a, loads_, out_);
        return out_.back();
      case Metric::mass:
        break;
    }
    mass_matrix<double>(model_, data_, s.q, M_);
    return M_.back();
  }
  std::vector<double> result(Metric metric, std::size_t state) override {
    call(metric, state);
    return metric == Metric::mass ? M_ : out_;
  }

 private:
  static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  Model model_;
  Data data_;
  const std::vector<State>& states_;
  const Loads loads_{.gravity = kGravity};
  std::vector<double> out_, M_;
};

// The lanes of a scalar; a plain one has one.
template <class P>
struct LanesOf {
  static constexpr int kCount = 1;
  static void set(P& x, int, double value) { x = static_cast<P>(value); }
  static double get(const P& x, int) { return static_cast<double>(x); }
};
template <class T, int N>
struct LanesOf<PackT<T, N>> {
  static constexpr int kCount = N;
  static void set(PackT<T, N>& x, int lane, double value) { x.set(lane, static_cast<T>(value)); }
  static double get(const PackT<T, N>& x, int lane) { return static_cast<double>(x[lane]); }
};

template <class P>
class BatchOf final : public Batch {
 public:
  using B = base_t<P>;
  static constexpr int kLanes = LanesOf<P>::kCount;
  BatchOf(const Model& model, const std::vector<State>& states)
      : model_(model), data_(model_), out_(static_cast<std::size_t>(model.velocities())) {
    if (model.velocities() <= kMostVelocitiesDifferentiated) {
      memory_ = std::make_unique<DerivativesDataT<P>>(model_);
      for (auto& matrix : matrices_) matrix.resize(out_.size() * out_.size());
    }
    for (std::size_t first = 0; first + kLanes <= states.size(); first += kLanes) {
      const auto pack = [&](std::vector<double> State::*numbers) {
        std::vector<P> packed((states[first].*numbers).size());
        for (std::size_t i = 0; i < packed.size(); ++i) {
          for (int lane = 0; lane < kLanes; ++lane) {
            const State& s = states[first + static_cast<std::size_t>(lane)];
            LanesOf<P>::set(packed[i], lane, (s.*numbers)[i]);
          }
        }
        return packed;
      };
      packs_.push_back({pack(&State::q), pack(&State::v), pack(&State::tau), pack(&State::a)});
    }
  }
  std::string name() const override {
    return (single() ? "float" : "double") + (kLanes == 1 ? "" : std::to_string(kLanes));
  }
  int lanes() const override { return kLanes; }
  bool single() const override { return sizeof(B) == sizeof(float); }
  std::size_t packs() const override { return packs_.size(); }
  double call(BatchCall call, std::size_t pack) override {
    if (!done(call, packs_[pack])) return std::numeric_limits<double>::quiet_NaN();
    const P& last = call == BatchCall::forward ? out_.back() : matrices_[0].back();
    return LanesOf<P>::get(last, kLanes - 1);
  }
  std::vector<double> result(BatchCall which, std::size_t pack, int lane) override {
    const bool known = std::isfinite(call(which, pack));
    std::vector<double> out;
    const auto take = [&](const std::vector<P>& numbers) {
      for (const P& x : numbers) {
        out.push_back(known ? LanesOf<P>::get(x, lane) : std::numeric_limits<double>::quiet_NaN());
      }
    };
    if (which == BatchCall::forward) {
      take(out_);
    } else {
      for (const auto& matrix : matrices_) take(matrix);
    }
    return out;
  }

 private:
  struct Packed {
    std::vector<P> q, v, tau, a;
  };

  bool done(BatchCall call, const Packed& s) {
    auto& [by_q, by_v, by_force] = matrices_;
    switch (call) {
      case BatchCall::forward:
        return forward_dynamics<P>(model_, data_, s.q, s.v, s.tau, loads_, out_).has_value();
      case BatchCall::forward_derivatives:
        return forward_dynamics_derivatives<P>(model_, data_, *memory_, s.q, s.v, s.tau, loads_,
                                               {out_, by_q, by_v, by_force})
            .has_value();
      case BatchCall::inverse_derivatives:
        break;
    }
    return inverse_dynamics_derivatives<P>(model_, data_, *memory_, s.q, s.v, s.a, loads_,
                                           {by_q, by_v, by_force})
        .has_value();
  }

  ModelT<B> model_;
  DataT<P> data_;
  std::unique_ptr<DerivativesDataT<P>> memory_;
  std::vector<Packed> packs_;
  const LoadsT<P> loads_{.gravity = {P(kGravity.x), P(kGravity.y), P(kGravity.z)}};
  std::vector<P> out_;
  std::array<std::vector<P>, 3> matrices_;
};

}  // namespace

MadeEngine make_ours(const BenchModel& model, const std::vector<State>& states) {
  auto built = build(model);
  if (!built) return tl::make_unexpected(built.error().message);
  return std::make_unique<Ours>(std::move(*built), states);
}

std::vector<std::unique_ptr<Batch>> make_batches(const BenchModel& model,
                                                 const std::vector<State>& states) {
  std::vector<std::unique_ptr<Batch>> batches;
  const auto built = build(model);
  if (!built) return batches;
  batches.push_back(std::make_unique<BatchOf<double>>(*built, states));
  batches.push_back(std::make_unique<BatchOf<PackT<double, 4>>>(*built, states));
  batches.push_back(std::make_unique<BatchOf<PackT<double, 8>>>(*built, states));
  batches.push_back(std::make_unique<BatchOf<PackT<float, 8>>>(*built, states));
  batches.push_back(std::make_unique<BatchOf<PackT<float, 16>>>(*built, states));
  return batches;
}

}  // namespace vp::bench
