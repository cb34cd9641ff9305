// A simulated cabinet: the firmware's own .elf runs in simavr with eight simulated mice and eight
// haptic drivers on its pins. A simulated PC receives its data and sends commands. Time is virtual
// and advances only in advance_us().
//
// simavr is GPL-3: this library is for tests only and is not linked into anything shipped.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "firmware_sim/motor_bus.h"
#include "firmware_sim/sim_mouse.h"

namespace firmware_sim {

inline constexpr int kMice = 8;

enum class Board {
  mega32u4,  // USB: a 64-byte HID report every millisecond
  mega2560,  // UART0: COBS frames at 1 Mbaud, 250 a second
};

// The .elf of this build for a board.
std::string firmware_elf(Board board);

struct Report {
  std::uint64_t time_us = 0;  // when the host took it
  std::array<std::uint8_t, 64> bytes{};
};

// A report of an interface other than that of the frames.
struct PadReport {
  std::uint64_t time_us = 0;  // when the host took it
  int interface = 0;
  std::vector<std::uint8_t> bytes;
};

struct CabinetOptions {
  std::array<MouseOptions, kMice> mice{};
  std::uint32_t host_poll_us = 1000;  // period of the USB host's polls
  std::vector<std::uint8_t> eeprom;   // content at power-on; empty: erased
  // mega32u4: ten bytes of the signature row.
  std::array<std::uint8_t, 10> unique_id{0x59, 0x36, 0x34, 0x32, 0x31,
                                         0x39, 0x0B, 0x1C, 0xA0, 0xFE};
};

class CabinetSim {
 public:
  // Powers everything on. Throws std::runtime_error if the .elf cannot be loaded.
  explicit CabinetSim(const std::string& elf, Board board, const CabinetOptions& options = {});
  explicit CabinetSim(Board board, const CabinetOptions& options = {});
  ~CabinetSim();
  CabinetSim(const CabinetSim&) = delete;
  CabinetSim& operator=(const CabinetSim&) = delete;

  // Throws std::runtime_error if the firmware crashes.
  void advance_us(std::uint64_t us);
  std::uint64_t now_us() const;

  SimMouse& mouse(int rod);
  // The firmware has enabled all connected mice.
  bool all_enabled() const;

  // mega32u4: reports taken since the last call.
  std::vector<Report> take_reports();
  // Reports of all other interfaces since the last call.
  std::vector<PadReport> take_pad_reports();
  // mega2560: bytes sent by UART0 since the last call.
  std::vector<std::uint8_t> take_serial();

  // Sends to the board. mega32u4: an output report to the command endpoint. mega2560: bytes to
  // UART0, one every 11 us.
  void send(std::span<const std::uint8_t> bytes);
  bool all_sent() const;
  std::uint64_t last_sent_us() const;  // when the board had received all of it
  // mega2560: bytes that arrived while two others were unread.
  int serial_overruns() const;

  MotorBus& motors();
  bool motors_enabled() const;  // enable line of the drivers
  // An open-drain line was driven high.
  bool drove_high() const;
  std::uint8_t led() const;  // pulse width

  // ---- EEPROM and resets
  std::vector<std::uint8_t> eeprom() const;
  std::uint64_t eeprom_writes() const;
  bool eeprom_misused() const;  // accessed during a write
  void stick_program(bool interrupts_off);
  int resets() const;

  // ---- the simulated USB host (mega32u4)
  bool usb_configured() const;
  void usb_reset();  // the host then enumerates again
  void usb_unplug();
  int usb_enumerations() const;  // so far
  // Off: no program has opened the frames' interface, so the host does not poll it.
  void usb_read_frames(bool on);
  // Violations of the data sheet, only on the endpoints that simavr lacks.
  const std::vector<std::string>& usb_violations() const;
  // As read at enumeration; empty before.
  const std::vector<std::uint8_t>& device_descriptor() const;
  const std::vector<std::uint8_t>& configuration_descriptor() const;
  const std::vector<std::uint8_t>& report_descriptor(int interface = 0) const;
  int usb_interfaces() const;
  const std::vector<std::uint8_t>& serial_descriptor() const;
  struct ControlResult {
    bool stalled = false;
    std::vector<std::uint8_t> data;
  };
  // Runs a control transfer after enumeration, with at most one packet from the host; advances the
  // time. Throws std::runtime_error if the device does not answer within 50 ms.
  ControlResult control(const std::array<std::uint8_t, 8>& setup,
                        std::vector<std::uint8_t> data = {});

  // ---- measurements
  std::uint32_t serial_baud() const;  // as configured for UART0
  double idle_share() const;          // fraction of CPU cycles asleep since the last reset_idle()
  void reset_idle();
  std::size_t static_ram_bytes() const;  // .data and .bss
  std::size_t unused_ram_bytes() const;  // between these and the deepest stack so far

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace firmware_sim
