// A computer player as an input source. It observes the match once per poll, so poll once per tick.
#pragma once

#include "cabinet/rod_input.h"
#include "foosball/computer_player.h"

namespace server {

class ComputerSource final : public cabinet::InputSource {
 public:
  // view must outlive the source and be the view of the previous tick.
  ComputerSource(const foosball::ComputerPlayerDesc& desc, const foosball::MatchView& view);

  // Replaces the player from the next poll on.
  void replace(const foosball::ComputerPlayerDesc& desc);
  // The team's rods that it plays from the next poll on (bit mask). The others are absent; with
  // none, nothing is computed.
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
