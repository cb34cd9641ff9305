#include "solve/islands.h"

#include <algorithm>

#include "solve/link_rows.h"

namespace vp::solve {
namespace {

constexpr std::uint32_t kNoIsland = 0xffffffffu;

}  // namespace

// The smallest node of the island.
std::uint32_t Islands::root_of(std::uint32_t node) {
  while (parent_[node] != node) node = parent_[node] = parent_[parent_[node]];
  return node;
}

void Islands::join_nodes(const StepContext& s) {
  ends_.clear();
  parent_.clear();
  const auto add = [&](const auto& contact_or_pair) {
    const auto node = static_cast<std::uint32_t>(parent_.size());
    for_moving_bodies(s, contact_or_pair,
                      [&](MovingBodyKey mover) { ends_.emplace_back(mover, node); });
    parent_.push_back(node);
  };
  for (const ContactConstraint& c : s.contacts) add(c);
  for (const JointPair& pair : s.pairs) add(pair);
  std::sort(ends_.begin(), ends_.end());
  for (std::size_t k = 1; k < ends_.size(); ++k) {
    if (ends_[k].first != ends_[k - 1].first) continue;
    const std::uint32_t a = root_of(ends_[k - 1].second), b = root_of(ends_[k].second);
    parent_[std::max(a, b)] = std::min(a, b);
  }
}

void Islands::number_islands(const StepContext& s) {
  islands_.clear();
  island_of_.assign(parent_.size(), kNoIsland);
  for (std::uint32_t i = 0; i < parent_.size(); ++i) {
    const std::uint32_t root = root_of(i);
    if (root == i) {
      island_of_[i] = static_cast<std::uint32_t>(islands_.size());
      islands_.push_back({});
    }
    Island& island = islands_[island_of_[i] = island_of_[root]];
    if (i >= s.contacts.size()) continue;
    ++island.end_contact;
    island.rows += static_cast<std::uint32_t>(rows_of(s.contacts[i]));
  }
  std::uint32_t count = 0;
  for (Island& island : islands_) {
    island.first_contact = count;
    count += island.end_contact;
    island.end_contact = island.first_contact;
  }
  contacts_.resize(s.contacts.size());
  for (std::uint32_t i = 0; i < s.contacts.size(); ++i) {
    contacts_[islands_[island_of_[i]].end_contact++] = i;
  }
}

void Islands::add_joints(const StepContext& s) {
  const auto island_of = [&](std::uint32_t articulation) {
    const MovingBodyKey key = key_of_articulation(articulation);
    const auto end = std::lower_bound(ends_.begin(), ends_.end(), std::pair{key, 0u});
    const bool found = end != ends_.end() && end->first == key;
    return found ? island_of_[end->second] : kNoIsland;
  };
  island_of_joint_.clear();
  for (std::uint32_t i = 0; i < s.joints.size(); ++i) {
    const JointRow& row = s.joints[i];
    const bool same = i > 0 && row.articulation == s.joints[i - 1].articulation;
    const std::uint32_t own = row.pair != kNoPair ? island_of_[s.contacts.size() + row.pair]
                              : same              ? island_of_joint_.back()
                                                  : island_of(row.articulation);
    island_of_joint_.push_back(own);
    if (own == kNoIsland) continue;
    ++islands_[own].end_joint;
    ++islands_[own].rows;
  }
  std::uint32_t count = 0;
  for (Island& island : islands_) {
    island.first_joint = count;
    count += island.end_joint;
    island.end_joint = island.first_joint;
  }
  joints_.resize(count);
  for (std::uint32_t i = 0; i < s.joints.size(); ++i) {
    const std::uint32_t own = island_of_joint_[i];
    if (own != kNoIsland) joints_[islands_[own].end_joint++] = i;
  }
}

void Islands::find(const StepContext& s) {
  join_nodes(s);
  number_islands(s);
  add_joints(s);
}

}  // namespace vp::solve
