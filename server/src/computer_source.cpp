#include "computer_source.h"

namespace server {

ComputerSource::ComputerSource(const foosball::ComputerPlayerDesc& desc,
                               const foosball::MatchView& view)
    : player_(desc), view_(view), name_("computer of team " + std::to_string(desc.team)) {}

void ComputerSource::replace(const foosball::ComputerPlayerDesc& desc) {
  player_ = foosball::ComputerPlayer(desc);
}

void ComputerSource::set_playing(bool playing) {
  playing_ = playing;
  if (!playing) rods_ = {};
}

void ComputerSource::poll(std::int64_t now_us) {
  if (!playing_) return;
  targets_ = {};
  player_.play(view_, targets_);
  ++counters_.frames;
  for (int rod = 0; rod < cabinet::kRods; ++rod) {
    const foosball::RodTarget& target = targets_[rod];
    if (!target.live) continue;
    rods_[rod] = {target.slide,      target.angle, target.slide_rate,
                  target.angle_rate, now_us,       cabinet::RodStatus::live};
  }
}

}  // namespace server
