// Reads arbitrary bytes as a device command, unchanged and with a correct CRC. Accepted commands
// are in range and re-encode to the same bits.
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "wire/device_command.h"

namespace {

using Octets = std::vector<std::uint8_t>;

void read(const Octets& bytes) {
  wire::DeviceCommand command{};
  if (!wire::decode_device_command(bytes.data(), bytes.size(), command)) return;
  if (!wire::valid_device_command(command)) std::abort();
  Octets again(wire::kDeviceCommandBytes);
  wire::encode_device_command(command, again.data());
  if (again != bytes) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Octets bytes(data, data + size);
  read(bytes);
  if (size == wire::kDeviceCommandBytes) {
    wire::device_put16(bytes.data() + 14, wire::device_crc16(bytes.data(), 14));
    read(bytes);
  }
  return 0;
}
