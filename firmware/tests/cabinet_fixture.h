// Shared parts of the firmware tests in simavr: waiting for events, moving all mice, reading
// frames.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "firmware_sim/cabinet_sim.h"
#include "wire/device_frame.h"
#include "wire/device_settings.h"

namespace firmware_sim {

struct Frames {
  std::vector<wire::DeviceFrame> good;
  std::vector<wire::SettingsReport> settings;
  int bad = 0;

  const wire::DeviceFrame& last() const { return good.back(); }
  unsigned errors() const {
    unsigned sum = 0;
    for (const wire::DeviceFrame& frame : good) sum += frame.quality;
    return sum;
  }
  bool resynchronised() const {
    for (const wire::DeviceFrame& frame : good) {
      if ((frame.flags & 1) != 0) return true;
    }
    return false;
  }
  std::uint8_t overflow() const {
    unsigned seen = 0;
    for (const wire::DeviceFrame& frame : good) seen |= frame.overflow;
    return static_cast<std::uint8_t>(seen);
  }
};

// A board with eight mice and all frames it sends, decoded.
class Cabinet {
 public:
  explicit Cabinet(Board board, const CabinetOptions& options = {})
      : sim(board, options), board_(board) {}

  // The frames since the last call.
  Frames take() {
    Frames frames;
    if (board_ == Board::mega32u4) {
      for (const Report& report : sim.take_reports())
        add(report.bytes.data(), wire::kDeviceFrameBytes, frames);
    } else {
      take_serial(frames);
    }
    if (!frames.good.empty()) last_ = frames.last();
    return frames;
  }

  // Advances until done() holds; fails the test after limit_ms.
  bool advance_until(const std::function<bool()>& done, int limit_ms) {
    for (int ms = 0; ms < limit_ms; ++ms) {
      if (done()) return true;
      sim.advance_us(1000);
    }
    return done();
  }

  // Advances until a frame reports exactly the mice of the mask, and none is still being enabled.
  bool wait_for_present(unsigned mask, int limit_ms = 3000) {
    return advance_until(
        [&] {
          take();
          return last_.present == mask;
        },
        limit_ms);
  }

  // Advances until all movement has been sent and a later frame has arrived.
  bool settle() {
    const bool settled = advance_until(
        [&] {
          for (int rod = 0; rod < kMice; ++rod) {
            if (sim.mouse(rod).enabled() && !sim.mouse(rod).settled()) return false;
          }
          return true;
        },
        5000);
    sim.advance_us(20'000);
    return settled;
  }

  const wire::DeviceFrame& last() const { return last_; }

  CabinetSim sim;

 private:
  static void add(const std::uint8_t* bytes, std::size_t size, Frames& frames) {
    wire::DeviceFrame frame{};
    wire::SettingsReport settings;
    if (wire::decode_device_frame(bytes, size, frame)) {
      frames.good.push_back(frame);
    } else if (wire::decode_settings_report(bytes, size, settings)) {
      frames.settings.push_back(settings);
    } else {
      ++frames.bad;
    }
  }

  void take_serial(Frames& frames) {
    for (const std::uint8_t byte : sim.take_serial()) {
      if (byte != 0) {
        pending_.push_back(byte);
        continue;
      }
      std::array<std::uint8_t, 64> decoded{};
      const std::size_t size =
          wire::cobs_decode(pending_.data(), pending_.size(), decoded.data(), decoded.size());
      add(decoded.data(), size, frames);
      pending_.clear();
    }
  }

  Board board_;
  std::vector<std::uint8_t> pending_;
  wire::DeviceFrame last_{};
};

// Expected counts of the mice in the frame's format: 16 bits that wrap.
struct Moved {
  std::array<std::uint16_t, kMice> slide{}, spin{};

  void move(CabinetSim& sim, int rod, int slide_counts, int spin_counts) {
    const auto i = static_cast<std::size_t>(rod);
    sim.mouse(rod).move(slide_counts, spin_counts);
    slide[i] = static_cast<std::uint16_t>(slide[i] + slide_counts);
    spin[i] = static_cast<std::uint16_t>(spin[i] + spin_counts);
  }
};

inline void expect_counts(const wire::DeviceFrame& frame, const Moved& moved) {
  for (std::size_t i = 0; i < kMice; ++i) {
    EXPECT_EQ(frame.slide[i], moved.slide[i]) << "rod " << i;
    EXPECT_EQ(frame.spin[i], moved.spin[i]) << "rod " << i;
  }
}

}  // namespace firmware_sim
