// Reads arbitrary bytes as an input datagram, unchanged and with a correct checksum. Accepted
// datagrams re-encode to the same bits.
#include <cstdlib>

#include "datagram.h"

namespace {

void read(const wire::samples::Bytes& bytes) {
  wire::InputDatagram once, twice;
  if (!wire::decode_input(bytes, once)) return;
  if (wire::samples::encoded(once) != bytes) std::abort();
  if (!wire::decode_input(wire::samples::encoded(once), twice)) std::abort();
  if (!wire::samples::same(once, twice)) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return read_as_is_and_sealed(data, size, read);
}
