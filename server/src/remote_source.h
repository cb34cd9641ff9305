// The rods of one team as its client sends them.
#pragma once

#include "cabinet/rod_input.h"
#include "foosball/table.h"
#include "wire/input_datagram.h"

namespace server {

class RemoteSource final : public cabinet::InputSource {
 public:
  // A client sends at least 20 datagrams a second; after five missing ones its rods hold.
  static constexpr std::int64_t kSilenceUs = 250'000;

  RemoteSource(const foosball::TableSpec& table, int team);

  // Another client, or none, has the team: forgets all.
  void reset();
  // Rods of the other team are not looked at. False for a datagram no newer than one accepted.
  bool accept(const wire::InputDatagram& input, std::int64_t now_us);

  void poll(std::int64_t now_us) override;
  const cabinet::RodInputs& rods() const override { return rods_; }
  const cabinet::SourceCounters& counters() const override { return counters_; }
  const std::string& name() const override { return name_; }

 private:
  std::array<bool, cabinet::kRods> own_{};
  cabinet::RodInputs rods_{};
  cabinet::SourceCounters counters_;
  std::string name_;
  bool heard_ = false;
  std::uint32_t sequence_ = 0;
  std::int64_t heard_us_ = 0;
};

}  // namespace server
