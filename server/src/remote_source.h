// The rods of one client, from its input datagrams.
#pragma once

#include <cstdint>
#include <string>

#include "cabinet/rod_input.h"
#include "wire/input_datagram.h"

namespace server {

class RemoteSource final : public cabinet::InputSource {
 public:
  // A client sends at least 20 datagrams per second; after five missing ones its rods hold.
  static constexpr std::int64_t kSilenceUs = 250'000;

  explicit RemoteSource(const std::string& name) : name_(name) {}

  // Assigns the source to another client or to none: clears all state.
  void reset(std::int64_t now_us);
  // Sets the client's rods (bit mask). Clears the state of rods that it gives up.
  void set_rods(std::uint8_t rods);
  // The client reconnects: its rods stay in place and its sequence restarts. Its silence continues,
  // since a connection moves no rod.
  void resume() { received_ = false; }
  // Time since its last datagram, or since reset() if it has sent none.
  std::int64_t silent_us(std::int64_t now_us) const { return now_us - received_us_; }
  // Ignores rods of others. False for a datagram that is not newer than the last accepted one.
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
  bool received_ = false;
  std::uint32_t sequence_ = 0;
  std::int64_t received_us_ = 0;
};

}  // namespace server
