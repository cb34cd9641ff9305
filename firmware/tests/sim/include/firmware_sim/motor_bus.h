// Simulates eight haptic drivers of the DRV2605 class behind a multiplexer of the TCA9548A class,
// and an expander with a readable byte, on the two wires of an I2C bus (UM10204, fast mode). They
// only see the levels of the wires, and record violations by the controller.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace firmware_sim {

class MotorBus {
 public:
  static constexpr std::uint8_t kMultiplexer = 0x70, kDriver = 0x5A, kExpander = 0x20;

  // ---- connected devices
  bool multiplexer = true;
  std::uint8_t attached = 0xFF;          // bit i: driver i
  std::optional<std::uint8_t> expander;  // its input byte

  // ---- faults
  void hold_data(int clocks) { held_clocks_ = clocks; }  // pulls data low for this many clocks
  bool holds_clock = false;                              // from the next clock on
  std::uint32_t stretch_us = 0;                          // before each acknowledge

  // ---- events
  struct Write {
    std::uint64_t time_ns = 0;
    int rod = 0;
    std::uint8_t address = 0, value = 0;
  };
  const std::vector<Write>& writes() const { return writes_; }              // to the drivers
  const std::vector<std::uint64_t>& reads_ns() const { return reads_ns_; }  // of the expander
  std::uint8_t running(int rod) const { return registers_[static_cast<std::size_t>(rod)][2]; }
  std::uint8_t driver_register(int rod, std::uint8_t address) const {
    return registers_[static_cast<std::size_t>(rod)][address];
  }
  const std::vector<std::string>& violations() const { return violations_; }
  std::uint64_t clocks() const { return clocks_; }

  // ---- wires
  // Sets what the controller pulls low from now on.
  void drive(std::uint64_t now_ns, bool clock_low, bool data_low);
  // When the devices release a stretched clock. Call drive() then, with what the controller pulls
  // low.
  std::optional<std::uint64_t> next_event_ns() const { return stretched_until_ns_; }
  bool pulls_clock() const { return clock_held_ || stretched_until_ns_.has_value(); }
  bool pulls_data() const { return data_low_ || held_clocks_ > 0; }

 private:
  enum class Part { none, multiplexer, driver, expander };

  bool take_step(std::uint64_t now_ns, bool clock_low, bool data_low);
  void on_start(std::uint64_t now_ns);
  void on_stop(std::uint64_t now_ns);
  void on_rise(std::uint64_t now_ns);
  void on_fall(std::uint64_t now_ns);
  bool take_byte(std::uint64_t now_ns);
  bool take_address(std::uint64_t now_ns);
  void require(bool good, const char* what, std::uint64_t now_ns);

  bool master_clock_low_ = false, master_data_low_ = false;
  bool clock_ = true, data_ = true;  // levels of the wires
  bool data_low_ = false, clock_held_ = false;
  int held_clocks_ = 0;
  std::optional<std::uint64_t> stretched_until_ns_;

  bool active_ = false;  // between START and STOP
  bool begun_ = false;   // the clock fell after START
  bool addressed_ = false, sends_ = false;
  Part part_ = Part::none;
  int bit_ = 0;
  std::uint8_t shift_ = 0;
  int bytes_ = 0;
  std::uint8_t pointer_ = 0, channels_ = 0, new_channels_ = 0;

  std::array<std::array<std::uint8_t, 256>, 8> registers_{};
  std::vector<Write> writes_;
  std::vector<std::uint64_t> reads_ns_;
  std::vector<std::string> violations_;
  std::uint64_t clocks_ = 0;
  std::uint64_t rose_ns_ = 0, fell_ns_ = 0, data_ns_ = 0, start_ns_ = 0, stop_ns_ = 0;
};

}  // namespace firmware_sim
