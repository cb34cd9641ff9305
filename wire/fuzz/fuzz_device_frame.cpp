// Reads arbitrary bytes as a device frame, plain (unchanged and with a correct CRC) and in COBS.
// Accepted frames re-encode to the same bits; a frame of version 1 re-encodes as the same frame of
// the current version.
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "wire/device_frame.h"

namespace {

using Octets = std::vector<std::uint8_t>;

void seal(Octets& bytes) {
  wire::device_put16(bytes.data() + 44, wire::device_crc16(bytes.data(), 44));
}

void read_plain(Octets bytes) {
  wire::DeviceFrame frame{};
  if (!wire::decode_device_frame(bytes.data(), bytes.size(), frame)) return;
  Octets again(wire::kDeviceFrameBytes);
  wire::encode_device_frame(frame, again.data());
  if (bytes[0] != wire::kDeviceFrameVersion) {
    bytes[0] = wire::kDeviceFrameVersion;
    seal(bytes);
  }
  if (again != bytes) std::abort();
}

void read_cobs(const Octets& bytes) {
  for (const std::size_t capacity : {std::size_t{0}, wire::kDeviceFrameBytes, bytes.size()}) {
    Octets plain(capacity);
    plain.resize(wire::cobs_decode(bytes.data(), bytes.size(), plain.data(), capacity));
    if (plain.size() > capacity) std::abort();
    read_plain(plain);
  }
}

void there_and_back(const Octets& bytes) {
  if (bytes.size() > 254) return;
  Octets coded(bytes.size() + 2), plain(bytes.size());
  const std::size_t size = wire::cobs_encode(bytes.data(), bytes.size(), coded.data());
  if (size != coded.size() || std::memchr(coded.data(), 0, size - 1) != nullptr) std::abort();
  plain.resize(wire::cobs_decode(coded.data(), size - 1, plain.data(), plain.size()));
  if (plain != bytes) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Octets bytes(data, data + size);
  read_plain(bytes);
  read_cobs(bytes);
  there_and_back(bytes);
  if (size == wire::kDeviceFrameBytes) {
    seal(bytes);
    read_plain(bytes);
  }
  return 0;
}
