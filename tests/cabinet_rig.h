// The whole way of the data in lockstep: the firmware in its simulator, a real socket pair in place
// of hidraw, the server's tick, and a listener on UDP that decodes what a renderer would. Time is
// the simulator's; every exchange is awaited, none is timed.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "cabinet/device_source.h"
#include "firmware_sim/cabinet_sim.h"
#include "server/server.h"
#include "wire/control.h"
#include "wire/seal.h"
#include "wire/snapshot.h"

namespace end_to_end {

class CabinetRig {
 public:
  explicit CabinetRig(foosball::Layout layout);
  ~CabinetRig();
  CabinetRig(const CabinetRig&) = delete;
  CabinetRig& operator=(const CabinetRig&) = delete;

  // One millisecond of everything; returns the snapshot that the listener got for it.
  const wire::Snapshot& step();

  firmware_sim::CabinetSim& cabinet() { return sim_; }
  // Pulls the cabinet's plug out of the server, and puts it back in.
  void unplug();
  void plug_in();
  // What the server has told a person since the last call.
  std::vector<wire::Notice> notices();
  // Waits for the next notice, which travels by another thread than the tick's; none in 5 s: empty.
  std::optional<wire::Notice> next_notice();

  // A second reader of the same reports: what the PC made of the counts, before the physics.
  const cabinet::DeviceSource& tap() const { return *tap_; }
  std::uint64_t haptic_pulses() const;  // that the server has sent to whoever has the rods

  // Ticks without a snapshot, or with one for another tick, since the listener joined.
  int snapshots_missed() const { return missed_; }

 private:
  // A cable for 64-byte reports: where the simulator writes and where a device reads; -1:
  // unplugged.
  struct Cable {
    int writing = -1, reading = -1;
  };

  static void connect_cable(Cable& cable);
  static std::unique_ptr<cabinet::DeviceSource> device_on(Cable& cable);
  void join();
  bool next_message(int deadline_ms, wire::ControlMessage& message);
  bool receive(wire::Snapshot& snapshot);
  void tick();
  void forward_reports();
  void forward_commands();

  firmware_sim::CabinetSim sim_{firmware_sim::Board::mega32u4};
  Cable to_server_, to_tap_;  // before what reads from them
  std::unique_ptr<server::Server> server_;
  std::unique_ptr<cabinet::DeviceSource> tap_;
  int udp_ = -1, tcp_ = -1;
  wire::ControlReader reader_;
  wire::DatagramOpener opener_;
  wire::Snapshot last_;
  bool first_ = true;
  int missed_ = 0;
};

}  // namespace end_to_end
