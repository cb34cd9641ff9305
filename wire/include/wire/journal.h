// The recording of a match: the inputs of every tick, from which foosball::Match replays it bit for
// bit.
//
// A file is a sequence of records [u32 payload length][u32 CRC-32 of the payload][payload], little
// endian, appended during play. A reader stops at the first bad record and keeps all before it.
// wire/journal_description.h describes the payloads.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "wire/characters.h"
#include "wire/limits.h"

namespace wire {

inline constexpr std::int64_t kJournalAngleLimit = 1'000'000'000'000'000;  // [urad], 1e9 rad
inline constexpr int kJournalBatch = 64;                                   // max ticks per record
inline constexpr std::size_t kMaxJournalCommands = 64;                     // per tick
inline constexpr std::size_t kMaxKeyframe = 1 << 20;                       // bytes
inline constexpr std::size_t kMaxJournalHeader = 8 * 1024;  // bytes, with all characters

// A rod target, quantised to the journal's grid. The simulation only receives values from this
// grid, so that live play and replay use the same numbers.
struct JournalRod {
  std::int32_t slide_100nm = 0;
  std::int64_t angle_urad = 0;
  std::int32_t slide_rate_um_s = 0;
  std::int32_t angle_rate_mrad_s = 0;
  bool live = false;
  bool operator==(const JournalRod&) const = default;
};

// The same in SI units.
struct RodTargetValues {
  double slide = 0, angle = 0;            // [m], [rad]
  double slide_rate = 0, angle_rate = 0;  // [m/s], [rad/s]
  bool live = false;
};

// Rounds to the nearest point of the grid. Values out of range saturate. A rod with a value that is
// not finite is not live, at zero. quantise(dequantise(r)) == r for every r within the limits.
JournalRod quantise_rod(const RodTargetValues& values);
RodTargetValues dequantise_rod(const JournalRod& rod);

// A foosball::GameSetup.
struct JournalSetup {
  std::uint8_t mode = 0, rule_set = 0, goals = 0, sets = 0;
  std::uint32_t match_ms = 0;
  bool change_sides = false;
  std::uint32_t date = 0;
  bool operator==(const JournalSetup&) const = default;
};

struct JournalCommand {
  std::uint8_t kind = 0, team = 0, value = 0;
  std::uint64_t amount = 0;  // tune: the bits of a double (IEEE 754); else 0
  JournalSetup setup{};      // set_up; else all zero
  bool operator==(const JournalCommand&) const = default;
};

struct JournalHeader {
  std::uint16_t version = 2;
  std::uint8_t layout = 0;
  std::uint64_t seed = 0;
  std::uint8_t mode = 0, rule_set = 0;  // Mode, RuleSet (wire/enums.h)
  std::uint32_t goals_to_win = 5, max_goals = 8, lead = 1, sets_to_win = 1;
  std::uint32_t match_ms = 0;
  bool golden_goal = true, change_sides = false, jarring = false;
  std::uint8_t spin = 1;  // foosball::SpinRule
  std::uint32_t time_outs = 2, time_out_ms = 30000;
  std::uint32_t dead_ball_ms = 2000, still_ms = 5000;
  std::uint32_t possession_midfield_ms = 10000, possession_ms = 15000;
  std::uint32_t ceremony_ms = 2500, end_ms = 6000, idle_ms = 60000, attract_ms = 30000;
  std::array<std::uint64_t, kTuningCount> tuning{};  // in order: the bits of doubles (IEEE 754)
  // The available characters, 1 to kMaxCharacterCount.
  std::vector<CharacterRecord> characters = std::vector<CharacterRecord>(1);
};

struct JournalTick {
  std::uint64_t tick = 0;  // starts at 0 and increases by 1
  std::array<JournalRod, 8> rods{};
  std::vector<JournalCommand> commands;  // at most kMaxJournalCommands
};

struct JournalHash {
  std::uint64_t tick = 0;  // ticks stepped so far
  std::uint64_t state_hash = 0;
};

struct JournalKeyframe {
  std::uint64_t tick = 0;           // ticks stepped so far
  std::vector<std::byte> snapshot;  // foosball::Match::snapshot, at most kMaxKeyframe
};

// The standing of the match, for lists of recordings; a replay does not need it.
struct JournalStanding {
  std::uint64_t tick = 0;               // ticks stepped so far
  std::array<std::uint8_t, 2> score{};  // of the last match with a goal; then sets won in it
  std::array<std::uint8_t, 2> sets{};
  std::array<std::uint8_t, 2> character{};  // index into the header's list
  std::array<bool, 2> computer{};           // plays the team
  std::uint16_t won = 0;                    // matches won so far
  bool operator==(const JournalStanding&) const = default;
};

struct JournalEnd {
  std::uint64_t ticks = 0;
  std::uint64_t state_hash = 0;
};

using JournalEntry = std::variant<JournalHeader, JournalTick, JournalHash, JournalKeyframe,
                                  JournalEnd, JournalStanding>;

// Change of a rod's target since the previous tick (at tick 0: since a rod that is not live, at 0).
struct JournalRodChange {
  bool changed = false;
  bool live = false;
  std::int64_t slide = 0, angle = 0, slide_rate = 0, angle_rate = 0;
};

// The encoded content of a tick.
struct JournalTickChange {
  std::array<JournalRodChange, 8> rods{};
  std::vector<JournalCommand> commands;
};

// The format of a recording. A program reads only its own.
struct JournalFormat {
  std::uint16_t version = 0;
  std::uint32_t layout_hash = 0;  // of all the journal's tables
  bool operator==(const JournalFormat&) const = default;
};
JournalFormat journal_format();
// "version 1, layout 0123abcd"
std::string to_text(const JournalFormat& format);
// The format of a file that begins with a complete header of a format other than this program's;
// otherwise nothing.
std::optional<JournalFormat> other_journal_format(std::span<const std::byte> file);

// Encodes entries to bytes to append to a file. Ticks are coded as changes since the previous tick,
// and batched in records of up to kJournalBatch. Any other entry, and flush(), ends the open
// record.
class JournalEncoder {
 public:
  // Allocates all the memory it will need, for the largest entries.
  JournalEncoder();

