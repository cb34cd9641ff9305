// The joints of a step in blocks of SIMD lanes, sorted by colour, and within a colour by form. No
// two joints of a colour share a body that moves. The blocks depend only on which joints take part
// and on their order, so the order of solving is a function of the state.
#pragma once

#include <array>
#include <cstdint>
#include <tuple>
#include <vector>

#include "solve/joint_block.h"
#include "solve/large_pages.h"

namespace vp {

template <class BLOCK>
struct JointRun {
  solve::JointForm form;
  std::uint32_t lanes = 0;           // used
  bool alone = false;                // the last colour: one joint in each block
  solve::LargeVector<BLOCK> blocks;  // keeps its capacity between steps
};

// Runs of one kind of block, of all colours.
template <class BLOCK>
struct JointRunsOf {
  std::vector<JointRun<BLOCK>> runs;
  std::size_t used = 0;
};

class JointRuns {
 public:
  static constexpr int kColours = 64, kLastColour = kColours - 1;
  template <class BLOCK>
  struct Lane {
    BLOCK& block;
    int at;
  };

  // Removes all joints. states: the number of body states.
  void clear(std::size_t states);
  // Returns an empty lane for a joint of two body states. A state that moves is in no other lane of
  // the block. Precondition: at least one of the two moves.
  template <class BLOCK>
  Lane<BLOCK> add(const solve::JointForm& form, std::uint32_t joint, std::uint32_t state_a,
                  bool moves_a, std::uint32_t state_b, bool moves_b);
  // Calls f(run) for all runs, in the order of solving.
  template <class F>
  void for_each(const F& f) {
    for (const auto& colour : by_colour_) {
      for (const Ref& ref : colour) {
        if (ref.kind == 0) f(std::get<0>(kinds_).runs[ref.index]);
        if (ref.kind == 1) f(std::get<1>(kinds_).runs[ref.index]);
        if (ref.kind == 2) f(std::get<2>(kinds_).runs[ref.index]);
        if (ref.kind == 3) f(std::get<3>(kinds_).runs[ref.index]);
      }
    }
  }

 private:
  struct Ref {
    std::uint8_t kind;
    std::uint32_t index;
  };
  int colour_for(std::uint32_t state_a, bool moves_a, std::uint32_t state_b, bool moves_b);

  std::tuple<JointRunsOf<solve::BallBlock>, JointRunsOf<solve::AxesBlock>,
             JointRunsOf<solve::FrameBlock>, JointRunsOf<solve::RowsBlock>>
      kinds_;
  std::array<std::vector<Ref>, kColours> by_colour_;
  std::vector<std::uint64_t> taken_;  // of each state: the colours of its joints, as bits
};

}  // namespace vp
