// Shared parts of the command tests in simavr: commands on each board's line, and the motors'
// state.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cabinet_fixture.h"
#include "wire/device_command.h"

namespace firmware_sim {

inline std::string name_of(Board board) {
  return board == Board::mega32u4 ? "Mega32u4" : "Mega2560";
}

// Clocks over the standard's full range, each with its own jitter.
inline CabinetOptions mixed_mice() {
  CabinetOptions options;
  for (std::size_t i = 0; i < kMice; ++i) {
    options.mice[i].clock_hz = std::array{10'000u, 12'500u, 16'700u}[i % 3];
    options.mice[i].jitter_ns = 500;
    options.mice[i].self_test_ms = static_cast<std::uint32_t>(400 + 13 * i);
    options.mice[i].seed = 100 + i;
  }
  return options;
}

inline wire::DeviceCommand pulse_command(int rod, int amplitude, int duration_ms) {
  wire::DeviceCommand command{};
  command.kind = wire::kPulseCommand;
  command.rod = static_cast<std::uint8_t>(rod);
  command.amplitude = static_cast<std::uint8_t>(amplitude);
  command.duration_ms = static_cast<std::uint16_t>(duration_ms);
  return command;
}

inline wire::DeviceCommand settings_command(int brightness, bool pulses = true) {
  wire::DeviceCommand command{};
  command.kind = wire::kSettingsCommand;
  command.resolution = 20;
  command.brightness = static_cast<std::uint8_t>(brightness);
  command.switches = pulses ? 0 : 1;
  return command;
}

using CommandBytes = std::array<std::uint8_t, wire::kDeviceCommandBytes>;

inline CommandBytes bytes_of(const wire::DeviceCommand& command) {
  CommandBytes bytes{};
  wire::encode_device_command(command, bytes.data());
  return bytes;
}

// A board with motors; it encodes commands for the board's line.
class MotorCabinet : public Cabinet {
 public:
  explicit MotorCabinet(Board board, const CabinetOptions& options = {})
      : Cabinet(board, options), board_(board) {}

  void send_bytes(const CommandBytes& bytes) {
    if (board_ == Board::mega32u4) {
      std::array<std::uint8_t, 64> report{};
      std::copy(bytes.begin(), bytes.end(), report.begin());
      sim.send(report);
    } else {
      std::array<std::uint8_t, wire::kDeviceCommandBytes + 2> coded{};
      wire::cobs_encode(bytes.data(), bytes.size(), coded.data());
      sim.send(coded);
    }
  }
  void send(const wire::DeviceCommand& command) { send_bytes(bytes_of(command)); }

  // Advances from power-on until all mice and drivers are set up.
  bool start() {
    if (!wait_for_present(0xFF)) return false;
    const bool set_up = advance_until(
        [this] {
          for (int rod = 0; rod < kMice; ++rod) {
            if (sim.motors().attached >> rod & 1 && sim.motors().driver_register(rod, 1) != 5)
              return false;
          }
          return true;
        },
        2000);
    sim.advance_us(10'000);
    take();
    return set_up;
  }

  // Time of the first write of this value to the rod's playback register at or after from_us.
  std::optional<std::uint64_t> written_us(int rod, int value, std::uint64_t from_us) {
    for (const MotorBus::Write& write : sim.motors().writes()) {
      if (write.rod == rod && write.address == 2 && write.value == value &&
          write.time_ns / 1000 >= from_us)
        return write.time_ns / 1000;
    }
    return std::nullopt;
  }

  // Checks for misuse of the bus and the EEPROM.
  void expect_no_fault() {
    EXPECT_EQ(sim.motors().violations(), std::vector<std::string>{});
    EXPECT_FALSE(sim.drove_high());
    EXPECT_FALSE(sim.eeprom_misused());
    EXPECT_EQ(sim.serial_overruns(), 0);
  }

 private:
  Board board_;
};

// Moves all mice all the time, by counts drawn with a fixed seed.
class Shaker {
 public:
  void step(CabinetSim& sim) {
    for (int rod = 0; rod < kMice; ++rod) {
      moved.move(sim, rod, static_cast<int>(random_() % 81) - 40,
                 static_cast<int>(random_() % 81) - 40);
    }
    sim.advance_us(1000);
  }
  Moved moved;

 private:
  std::mt19937 random_{7};
};

}  // namespace firmware_sim
