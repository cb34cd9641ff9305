// The passes for one instruction set. Compiled once per set, with VP_PASSES the table's name and
// VP_LANES the width (CMakeLists.txt).
#include "solve/passes.h"

#include <algorithm>
#include <limits>

#include "solve/contact_passes.h"
#include "solve/renew_pass.h"
#include "solve/restitution_pass.h"

namespace vp::solve {
namespace {

constexpr int W = VP_LANES;

// PaddedSix floats of velocity, displacement or acceleration, in the memory layout of a state.
using Row8 = lanes::RawT<8>;

void accelerate(BodyState* states, const std::uint32_t* bodies, std::size_t count, float h) {
  const Row8 one = {1, 1, 1, 1, 1, 1, 1, 1};
  for (std::size_t i = 0; i < count; ++i) {
    BodyState& state = states[bodies[i] + 1];
    const Row8 tail = lanes::load<8>(state.inertia);
    const Row8 keep = __builtin_shufflevector(tail, one, 6, 6, 6, 7, 7, 7, 8, 8);
    lanes::store<8>(state.velocity,
                    (lanes::load<8>(state.velocity) + h * lanes::load<8>(state.rate)) * keep);
  }
}

void keep(BodyState* states, VelocityChange* velocity_changes, const std::uint32_t* bodies,
          std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    lanes::store<8>(velocity_changes[bodies[i]].velocity,
                    lanes::load<8>(states[bodies[i] + 1].velocity));
  }
}
void find_velocity_changes(BodyState* states, VelocityChange* velocity_changes,
                           const std::uint32_t* bodies, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    VelocityChange& change = velocity_changes[bodies[i]];
    lanes::store<8>(change.velocity, lanes::load<8>(states[bodies[i] + 1].velocity) -
                                         lanes::load<8>(change.velocity));
  }
}
void repeat(BodyState* states, VelocityChange* velocity_changes, const std::uint32_t* bodies,
            std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    BodyState& state = states[bodies[i] + 1];
    VelocityChange& change = velocity_changes[bodies[i]];
    const Row8 before = lanes::load<8>(state.velocity);
    lanes::store<8>(state.velocity, before + lanes::load<8>(change.velocity));
    lanes::store<8>(change.velocity, before);
  }
}

void move(BodyState* states, const std::uint32_t* bodies, std::size_t count, float h) {
  const Row8 step = {h, h, h, h, h, h, 0, 0};
  for (std::size_t i = 0; i < count; ++i) {
    BodyState& state = states[bodies[i] + 1];
    lanes::store<8>(state.displacement,
                    lanes::load<8>(state.displacement) + step * lanes::load<8>(state.velocity));
  }
}

bool find_deviating(const BodyState* states, const SearchedMotion* searched,
                    const std::uint32_t* bodies, std::size_t count, float left,
                    std::uint8_t* flags) {
  using F = Lanes<8>;
  constexpr float kMax = std::numeric_limits<float>::max();
  const Row8 max = {kMax, kMax, kMax, kMax, kMax, kMax, kMax, kMax};
  const Row8 used = {left, left, left, left, left, left, 0, 0};
  bool some = false;
  for (std::size_t i = 0; i < count; ++i) {
    const Row8 motion = lanes::load<8>(searched[bodies[i]].velocity);
    const Row8 limit = __builtin_shufflevector(motion, max, 6, 6, 6, 7, 7, 7, 8, 8);
    const F change(lanes::load<8>(states[bodies[i] + 1].velocity) - motion);
    const bool deviates = !none(F(used) * abs(change) > F(limit));
    flags[i] = deviates ? 1 : 0;
    some |= deviates;
  }
  return some;
}

// Runs f(lanes, block, slot) on all slots in use, W at a time.
template <int P, class F>
void for_lanes(const typename ContactPasses<P>::Run& run, const F& f) {
  ContactBlock<P>* block = run.blocks;
  for (std::uint32_t first = 0; first < run.slots; first += run.stride, ++block) {
    const int end = static_cast<int>(std::min(run.stride, run.slots - first));
    for (int at = 0; at < end; at += W) {
      LanesOf<W, P> lanes(*block, at, run.states);
      f(lanes, static_cast<std::size_t>(block - run.blocks), at);
    }
  }
}

