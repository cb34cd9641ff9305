// A C++ interface to simavr: one micro-controller with its firmware, two ports as open-drain buses,
// and features that simavr lacks: EEPROM write time, the signature row, pins that keep their levels
// through a reset.
#pragma once

#include <simavr/sim_avr.h>

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

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

  // Lines that external devices leave high, and lines that the firmware pulls low.
  void set_clock(int bit, bool high) { set_line(clock_, bit, high); }
  void set_data(int bit, bool high) { set_line(data_, bit, high); }
  std::uint8_t clock_pulled() const { return pulled(clock_); }
  std::uint8_t data_pulled() const { return pulled(data_); }

  // Any port, with the lines that are pulled up externally.
  avr_ioport_t* find_port(char name);
  void pull_up(avr_ioport_t* port, std::uint8_t mask);
  void set_line(avr_ioport_t* port, int bit, bool high);
  std::uint8_t pulled(const avr_ioport_t* port) const;
  std::uint8_t driven_high(const avr_ioport_t* port) const;

  avr_uart_t* uart(char name);
  std::uint8_t memory(std::uint16_t address) const { return avr_->data[address]; }

  // ---- EEPROM
  void set_eeprom(const std::vector<std::uint8_t>& bytes);
  std::vector<std::uint8_t> eeprom() const;
  std::uint64_t eeprom_writes() const { return eeprom_writes_; }
  bool eeprom_misused() const { return eeprom_misused_; }  // accessed during a write

  std::array<std::uint8_t, 32> signature_row{};

  // ---- watchdog resets
  // Puts a jump to itself at the program counter; the reset restores the code.
  void stick(bool interrupts_off);
  int resets() const { return resets_; }
  // simavr drops all pending timers at a reset: called after each one.
  std::function<void()> on_reset;

  std::uint64_t slept_cycles() const { return slept_; }
  std::size_t static_ram_bytes() const { return static_ram_; }
  std::size_t unused_ram_bytes() const;

 private:
  void after_reset();
  static void sleep(avr_t* avr, avr_cycle_count_t cycles);
  static void reset(avr_t* avr);
  static void on_eeprom(avr_t* avr, avr_io_addr_t address, std::uint8_t value, void* parameter);
  static avr_cycle_count_t on_eeprom_written(avr_t* avr, avr_cycle_count_t when, void* parameter);
  static void on_flash_control(avr_t* avr, avr_io_addr_t address, std::uint8_t value,
                               void* parameter);
  static void on_watchdog_interrupt(avr_irq_t* irq, std::uint32_t value, void* parameter);
  static avr_cycle_count_t on_watchdog_not_served(avr_t* avr, avr_cycle_count_t when,
                                                  void* parameter);
  static std::uint8_t on_serial_status_read(avr_t* avr, avr_io_addr_t address, void* parameter);
  static avr_cycle_count_t on_signature_read(avr_t* avr, avr_cycle_count_t when, void* parameter);

  avr_t* avr_ = nullptr;
  avr_ioport_t* clock_ = nullptr;
  avr_ioport_t* data_ = nullptr;
  std::uint64_t slept_ = 0;
  std::size_t static_ram_ = 0;
  std::size_t ram_end_of_static_ = 0;

  bool eeprom_busy_ = false, eeprom_misused_ = false;
  std::uint64_t eeprom_writes_ = 0;
  std::optional<std::array<std::uint8_t, 32>> flash_behind_signature_;
  avr_uart_t* uart_ = nullptr;  // null: none
  avr_io_read_t chip_reads_serial_status_ = nullptr;
  void (*chip_reset_)(avr_t*) = nullptr;
  bool was_reset_ = false;
  int resets_ = 0;
  std::optional<std::uint32_t> stuck_at_;
  std::array<std::uint8_t, 2> flash_where_stuck_{};
};

}  // namespace firmware_sim