  // Returns false, and writes nothing, for an entry that a reader would reject: no header first, a
  // second header, a tick that is not the next one, a count that is not the number of ticks so far,
  // too many commands, a command, layout or angle out of range, a keyframe that is too large,
  // anything after the end.
  bool add(const JournalEntry& entry, std::vector<std::byte>& out);
  void flush(std::vector<std::byte>& out);

 private:
  bool add_tick(const JournalTick& tick, std::vector<std::byte>& out);

  std::array<JournalRod, 8> previous_{};
  std::uint64_t next_tick_ = 0;
  JournalTickChange change_;
  std::vector<std::byte> open_;   // ticks of the open record, without its header
  std::vector<std::byte> large_;  // a keyframe's payload; reused for its memory
  int open_ticks_ = 0;
  bool started_ = false, ended_ = false;
};

// Information from the last records of a file, without reading all of it: the standing of the match
// and the length of the recording.
struct JournalTail {
  std::optional<JournalStanding> standing;
  std::optional<JournalEnd> end;  // none: truncated, or still being written
};
// tail: the last bytes of the file, starting at any byte. Ignores other records between the two.
JournalTail read_journal_tail(std::span<const std::byte> tail);

// Reads entries from the bytes of a complete file, which must outlive the reader.
class JournalReader {
 public:
  explicit JournalReader(std::span<const std::byte> file) : file_(file) {}
  // Returns the next entry; nothing at the end or at the first bad record.
  std::optional<JournalEntry> next();
  // Empty after a clean end; otherwise the error and its byte offset. A file that ends between two
  // records is clean even if play was interrupted: then there was no JournalEnd.
  const std::string& problem() const { return problem_; }
  // The version of the file's format if it is of another release; otherwise 0.
  unsigned other_version() const { return other_version_; }
  // The same reader at the same entry of a longer file that begins with the same bytes. A reader
  // that had reached the end, or a record truncated there, can continue.
  JournalReader over(std::span<const std::byte> longer) const;

 private:
  std::nullopt_t fail(const std::string& what);
  std::string open_record();
  std::optional<JournalEntry> read_entry();
  std::optional<JournalEntry> read_tick();
  bool of_another_release();
  template <class Entry, class Describe>
  std::optional<JournalEntry> read_whole(Entry entry, Describe describe);

  std::span<const std::byte> file_;
  std::size_t at_ = 0;                 // next record
  std::span<const std::byte> record_;  // rest of the payload
  std::size_t record_at_ = 0;          // offset of the record, for problem_
  int ticks_left_ = 0;
  std::array<JournalRod, 8> previous_{};
  std::uint64_t next_tick_ = 0;
  bool started_ = false, ended_ = false;
  unsigned other_version_ = 0;
  std::string problem_;
};

}  // namespace wire
