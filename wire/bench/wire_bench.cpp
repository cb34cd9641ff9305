// Cost of encoding and decoding: a full snapshot (32 men, 8 events), an input datagram, a tick of
// the journal.
#include <benchmark/benchmark.h>

#include "crc32.h"
#include "samples.h"

namespace {

using namespace wire;

void encode_snapshot_full(benchmark::State& state) {
  std::mt19937_64 random(1);
  const Snapshot snapshot = samples::random_snapshot(random, true);
  std::array<std::byte, kMaxDatagram> out;
  for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(encode_snapshot(snapshot, out));
}
BENCHMARK(encode_snapshot_full)->Unit(benchmark::kMicrosecond);

void decode_snapshot_full(benchmark::State& state) {
  std::mt19937_64 random(1);
  const auto bytes = samples::encoded(samples::random_snapshot(random, true));
  Snapshot snapshot;
  for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(decode_snapshot(bytes, snapshot));
}
BENCHMARK(decode_snapshot_full)->Unit(benchmark::kMicrosecond);

void encode_input_datagram(benchmark::State& state) {
  const InputDatagram input = samples::input();
  std::array<std::byte, kMaxInputDatagram> out;
  for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(encode_input(input, out));
}
BENCHMARK(encode_input_datagram)->Unit(benchmark::kMicrosecond);

void decode_input_datagram(benchmark::State& state) {
  const auto bytes = samples::encoded(samples::input());
  InputDatagram input;
  for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(decode_input(bytes, input));
}
BENCHMARK(decode_input_datagram)->Unit(benchmark::kMicrosecond);

// Four rods move; includes ending the record every 64 ticks.
void journal_tick(benchmark::State& state) {
  JournalEncoder encoder;
  samples::Bytes out;
  encoder.add(JournalHeader{}, out);
  JournalEntry entry{JournalTick{}};
  auto& tick = std::get<JournalTick>(entry);
  std::size_t bytes = 0;
  for ([[maybe_unused]] auto _ : state) {
    for (std::size_t rod = 0; rod < 4; ++rod) {
      tick.rods[rod] = {static_cast<std::int32_t>(tick.tick % 1000) * 300,
                        static_cast<std::int64_t>(tick.tick) * 900, 300'000, 900, true};
    }
    encoder.add(entry, out);
    ++tick.tick;
    bytes += out.size();
    out.clear();
  }
  state.counters["bytes/tick"] = static_cast<double>(bytes) / static_cast<double>(tick.tick);
}
BENCHMARK(journal_tick)->Unit(benchmark::kMicrosecond);

void crc32_of_1200_bytes(benchmark::State& state) {
  const samples::Bytes bytes(1200, std::byte{0x5A});
  for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(crc32(bytes));
}
BENCHMARK(crc32_of_1200_bytes)->Unit(benchmark::kMicrosecond);

}  // namespace

BENCHMARK_MAIN();
