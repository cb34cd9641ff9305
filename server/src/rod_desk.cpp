#include "rod_desk.h"

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
    : table_(foosball::table_spec(match.layout)), mux_(slide_limits(table_)) {
  for (int team = 0; team < foosball::kTeams; ++team) {
    remotes_[team] = std::make_unique<RemoteSource>(table_, team);
    remote_index_[team] = add(*remotes_[team], cabinet::Origin::absolute, RodDriver::client);
    computer_index_[team] = cabinet::SourceMux::kNobody;
    if (!computer[team]) continue;
    foosball::ComputerPlayerDesc desc;
    desc.team = team;
    desc.seed = computer_seed(match.seed, team);
    desc.opens_match = computer[0] && computer[1];
    computers_[team] = std::make_unique<ComputerSource>(desc, view);
    computer_index_[team] = add(*computers_[team], cabinet::Origin::absolute, RodDriver::computer);
  }
  assign_all();
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
    if (computers_[team]) computers_[team]->set_playing(!claimed_[team]);
  }
  for (int rod = 0; rod < foosball::kRods; ++rod) {
    const int team = table_.rods[rod].team;
    order_.back() = claimed_[team] ? remote_index_[team] : computer_index_[team];
    mux_.assign(rod, order_);
  }
}

RodDriver RodDesk::driver(int rod) const {
  const int source = mux_.source_of(rod);
  return source == cabinet::SourceMux::kNobody ? RodDriver::none : kinds_[source];
}

}  // namespace server
