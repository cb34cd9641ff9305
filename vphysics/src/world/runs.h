// The contacts of all colours, in the order of solving.
#pragma once

#include "world/impl.h"

namespace vp {

// f(passes of the kind, run of lanes, its blocks).
template <class F>
void World::Impl::for_runs(const F& f) {
  const solve::Passes& pass = solve::passes();
  const auto one_run = [&](const auto& passes, auto& colour, int index) {
    if (colour.lanes == 0) return;
    using Run = typename std::remove_cvref_t<decltype(passes)>::Run;
    const bool last = index == solve::kLastColour;
    f(passes,
      Run{colour.blocks.data(), colour.lanes, last ? 1u : std::uint32_t{solve::kLanes},
          body_rows.data()},
      colour.blocks);
  };
  for (int c = 0; c < solve::kColours; ++c) {
    one_run(pass.one, graph.of<1>(c), c);
    one_run(pass.four, graph.of<4>(c), c);
  }
}

}  // namespace vp
