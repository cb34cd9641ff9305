// A controller of the cabinet: its firmware in a simulator, eight simulated sensors and eight
// motors on its pins, and a PC at the other end of its cable. The time is the simulator's, and
// passes only in advance().
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "cabinet/device_source.h"
#include "cabinet/rod_input.h"

namespace cabinet_bench {

enum class Board { mega32u4, mega2560, rp2040 };
inline constexpr std::array kBoards{Board::mega32u4, Board::mega2560, Board::rp2040};
std::string name_of(Board board);
std::optional<Board> board_named(const std::string& name);
// Of the sensors that the documentation recommends for it [counts/mm].
double usual_counts_per_mm(Board board);

template <class T>
using PerRod = std::array<T, cabinet::kRods>;

// Motion of the surface under a sensor since power-on [counts]; real, the sensor reports integers.
struct Surface {
  double slide = 0, spin = 0;
};

struct Packet {
  std::int64_t time_us;  // when the PC had received all of it
  std::vector<std::uint8_t> bytes;
};
struct MotorWrite {  // the register of a motor's driver
  std::int64_t time_us;
  int rod, amplitude;
};
// Accumulated integer counts that a sensor has reported from power-on to its last report.
struct Told {
  std::int64_t time_us;
  std::int64_t slide, spin;
};

class Controller {
 public:
  virtual ~Controller() = default;

  // Advances by one millisecond, in which the surfaces move uniformly to `to`. Throws
  // std::runtime_error if the firmware crashes.
  virtual void advance(const PerRod<Surface>& to) = 0;
  // From now on: one bit for each rod whose index mark is under its switch. Before the first call
  // no expander is attached.
  virtual void show_marks(std::uint8_t under) = 0;
  virtual std::int64_t now_us() const = 0;
  virtual cabinet::DeviceFraming framing() const = 0;
  // The packets that the PC received since the last call, oldest first.
  virtual std::vector<Packet> take_packets() = 0;

  // ---- motors
  // A packet from the PC, as cabinet::DeviceSource::send() writes it to the line.
  virtual void command(std::span<const std::uint8_t> packet) = 0;
  virtual std::vector<MotorWrite> take_motor_writes() = 0;

  // ---- troubles
  // The reports of the rod's sensor since the last call, oldest first.
  virtual std::vector<Told> take_told(int rod) = 0;
  // Injects a fault at the rod's sensor or at the controller, and returns its name. Empty: not now.
  virtual std::string trouble(int rod, std::mt19937& random) = 0;
};

// Powered on just now. Throws std::runtime_error if a part of the simulator is missing.
std::unique_ptr<Controller> power_on(Board board);

std::unique_ptr<Controller> power_on_avr(Board board);
std::unique_ptr<Controller> power_on_rp2040();

}  // namespace cabinet_bench
