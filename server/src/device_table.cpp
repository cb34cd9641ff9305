#include "device_table.h"

#include <algorithm>

namespace server {

void fill(DeviceTable& table, const std::vector<std::unique_ptr<cabinet::Device>>& devices,
          std::int64_t now_us) {
  table.time_us = now_us;
  table.devices = std::min(devices.size(), table.lines.size());
  for (std::size_t i = 0; i < table.devices; ++i) {
    const cabinet::Device& device = *devices[i];
    DeviceTable::Line& line = table.lines[i];
    line.name = {};
    device.name().copy(line.name.data(), line.name.size() - 1);
    line.state = device.state();
    line.counters = device.counters();
    line.rods = device.rods();
    line.counts = device.counts();
  }
}

wire::Devices to_wire(const DeviceTable& table) {
  wire::Devices out{table.time_us, {}};
  for (std::size_t i = 0; i < table.devices; ++i) {
    const DeviceTable::Line& line = table.lines[i];
    const cabinet::SourceCounters& c = line.counters;
    wire::DeviceReport& device =
        out.devices.emplace_back(wire::DeviceReport{.name = line.name.data(),
                                                    .state = static_cast<std::uint8_t>(line.state),
                                                    .frames = c.frames,
                                                    .lost = c.lost,
                                                    .bad = c.bad,
                                                    .stale = c.stale,
                                                    .reopened = c.reopened,
                                                    .overflows = c.overflows,
                                                    .impossible = c.impossible,
                                                    .line_errors = c.line_errors,
                                                    .stamped = c.stamped,
                                                    .latency_sum_us = c.latency_sum_us,
                                                    .latency_max_us = c.latency_max_us,
                                                    .rods = {}});
    for (std::size_t rod = 0; rod < device.rods.size(); ++rod) {
      const cabinet::RodInput& in = line.rods[rod];
      device.rods[rod] = {static_cast<std::uint8_t>(in.status), line.counts[rod].slide,
                          line.counts[rod].spin, static_cast<float>(in.slide),
                          static_cast<float>(in.angle)};
    }
  }
  return out;
}

}  // namespace server
