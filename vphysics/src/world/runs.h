// The contacts of all regions and colours: region after region, then what is between them.
#pragma once

#include "world/impl.h"
#include "world/parallel.h"

namespace vp {

// f(passes of the kind, run of lanes, its blocks), one colour after the other.
template <class F>
void World::Impl::for_runs_of(std::size_t region, const F& f) {
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
  graph.colours_in_use(region).for_each([&](int c) {
    one_run(pass.one, graph.of<1>(region, c), c);
    one_run(pass.four, graph.of<4>(region, c), c);
  });
}

template <class F>
void World::Impl::for_runs(const F& f) {
  for (std::size_t region = 1; region <= region_count; ++region) for_runs_of(region, f);
  for_runs_of(solve::kBetween, f);
}

// f(region) of all but kBetween, side by side: no body but the fixed world is of two.
template <class F>
void World::Impl::for_regions(const F& f) const {
  in_parallel(region_count, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t region = begin + 1; region <= end; ++region) f(region);
  });
}

// f(passes, part of a run, number of its first block as number_blocks() has it), one colour after
// the other; the parts of a colour side by side where regions are not. Contacts of the last colour
// have no parts: they share bodies.
template <class F>
void World::Impl::for_parts_of(std::size_t region, const F& f) {
  constexpr std::size_t kGrain = 8;  // blocks: some microseconds
  std::size_t first = first_block[region];
  for_runs_of(region, [&](const auto& passes, const auto& run, const auto& blocks) {
    const auto part_of = [&](std::size_t begin, std::size_t end) {
      auto part = run;
      part.blocks += begin;
      const auto skipped = static_cast<std::uint32_t>(begin) * run.stride;
      part.lanes =
          std::min(run.lanes - skipped, static_cast<std::uint32_t>(end - begin) * run.stride);
      f(passes, part, first + begin);
    };
    if (region == solve::kBetween && run.stride > 1) {
      in_parallel(blocks.size(), kGrain, part_of);
    } else {
      part_of(0, blocks.size());
    }
    first += blocks.size();
  });
}

// The same, and then of kBetween.
template <class F>
void World::Impl::everywhere(const F& f) const {
  for_regions(f);
  f(std::size_t{solve::kBetween});
}

template <class F>
void World::Impl::for_parts(const F& f) {
  everywhere([&](std::size_t region) { for_parts_of(region, f); });
}

}  // namespace vp
