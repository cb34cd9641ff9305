// The state of this machine's controllers and mice, for a host's screen. The tick is only asked
// while a host requests it.
#include <sys/eventfd.h>

#include <utility>

#include "control_server.h"
#include "os/clock.h"

namespace server {

void ControlServer::report_devices(const DeviceTable& table) {
  devices_asked_.store(false, std::memory_order_relaxed);
  if (devices_.push(DeviceTable(table))) ::eventfd_write(wake_.get(), 1);
}

// For hosts only: other clients have no need to know the machine's devices.
void ControlServer::take_device_query(ControlConnection& connection) {
  const Seat* seat = seats_.find(connection.client);
  const bool may = seat != nullptr && seat->role == wire::Role::host;
  if (!may || !connection.device_queries.take(os::monotonic_us())) {
    count(Count::requests_dropped);
    return;
  }
  connection.awaits_devices = true;
  devices_asked_.store(true, std::memory_order_release);
}

void ControlServer::publish_devices() {
  while (devices_.pop(device_table_)) {
    const wire::Devices devices = to_wire(device_table_);
    for (auto& connection : connections_) {
      if (connection->state == ControlConnection::State::joined &&
          std::exchange(connection->awaits_devices, false))
        send(*connection, devices);
    }
  }
}

}  // namespace server
