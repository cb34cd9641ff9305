// simavr behind a C++ face: one micro-controller with its firmware, two ports as open-drain buses.
#pragma once

#include <simavr/sim_avr.h>

#include <cstdint>
#include <functional>
#include <string>

extern "C" {
struct avr_ioport_t;
struct avr_uart_t;
}

namespace firmware_sim {

class AvrBoard {
 public:
  static constexpr std::uint64_t kHz = 16'000'000;
  static constexpr std::uint64_t kCyclesPerUs = kHz / 1'000'000;

  AvrBoard(const std::string& elf, const char* mcu, char clock_port, char data_port);
  ~AvrBoard();
  AvrBoard(const AvrBoard&) = delete;
  AvrBoard& operator=(const AvrBoard&) = delete;

  avr_t* avr() { return avr_; }
  std::uint64_t cycle() const { return avr_->cycle; }
  void run_until(std::uint64_t cycle);

  // What the outside lets be high, and what the firmware pulls low.
  void set_clock(int bit, bool high) { set_line(clock_, bit, high); }
  void set_data(int bit, bool high) { set_line(data_, bit, high); }
  std::uint8_t clock_pulled() const { return pulled(clock_); }
  std::uint8_t data_pulled() const { return pulled(data_); }

  avr_uart_t* uart(char name);

  std::uint64_t slept_cycles() const { return slept_; }
  std::size_t static_ram_bytes() const { return static_ram_; }
  std::size_t unused_ram_bytes() const;

 private:
  avr_ioport_t* find_port(char name);
  void set_line(avr_ioport_t* port, int bit, bool high);
  std::uint8_t pulled(const avr_ioport_t* port) const;
  static void sleep(avr_t* avr, avr_cycle_count_t cycles);

  avr_t* avr_ = nullptr;
  avr_ioport_t* clock_ = nullptr;
  avr_ioport_t* data_ = nullptr;
  std::uint64_t slept_ = 0;
  std::size_t static_ram_ = 0;
  std::size_t ram_end_of_static_ = 0;
};

}  // namespace firmware_sim
