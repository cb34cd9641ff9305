// Reads arbitrary bytes as a snapshot, unchanged and with a correct checksum. Accepted snapshots
// re-encode to an equal snapshot.
#include <cstdlib>

#include "datagram.h"

namespace {

void read(const wire::samples::Bytes& bytes) {
  wire::Snapshot once, twice;
  if (!wire::decode_snapshot(bytes, once)) return;
  if (!wire::decode_snapshot(wire::samples::encoded(once), twice)) std::abort();
  if (!wire::samples::same_but_for_ties(once, twice)) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return read_as_is_and_sealed(data, size, read);
}
