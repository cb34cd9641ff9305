// The current state of the server's devices, for a host's screen. The tick fills it without
// allocating; the control thread makes a message of it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "cabinet/device.h"
#include "wire/control.h"

namespace server {

struct DeviceTable {
  struct Line {
    std::array<char, wire::kMaxName + 1> name{};  // zero-terminated
    cabinet::DeviceState state = cabinet::DeviceState::missing;
    cabinet::SourceCounters counters;
    cabinet::RodInputs rods{};
    cabinet::RodCounts counts{};
  };
  std::int64_t time_us = 0;
  std::size_t devices = 0;
  std::array<Line, wire::kMaxDevices> lines;
};

// Uses the first kMaxDevices devices.
void fill(DeviceTable& table, const std::vector<std::unique_ptr<cabinet::Device>>& devices,
          std::int64_t now_us);
wire::Devices to_wire(const DeviceTable& table);

}  // namespace server
