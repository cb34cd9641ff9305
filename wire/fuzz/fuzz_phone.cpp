// Reads arbitrary bytes as a phone's message and as a reply to it. Accepted messages re-encode to
// the same bits.
#include <cstdint>
#include <cstdlib>

#include "samples.h"

namespace {

template <class Message>
void read(const wire::samples::Bytes& bytes) {
  Message once, twice;
  if (!wire::decode_phone(bytes, once)) return;
  if (wire::samples::encoded(once) != bytes) std::abort();
  if (!wire::decode_phone(wire::samples::encoded(once), twice)) std::abort();
  if (!wire::samples::same(once, twice)) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto in = std::as_bytes(std::span(data, size));
  const wire::samples::Bytes bytes(in.begin(), in.end());
  read<wire::PhoneRequest>(bytes);
  read<wire::PhoneReply>(bytes);
  return 0;
}
