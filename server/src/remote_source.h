// The rods of one client as it sends them.
#pragma once

#include <cstdint>
#include <string>

#include "cabinet/rod_input.h"
#include "wire/input_datagram.h"

namespace server {

class RemoteSource final : public cabinet::InputSource {
 public:
  // A client sends at least 20 datagrams a second; after five missing ones its rods hold.
  static constexpr std::int64_t kSilenceUs = 250'000;

  explicit RemoteSource(const std::string& name) : name_(name) {}

  // Another client, or none, is to be heard here from now on: forgets all.
  void reset(std::int64_t now_us);
  // The client has these rods, by bit, from now on; of those that it gives up nothing is kept.
  void set_rods(std::uint8_t rods);
  // The client connects anew: its rods stay where they are, its count begins anew. Its silence goes
  // on: a connection moves no rod.
  void resume() { heard_ = false; }
  // Since its last datagram; of a client that has sent none, since it came.
  std::int64_t silent_us(std::int64_t now_us) const { return now_us - heard_us_; }
  // Rods of others are not looked at. False for a datagram no newer than one accepted.
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
