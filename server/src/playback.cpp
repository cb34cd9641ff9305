#include "server/playback.h"

#include "server/exit_code.h"
#include "server/match_record.h"
#include "wire/read_file.h"

namespace server {

tl::expected<std::unique_ptr<Playback>, std::string> Playback::open(const std::string& path) {
  auto bytes = wire::read_file(path, wire::kMaxJournalFile);
  if (!bytes) return tl::unexpected(bytes.error());
  return from_bytes(std::move(*bytes), path);
}

tl::expected<std::unique_ptr<Playback>, std::string> Playback::from_bytes(
    std::vector<std::byte> file, const std::string& name) {
  if (const auto format = wire::other_journal_format(file)) {
    return tl::unexpected(name + " was recorded by another release: it needs one that reads " +
                          "recordings of " + wire::to_text(*format) + ", this one reads " +
                          wire::to_text(wire::journal_format()) +
                          "; replay it with the release that recorded it");
  }
  std::unique_ptr<Playback> playback(
      new Playback(std::make_shared<const std::vector<std::byte>>(std::move(file)), name));
  const auto first = playback->reader_.next();
  const auto* header = first ? std::get_if<wire::JournalHeader>(&*first) : nullptr;
  if (header == nullptr) {
    if (const unsigned version = playback->reader_.other_version(); version != 0) {
      return tl::unexpected(name + " was recorded by another release (format " +
                            std::to_string(version) + ", this one plays format " +
                            std::to_string(wire::JournalHeader{}.version) +
                            "): replay it with the release that recorded it");
    }
    const std::string& problem = playback->reader_.problem();
    return tl::unexpected(name + " is not a recorded match" +
                          (problem.empty() ? "" : " (" + problem + ")") +
                          ": choose a file that --record wrote");
  }
  playback->match_ = from_header(*header);
  if (const auto playable = foosball::Match::create(playback->match_); !playable)
    return tl::unexpected(name + " cannot be replayed: " + playable.error().message);
  if (!playback->holds_a_tick()) {
    return tl::unexpected(
        name + " contains the beginning of a match, but no tick of it: there is nothing to replay");
  }
  return playback;
}

Playback::Playback(Bytes file, std::string name)
    : file_(std::move(file)), name_(std::move(name)), reader_(*file_) {}

std::unique_ptr<Playback> Playback::twin() const {
  std::unique_ptr<Playback> twin(new Playback(file_, name_));
  twin->reader_.next();  // the header
  twin->match_ = match_;
  return twin;
}

void Playback::extend(Bytes longer) {
  reader_ = reader_.over(*longer);
  file_ = std::move(longer);
  exhausted_ = false;
}

void Playback::go_to(const Place& place) {
  // The longer file contains the bytes of both.
  if (place.file->size() > file_->size()) file_ = place.file;
  reader_ = place.file == file_ ? place.reader : place.reader.over(*file_);
  ticks_ = place.ticks;
  checked_ = place.checked;
  first_difference_ = place.first_difference;
  ended_ = place.ended;
  exhausted_ = place.exhausted;
}

bool Playback::holds_a_tick() const {
  wire::JournalReader reader(*file_);
  while (const auto entry = reader.next()) {
    if (std::holds_alternative<wire::JournalTick>(*entry)) return true;
  }
  return false;
}

std::uint64_t Playback::total_ticks() const {
  wire::JournalReader reader = reader_;
  std::uint64_t ticks = ticks_;
  while (const auto entry = reader.next()) {
    ticks += std::holds_alternative<wire::JournalTick>(*entry) ? 1 : 0;
  }
  return ticks;
}

const wire::JournalTick* Playback::next(const foosball::Match& match) {
  while (auto entry = reader_.next()) {
    if (auto* tick = std::get_if<wire::JournalTick>(&*entry)) {
      tick_ = std::move(*tick);
      ++ticks_;
      return &tick_;
    }
    if (const auto* hash = std::get_if<wire::JournalHash>(&*entry)) check(match, *hash);
    if (const auto* keyframe = std::get_if<wire::JournalKeyframe>(&*entry)) check(match, *keyframe);
    if (const auto* end = std::get_if<wire::JournalEnd>(&*entry)) {
      check(match, {end->ticks, end->state_hash});
      ended_ = true;
    }
  }
  exhausted_ = true;
  return nullptr;
}

void Playback::check(const foosball::Match& match, const wire::JournalHash& hash) {
  compare(hash.tick, hash.tick == ticks_ && hash.state_hash == match.state_hash());
}

void Playback::check(const foosball::Match& match, const wire::JournalKeyframe& keyframe) {
  scratch_.clear();
  match.snapshot(scratch_);
  compare(keyframe.tick, keyframe.tick == ticks_ && keyframe.snapshot == scratch_);
}

void Playback::compare(std::uint64_t tick, bool same) {
  ++checked_;
  if (!same && !first_difference_) first_difference_ = tick;
}

Playback::Verdict Playback::verdict() const {
  if (first_difference_) return Verdict::differs;
  if (!exhausted_) return Verdict::so_far;
  return ended_ && reader_.problem().empty() ? Verdict::same : Verdict::cut_short;
}

std::string Playback::verdict_sentence() const {
  const std::string after =
      std::to_string(ticks_) + " ticks, " + std::to_string(checked_) + " states compared";
  switch (verdict()) {
    case Verdict::same:
      return "the replay is the match that was played: " + after;
    case Verdict::so_far:
      return "stopped before the recording's end; the match is the one that was played so far: " +
             after;
    case Verdict::cut_short:
      return name_ + " stops early" +
             (reader_.problem().empty() ? " (no end was recorded)"
                                        : " (" + reader_.problem() + ")") +
             "; the match is the one that was played so far: " + after;
    case Verdict::differs:
      return "the replay differs from the match that was played, first seen at tick " +
             std::to_string(*first_difference_) +
             ": it was recorded by another release, or this "
             "build is not deterministic";
  }
  return {};
}

int exit_code(Playback::Verdict verdict) {
  switch (verdict) {
    case Playback::Verdict::same:
    case Playback::Verdict::so_far:
      return kExitOk;
    case Playback::Verdict::cut_short:
      return kExitCutShort;
    case Playback::Verdict::differs:
      break;
  }
  return kExitFailed;
}

void step_recorded(foosball::Match& match, const wire::JournalTick& tick) {
  foosball::TickInput input;
  for (int rod = 0; rod < foosball::kRods; ++rod) input.rods[rod] = from_grid(tick.rods[rod]);
  std::array<foosball::Command, wire::kMaxJournalCommands> commands;
  const std::size_t count = std::min(tick.commands.size(), commands.size());
  for (std::size_t i = 0; i < count; ++i) commands[i] = from_record(tick.commands[i]);
  input.commands = std::span(commands).first(count);
  match.step(input);
}

}  // namespace server
