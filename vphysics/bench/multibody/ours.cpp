// Virtual Physics: one state, and batches.
#include "engine.h"
#include "vphysics/multibody/dynamics.h"

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

template <class T, int N>
class BatchOf final : public Batch {
 public:
  using P = PackT<T, N>;
  BatchOf(const Model& model, const std::vector<State>& states)
      : model_(model), data_(model_), out_(static_cast<std::size_t>(model.velocities())) {
    for (std::size_t first = 0; first + N <= states.size(); first += N) {
      const auto pack = [&](std::vector<double> State::*numbers) {
        std::vector<P> packed((states[first].*numbers).size());
        for (std::size_t i = 0; i < packed.size(); ++i) {
          for (int lane = 0; lane < N; ++lane) {
            const State& s = states[first + static_cast<std::size_t>(lane)];
            packed[i].set(lane, static_cast<T>((s.*numbers)[i]));
          }
        }
        return packed;
      };
      packs_.push_back({pack(&State::q), pack(&State::v), pack(&State::tau)});
    }
  }
  std::string name() const override { return (single() ? "float" : "double") + std::to_string(N); }
  int lanes() const override { return N; }
  bool single() const override { return sizeof(T) == sizeof(float); }
  std::size_t packs() const override { return packs_.size(); }
  double call(std::size_t pack) override {
    const Packed& s = packs_[pack];
    if (!forward_dynamics<P>(model_, data_, s.q, s.v, s.tau, loads_, out_)) {
      return std::numeric_limits<double>::quiet_NaN();
    }
    return static_cast<double>(out_.back()[N - 1]);
  }
  std::vector<double> result(std::size_t pack, int lane) override {
    call(pack);
    std::vector<double> a;
    for (const P& x : out_) a.push_back(static_cast<double>(x[lane]));
    return a;
  }

 private:
  struct Packed {
    std::vector<P> q, v, tau;
  };
  ModelT<T> model_;
  DataT<P> data_;
  std::vector<Packed> packs_;
  const LoadsT<P> loads_{.gravity = {P(kGravity.x), P(kGravity.y), P(kGravity.z)}};
  std::vector<P> out_;
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
  batches.push_back(std::make_unique<BatchOf<double, 4>>(*built, states));
  batches.push_back(std::make_unique<BatchOf<double, 8>>(*built, states));
  batches.push_back(std::make_unique<BatchOf<float, 8>>(*built, states));
  batches.push_back(std::make_unique<BatchOf<float, 16>>(*built, states));
  return batches;
}

}  // namespace vp::bench
