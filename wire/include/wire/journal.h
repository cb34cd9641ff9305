// The recording of a match: what went into every tick, so that foosball::Match replays it to the bit.
//
// A file is a sequence of records [u32 payload length][u32 CRC-32 of the payload][payload], little
// endian, appended as play goes on; a reader stops at the first bad record and keeps all before it.
// What a payload holds is described in wire/journal_description.h.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace wire {

// A rod target on the grid of the journal. The simulation is only ever fed values that went through
// this grid, so that live play and replay see the same numbers.
struct JournalRod {
  std::int32_t slide_100nm = 0;
  std::int64_t angle_urad = 0;
  std::int32_t slide_rate_um_s = 0;
  std::int32_t angle_rate_mrad_s = 0;
  bool live = false;
  bool operator==(const JournalRod&) const = default;
};

struct JournalCommand {
  std::uint8_t kind = 0, team = 0, value = 0;
  bool operator==(const JournalCommand&) const = default;
};

struct JournalHeader {
  std::uint16_t version = 1;
  std::uint8_t layout = 0;
  std::uint64_t seed = 0;
  std::uint32_t goals_to_win = 5, max_goals = 8;
  std::uint32_t dead_ball_ms = 6000, ceremony_ms = 2500, end_ms = 6000;
};

struct JournalTick {
  std::uint64_t tick = 0;  // the first is 0, each next one more
  std::array<JournalRod, 8> rods{};
  std::vector<JournalCommand> commands;  // at most 64
};

struct JournalHash {
  std::uint64_t tick = 0;  // ticks stepped so far
  std::uint64_t state_hash = 0;
};

struct JournalKeyframe {
  std::uint64_t tick = 0;            // ticks stepped so far
  std::vector<std::byte> snapshot;   // foosball::Match::snapshot, at most 1 MiB
};

struct JournalEnd {
  std::uint64_t ticks = 0;
  std::uint64_t state_hash = 0;
};

using JournalEntry = std::variant<JournalHeader, JournalTick, JournalHash, JournalKeyframe, JournalEnd>;

// Encodes entries to bytes ready to append to a file. Ticks are coded as changes against the tick
// before and gathered in records of up to kJournalBatch; flush() closes an open record.
inline constexpr int kJournalBatch = 64;

class JournalEncoder {
 public:
  void add(const JournalEntry& entry, std::vector<std::byte>& out);
  void flush(std::vector<std::byte>& out);

 private:
  JournalTick previous_;
  std::vector<std::byte> open_;
  int open_ticks_ = 0;
};

// Reads entries from the bytes of a whole file, which must outlive the reader.
class JournalReader {
 public:
  explicit JournalReader(std::span<const std::byte> file) : file_(file) {}
  // The next entry; nothing at the end or at the first bad record.
  std::optional<JournalEntry> next();
  // Empty after a clean end; else what was wrong and at which byte.
  const std::string& problem() const { return problem_; }

 private:
  std::span<const std::byte> file_;
  std::size_t at_ = 0;
  std::span<const std::byte> record_;
  std::size_t record_at_ = 0;
  int ticks_left_ = 0;
  JournalTick previous_;
  std::string problem_;
};

}  // namespace wire
