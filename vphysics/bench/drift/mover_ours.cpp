#include "system.h"
#include "vphysics/multibody/integrators.h"

namespace vp::bench {
namespace {

enum class Method { semi_implicit, rk4, adaptive, variational };

class Ours final : public Mover {
 public:
  Ours(const System& system, Method method, const char* label)
      : model_(system.model),
        data_(system.model),
        state_(system.start),
        method_(method),
        step_{.h = kStep, .loads = {.gravity = system.gravity}} {
    name = label;
  }

  void advance(int steps) override {
    if (method_ == Method::adaptive) {
      step_.h = steps * kStep;
      failed = !advance_adaptive<double>(
          model_, data_, state_.q, state_.v, step_,
          {.absolute = 1e-10, .relative = 1e-10, .first_step = report_.next_step}, report_);
      return;
    }
    for (int i = 0; i < steps && !failed; ++i) failed = !step();
  }
  State state() const override { return state_; }

 private:
  bool step() {
    switch (method_) {
      case Method::semi_implicit:
        return step_semi_implicit<double>(model_, data_, state_.q, state_.v, step_).has_value();
      case Method::rk4:
        return step_rk4<double>(model_, data_, state_.q, state_.v, step_).has_value();
      default:
        return step_variational<double>(model_, data_, state_.q, state_.v, step_).has_value();
    }
  }

  const Model& model_;
  IntegratorData data_;
  State state_;
  Method method_;
  StepT<double> step_;
  AdaptiveReport report_;
};

}  // namespace

std::vector<std::unique_ptr<Mover>> our_movers(const System& system) {
  std::vector<std::unique_ptr<Mover>> awake_bodies;
  const auto add = [&](Method method, const char* label) {
    awake_bodies.push_back(std::make_unique<Ours>(system, method, label));
  };
  add(Method::semi_implicit, "vphysics: semi-implicit Euler");
  add(Method::rk4, "vphysics: RK4");
  add(Method::adaptive, "vphysics: adaptive 1e-10");
  add(Method::variational, "vphysics: variational");
  return awake_bodies;
}

}  // namespace vp::bench
