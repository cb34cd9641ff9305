// Reads arbitrary bytes as a controller's settings report, unchanged and with a correct CRC.
// Accepted reports re-encode to the same bits.
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "wire/device_settings.h"

namespace {

using Octets = std::vector<std::uint8_t>;

void read(const Octets& bytes) {
  wire::SettingsReport report;
  if (!wire::decode_settings_report(bytes.data(), bytes.size(), report)) return;
  Octets again(wire::kDeviceFrameBytes);
  wire::encode_settings_report(report.settings, report.abilities, report.sequence, again.data());
  if (again != bytes) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Octets bytes(data, data + size);
  read(bytes);
  if (size == wire::kDeviceFrameBytes) {
    wire::device_put16(bytes.data() + 44, wire::device_crc16(bytes.data(), 44));
    read(bytes);
  }
  return 0;
}
