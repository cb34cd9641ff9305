#include <array>
#include <cstdio>
#include <limits>

#include "codec.h"
#include "layouts.h"
#include "wire/journal.h"
#include "wire/journal_description.h"

namespace wire {
namespace {

constexpr std::size_t kRecordHead = 8;
constexpr std::size_t kMaxPayload = kMaxKeyframe + 64;  // a keyframe is the largest

std::uint32_t get32(std::span<const std::byte> bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value |= static_cast<std::uint32_t>(bytes[i]) << 8 * i;
  return value;
}

// Adds the change; false if the sum exceeds the range of Int or the limit.
template <class Int>
bool move_by(Int& value, std::int64_t change,
             std::int64_t limit = std::numeric_limits<Int>::max()) {
  const std::int64_t sum = value + change;  // cannot overflow: both are far below 2^63
  if (sum < std::numeric_limits<Int>::min() || sum < -limit - 1 || sum > limit) return false;
  value = static_cast<Int>(sum);
  return true;
}

bool apply(const JournalRodChange& change, JournalRod& rod) {
  if (!change.changed) return true;
  const JournalRod before = rod;
  rod.live = change.live;
  return move_by(rod.slide_100nm, change.slide) &&
         move_by(rod.angle_urad, change.angle, kJournalAngleLimit) &&
         move_by(rod.slide_rate_um_s, change.slide_rate) &&
         move_by(rod.angle_rate_mrad_s, change.angle_rate) && rod != before;
}

}  // namespace

Layout journal_tick_layout() {
  return list_layout<JournalTickChange>([](Lister& l, auto& t) { describe_journal_tick(l, t); });
}

std::vector<NamedLayout> journal_layouts() {
  return {
      {"header", "the first record",
       list_layout<JournalHeader>([](Lister& l, auto& h) { describe_journal_header(l, h); })},
      {"ticks", "the inputs of up to 64 ticks",
       list_layout<JournalTicksHead>(
           [](Lister& l, auto& h) { describe_journal_ticks_head(l, h); })},
      {"tick", "`count` times in a record of ticks, each starts at a whole byte",
       journal_tick_layout()},
      {"hash", "of the match's state, for a replay to compare with",
       list_layout<JournalHash>([](Lister& l, auto& h) { describe_journal_hash(l, h); })},
      {"keyframe", "the complete state of the match, to start from",
       list_layout<JournalKeyframe>([](Lister& l, auto& k) { describe_journal_keyframe(l, k); })},
      {"end", "the last record",
       list_layout<JournalEnd>([](Lister& l, auto& e) { describe_journal_end(l, e); })},
      {"standing", "the score of the match, for lists of recordings",
       list_layout<JournalStanding>([](Lister& l, auto& s) { describe_journal_standing(l, s); })}};
}

std::uint32_t journal_layout_hash() {
  static const std::uint32_t hash = [] {
    Layout all;
    for (const NamedLayout& part : journal_layouts()) {
      all.insert(all.end(), part.layout.begin(), part.layout.end());
    }
    return layout_hash(all);
  }();
  return hash;
}

JournalFormat journal_format() {
  return {static_cast<std::uint16_t>(kJournalVersion), journal_layout_hash()};
}

std::string to_text(const JournalFormat& format) {
  std::array<char, 48> text;
  std::snprintf(text.data(), text.size(), "version %u, layout %08x", unsigned{format.version},
                unsigned{format.layout_hash});
  return text.data();
}

// In every version a header begins with kind, magic, version and layout hash: 1 + 4 + 2 + 4 bytes.
std::optional<JournalFormat> other_journal_format(std::span<const std::byte> file) {
  constexpr std::size_t kIdentity = 11;
  if (file.size() < kRecordHead + kIdentity) return std::nullopt;
  const std::size_t size = get32(file);
  const auto rest = file.subspan(kRecordHead);
  if (size < kIdentity || size > rest.size() || crc32(rest.first(size)) != get32(file.subspan(4)) ||
      rest[0] != static_cast<std::byte>(JournalKind::header) ||
      get32(rest.subspan(1)) != kJournalMagic) {
    return std::nullopt;
  }
  const auto version = static_cast<std::uint16_t>(get32(rest.subspan(5)) & 0xffffu);
  const JournalFormat format{version, get32(rest.subspan(7))};
  if (format == journal_format()) return std::nullopt;
  return format;
}

std::nullopt_t JournalReader::fail(const std::string& what) {
  problem_ = "record at byte " + std::to_string(record_at_) + ": " + what;
  at_ = file_.size();
  record_ = {};
  ticks_left_ = 0;
  return std::nullopt;
}

// Reads the next record's payload into record_. Returns an error message if there is no valid one.
std::string JournalReader::open_record() {
  const auto rest = file_.subspan(at_);
  if (rest.size() < kRecordHead) return "cut off within its head";
  const std::size_t size = get32(rest), there = rest.size() - kRecordHead;
  if (size == 0 || size > kMaxPayload) {
    return "a length of " + std::to_string(size) + " bytes cannot be";
  }
  if (size > there) {
    return "cut off: " + std::to_string(there) + " of " + std::to_string(size) + " bytes are there";
  }
  record_ = rest.subspan(kRecordHead, size);
  if (crc32(record_) != get32(rest.subspan(4))) return "wrong checksum";
  at_ += kRecordHead + size;
  return {};
}

// Reads a record that is one entry.
template <class Entry, class Describe>
std::optional<JournalEntry> JournalReader::read_whole(Entry entry, Describe describe) {
  Decoder decoder(record_, journal_layout_hash());
  describe(decoder, entry);
  if (!decoder.ok()) return fail(std::string("field ") + decoder.bad_field() + " is not valid");
  if (!decoder.at_end()) return fail("bytes left over");
  record_ = {};
  return entry;
}

std::optional<JournalEntry> JournalReader::read_tick() {
  JournalTickChange change;
  Decoder decoder(record_, journal_layout_hash());
  describe_journal_tick(decoder, change);
  const std::string where = "tick " + std::to_string(next_tick_) + ": ";
  if (!decoder.ok()) return fail(where + "field " + decoder.bad_field() + " is not valid");
  JournalTick tick;
  tick.tick = next_tick_;
  tick.rods = previous_;
  for (std::size_t i = 0; i < tick.rods.size(); ++i) {
    if (!apply(change.rods[i], tick.rods[i])) {
      return fail(where + "rod " + std::to_string(i + 1) + " leaves its range or does not change");
    }
  }
  tick.commands = std::move(change.commands);
  record_ = record_.subspan(decoder.consumed());
  --ticks_left_;
  if (ticks_left_ == 0 && !record_.empty()) return fail(where + "bytes left over");
  previous_ = tick.rods;
  ++next_tick_;
  return tick;
}

// In every release a header begins with kind, magic and version.
bool JournalReader::of_another_release() {
  constexpr std::size_t kBegin = 7;
  if (record_.size() < kBegin || get32(record_.subspan(1)) != kJournalMagic) return false;
  const unsigned version =
      std::to_integer<unsigned>(record_[5]) | std::to_integer<unsigned>(record_[6]) << 8;
  if (version == kJournalVersion) return false;
  other_version_ = version;
  return true;
}

std::optional<JournalEntry> JournalReader::read_entry() {
  const auto kind = static_cast<JournalKind>(record_[0]);
  if (ended_) return fail("comes after the end");
  if (started_ == (kind == JournalKind::header)) {
    return fail(started_ ? "a second header" : "not a recording: it starts without a header");
  }
  const auto at_tick = [&](std::optional<JournalEntry> entry,
                           std::uint64_t tick) -> std::optional<JournalEntry> {
    if (entry && tick != next_tick_) {
      return fail("says tick " + std::to_string(tick) + " after " + std::to_string(next_tick_) +
                  " ticks");
    }
    return entry;
  };
  switch (kind) {
    case JournalKind::header: {
      if (of_another_release()) return fail("recorded by another release");
      auto entry =
          read_whole(JournalHeader{}, [](auto& d, auto& h) { describe_journal_header(d, h); });
      if (entry && std::get<JournalHeader>(*entry).characters.empty()) {
        return fail("field characters is not valid");
      }
      started_ = entry.has_value();
      return entry;
    }
    case JournalKind::ticks: {
      JournalTicksHead head;
      Decoder decoder(record_, journal_layout_hash());
      describe_journal_ticks_head(decoder, head);
      if (!decoder.ok()) return fail(std::string("field ") + decoder.bad_field() + " is not valid");
      if (head.count == 0) return fail("no ticks");
      if (head.first_tick != next_tick_) {
        return fail("says tick " + std::to_string(head.first_tick) + " where tick " +
                    std::to_string(next_tick_) + " is the next");
      }
      record_ = record_.subspan(decoder.consumed());
      ticks_left_ = head.count;
      return read_tick();
    }
    case JournalKind::hash: {
      auto entry = read_whole(JournalHash{}, [](auto& d, auto& h) { describe_journal_hash(d, h); });
      return at_tick(entry, entry ? std::get<JournalHash>(*entry).tick : 0);
    }
    case JournalKind::keyframe: {
      auto entry =
          read_whole(JournalKeyframe{}, [](auto& d, auto& k) { describe_journal_keyframe(d, k); });
      const std::uint64_t tick = entry ? std::get<JournalKeyframe>(*entry).tick : 0;
      return at_tick(std::move(entry), tick);
    }
    case JournalKind::end: {
      auto entry = read_whole(JournalEnd{}, [](auto& d, auto& e) { describe_journal_end(d, e); });
      entry = at_tick(entry, entry ? std::get<JournalEnd>(*entry).ticks : 0);
      ended_ = entry.has_value();
      return entry;
    }
    case JournalKind::standing: {
      auto entry =
          read_whole(JournalStanding{}, [](auto& d, auto& s) { describe_journal_standing(d, s); });
      return at_tick(entry, entry ? std::get<JournalStanding>(*entry).tick : 0);
    }
  }
  return fail("of unknown kind " + std::to_string(static_cast<int>(kind)));
}

JournalReader JournalReader::over(std::span<const std::byte> longer) const {
  JournalReader reader = *this;
  reader.file_ = longer;
  if (!problem_.empty()) {
    reader.at_ = record_at_;
    reader.problem_.clear();
  } else if (!record_.empty()) {
    reader.record_ =
        longer.subspan(static_cast<std::size_t>(record_.data() - file_.data()), record_.size());
  }
  return reader;
}

namespace {

// Reads the record that begins here, if it is of this kind.
template <class Entry, class Describe>
std::optional<Entry> whole_record(std::span<const std::byte> at, JournalKind kind,
                                  Describe describe) {
  constexpr std::size_t kLongest = 40;  // max payload of both kinds
  if (at.size() <= kRecordHead || at[kRecordHead] != static_cast<std::byte>(kind)) return {};
  const std::size_t size = get32(at);
  if (size > kLongest || size > at.size() - kRecordHead) return {};
  const auto payload = at.subspan(kRecordHead, size);
  if (crc32(payload) != get32(at.subspan(4))) return {};
  Entry entry;
  Decoder decoder(payload, journal_layout_hash());
  describe(decoder, entry);
  if (!decoder.ok() || !decoder.at_end()) return {};
  return entry;
}

}  // namespace

// Searches backwards from the end: a record may begin at any byte.
JournalTail read_journal_tail(std::span<const std::byte> tail) {
  JournalTail read;
  for (std::size_t at = tail.size(); at-- > 0 && !read.standing;) {
    const auto here = tail.subspan(at);
    if (!read.end)
      read.end = whole_record<JournalEnd>(here, JournalKind::end,
                                          [](auto& d, auto& e) { describe_journal_end(d, e); });
    read.standing = whole_record<JournalStanding>(
        here, JournalKind::standing, [](auto& d, auto& s) { describe_journal_standing(d, s); });
  }
  return read;
}

std::optional<JournalEntry> JournalReader::next() {
  if (ticks_left_ > 0) return read_tick();
  if (at_ == file_.size() && (started_ || !problem_.empty())) return std::nullopt;
  record_at_ = at_;
  if (file_.empty()) return fail("the file is empty; a recording starts with a header");
  const std::string damage = open_record();
  if (!damage.empty()) return fail(damage);
  return read_entry();
}

}  // namespace wire
