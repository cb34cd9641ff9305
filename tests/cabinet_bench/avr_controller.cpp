// The two AVR controllers in simavr, with PS/2 mice.
#include <algorithm>
#include <cmath>

#include "controller.h"
#include "firmware_sim/cabinet_sim.h"

namespace cabinet_bench {
namespace {

using firmware_sim::CabinetSim;
using firmware_sim::SimMouse;

// Bytes of a serial line have no time stamps: they are polled at this interval.
constexpr std::uint64_t kSliceUs = 250;
constexpr std::uint8_t kPlayback = 0x02;  // the driver's register that sets the motor's amplitude

// Mice differ in clock rate, reply time, and in how they report an overflow.
firmware_sim::MouseOptions drawn_mouse(std::mt19937& random) {
  const auto between = [&](std::uint32_t low, std::uint32_t high) {
    return std::uniform_int_distribution<std::uint32_t>(low, high)(random);
  };
  firmware_sim::MouseOptions mouse;
  mouse.clock_hz = between(10'500, 16'500);
  mouse.jitter_ns = 500;
  mouse.byte_gap_us = between(60, 200);
  mouse.reply_us = between(150, 600);
  mouse.self_test_ms = between(300, 700);
  mouse.splits_overflow = between(0, 1) == 0;
  mouse.seed = random();
  return mouse;
}

firmware_sim::CabinetOptions drawn_cabinet() {
  std::mt19937 random(77);
  firmware_sim::CabinetOptions options;
  for (firmware_sim::MouseOptions& mouse : options.mice) {
    mouse = drawn_mouse(random);
    mouse.splits_overflow = true;
  }
  return options;
}

class AvrController final : public Controller {
 public:
  explicit AvrController(Board board)
      : board_(board),
        sim_(board == Board::mega32u4 ? firmware_sim::Board::mega32u4
                                      : firmware_sim::Board::mega2560,
             drawn_cabinet()) {
    for (int rod = 0; rod < cabinet::kRods; ++rod) {
      sim_.mouse(rod).follow([this, rod](std::uint64_t now_ns) { return passed(rod, now_ns); });
    }
  }

  void advance(const PerRod<Surface>& to) override {
    from_ = to_;
    to_ = to;
    began_us_ = now_us();
    for (std::uint64_t us = 0; us < 1000; us += kSliceUs) {
      plug_in_due();
      sim_.advance_us(kSliceUs);
      take_serial();
    }
    for (int rod = 0; rod < cabinet::kRods; ++rod) note_told(rod);
  }
  void show_marks(std::uint8_t under) override {
    sim_.motors().expander = static_cast<std::uint8_t>(~under);
  }
  std::int64_t now_us() const override { return static_cast<std::int64_t>(sim_.now_us()); }
  cabinet::DeviceFraming framing() const override {
    return board_ == Board::mega32u4 ? cabinet::DeviceFraming::report
                                     : cabinet::DeviceFraming::cobs;
  }
  std::vector<Packet> take_packets() override {
    if (board_ == Board::mega32u4) {
      for (const firmware_sim::Report& report : sim_.take_reports()) {
        packets_.push_back({static_cast<std::int64_t>(report.time_us),
                            {report.bytes.begin(), report.bytes.end()}});
      }
    }
    return std::exchange(packets_, {});
  }

  void command(std::span<const std::uint8_t> packet) override {
    sim_.send(board_ == Board::mega32u4 ? packet.subspan(1) : packet);  // no report number
  }
  std::vector<MotorWrite> take_motor_writes() override {
    std::vector<MotorWrite> fresh;
    const auto& writes = sim_.motors().writes();
    for (; writes_ < writes.size(); ++writes_) {
      const firmware_sim::MotorBus::Write& write = writes[writes_];
      if (write.address != kPlayback) continue;
      fresh.push_back({static_cast<std::int64_t>(write.time_ns / 1000), write.rod, write.value});
    }
    return fresh;
  }

  std::vector<Told> take_told(int rod) override {
    return std::exchange(sensors_[static_cast<std::size_t>(rod)].told, {});
  }
  std::string trouble(int rod, std::mt19937& random) override;

 private:
  struct Sensor {
    std::int64_t slide = 0, spin = 0;  // requested by the mouse
    bool enabled = false;
    std::uint64_t packets = 0;
    std::vector<Told> told;
    std::int64_t plug_in_us = 0;  // 0: it is plugged in
  };
  Sensor& sensor(int rod) { return sensors_[static_cast<std::size_t>(rod)]; }

