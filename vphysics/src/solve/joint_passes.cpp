// The joint passes for one instruction set. Compiled once per set, with VP_JOINT_PASSES the table's
// name and VP_LANES the width (CMakeLists.txt).
#include "solve/joint_passes.h"

#include <algorithm>
#include <type_traits>

#include "solve/passes.h"

namespace vp::solve {
namespace {

constexpr int kWidth = VP_LANES;

void find_step_motions(const BodyState* states, const std::array<float, 6>* start,
                       const std::uint32_t* bodies, std::size_t count, StepMotion* motions) {
  using F = Lanes<kWidth>;
  for (std::size_t first = 0; first < count; first += kWidth) {
    const int some = static_cast<int>(std::min<std::size_t>(kWidth, count - first));
    Vec3T<F> displacement, theta, q;
    F w;
    for (int i = 0; i < some; ++i) {
      const std::uint32_t body = bodies[first + static_cast<std::size_t>(i)];
      const float* to = states[body + 1].displacement;
      const auto& from = start[body];
      displacement.x.set(i, to[0] - from[0]);
      displacement.y.set(i, to[1] - from[1]);
      displacement.z.set(i, to[2] - from[2]);
      theta.x.set(i, to[3] - from[3]);
      theta.y.set(i, to[4] - from[4]);
      theta.z.set(i, to[5] - from[5]);
    }
    quaternion_of<kWidth>(theta, q, w);
    for (int i = 0; i < some; ++i) {
      motions[bodies[first + static_cast<std::size_t>(i)] + 1] = {
          {q.x[i], q.y[i], q.z[i], w[i]},
          {displacement.x[i], displacement.y[i], displacement.z[i]},
          0.0f};
    }
  }
}

// Runs f(lanes, at) on all slots, kWidth at a time.
template <int kRows, int kLocked, class B, class F>
void for_lanes_of(const typename JointPasses<B>::Run& run, const F& f) {
  for (std::size_t i = 0; i < run.count; ++i) {
    for (int at = 0; at < kLanes; at += kWidth) {
      if (run.blocks[i].a.lane[at] + run.blocks[i].b.lane[at] == 2 * kWorldState) break;  // empty
      JointLanes<kWidth, B, kRows, kLocked> lanes(run.blocks[i], at, run.states, *run.form);
      f(lanes, at);
    }
  }
}
// The same, with code of its own for hinges without and with a bounded row.
template <class B, class F>
void for_joints(const typename JointPasses<B>::Run& run, const F& f) {
  if constexpr (std::is_same_v<B, AxesBlock>) {
    if (run.form->locked == 2) {
      if (run.form->rows == 2) return for_lanes_of<2, 2, B>(run, f);
      if (run.form->rows == 3) return for_lanes_of<3, 2, B>(run, f);
    }
  }
  for_lanes_of<kAnyRows, kAnyRows, B>(run, f);
}

template <class B>
void load_joint_masses(const typename JointPasses<B>::Run& run) {
  for_joints<B>(run, [](auto& c, int) {
    c.load_inertias();
    c.gather_velocities();
    c.put(c.block().mass_a, c.inverse_mass_a());
    c.put(c.block().mass_b, c.inverse_mass_b());
  });
}
template <class B>
[[gnu::flatten]] bool prepare_joints(const typename JointPasses<B>::Run& run) {
  bool some_far = false;
  for_joints<B>(run, [&](auto& c, int at) {
    some_far = prepare_lanes(c, run.motions, at, run.max_bias_velocity) || some_far;
  });
  return some_far;
}
template <class B>
[[gnu::flatten]] void warm_start_joints(const typename JointPasses<B>::Run& run) {
  for_joints<B>(run, [](auto& c, int) { warm_start_lanes(c); });
}
template <class B, bool kSomeFar, bool kFirst>
[[gnu::flatten]] void solve_joint_run_if(const typename JointPasses<B>::Run& run, float h) {
  for_joints<B>(run,
                [&](auto& c, int) { solve_lanes<kSomeFar>(c, h, run.max_bias_velocity, kFirst); });
}
template <class B, bool kFirst>
void solve_joint_run(const typename JointPasses<B>::Run& run, float h) {
  (run.some_far ? solve_joint_run_if<B, true, kFirst> : solve_joint_run_if<B, false, kFirst>)(run,
                                                                                              h);
}
template <class B>
[[gnu::flatten]] void relax_joints(const typename JointPasses<B>::Run& run, float h) {
  for_joints<B>(run, [&](auto& c, int) { relax_lanes(c, h); });
}

template <class B>
constexpr JointPasses<B> passes_of() {
  return {load_joint_masses<B>,     prepare_joints<B>,         warm_start_joints<B>,
          solve_joint_run<B, true>, solve_joint_run<B, false>, relax_joints<B>};
}

}  // namespace
}  // namespace vp::solve

const vphysics_solver::AllJointPasses vphysics_solver::VP_JOINT_PASSES = {
    vp::solve::find_step_motions, vp::solve::passes_of<vphysics_solver::BallBlock>(),
    vp::solve::passes_of<vphysics_solver::AxesBlock>(),
    vp::solve::passes_of<vphysics_solver::FrameBlock>(),
    vp::solve::passes_of<vphysics_solver::RowsBlock>()};