template <int P>
[[gnu::flatten]] void renew(ContactBlock<P>& block, const NewContacts& contacts) {
  constexpr int kDoubles = W / 2;  // as many bytes as W floats
  for (int at = 0; at < kLanes; at += kDoubles) {
    if ((contacts.lanes >> at & ((1u << kDoubles) - 1u)) != 0)
      RenewLanes<kDoubles, P>(block, contacts, at).renew();
  }
}
template <int P>
void load_inertias(const typename ContactPasses<P>::Run& run) {
  for_lanes<P>(run, [](LanesOf<W, P>& c, std::size_t, int) { c.load_inertias(); });
}
template <int P>
[[gnu::flatten]] bool apply_restitution(const typename ContactPasses<P>::Run& run, float h,
                                        float threshold, BounceShift* shifts) {
  bool bounced = false;
  for_lanes<P>(run, [&](LanesOf<W, P>& c, std::size_t, int) {
    bounced = apply_restitution_lanes<W, P>(c, h, threshold, shifts) || bounced;
  });
  return bounced;
}
template <int P>
[[gnu::flatten]] void warm_start(const typename ContactPasses<P>::Run& run) {
  for_lanes<P>(run, [](LanesOf<W, P>& c, std::size_t, int) { warm_start_lanes<W, P>(c); });
}
template <int P, Pass kPass>
[[gnu::flatten]] void solve(const typename ContactPasses<P>::Run& run, const Soft& soft) {
  for_lanes<P>(run, [&](LanesOf<W, P>& c, std::size_t, int) { solve_lanes<W, P, kPass>(c, soft); });
}
template <int P>
[[gnu::flatten]] bool relax(const typename ContactPasses<P>::Run& run, const Soft& soft) {
  bool too_deep = false;
  for_lanes<P>(run, [&](LanesOf<W, P>& c, std::size_t, int) {
    too_deep = solve_lanes<W, P, Pass::relax>(c, soft) || too_deep;
  });
  return too_deep;
}
// A bit for each slot of the block that is in use.
std::uint32_t used(std::uint32_t slots, std::uint32_t stride, std::size_t block) {
  const std::uint32_t count = std::min(stride, slots - static_cast<std::uint32_t>(block) * stride);
  return (1u << count) - 1u;
}
template <int P>
[[gnu::flatten]] void find_moved(const typename ContactPasses<P>::Run& run, float dt,
                                 float rotation, std::uint32_t* bits) {
  for_lanes<P>(run, [&](LanesOf<W, P>& c, std::size_t block, int at) {
    const std::uint32_t found = find_moved_slots<W, P>(c, dt, rotation) << at;
    const std::uint32_t before = at == 0 ? 0u : bits[block];
    bits[block] = before | (found & used(run.slots, run.stride, block));
  });
}
template <int P>
[[gnu::flatten]] void find_changes(const typename ContactPasses<P>::Run& run, float keeps_load,
                                   std::uint32_t* bits) {
  for_lanes<P>(run, [&](LanesOf<W, P>& c, std::size_t block, int at) {
    const std::uint32_t found = find_changed_slots<W, P>(c, at, keeps_load) << at;
    const std::uint32_t slots = used(run.slots, run.stride, block);
    bits[block] = (at == 0 ? 0u : bits[block]) | (found & (slots | slots << kLanes));
  });
}
[[gnu::flatten]] void find_closer(SpeculativeBlock* blocks, std::size_t count, BodyState* states,
                                  float dt, std::uint32_t* bits) {
  for (std::size_t b = 0; b < count; ++b) {
    std::uint32_t found = 0;
    for (int at = 0; at < kLanes; at += W) {
      found |= find_closer_pairs<W>(blocks[b].pairs + at, states, dt) << at;
    }
    bits[b] = found;
  }
}

template <int P>
constexpr ContactPasses<P> contact_passes() {
  return {renew<P>,      load_inertias<P>,      apply_restitution<P>,
          warm_start<P>, solve<P, Pass::first>, solve<P, Pass::again>,
          relax<P>,      find_moved<P>,         find_changes<P>};
}

}  // namespace
}  // namespace vp::solve

const vphysics_solver::Passes vphysics_solver::VP_PASSES = {vp::solve::accelerate,
                                                            vp::solve::keep,
                                                            vp::solve::find_velocity_changes,
                                                            vp::solve::repeat,
                                                            vp::solve::move,
                                                            vp::solve::find_deviating,
                                                            vp::solve::find_closer,
                                                            vp::solve::contact_passes<1>(),
                                                            vp::solve::contact_passes<4>()};
