// A cabinet without the wood: the firmware's own .elf runs in simavr, eight simulated mice and
// eight haptic drivers are on its pins, and a simulated PC takes what it sends, and sends commands.
// Time is virtual: nothing happens but in advance_us().
//
// simavr is GPL-3: this library is for tests only and is linked into nothing that is shipped.
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
  mega32u4,  // USB: 64-byte HID reports, one a millisecond
  mega2560,  // UART0: COBS frames at 1 Mbaud, 250 a second
};

// The .elf that this build made for board.
std::string firmware_elf(Board board);

struct Report {
  std::uint64_t time_us = 0;  // when the host took it
  std::array<std::uint8_t, 64> bytes{};
};

// Of an interface besides that of the frames.
struct PadReport {
  std::uint64_t time_us = 0;  // when the host took it
  int interface = 0;
  std::vector<std::uint8_t> bytes;
};

struct CabinetOptions {
  std::array<MouseOptions, kMice> mice{};
  std::uint32_t host_poll_us = 1000;  // how often the USB host asks for a report
  std::vector<std::uint8_t> eeprom;   // what it holds at power-on; empty: erased
  // mega32u4: ten bytes of the signature row.
  std::array<std::uint8_t, 10> unique_id{0x59, 0x36, 0x34, 0x32, 0x31,
                                         0x39, 0x0B, 0x1C, 0xA0, 0xFE};
};

class CabinetSim {
 public:
  // Power-on of everything. Throws std::runtime_error when the .elf cannot be loaded.
  explicit CabinetSim(const std::string& elf, Board board, const CabinetOptions& options = {});
  explicit CabinetSim(Board board, const CabinetOptions& options = {});
  ~CabinetSim();
  CabinetSim(const CabinetSim&) = delete;
  CabinetSim& operator=(const CabinetSim&) = delete;

  // Throws std::runtime_error when the firmware crashes.
  void advance_us(std::uint64_t us);
  std::uint64_t now_us() const;

  SimMouse& mouse(int rod);
  // All mice that are plugged in are enabled by the firmware.
  bool all_enabled() const;

  // mega32u4: the reports taken since the last call.
  std::vector<Report> take_reports();
  // The same of all other interfaces.
  std::vector<PadReport> take_pad_reports();
  // mega2560: the bytes that left UART0 since the last call.
  std::vector<std::uint8_t> take_serial();

  // Towards the board. mega32u4: an output report for the command endpoint; mega2560: bytes for
  // UART0, one in 11 us.
  void send(std::span<const std::uint8_t> bytes);
  bool all_sent() const;
  std::uint64_t last_sent_us() const;  // when the board had the last of it
  // mega2560: bytes that found two before them not taken.
  int serial_overruns() const;

  MotorBus& motors();
  bool motors_enabled() const;  // the line that enables the drivers
  // A line that must be open drain was driven high.
  bool drove_high() const;
  std::uint8_t led() const;  // width of its pulses

  // ---- EEPROM and resets
  std::vector<std::uint8_t> eeprom() const;
  std::uint64_t eeprom_writes() const;
  bool eeprom_misused() const;  // spoken to while it was writing
  void stick_program(bool interrupts_off);
  int resets() const;

  // ---- the simulated USB host (mega32u4)
  bool usb_configured() const;
  void usb_reset();  // and enumerates again
  void usb_unplug();
  int usb_enumerations() const;  // so far
  // Off: no program has opened the interface of the frames, so the host does not ask for them.
  void usb_read_frames(bool on);
  // What the data sheet forbids; only of the endpoints that simavr has not.
  const std::vector<std::string>& usb_violations() const;
  // As read during enumeration; empty before.
  const std::vector<std::uint8_t>& device_descriptor() const;
  const std::vector<std::uint8_t>& configuration_descriptor() const;
  const std::vector<std::uint8_t>& report_descriptor(int interface = 0) const;
  int usb_interfaces() const;
  const std::vector<std::uint8_t>& serial_descriptor() const;
  struct ControlResult {
    bool stalled = false;
    std::vector<std::uint8_t> data;
  };
  // One control transfer after enumeration, with at most a packet from the host; advances the time.
  // Throws std::runtime_error when the device has not answered within 50 ms.
  ControlResult control(const std::array<std::uint8_t, 8>& setup,
                        std::vector<std::uint8_t> data = {});

  // ---- measured
  std::uint32_t serial_baud() const;  // as UART0 is set up
  double idle_share() const;  // of the CPU's cycles, slept, since the last call of reset_idle()
  void reset_idle();
  std::size_t static_ram_bytes() const;  // .data and .bss
  std::size_t unused_ram_bytes() const;  // between them and the deepest stack so far

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace firmware_sim
