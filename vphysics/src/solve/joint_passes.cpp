// The joint passes for one instruction set. Compiled once per set, with VP_JOINT_PASSES the table's
// name and VP_LANES the width (CMakeLists.txt).
#include "solve/joint_passes.h"

#include <algorithm>
#include <array>
#include <type_traits>

#include "solve/passes.h"
#include "solve/precession_pass.h"

namespace vp::solve {
namespace {

constexpr int kWidth = VP_LANES;

void find_step_motions(const BodyState* states, const StartDisplacement* start,
                       const std::uint32_t* bodies, std::size_t count, StepMotion* motions) {
  using F = Lanes<kWidth>;
  for (std::size_t first = 0; first < count; first += kWidth) {
    // The last group is filled up with its last body.
    const auto body = [&](int i) {
      return bodies[std::min(first + static_cast<std::size_t>(i), count - 1)];
    };
    F to[8], from[8];
    lanes::gather8<kWidth>([&](int i) { return states[body(i) + 1].displacement; }, to);
    lanes::gather8<kWidth>([&](int i) { return start[body(i)].displacement; }, from);
    for (int k = 0; k < 6; ++k) to[k] -= from[k];
    Vec3T<F> q;
    F w;
    quaternion_of<kWidth>({to[3], to[4], to[5]}, q, w);
    const F motion[8] = {q.x, q.y, q.z, w, to[0], to[1], to[2], F(0.0f)};
    lanes::scatter8<kWidth>([&](int i) { return reinterpret_cast<float*>(&motions[body(i) + 1]); },
                            motion, [](int) { return true; });
  }
}

void precess(BodyState* states, const StartDisplacement* start, const std::uint32_t* bodies,
             std::size_t count, const BodyInertia* inertias, float h) {
  using F = Lanes<kWidth>;
  using V = Vec3T<F>;
  const auto row_of = [](const auto& row) {
    std::array<F, 8> r;
    lanes::gather8<kWidth>(row, r.data());
    return r;
  };
  const auto sym_of = [](const std::array<F, 8>& r) {
    return Sym3T<F>{r[0], r[1], r[2], r[3], r[4], r[5]};
  };
  const auto put = [](const auto& row, const std::array<F, 8>& r) {
    lanes::scatter8<kWidth>(row, r.data(), [](int) { return true; });
  };
  for (std::size_t first = 0; first < count; first += kWidth) {
    // The last group is filled up with its last body.
    const auto at = [&](int i) { return std::min(first + static_cast<std::size_t>(i), count - 1); };
    const auto state = [&](int i) -> BodyState& { return states[bodies[at(i)] + 1]; };
    const auto velocity_of = [&](int i) { return state(i).velocity; };
    const auto displacement_of = [&](int i) { return state(i).displacement; };
    const auto inertia_of = [&](int i) { return state(i).inertia; };
    const auto velocity = row_of(velocity_of), displacement = row_of(displacement_of),
               inertia = row_of(inertia_of);
    const auto from = row_of([&](int i) { return start[bodies[at(i)]].displacement; });
    const auto inverse_row = row_of([&](int i) { return inertias[at(i)].inverse; });
    const Sym3T<F> I = sym_of(row_of([&](int i) { return inertias[at(i)].inertia; })),
                   inverse = sym_of(inverse_row);
    PrecessingLanes<kWidth> body{{}, {}, {velocity[3], velocity[4], velocity[5]}};
    const V since = V{displacement[3], displacement[4], displacement[5]} -
                    V{from[3], from[4], from[5]} - F(h) * body.rate;
    quaternion_of<kWidth>(since, body.q, body.w);
    body.rotate(I, inverse, h);
    const V rotation = V{from[3], from[4], from[5]} + rotation_vector_of<kWidth>(body.q, body.w);
    const Sym3T<F> now = inverse_row[6] * body.rotated(inverse);
    put(velocity_of, {velocity[0], velocity[1], velocity[2], body.rate.x, body.rate.y, body.rate.z,
                      velocity[6], velocity[7]});
    put(displacement_of, {displacement[0], displacement[1], displacement[2], rotation.x, rotation.y,
                          rotation.z, displacement[6], displacement[7]});
    put(inertia_of, {now.xx, now.yy, now.zz, now.xy, now.yz, now.zx, inertia[6], inertia[7]});
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
[[gnu::flatten]] void load_joint_inertias(const typename JointPasses<B>::Run& run) {
  for_joints<B>(run, [](auto& c, int) { c.load_inertias(); });
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
  return {load_joint_masses<B>, load_joint_inertias<B>,   prepare_joints<B>,
          warm_start_joints<B>, solve_joint_run<B, true>, solve_joint_run<B, false>,
          relax_joints<B>};
}

}  // namespace
}  // namespace vp::solve

const vphysics_solver::AllJointPasses vphysics_solver::VP_JOINT_PASSES = {
    vp::solve::find_step_motions,
    vp::solve::precess,
    vp::solve::passes_of<vphysics_solver::BallBlock>(),
    vp::solve::passes_of<vphysics_solver::AxesBlock>(),
    vp::solve::passes_of<vphysics_solver::FrameBlock>(),
    vp::solve::passes_of<vphysics_solver::RowsBlock>()};
