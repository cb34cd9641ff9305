// A USB host's port: resets the device, enumerates it, then asks endpoint 1 for a report every
// poll.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "firmware_sim/cabinet_sim.h"

namespace firmware_sim {

// What the host can do on the bus; each returns false for NAK.
struct UsbBus {
  enum class Answer { ok, nak, stall };
  std::function<void()> reset;
  std::function<Answer(std::array<std::uint8_t, 8> setup)> setup;
  std::function<Answer(int endpoint, std::vector<std::uint8_t>& out)> read;
  std::function<Answer(int endpoint)> write_empty;
};

class UsbHost {
 public:
  UsbHost(UsbBus bus, std::uint32_t poll_us) : bus_(std::move(bus)), poll_us_(poll_us) {}

  void attached(std::uint64_t now_us);
  void reset_port();
  // Does what is due; returns how long until it has to be called again [us].
  std::uint32_t run(std::uint64_t now_us);

  bool configured() const { return configured_; }
  std::vector<Report> take_reports() { return std::exchange(reports_, {}); }

  // A transfer of the test's own, begun between two reports.
  void request(const std::array<std::uint8_t, 8>& setup);
  std::optional<CabinetSim::ControlResult> take_result() { return std::exchange(result_, {}); }

  std::vector<std::uint8_t> device, configuration, report;

 private:
  using Setup = std::array<std::uint8_t, 8>;
  using Done = std::function<void(CabinetSim::ControlResult)>;
  enum class Stage { setup, data_in, status_in, status_out };
  struct Transfer {
    Setup setup;
    Done done;
    Stage stage = Stage::setup;
    CabinetSim::ControlResult result;
  };

  void enumerate();
  void add(const Setup& setup, Done done = {});
  void step_transfer();
  void end_transfer(bool stalled);
  void poll_report(std::uint64_t now_us);

  UsbBus bus_;
  std::uint32_t poll_us_;
  bool attached_ = false;
  bool configured_ = false;
  bool reset_due_ = false;
  std::uint64_t next_poll_us_ = 0;
  std::deque<Transfer> transfers_;
  std::vector<Report> reports_;
  std::optional<CabinetSim::ControlResult> result_;
};

}  // namespace firmware_sim
