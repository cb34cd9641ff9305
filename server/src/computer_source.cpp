#include "computer_source.h"

namespace server {

ComputerSource::ComputerSource(const foosball::ComputerPlayerDesc& desc,
                               const foosball::MatchView& view)
    : player_(desc),
      team_(desc.team),
      view_(view),
      name_("computer of team " + std::to_string(desc.team)) {}

void ComputerSource::replace(const foosball::ComputerPlayerDesc& desc) {
  player_ = foosball::ComputerPlayer(desc);
  team_ = desc.team;
}

void ComputerSource::poll(std::int64_t now_us) {
  targets_ = {};
  player_.play(view_, targets_, mine_);
  rods_ = {};
  if (mine_ == 0) return;
  ++counters_.frames;
  // A rod that is no longer driven still belongs to the computer: it holds its position.
  for (const int rod : rods_of_team(foosball::table_spec(view_.layout), team_)) {
    if ((mine_ >> rod & 1) == 0) continue;
    const foosball::RodTarget& target = targets_[rod];
    rods_[rod] = {target.slide,      target.angle, target.slide_rate,
                  target.angle_rate, now_us,       cabinet::RodStatus::live};
  }
}

}  // namespace server
