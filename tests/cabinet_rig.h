// End-to-end rig in lockstep: the firmware in its simulator, a real socket pair in place of hidraw,
// the server's tick, and a UDP listener that decodes like a renderer. The time is the simulator's;
// every exchange is awaited, none is timed.
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

  // Advances everything by one millisecond; returns the snapshot that the listener received for it.
  const wire::Snapshot& step();

  firmware_sim::CabinetSim& cabinet() { return sim_; }
  // Unplugs the cabinet from the server, and plugs it in again.
  void unplug();
  void plug_in();
  // The server's notices to a person since the last call.
  std::vector<wire::Notice> notices();
  // Waits for the next notice, which another thread than the tick's sends; none in 5 s: empty.
  std::optional<wire::Notice> next_notice();

  // A second reader of the same reports: the PC's targets from the counts, before the physics.
  const cabinet::DeviceSource& tap() const { return *tap_; }
  std::uint64_t haptic_pulses() const;  // that the server sent to the players of the rods

  // Ticks without a snapshot, or with one for another tick, since the listener joined.
  int snapshots_missed() const { return missed_; }

 private:
  // A cable for 64-byte reports: the simulator's end to write to, and the device's end to read; -1:
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
  Cable to_server_, to_tap_;  // before their readers
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
