// Reads a control stream in chunks of a size given by the first byte. The messages do not depend on
// the chunk size, and each can be encoded again.
#include <cstdlib>

#include "samples.h"

namespace {

using Status = wire::ControlReader::Status;

struct Outcome {
  std::vector<wire::ControlMessage> messages;
  Status last = Status::need_more;
};

Outcome read(std::span<const std::byte> stream, std::size_t chunk) {
  wire::ControlReader reader;
  Outcome outcome;
  while (!stream.empty()) {
    const std::size_t size = std::min(chunk, stream.size());
    reader.push(stream.first(size));
    stream = stream.subspan(size);
    wire::ControlMessage message;
    while ((outcome.last = reader.next(message)) == Status::message) {
      outcome.messages.push_back(message);
    }
  }
  return outcome;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto stream = std::as_bytes(std::span(data, size)).subspan(1);
  const Outcome whole = read(stream, stream.size());
  const Outcome parts = read(stream, std::size_t{1} + data[0] % 64);
  if (whole.last != parts.last || whole.messages.size() != parts.messages.size()) std::abort();
  for (std::size_t i = 0; i < whole.messages.size(); ++i) {
    if (!wire::samples::same(whole.messages[i], parts.messages[i])) std::abort();
    const auto sent = wire::samples::encoded(whole.messages[i]);
    const Outcome again = read(sent, sent.size());
    if (again.messages.size() != 1) std::abort();
    if (!wire::samples::same(again.messages[0], whole.messages[i])) std::abort();
  }
  return 0;
}
