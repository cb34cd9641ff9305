// Endpoints 5 and 6 of the ATmega32U4, which simavr lacks, and a notification when the firmware
// detaches from the bus, which simavr does not give.
#pragma once

#include <simavr/sim_avr.h>

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "usb_host.h"

namespace firmware_sim {

// Interrupt IN endpoints with one bank.
class MoreEndpoints {
 public:
  static constexpr int kFirst = 5, kCount = 2;

  // Intercepts simavr's own registers from now on.
  explicit MoreEndpoints(avr_t* avr);
  MoreEndpoints(const MoreEndpoints&) = delete;
  MoreEndpoints& operator=(const MoreEndpoints&) = delete;

  std::function<void()> on_detach;
  void reset();  // of the bus or the chip
  // A host's read from one of these endpoints.
  UsbBus::Answer read(int endpoint, std::vector<std::uint8_t>& out);
  // Violations of the data sheet.
  const std::vector<std::string>& violations() const { return violations_; }

 private:
  struct Endpoint {
    bool enabled = false, allocated = false, stalled = false;
    bool free = false;  // the program owns the bank
    std::size_t size = 0;
    std::vector<std::uint8_t> bank;
  };
  // simavr's handlers of one register.
  struct Chip {
    avr_io_write_t write = nullptr;
    void* write_parameter = nullptr;
    avr_io_read_t read = nullptr;
    void* read_parameter = nullptr;
  };

  Endpoint* chosen(const avr_t* avr);
  void take(Endpoint& endpoint, std::uint16_t address, std::uint8_t value);
  static void on_write(avr_t* avr, avr_io_addr_t address, std::uint8_t value, void* parameter);
  static std::uint8_t on_read(avr_t* avr, avr_io_addr_t address, void* parameter);

  std::array<Endpoint, kCount> endpoints_;
  std::array<Chip, 32> chip_{};
  std::vector<std::string> violations_;
};

}  // namespace firmware_sim
