#include "rod_desk.h"

#include <cmath>
#include <span>

namespace server {
namespace {

std::array<double, cabinet::kRods> slide_limits(const foosball::TableSpec& table) {
  std::array<double, cabinet::kRods> limits{};
  for (int rod = 0; rod < foosball::kRods; ++rod) limits[rod] = table.rods[rod].slide_limit;
  return limits;
}

// The two computers must not think alike, nor as the match's own dice fall.
std::uint64_t computer_seed(std::uint64_t match_seed, int team) {
  return match_seed * 0x9E3779B97F4A7C15u + 1 + static_cast<std::uint64_t>(team);
}

}  // namespace

RodDesk::RodDesk(const foosball::MatchDesc& match,
                 const std::array<bool, foosball::kTeams>& computer,
                 const foosball::MatchView& view)
    : table_(foosball::table_spec(match.layout)),
      computer_allowed_(computer),
      seed_(match.seed),
      mux_(slide_limits(table_)) {
  if (match.mode == foosball::Mode::ladder) rung_ = 0;
  for (int team = 0; team < foosball::kTeams; ++team) {
    remotes_[team] = std::make_unique<RemoteSource>(table_, team);
    remote_index_[team] = add(*remotes_[team], cabinet::Origin::absolute, RodDriver::client);
    computers_[team] = std::make_unique<ComputerSource>(computer_desc(team), view);
    computer_index_[team] = add(*computers_[team], cabinet::Origin::absolute, RodDriver::computer);
  }
  assign_all();
}

foosball::ComputerPlayerDesc RodDesk::computer_desc(int team) const {
  static_assert(foosball::kLadderRungs == foosball::kLevels);
  foosball::ComputerPlayerDesc desc;
  desc.team = team;
  desc.seed = computer_seed(seed_, team);
  desc.opens_match = computer_allowed_[0] && computer_allowed_[1];
  if (rung_ >= 0) {
    desc.player.level = rung_ + 1;
    desc.player.style = foosball::style_of_level(rung_ + 1);
  }
  return desc;
}

void RodDesk::set_rung(int rung) {
  if (rung_ < 0 || rung == rung_ || rung < 0 || rung >= foosball::kLadderRungs) return;
  rung_ = rung;
  for (int team = 0; team < foosball::kTeams; ++team) {
    computers_[team]->replace(computer_desc(team));
  }
}

// Sources that hands drive: first the clients', then the devices'.
const cabinet::RodInput& RodDesk::hand(std::size_t source, int rod) const {
  if (source < remotes_.size()) return remotes_[source]->rods()[rod];
  return devices_[source - remotes_.size()]->rods()[rod];
}

void RodDesk::show_match(bool shown) {
  if (shown == shown_) return;
  shown_ = shown;
  hands_.resize(remotes_.size() + devices_.size());
  for (std::size_t source = 0; source < hands_.size(); ++source) {
    for (int rod = 0; rod < cabinet::kRods; ++rod) hands_[source][rod] = hand(source, rod);
  }
  assign_all();
}

bool RodDesk::hand_moved() const {
  // More than a sensor's noise, as foosball's idle watch has it.
  constexpr double kSlide = 0.003, kAngle = 0.05;  // [m], [rad]
  for (std::size_t source = 0; source < hands_.size(); ++source) {
    for (int rod = 0; rod < cabinet::kRods; ++rod) {
      const cabinet::RodInput& now = hand(source, rod);
      const cabinet::RodInput& then = hands_[source][rod];
      if (now.status != cabinet::RodStatus::live) continue;
      if (then.status != cabinet::RodStatus::live) return true;
      if (std::fabs(now.slide - then.slide) > kSlide) return true;
      if (std::fabs(now.angle - then.angle) > kAngle) return true;
    }
  }
  return false;
}

int RodDesk::add(cabinet::InputSource& source, cabinet::Origin origin, RodDriver kind) {
  kinds_.push_back(kind);
  return mux_.add(source, origin);
}

void RodDesk::add_device(std::unique_ptr<cabinet::DeviceSource> device) {
  order_.insert(order_.end() - 1, add(*device, cabinet::Origin::relative, RodDriver::cabinet));
  devices_.push_back(std::move(device));
  assign_all();
}

void RodDesk::set_claimed(int team, bool claimed) {
  claimed_[team] = claimed;
  remotes_[team]->reset();
  assign_all();
}

void RodDesk::assign_all() {
  for (int team = 0; team < foosball::kTeams; ++team) {
    computers_[team]->set_playing(shown_ || (computer_allowed_[team] && !claimed_[team]));
  }
  for (int rod = 0; rod < foosball::kRods; ++rod) {
    const int team = table_.rods[rod].team;
    const int computer =
        computer_allowed_[team] ? computer_index_[team] : cabinet::SourceMux::kNobody;
    order_.back() = claimed_[team] ? remote_index_[team] : computer;
    if (shown_) {
      mux_.assign(rod, std::span(&computer_index_[team], 1));
    } else {
      mux_.assign(rod, order_);
    }
  }
}

RodDriver RodDesk::driver(int rod) const {
  const int source = mux_.source_of(rod);
  return source == cabinet::SourceMux::kNobody ? RodDriver::none : kinds_[source];
}

}  // namespace server
