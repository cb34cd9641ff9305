// A USB host's port: resets the device, enumerates it, then polls the endpoint of each of its HID
// interfaces for reports.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "firmware_sim/cabinet_sim.h"

namespace firmware_sim {

// Bus operations of the host; each returns false for NAK.
struct UsbBus {
  enum class Answer { ok, nak, stall };
  std::function<void()> reset;
  std::function<Answer(std::array<std::uint8_t, 8> setup)> setup;
  std::function<Answer(int endpoint, std::vector<std::uint8_t>& out)> read;
  std::function<Answer(int endpoint, std::span<const std::uint8_t> bytes)> write;
};

class UsbHost {
 public:
  UsbHost(UsbBus bus, std::uint32_t poll_us) : bus_(std::move(bus)), poll_us_(poll_us) {}

  void attached(std::uint64_t now_us);
  void detached();
  void unplug();  // permanently
  void reset_port();
  // Handles what is due; returns the time until the next call [us].
  std::uint32_t run(std::uint64_t now_us);

  bool configured() const { return configured_; }
  int enumerations() const { return enumerations_; }
  // Linux does not poll an interface that no program has opened.
  void read_frames(bool on) { reads_frames_ = on; }
  std::vector<Report> take_reports() { return std::exchange(reports_, {}); }
  std::vector<PadReport> take_pad_reports() { return std::exchange(pad_reports_, {}); }

  // A transfer requested by the test, started between two reports. data: sent by the host, at most
  // one packet.
  void request(const std::array<std::uint8_t, 8>& setup, std::vector<std::uint8_t> data);
  std::optional<CabinetSim::ControlResult> take_result() { return std::exchange(result_, {}); }

  // An output report for the command endpoint: one per millisecond, after the input report.
  void send(std::vector<std::uint8_t> bytes) { outgoing_.push_back(std::move(bytes)); }
  std::size_t unsent() const { return outgoing_.size(); }
  std::uint64_t last_sent_us() const { return last_sent_us_; }  // when the device took it

  std::vector<std::uint8_t> device, configuration, serial;
  std::vector<std::vector<std::uint8_t>> report;  // descriptors, by interface

 private:
  using Setup = std::array<std::uint8_t, 8>;
  using Done = std::function<void(CabinetSim::ControlResult)>;
  enum class Stage { setup, data_in, data_out, status_in, status_out };
  struct Transfer {
    Setup setup;
    std::vector<std::uint8_t> data;  // sent by the host
    Done done;
    Stage stage = Stage::setup;
    CabinetSim::ControlResult result;
  };

  void enumerate();
  void take_configuration(CabinetSim::ControlResult result);
  void add(const Setup& setup, Done done = {}, std::vector<std::uint8_t> data = {});
  void step_transfer();
  void end_transfer(bool stalled);
  void poll_report(std::uint64_t now_us);
  void poll_pads(std::uint64_t now_us);
  void send_report(std::uint64_t now_us);

  UsbBus bus_;
  std::uint32_t poll_us_;
  bool attached_ = false, unplugged_ = false;
  bool configured_ = false;
  bool reset_due_ = false;
  bool reads_frames_ = true;
  int enumerations_ = 0;
  std::vector<int> in_endpoints_;  // by interface
  std::vector<PadReport> pad_reports_;
  std::uint64_t next_poll_us_ = 0;
  std::deque<Transfer> transfers_;
  std::vector<Report> reports_;
  std::deque<std::vector<std::uint8_t>> outgoing_;
  std::uint64_t last_sent_us_ = 0;
  std::optional<CabinetSim::ControlResult> result_;
};

}  // namespace firmware_sim
