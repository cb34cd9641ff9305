// A computer player as an input source: one look at the match a poll, so one poll a tick.
#pragma once

#include "cabinet/rod_input.h"
#include "foosball/computer_player.h"

namespace server {

class ComputerSource final : public cabinet::InputSource {
 public:
  // view must outlive the source and be that of the tick before.
  ComputerSource(const foosball::ComputerPlayerDesc& desc, const foosball::MatchView& view);

  // Another player takes its place, from the next poll on.
  void replace(const foosball::ComputerPlayerDesc& desc);
  // The rods that it plays from the next poll on, by bit, of its team's. The others are absent;
  // none: nothing is computed.
  void set_rods(std::uint8_t rods) { mine_ = rods; }

  void poll(std::int64_t now_us) override;
  const cabinet::RodInputs& rods() const override { return rods_; }
  const cabinet::SourceCounters& counters() const override { return counters_; }
  const std::string& name() const override { return name_; }

 private:
  foosball::ComputerPlayer player_;
  int team_;
  const foosball::MatchView& view_;
  foosball::RodTargets targets_{};
  cabinet::RodInputs rods_{};
  cabinet::SourceCounters counters_;
  std::string name_;
  std::uint8_t mine_ = 0;
};

}  // namespace server
