// Loops over the contacts of all regions and colours: one region after the other, then
// kSharedRegion.
#pragma once

#include <algorithm>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "parallel.h"
#include "solve/contact_graph.h"
#include "solve/passes.h"

namespace vp {

// 32 bits for each block of contacts, as results of a pass, and the index of each region's first
// block.
struct BlockBits {
  std::vector<std::uint32_t> words;
  std::vector<std::size_t> first;
};

struct ContactRuns {
  solve::ContactGraph& graph;
  solve::BodyState* states;
  const Workers& workers;
  BlockBits& block_bits;

  std::uint32_t* words() const { return block_bits.words.data(); }

  // Calls f(passes of the kind, run of contact slots, its blocks), one colour after the other.
  template <class F>
  void for_runs_of(std::size_t region, const F& f) const {
    const solve::Passes& pass = solve::passes();
    const auto one_run = [&](const auto& passes, auto& colour, int index) {
      if (colour.slots == 0) return;
      using Run = typename std::remove_cvref_t<decltype(passes)>::Run;
      const bool last = index == solve::kLastColour;
      f(passes,
        Run{colour.blocks.data(), colour.slots, last ? 1u : std::uint32_t{solve::kLanes}, states},
        colour.blocks);
    };
    graph.colours_in_use(region).for_each([&](int c) {
      one_run(pass.one, graph.of<1>(region, c), c);
      one_run(pass.four, graph.of<4>(region, c), c);
    });
  }

  template <class F>
  void for_runs(const F& f) const {
    for (std::size_t region = 1; region <= regions(); ++region) for_runs_of(region, f);
    for_runs_of(solve::kSharedRegion, f);
  }

  // Calls f(region) for all but kSharedRegion, in parallel: no two regions share a body, except the
  // fixed world.
  template <class F>
  void for_regions(const F& f) const {
    workers.in_parallel(regions(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t region = begin + 1; region <= end; ++region) f(region);
    });
  }

  // Calls f(passes, part of a run, index of its first block as number() counts), one colour after
  // the other. In kSharedRegion the parts of a colour run in parallel. Contacts of the last colour
  // share bodies and are not divided into parts.
  template <class F>
  void for_parts_of(std::size_t region, const F& f) const {
    constexpr std::size_t kGrain = 8;  // blocks: some microseconds
    std::size_t first = block_bits.first[region];
    for_runs_of(region, [&](const auto& passes, const auto& run, const auto& blocks) {
      const auto part_of = [&](std::size_t begin, std::size_t end) {
        auto part = run;
        part.blocks += begin;
        const auto skipped = static_cast<std::uint32_t>(begin) * run.stride;
        part.slots =
            std::min(run.slots - skipped, static_cast<std::uint32_t>(end - begin) * run.stride);
        f(passes, part, first + begin);
      };
      if (region == solve::kSharedRegion && run.stride > 1) {
        workers.in_parallel(blocks.size(), kGrain, part_of);
      } else {
        part_of(0, blocks.size());
      }
      first += blocks.size();
    });
  }

  // The same, and then kSharedRegion.
  template <class F>
  void everywhere(const F& f) const {
    for_regions(f);
    f(std::size_t{solve::kSharedRegion});
  }

  template <class F>
  void for_parts(const F& f) const {
    everywhere([&](std::size_t region) { for_parts_of(region, f); });
  }

  // Numbers the blocks of all regions and colours. Returns their count.
  std::size_t number() const {
    block_bits.first.resize(graph.regions());
    std::size_t count = 0;
    const auto number = [&](std::size_t region) {
      block_bits.first[region] = count;
      for_runs_of(region, [&](const auto&, const auto&, const auto& b) { count += b.size(); });
    };
    for (std::size_t region = 1; region <= regions(); ++region) number(region);
    number(solve::kSharedRegion);
    block_bits.words.resize(std::max(block_bits.words.size(), count));
    return count;
  }

 private:
  std::size_t regions() const { return graph.regions() - 1; }  // without kSharedRegion
};

}  // namespace vp
