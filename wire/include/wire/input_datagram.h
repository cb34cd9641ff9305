// Rod positions from a client (mouse, keys, gamepad) to the server: one UDP datagram per change,
// and at least 20 per second. Positions are absolute, so that a lost datagram loses no motion.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace wire {

inline constexpr std::size_t kMaxInputDatagram = 160;

struct InputRod {
  bool driven = false;
  float slide = 0;                       // [m]
  double angle = 0;                      // [rad], full revolutions count; wraps at 65536
  float slide_rate = 0, angle_rate = 0;  // [m/s], [rad/s]
};

struct InputDatagram {
  std::uint64_t session = 0;   // the server's, from Welcome
  std::uint64_t token = 0;     // the client's own secret, from Welcome
  std::uint32_t sequence = 0;  // older ones are dropped
  std::array<InputRod, 8> rods{};
};

// Writes one datagram. Returns its size, or 0 if out is too small. Clamps values to their field's
// range; values that are not finite become 0. out: kMaxInputDatagram bytes.
std::size_t encode_input(const InputDatagram& input, std::span<std::byte> out);
// Returns false unless magic, version, layout hash, every range, the exact length and the checksum
// are valid; input is then unspecified but valid.
bool decode_input(std::span<const std::byte> in, InputDatagram& input);

std::uint32_t input_layout_hash();

}  // namespace wire
