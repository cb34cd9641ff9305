// The contacts of all regions and colours: region after region, then what is between them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "solve/contact_graph.h"
#include "solve/passes.h"
#include "world/parallel.h"

namespace vp {

// A word for each block of contacts, for what a pass finds in it; and where each region's begin.
struct BlockBits {
  std::vector<std::uint32_t> words;
  std::vector<std::size_t> first;
};

struct ContactRuns {
  solve::ContactGraph& graph;
  solve::BodyRow* rows;
  const Workers& workers;
  BlockBits& block_bits;

  std::uint32_t* words() const { return block_bits.words.data(); }

  // f(passes of the kind, run of lanes, its blocks), one colour after the other.
  template <class F>
  void for_runs_of(std::size_t region, const F& f) const {
    const solve::Passes& pass = solve::passes();
    const auto one_run = [&](const auto& passes, auto& colour, int index) {
      if (colour.lanes == 0) return;
      using Run = typename std::remove_cvref_t<decltype(passes)>::Run;
      const bool last = index == solve::kLastColour;
      f(passes,
        Run{colour.blocks.data(), colour.lanes, last ? 1u : std::uint32_t{solve::kLanes}, rows},
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
    for_runs_of(solve::kBetween, f);
  }

  // f(region) of all but kBetween, side by side: no body but the fixed world is of two.
  template <class F>
  void for_regions(const F& f) const {
    workers.in_parallel(regions(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t region = begin + 1; region <= end; ++region) f(region);
    });
  }

  // f(passes, part of a run, number of its first block as number() has it), one colour after
  // the other; the parts of a colour side by side where regions are not. Contacts of the last
  // colour have no parts: they share bodies.
  template <class F>
  void for_parts_of(std::size_t region, const F& f) const {
    constexpr std::size_t kGrain = 8;  // blocks: some microseconds
    std::size_t first = block_bits.first[region];
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
        workers.in_parallel(blocks.size(), kGrain, part_of);
      } else {
        part_of(0, blocks.size());
      }
      first += blocks.size();
    });
  }

  // The same, and then of kBetween.
  template <class F>
  void everywhere(const F& f) const {
    for_regions(f);
    f(std::size_t{solve::kBetween});
  }

  template <class F>
  void for_parts(const F& f) const {
    everywhere([&](std::size_t region) { for_parts_of(region, f); });
  }

  // Numbers the blocks of all regions and colours. Returns how many there are.
  std::size_t number() const {
    block_bits.first.resize(graph.regions());
    std::size_t count = 0;
    const auto number = [&](std::size_t region) {
      block_bits.first[region] = count;
      for_runs_of(region, [&](const auto&, const auto&, const auto& b) { count += b.size(); });
    };
    for (std::size_t region = 1; region <= regions(); ++region) number(region);
    number(solve::kBetween);
    block_bits.words.resize(std::max(block_bits.words.size(), count));
    return count;
  }

 private:
  std::size_t regions() const { return graph.regions() - 1; }  // but kBetween
};

}  // namespace vp
