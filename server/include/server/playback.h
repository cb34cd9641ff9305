// Reads a recorded match tick by tick and validates its replay. The journal's state hashes,
// keyframes and end must equal those of the match that is stepped with the journal's inputs.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <utility>
#include <vector>

#include "foosball/match.h"
#include "wire/journal.h"

namespace server {

class Playback {
 public:
  enum class Verdict {
    same,       // every hash matched, up to the recorded end
    so_far,     // every hash matched, but the replay stopped before the recording's end
    cut_short,  // every hash matched, but the recording has no end record
    differs,    // a hash did not match: this build does not reproduce the match
  };

  // Reads the file. The error is a sentence that names it. Errors: the file cannot be read, does
  // not begin with the header of a playable match, or holds no tick.
  static tl::expected<std::unique_ptr<Playback>, std::string> open(const std::string& path);
  static tl::expected<std::unique_ptr<Playback>, std::string> from_bytes(
      std::vector<std::byte> file, const std::string& name);

  const foosball::MatchDesc& match() const { return match_; }

  using Bytes = std::shared_ptr<const std::vector<std::byte>>;  // of a complete file
  const Bytes& bytes() const { return file_; }
  // Another reader of the same bytes, at their beginning.
  std::unique_ptr<Playback> twin() const;
  // Continues in a longer version of the file. Precondition: it begins with bytes().
  void extend(Bytes longer);

  // A position in the recording. Use it to go back there with a match restored to the same tick.
  // Valid for the playback that made it and for its twins, even if some of them were extended.
  struct Place {
    Bytes file;
    wire::JournalReader reader;
    std::uint64_t ticks, checked;
    std::optional<std::uint64_t> first_difference;
    bool ended, exhausted;
  };
  Place place() const {
    return {file_, reader_, ticks_, checked_, first_difference_, ended_, exhausted_};
  }
  void go_to(const Place& place);

  // Checks the match against the journal's hashes and keyframes, then returns the inputs of its
  // next tick; null at the end. Precondition: the match was stepped with every tick returned
  // before.
  const wire::JournalTick* next(const foosball::Match& match);

  Verdict verdict() const;
  std::string verdict_sentence() const;
  std::uint64_t ticks() const { return ticks_; }  // returned so far
  std::uint64_t total_ticks() const;              // of the recording; reads the rest of it
  std::uint64_t hashes_checked() const { return checked_; }

 private:
  Playback(Bytes file, std::string name);
  bool holds_a_tick() const;
  void check(const foosball::Match& match, const wire::JournalHash& hash);
  void check(const foosball::Match& match, const wire::JournalKeyframe& keyframe);
  void compare(std::uint64_t tick, bool same);

  Bytes file_;  // twins share it
  std::string name_;
  wire::JournalReader reader_;
  foosball::MatchDesc match_;
  wire::JournalTick tick_;
  std::vector<std::byte> scratch_;
  std::uint64_t ticks_ = 0, checked_ = 0;
  std::optional<std::uint64_t> first_difference_;  // ticks stepped
  bool ended_ = false;                             // the recorded end was read
  bool exhausted_ = false;                         // nothing more can be read
};

// Exit code of a program that replays: 0, 1 or 4 (server/exit_code.h).
int exit_code(Playback::Verdict verdict);

// Steps the match with one recorded tick. Every replay steps with this function.
void step_recorded(foosball::Match& match, const wire::JournalTick& tick);

}  // namespace server
