#include "world/joint_runs.h"

#include <bit>
#include <numeric>

#include "solve/body_state.h"

namespace vp {

void JointRuns::reserve(std::size_t joints, std::size_t regions) {
  runs_.reserve(joints);
  added_runs_.reserve(joints);
  order_.reserve(joints);
  ends_.reserve(std::max(joints, regions));
  last_run_.reserve(regions);
  first_run_.reserve(regions + 1);
  first_body_.reserve(regions + 1);
  added_.reserve(joints);
  lanes_.reserve(joints);
  joined_.reserve(2 * joints);
  bodies_.reserve(2 * joints);
}

void JointRuns::clear(std::size_t states, std::size_t regions) {
  connect_regions_ = false;
  added_runs_.clear();
  added_.clear();
  joined_.clear();
  taken_.assign(states, 0);
  noted_.assign(states, 0);
  last_run_.assign(regions, kNone);
}

// The lowest colour that is free for both. If a body has more joints than there are colours, the
// rest go to the last colour, whose blocks are solved sequentially.
int JointRuns::colour_for(const End& a, const End& b) {
  const std::uint64_t taken = (a.moves ? taken_[a.state] : 0) | (b.moves ? taken_[b.state] : 0);
  const int colour = std::min(std::countr_one(taken), kLastColour);
  if (colour == kLastColour) return colour;
  for (const End& end : {a, b}) {
    if (end.moves) taken_[end.state] |= 1ull << colour;
  }
  return colour;
}

void JointRuns::note_body(const End& end) {
  if (end.state == solve::kWorldState || noted_[end.state] != 0) return;
  noted_[end.state] = 1;
  joined_.push_back({end.state - 1, end.region});
}

void JointRuns::add(JointBlockKind kind, const solve::JointForm& form, std::uint32_t joint,
                    const End& a, const End& b) {
  const auto colour = static_cast<std::uint8_t>(colour_for(a, b));
  const std::uint16_t region = solve::region_of(a, b);
  const bool of_two = a.state != solve::kWorldState && b.state != solve::kWorldState;
  connect_regions_ |= of_two && a.region != b.region;
  note_body(a);
  note_body(b);
  std::uint32_t& last = last_run_[region];
  std::uint32_t run = last;
  const auto is_its = [&](const Run& of) {
    return of.colour == colour && of.kind == kind && of.form == form;
  };
  while (run != kNone && !is_its(added_runs_[run])) run = added_runs_[run].next;
  if (run == kNone) {
    run = static_cast<std::uint32_t>(added_runs_.size());
    added_runs_.push_back({form, kind, colour, region, last});
    last = run;
  }
  ++added_runs_[run].lanes;
  added_.push_back({{joint, a.state, b.state}, run});
}

// If a joint connects regions, all joints are in kSharedRegion.
void JointRuns::join_regions() {
  if (!connect_regions_) return;
  for (Run& run : added_runs_) run.region = solve::kSharedRegion;
  for (JoinedBody& joined : joined_) joined.region = solve::kSharedRegion;
}

void JointRuns::lay_out() {
  join_regions();
  sort_runs();
  sort_lanes();
  sort_bodies();
}

void JointRuns::sort_runs() {
  order_.resize(added_runs_.size());
  std::iota(order_.begin(), order_.end(), 0u);
  std::sort(order_.begin(), order_.end(), [&](std::uint32_t i, std::uint32_t j) {
    const Run &a = added_runs_[i], &b = added_runs_[j];
    return std::tuple(a.region, a.colour, i) < std::tuple(b.region, b.colour, j);
  });
  runs_.clear();
  first_run_.assign(last_run_.size() + 1, 0);
  std::uint32_t lanes = 0, blocks[kJointBlockKinds] = {};
  for (const std::uint32_t i : order_) {
    Run& run = runs_.emplace_back(added_runs_[i]);
    ++first_run_[run.region + 1u];
    run.first_lane = lanes;
    lanes += run.lanes;
    std::uint32_t& end = blocks[static_cast<int>(run.kind)];
    run.first_block = end;
    end += run.blocks();
  }
  std::partial_sum(first_run_.begin(), first_run_.end(), first_run_.begin());
  const auto enlarge = [&]<class BLOCK>(solve::LargeVector<BLOCK>& of, JointBlockKind kind) {
    const std::uint32_t count = blocks[static_cast<int>(kind)];
    if (of.size() < count) of.resize(count);
  };
  enlarge(std::get<solve::LargeVector<solve::BallBlock>>(blocks_), JointBlockKind::ball);
  enlarge(std::get<solve::LargeVector<solve::AxesBlock>>(blocks_), JointBlockKind::axes);
  enlarge(std::get<solve::LargeVector<solve::FrameBlock>>(blocks_), JointBlockKind::frames);
  enlarge(std::get<solve::LargeVector<solve::RowsBlock>>(blocks_), JointBlockKind::rows);
}

void JointRuns::sort_lanes() {
  ends_.resize(added_runs_.size());
  for (std::size_t i = 0; i < runs_.size(); ++i) ends_[order_[i]] = runs_[i].first_lane;
  lanes_.resize(added_.size());
  for (const Added& added : added_) lanes_[ends_[added.run]++] = added.lane;
}

void JointRuns::sort_bodies() {
  first_body_.assign(last_run_.size() + 1, 0);
  for (const JoinedBody& joined : joined_) ++first_body_[joined.region + 1u];
  std::partial_sum(first_body_.begin(), first_body_.end(), first_body_.begin());
  ends_.assign(first_body_.begin(), first_body_.end() - 1);
  bodies_.resize(joined_.size());
  for (const JoinedBody& joined : joined_) bodies_[ends_[joined.region]++] = joined.body;
}

}  // namespace vp
