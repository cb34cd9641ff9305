#include "world/joint_runs.h"

#include <algorithm>
#include <bit>
#include <type_traits>

namespace vp {

void JointRuns::clear(std::size_t states) {
  std::apply([](auto&... kind) { ((kind.used = 0), ...); }, kinds_);
  for (auto& colour : by_colour_) colour.clear();
  taken_.assign(states, 0);
}

// The lowest colour that is free for both. If a body has more joints than there are colours, the
// rest go to the last colour, whose blocks are solved sequentially.
int JointRuns::colour_for(std::uint32_t state_a, bool moves_a, std::uint32_t state_b,
                          bool moves_b) {
  const std::uint64_t taken = (moves_a ? taken_[state_a] : 0) | (moves_b ? taken_[state_b] : 0);
  const int colour = std::min(std::countr_one(taken), kLastColour);
  if (colour == kLastColour) return colour;
  if (moves_a) taken_[state_a] |= 1ull << colour;
  if (moves_b) taken_[state_b] |= 1ull << colour;
  return colour;
}

template <class BLOCK>
JointRuns::Lane<BLOCK> JointRuns::add(const solve::JointForm& form, std::uint32_t joint,
                                      std::uint32_t state_a, bool moves_a, std::uint32_t state_b,
                                      bool moves_b) {
  constexpr std::uint8_t kKind = std::is_same_v<BLOCK, solve::BallBlock>    ? 0
                                 : std::is_same_v<BLOCK, solve::AxesBlock>  ? 1
                                 : std::is_same_v<BLOCK, solve::FrameBlock> ? 2
                                                                            : 3;
  auto& kind = std::get<kKind>(kinds_);
  const int colour = colour_for(state_a, moves_a, state_b, moves_b);
  auto& refs = by_colour_[static_cast<std::size_t>(colour)];
  const auto is_its = [&](const Ref& ref) {
    return ref.kind == kKind && kind.runs[ref.index].form == form;
  };
  auto found = std::find_if(refs.begin(), refs.end(), is_its);
  if (found == refs.end()) {
    if (kind.used == kind.runs.size()) kind.runs.emplace_back();
    JointRun<BLOCK>& fresh = kind.runs[kind.used];
    fresh.form = form;
    fresh.lanes = 0;
    fresh.alone = colour == kLastColour;
    fresh.blocks.clear();
    found = refs.insert(refs.end(), Ref{kKind, static_cast<std::uint32_t>(kind.used++)});
  }
  JointRun<BLOCK>& run = kind.runs[found->index];
  const int at = run.alone ? 0 : static_cast<int>(run.lanes % solve::kLanes);
  if (at == 0) run.blocks.emplace_back();  // its lanes refer to kWorldState
  ++run.lanes;
  BLOCK& block = run.blocks.back();
  block.a.lane[at] = state_a;
  block.b.lane[at] = state_b;
  block.joint.lane[at] = joint;
  return {block, at};
}

template JointRuns::Lane<solve::BallBlock> JointRuns::add(const solve::JointForm&, std::uint32_t,
                                                          std::uint32_t, bool, std::uint32_t, bool);
template JointRuns::Lane<solve::AxesBlock> JointRuns::add(const solve::JointForm&, std::uint32_t,
                                                          std::uint32_t, bool, std::uint32_t, bool);
template JointRuns::Lane<solve::FrameBlock> JointRuns::add(const solve::JointForm&, std::uint32_t,
                                                           std::uint32_t, bool, std::uint32_t,
                                                           bool);
template JointRuns::Lane<solve::RowsBlock> JointRuns::add(const solve::JointForm&, std::uint32_t,
                                                          std::uint32_t, bool, std::uint32_t, bool);

}  // namespace vp
