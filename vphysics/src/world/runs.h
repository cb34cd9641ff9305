// The contacts of all colours, in the order of solving.
#pragma once

#include <bit>

#include "world/impl.h"
#include "world/parallel.h"

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
          index >= solve::kFirstFixedColour, body_rows.data()},
      colour.blocks);
  };
  for (std::uint64_t left = graph.colours_in_use(); left != 0; left &= left - 1) {
    const int c = std::countr_zero(left);
    one_run(pass.one, graph.of<1>(c), c);
    one_run(pass.four, graph.of<4>(c), c);
  }
}

// f(passes, part of a run, number of its first block among all), one colour after the other; the
// parts of a colour side by side. Contacts of the last colour have no parts: they share bodies.
template <class F>
void World::Impl::for_parts(const F& f) {
  constexpr std::size_t kGrain = 8;  // blocks: some microseconds
  std::size_t first = 0;
  for_runs([&](const auto& passes, const auto& run, const auto& blocks) {
    const std::size_t grain = run.stride == 1 ? blocks.size() : kGrain;
    in_parallel(blocks.size(), grain, [&](std::size_t begin, std::size_t end) {
      auto part = run;
      part.blocks += begin;
      const auto skipped = static_cast<std::uint32_t>(begin) * run.stride;
      part.lanes =
          std::min(run.lanes - skipped, static_cast<std::uint32_t>(end - begin) * run.stride);
      f(passes, part, first + begin);
    });
    first += blocks.size();
  });
}

}  // namespace vp
