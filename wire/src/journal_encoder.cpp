#include <algorithm>
#include <array>

#include "codec.h"
#include "layouts.h"
#include "wire/journal.h"
#include "wire/journal_description.h"

namespace wire {
namespace {

// Max size of one tick (8 rods of 2 + 40 + 64 + 40 + 40 bits and 64 commands of 78 bits), and of
// any payload other than a header or a keyframe.
constexpr std::size_t kSmallPayload = 1024;

void append(std::vector<std::byte>& out, std::span<const std::byte> bytes) {
  out.insert(out.end(), bytes.begin(), bytes.end());
}

void append32(std::vector<std::byte>& out, std::uint64_t value) {
  for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<std::byte>(value >> shift));
}

// Appends a record: length, CRC, then the payload in two parts.
void append_record(std::vector<std::byte>& out, std::span<const std::byte> head,
                   std::span<const std::byte> rest = {}) {
  const std::size_t start = out.size();
  append32(out, head.size() + rest.size());
  append32(out, 0);
  append(out, head);
  append(out, rest);
  const std::uint32_t crc = crc32(std::span(out).subspan(start + 8));
  for (std::size_t i = 0; i < 4; ++i) out[start + 4 + i] = static_cast<std::byte>(crc >> 8 * i);
}

// Encodes into scratch and returns the used part.
template <class Describe, class Message>
std::span<const std::byte> encode(std::span<std::byte> scratch, Describe describe,
                                  const Message& message) {
  Encoder encoder(scratch, journal_layout_hash());
  describe(encoder, message);
  return scratch.first(encoder.finish());
}

bool valid(const JournalSetup& s) {
  return s.mode < kModeCount && s.rule_set < kRuleSetCount && s.goals <= kMaxGoals &&
         s.sets <= kMaxSets && s.match_ms <= kMaxMatchMs && s.date <= kLastDate;
}

bool valid(const JournalCommand& c) {
  return c.kind < kCommandKindCount && c.team < kTeamCount &&
         (c.amount == 0 || c.kind == number(RequestKind::tune)) &&
         (c.setup == JournalSetup{} || (c.kind == number(RequestKind::set_up) && valid(c.setup)));
}

bool valid(const JournalTick& tick) {
  return tick.commands.size() <= kMaxJournalCommands &&
         std::ranges::all_of(tick.commands, [](const JournalCommand& c) { return valid(c); }) &&
         std::ranges::all_of(tick.rods, [](const JournalRod& rod) {
           return -kJournalAngleLimit <= rod.angle_urad && rod.angle_urad <= kJournalAngleLimit;
         });
}

JournalRodChange change_of(const JournalRod& from, const JournalRod& to) {
  return {from != to,
          to.live,
          std::int64_t{to.slide_100nm} - from.slide_100nm,
          to.angle_urad - from.angle_urad,
          std::int64_t{to.slide_rate_um_s} - from.slide_rate_um_s,
          std::int64_t{to.angle_rate_mrad_s} - from.angle_rate_mrad_s};
}

}  // namespace

JournalEncoder::JournalEncoder() {
  change_.commands.reserve(kMaxJournalCommands);
  open_.reserve(kJournalBatch * kSmallPayload);
  large_.reserve(kSmallPayload + kMaxKeyframe);
}

bool JournalEncoder::add_tick(const JournalTick& tick, std::vector<std::byte>& out) {
  if (tick.tick != next_tick_ || !valid(tick)) return false;
  for (std::size_t i = 0; i < tick.rods.size(); ++i) {
    change_.rods[i] = change_of(previous_[i], tick.rods[i]);
  }
  change_.commands = tick.commands;
  std::array<std::byte, kSmallPayload> scratch;
  const auto describe = [](auto& codec, auto& t) { describe_journal_tick(codec, t); };
  append(open_, encode(scratch, describe, change_));
  previous_ = tick.rods;
  ++next_tick_;
  if (++open_ticks_ == kJournalBatch) flush(out);
  return true;
}

void JournalEncoder::flush(std::vector<std::byte>& out) {
  if (open_ticks_ == 0) return;
  const JournalTicksHead head{next_tick_ - static_cast<std::uint64_t>(open_ticks_),
                              static_cast<std::uint8_t>(open_ticks_)};
  std::array<std::byte, kSmallPayload> scratch;
  const auto describe = [](auto& codec, auto& h) { describe_journal_ticks_head(codec, h); };
  append_record(out, encode(scratch, describe, head), open_);
  open_.clear();
  open_ticks_ = 0;
}

bool JournalEncoder::add(const JournalEntry& entry, std::vector<std::byte>& out) {
  if (ended_ || started_ == std::holds_alternative<JournalHeader>(entry)) return false;
  if (const auto* tick = std::get_if<JournalTick>(&entry)) return add_tick(*tick, out);

  std::array<std::byte, kSmallPayload> scratch;
  if (const auto* header = std::get_if<JournalHeader>(&entry)) {
    if (header->version != kJournalVersion || header->layout >= kLayoutCount ||
        header->mode >= kModeCount || header->rule_set >= kRuleSetCount ||
        header->spin >= kSpinRuleCount || header->characters.empty() ||
        header->characters.size() > kMaxCharacterCount) {
      return false;
    }
    const auto describe = [](auto& codec, auto& h) { describe_journal_header(codec, h); };
    large_.resize(kMaxJournalHeader);
    append_record(out, encode(large_, describe, *header));
    started_ = true;
  } else if (const auto* hash = std::get_if<JournalHash>(&entry)) {
    if (hash->tick != next_tick_) return false;
    flush(out);
    const auto describe = [](auto& codec, auto& h) { describe_journal_hash(codec, h); };
    append_record(out, encode(scratch, describe, *hash));
  } else if (const auto* keyframe = std::get_if<JournalKeyframe>(&entry)) {
    if (keyframe->tick != next_tick_ || keyframe->snapshot.size() > kMaxKeyframe) return false;
    flush(out);
    large_.resize(kSmallPayload + keyframe->snapshot.size());
    const auto describe = [](auto& codec, auto& k) { describe_journal_keyframe(codec, k); };
    append_record(out, encode(large_, describe, *keyframe));
  } else if (const auto* standing = std::get_if<JournalStanding>(&entry)) {
    if (standing->tick != next_tick_) return false;
    flush(out);
    const auto describe = [](auto& codec, auto& s) { describe_journal_standing(codec, s); };
    append_record(out, encode(scratch, describe, *standing));
  } else if (const auto* end = std::get_if<JournalEnd>(&entry)) {
    if (end->ticks != next_tick_) return false;
    flush(out);
    const auto describe = [](auto& codec, auto& e) { describe_journal_end(codec, e); };
    append_record(out, encode(scratch, describe, *end));
    ended_ = true;
  }
  return true;
}

}  // namespace wire
