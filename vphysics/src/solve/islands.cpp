#include "solve/islands.h"

#include <algorithm>

#include "solve/link_rows.h"

namespace vp::solve {
namespace {

constexpr std::uint32_t kNoIsland = 0xffffffffu;

}  // namespace

// Of the contact with the least number in its island.
std::uint32_t Islands::root_of(std::uint32_t contact) {
  while (parent_[contact] != contact) contact = parent_[contact] = parent_[parent_[contact]];
  return contact;
}

void Islands::join_contacts(const StepContext& s) {
  ends_.clear();
  parent_.clear();
  for (std::uint32_t i = 0; i < s.contacts.size(); ++i) {
    const ContactConstraint& c = s.contacts[i];
    parent_.push_back(i);
    const auto add = [&](std::uint32_t body, bool moves, const LinkSide& side) {
      if (moves) ends_.emplace_back(body, i);
      if (side.depth == 0) return;
      ends_.emplace_back(
          key_of_articulation(static_cast<std::uint32_t>(s.bodies[body].articulation)), i);
    };
    add(c.a, c.moves_a, c.side_a);
    add(c.b, c.moves_b, c.side_b);
  }
  std::sort(ends_.begin(), ends_.end());
  for (std::size_t k = 1; k < ends_.size(); ++k) {
    if (ends_[k].first != ends_[k - 1].first) continue;
    const std::uint32_t a = root_of(ends_[k - 1].second), b = root_of(ends_[k].second);
    parent_[std::max(a, b)] = std::min(a, b);
  }
}

void Islands::number_islands(const StepContext& s) {
  islands_.clear();
  island_of_.assign(s.contacts.size(), kNoIsland);
  for (std::uint32_t i = 0; i < s.contacts.size(); ++i) {
    const std::uint32_t root = root_of(i);
    if (root == i) {
      island_of_[i] = static_cast<std::uint32_t>(islands_.size());
      islands_.push_back({});
    }
    Island& island = islands_[island_of_[i] = island_of_[root]];
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
    const MoverKey key = key_of_articulation(articulation);
    const auto end = std::lower_bound(ends_.begin(), ends_.end(), std::pair{key, 0u});
    const bool found = end != ends_.end() && end->first == key;
    return found ? island_of_[end->second] : kNoIsland;
  };
  joints_.clear();
  for (std::uint32_t i = 0; i < s.joints.size(); ++i) {
    const bool same = i > 0 && s.joints[i].articulation == s.joints[i - 1].articulation;
    const std::uint32_t own = same ? joints_.back() : island_of(s.joints[i].articulation);
    joints_.push_back(own);
    if (own == kNoIsland) continue;
    ++islands_[own].end_joint;
    ++islands_[own].rows;
  }
  island_of_.assign(joints_.begin(), joints_.end());
  std::uint32_t count = 0;
  for (Island& island : islands_) {
    island.first_joint = count;
    count += island.end_joint;
    island.end_joint = island.first_joint;
  }
  joints_.resize(count);
  for (std::uint32_t i = 0; i < s.joints.size(); ++i) {
    if (island_of_[i] != kNoIsland) joints_[islands_[island_of_[i]].end_joint++] = i;
  }
}

void Islands::find(const StepContext& s) {
  join_contacts(s);
  number_islands(s);
  add_joints(s);
}

}  // namespace vp::solve
