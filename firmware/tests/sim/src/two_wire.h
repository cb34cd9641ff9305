// The two-wire interface of an ATmega2560 as a controller on wires (data sheet, chapter 24).
// simavr's own version works on messages, without a bit rate, and has no devices that hold a line.
#pragma once

#include <simavr/sim_avr.h>

#include <cstdint>
#include <functional>

extern "C" {
struct avr_twi_t;
}

namespace firmware_sim {

class TwoWire {
 public:
  struct Wires {
    std::function<void()> changed;      // called when the lines pulled low change
    std::function<bool()> clock, data;  // levels of the wires
  };
  // Replaces simavr's version. present() is false if the chip has none.
  TwoWire(avr_t* avr, Wires wires);
  TwoWire(const TwoWire&) = delete;
  TwoWire& operator=(const TwoWire&) = delete;

  bool present() const { return twi_ != nullptr; }
  void reset();  // of the chip, which drops pending timers
  bool clock_low() const { return clock_low_; }
  bool data_low() const { return data_low_; }

 private:
  enum class Doing { nothing, start, byte, stop };

  static void on_control(avr_t* avr, avr_io_addr_t address, std::uint8_t value, void* parameter);
  static avr_cycle_count_t on_time(avr_t* avr, avr_cycle_count_t when, void* parameter);

  std::uint8_t& control() const;
  std::uint64_t half() const;  // half a clock period [cycles]
  void begin(std::uint8_t value);
  void begin_byte();
  void drive(bool clock_low, bool data_low);
  void release();
  void done(std::uint8_t status);
  // Each advances one step and returns the cycles until the next one; 0: finished.
  std::uint64_t step();
  std::uint64_t step_start();
  std::uint64_t step_byte();
  std::uint64_t step_stop();
  std::uint8_t status_of_byte() const;

  avr_t* avr_;
  avr_twi_t* twi_ = nullptr;
  Wires wires_;
  bool clock_low_ = false, data_low_ = false;
  Doing doing_ = Doing::nothing;
  int phase_ = 0;
  bool owns_bus_ = false;
  bool addressed_ = false, reading_ = false;   // after START
  bool sends_ = false, acknowledges_ = false;  // of the current byte
  int bit_ = 0;
  std::uint8_t shift_ = 0;
  bool acknowledged_ = false;
};

}  // namespace firmware_sim