  SimMouse::Counts passed(int rod, std::uint64_t now_ns) {
    const auto i = static_cast<std::size_t>(rod);
    const double part = std::clamp(
        (static_cast<double>(now_ns) * 1e-3 - static_cast<double>(began_us_)) * 1e-3, 0.0, 1.0);
    const auto whole = [part](double from, double to) {
      return static_cast<std::int64_t>(std::floor(std::lerp(from, to, part)));
    };
    const std::int64_t slide = whole(from_[i].slide, to_[i].slide),
                       spin = whole(from_[i].spin, to_[i].spin);
    return {static_cast<int>(slide - std::exchange(sensor(rod).slide, slide)),
            static_cast<int>(spin - std::exchange(sensor(rod).spin, spin))};
  }
  void note_told(int rod) {
    const SimMouse& mouse = sim_.mouse(rod);
    Sensor& s = sensor(rod);
    const bool begins = mouse.enabled() && !std::exchange(s.enabled, mouse.enabled());
    s.enabled = mouse.enabled();
    const bool spoke = std::exchange(s.packets, mouse.packets_sent()) != mouse.packets_sent();
    if (!begins && !spoke) return;
    const SimMouse::Counts unsent = mouse.unsent();
    s.told.push_back({spoke ? static_cast<std::int64_t>(mouse.last_packet_us()) : now_us(),
                      s.slide - unsent.slide, s.spin - unsent.spin});
  }
  void take_serial() {
    if (board_ == Board::mega32u4) return;
    auto bytes = sim_.take_serial();
    if (!bytes.empty()) packets_.push_back({now_us(), std::move(bytes)});
  }
  void plug_in_due() {
    for (int rod = 0; rod < cabinet::kRods; ++rod) {
      Sensor& s = sensor(rod);
      if (s.plug_in_us == 0 || now_us() < s.plug_in_us) continue;
      s.plug_in_us = 0;
      sim_.mouse(rod).replug();
    }
  }

  Board board_;
  CabinetSim sim_;
  PerRod<Surface> from_{}, to_{};
  std::int64_t began_us_ = 0;
  PerRod<Sensor> sensors_{};
  std::vector<Packet> packets_;
  std::size_t writes_ = 0;  // number of motor writes taken
};

std::string AvrController::trouble(int rod, std::mt19937& random) {
  SimMouse& mouse = sim_.mouse(rod);
  if (sensor(rod).plug_in_us != 0) return {};
  const auto below = [&](std::uint32_t n) {
    return std::uniform_int_distribution<std::uint32_t>(0, n - 1)(random);
  };
  const auto bit = [&] { return static_cast<int>(below(11)); };
  const auto unplug = [&](std::int64_t away_us) {
    mouse.unplug();
    sensor(rod).plug_in_us = now_us() + away_us;
  };
  switch (below(15)) {
    case 0:
      mouse.flip_parity();
      return "wrong parity";
    case 1:
      mouse.drop_stop();
      return "no stop bit";
    case 2:
      mouse.skip_clock(bit());
      return "clock lost";
    case 3:
      mouse.lose_byte();
      return "byte lost";
    case 4:
      mouse.stretch_clock(bit(), 20 + below(180));
      return "clock stretched, by less than a gap";
    case 5:
      mouse.stretch_clock(bit(), 350 + below(2000));
      return "clock stretched, to a gap";
    case 6:
      mouse.spike(200 + below(600));
      return "glitch, too short for an edge";
    case 7:
      mouse.spike(25'000 + below(50'000));
      return "glitch between bytes";
    case 8:
      mouse.glitch_clock(bit(), 21'000 + below(15'000));
      return "glitch within a byte";
    case 9:
      unplug(5'000 + below(40'000));
      return "plug that jumps";
    case 10:
      mouse.lose_announcement();
      unplug(5'000 + below(40'000));
      return "plug that jumps, and the mouse does not say so";
    case 11:
      mouse.misread_command();
      unplug(5'000 + below(40'000));
      return "plug that jumps, then a command that is misread";
    case 12:
      unplug(300'000 + below(1'500'000));
      return "unplugged";
    case 13:
      sim_.stick_program(below(2) == 0);
      return "a program that hangs, until the watchdog's reset";
    default:
      mouse.set_options(drawn_mouse(random));
      unplug(400'000 + below(1'500'000));
      return "replaced";
  }
}

}  // namespace

std::unique_ptr<Controller> power_on_avr(Board board) {
  return std::make_unique<AvrController>(board);
}

}  // namespace cabinet_bench
