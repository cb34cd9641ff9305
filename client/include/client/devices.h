// The input devices of a client. Each belongs to one person; one person may use several.
#pragma once

#include <cstdint>

namespace client {

inline constexpr int kPads = 4;

enum class Device : std::uint8_t {
  mouse,
  keys_1,  // the first key of each action: arrows
  keys_2,  // the second key: WASD
  pad_1,
  pad_2,
  pad_3,
  pad_4,
};
inline constexpr int kDevices = 7;
using DeviceSet = std::uint8_t;  // by bit
inline constexpr DeviceSet kAllDevices = (1u << kDevices) - 1;

constexpr DeviceSet bit_of(Device device) {
  return static_cast<DeviceSet>(1u << static_cast<unsigned>(device));
}
constexpr Device pad_device(int pad) {
  return static_cast<Device>(static_cast<int>(Device::pad_1) + pad);
}

}  // namespace client
