// The joints of a step in blocks of SIMD lanes, sorted by region, in a region by colour, and in a
// colour by form. No two joints of a colour share a body that moves, and no two regions share a
// body (world/regions.h). If a joint connects two regions, all joints are in kSharedRegion: solved
// region by region, chains that cross from one to the other would gain energy. The blocks depend
// only on which joints take part, on their order and on the regions of their bodies, so the order
// of solving is a function of the state.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

#include "solve/contact_graph.h"
#include "solve/joint_block.h"
#include "solve/large_pages.h"
#include "world/joint.h"

namespace vp {

// A joint in a lane of a block, and its bodies' states.
struct JointLane {
  std::uint32_t joint, state_a, state_b;
};

struct JointRange {
  std::size_t first, count;
};

// The blocks of one region, colour and form.
template <class BLOCK>
struct JointRun {
  const solve::JointForm& form;
  bool alone;  // the last colour: one joint in each block
  std::span<BLOCK> blocks;
  std::span<const JointLane> lanes;

  // Those of a block.
  JointRange lanes_of(std::size_t block) const {
    if (alone) return {block, 1};
    const std::size_t first = block * solve::kLanes;
    return {first, std::min<std::size_t>(solve::kLanes, lanes.size() - first)};
  }
};

class JointRuns {
 public:
  using End = solve::ContactGraph::End;
  static constexpr int kColours = 64, kLastColour = kColours - 1;

  // For at most that many, so that a step in which more joints wake up allocates nothing but
  // blocks.
  void reserve(std::size_t joints, std::size_t regions);
  // Removes all joints. states: the number of body states.
  void clear(std::size_t states, std::size_t regions);
  // Precondition: at least one of the two bodies moves.
  void add(JointBlockKind kind, const solve::JointForm& form, std::uint32_t joint, const End& a,
           const End& b);
  // Call it after the last add(): sorts the joints into blocks. The contents of the blocks are
  // undefined.
  void lay_out();

  // Calls f(run) for all runs of a region, in the order of solving.
  template <class F>
  void for_each(std::size_t region, const F& f) {
    for (const Run& run : std::span(runs_).subspan(first_run_[region], runs_in(region))) {
      if (run.kind == JointBlockKind::ball) f(run_of<solve::BallBlock>(run));
      if (run.kind == JointBlockKind::axes) f(run_of<solve::AxesBlock>(run));
      if (run.kind == JointBlockKind::frames) f(run_of<solve::FrameBlock>(run));
      if (run.kind == JointBlockKind::rows) f(run_of<solve::RowsBlock>(run));
    }
  }
  // Whether a joint is between bodies of two regions. Bodies that are in no region yet count as
  // one.
  bool connect_regions() const { return connect_regions_; }
  // The bodies of a region that have joints, except the fixed world.
  std::span<const std::uint32_t> bodies_of(std::size_t region) const {
    return std::span(bodies_).subspan(first_body_[region],
                                      first_body_[region + 1] - first_body_[region]);
  }

 private:
  struct Run {
    solve::JointForm form;
    JointBlockKind kind = JointBlockKind::ball;
    std::uint8_t colour = 0;
    std::uint16_t region = 0;
    std::uint32_t next = kNone;  // of the same region, while joints are added
    std::uint32_t lanes = 0, first_lane = 0, first_block = 0;

    bool alone() const { return colour == kLastColour; }
    std::uint32_t blocks() const {
      return alone() ? lanes : (lanes + solve::kLanes - 1) / solve::kLanes;
    }
  };
  struct Added {
    JointLane lane;
    std::uint32_t run;
  };
  struct JoinedBody {
    std::uint32_t body;
    std::uint16_t region;
  };
  template <class BLOCK>
  JointRun<BLOCK> run_of(const Run& run) {
    return {run.form, run.alone(),
            std::span(std::get<solve::LargeVector<BLOCK>>(blocks_))
                .subspan(run.first_block, run.blocks()),
            std::span<const JointLane>(lanes_).subspan(run.first_lane, run.lanes)};
  }
  std::size_t runs_in(std::size_t region) const {
    return first_run_[region + 1] - first_run_[region];
  }
  int colour_for(const End& a, const End& b);
  void note_body(const End& end);
  void join_regions();
  void sort_runs();
  void sort_lanes();
  void sort_bodies();

  bool connect_regions_ = false;
  // Blocks keep their contents, and memory, between steps.
  std::tuple<solve::LargeVector<solve::BallBlock>, solve::LargeVector<solve::AxesBlock>,
             solve::LargeVector<solve::FrameBlock>, solve::LargeVector<solve::RowsBlock>>
      blocks_;
  std::vector<Run> runs_, added_runs_;    // sorted, and in the order of their first joint
  std::vector<std::uint32_t> last_run_;   // of each region, in added_runs_
  std::vector<std::uint32_t> first_run_;  // of each region, in runs_; and the end
  std::vector<Added> added_;
  std::vector<JointLane> lanes_;
  std::vector<JoinedBody> joined_;
  std::vector<std::uint32_t> bodies_, first_body_;
  std::vector<std::uint32_t> order_, ends_;  // scratch
  std::vector<std::uint64_t> taken_;         // of each state: the colours of its joints, as bits
  std::vector<std::uint8_t> noted_;          // of each state: it is in joined_
};

}  // namespace vp
