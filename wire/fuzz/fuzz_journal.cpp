// Reads arbitrary bytes as a recording, unchanged and with a correct checksum on each record.
// Accepted entries can be recorded again and then read back equal.
#include <cstdlib>

#include "crc32.h"
#include "samples.h"

namespace {

using wire::samples::Bytes;

std::vector<wire::JournalEntry> entries_of(const Bytes& file) {
  wire::JournalReader reader(file);
  std::vector<wire::JournalEntry> entries;
  while (auto entry = reader.next()) entries.push_back(std::move(*entry));
  // After the end, further calls return nothing, and the problem stays the same.
  const std::string problem = reader.problem();
  if (reader.next() || reader.problem() != problem) std::abort();
  return entries;
}

void read(const Bytes& file) {
  const auto once = entries_of(file);
  wire::JournalEncoder encoder;
  Bytes recorded;
  for (const auto& entry : once) {
    if (!encoder.add(entry, recorded)) std::abort();
  }
  encoder.flush(recorded);
  const auto twice = entries_of(recorded);
  if (once.size() != twice.size()) std::abort();
  for (std::size_t i = 0; i < once.size(); ++i) {
    if (!wire::samples::same(once[i], twice[i])) std::abort();
  }
}

void reseal_records(Bytes& file) {
  for (std::size_t at = 0; file.size() - at > 8;) {
    std::size_t size = 0;
    for (std::size_t i = 0; i < 4; ++i) size |= static_cast<std::size_t>(file[at + i]) << 8 * i;
    if (size > file.size() - at - 8) return;
    const std::uint32_t crc = wire::crc32(std::span(file).subspan(at + 8, size));
    for (std::size_t i = 0; i < 4; ++i) file[at + 4 + i] = static_cast<std::byte>(crc >> 8 * i);
    at += 8 + size;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto in = std::as_bytes(std::span(data, size));
  Bytes file(in.begin(), in.end());
  read(file);
  reseal_records(file);
  read(file);
  return 0;
}
