#include "seeds.h"

#include <algorithm>

namespace wire::samples {
namespace {

// fuzz_control takes its chunk size from the first byte.
Bytes chunked(unsigned char chunk, const Bytes& stream) {
  Bytes bytes(stream.size() + 1);
  bytes[0] = static_cast<std::byte>(chunk);
  std::ranges::copy(stream, bytes.begin() + 1);
  return bytes;
}

}  // namespace

std::vector<Seed> seeds() {
  std::mt19937_64 random(1);
  std::vector<Seed> all{
      {"fuzz_snapshot", "golden", encoded(snapshot())},
      {"fuzz_snapshot", "empty", encoded(Snapshot{})},
      {"fuzz_snapshot", "full", encoded(random_snapshot(random, true))},
      {"fuzz_input", "golden", encoded(input())},
      {"fuzz_input", "random", encoded(random_input(random))},
      {"fuzz_journal", "golden", encoded(journal())},
      {"fuzz_journal", "cut", encoded({JournalHeader{}, JournalTick{}})},
      {"fuzz_journal", "long", encoded(random_journal(random, 70))},
      {"fuzz_device_frame", "plain", encoded(device_frame())},
      {"fuzz_device_frame", "cobs", encoded_cobs(device_frame())},
      {"fuzz_device_frame", "version_1", encoded_version_1(device_frame())},
  };
  all.push_back({"fuzz_device_settings", "golden", encoded(device_settings())});
  for (const auto& [name, command] : device_commands())
    all.push_back({"fuzz_device_command", name, encoded(command)});
  for (const auto& [name, message] : phone_requests())
    all.push_back({"fuzz_phone", name, encoded(message)});
  for (const auto& [name, message] : phone_replies())
    all.push_back({"fuzz_phone", name, encoded(message)});
  Bytes stream;
  for (const auto& [name, message] : control()) {
    all.push_back({"fuzz_control", name, chunked(7, encoded(message))});
    encode_control(message, stream);
  }
  all.push_back({"fuzz_control", "stream", chunked(0, stream)});
  return all;
}

}  // namespace wire::samples
