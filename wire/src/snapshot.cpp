#include "wire/snapshot.h"

#include <cmath>

#include "codec.h"
#include "layouts.h"
#include "wire/snapshot_description.h"

namespace wire {

Layout snapshot_layout() {
  return list_layout<Snapshot>([](Lister& l, Snapshot& s) { describe_snapshot(l, s); });
}

std::uint32_t snapshot_layout_hash() {
  static const std::uint32_t hash = layout_hash(snapshot_layout());
  return hash;
}

std::size_t encode_snapshot(const Snapshot& snapshot, std::span<std::byte> out) {
  Encoder encoder(out, snapshot_layout_hash());
  describe_snapshot(encoder, snapshot);
  return encoder.finish();
}

bool decode_snapshot(std::span<const std::byte> in, Snapshot& snapshot) {
  Decoder decoder(in, snapshot_layout_hash());
  describe_snapshot(decoder, snapshot);
  return decoder.at_end();
}

double unwrap_angle(double wrapped, double near) {
  constexpr double kLap = 256 * kTurn;
  return near + std::remainder(wrapped - near, kLap);
}

}  // namespace wire
