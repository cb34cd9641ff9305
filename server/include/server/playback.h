// A recorded match, read tick by tick, and the referee over its replay: the state hashes, keyframes
// and the end that the journal holds must be those of the match that was stepped with its inputs.
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
    same,       // every hash agreed, to the recorded end
    so_far,     // every hash agreed, but the replay was left before the recording's end
    cut_short,  // every hash agreed, but the recording stops without its end
    differs,    // a hash did not agree: this build does not play the match as it was played
  };

  // Reads the file; the error is a sentence that names it. Refused: what cannot be read, does not
  // begin with the header of a match that can be played, or holds no tick of it.
  static tl::expected<std::unique_ptr<Playback>, std::string> open(const std::string& path);
  static tl::expected<std::unique_ptr<Playback>, std::string> from_bytes(
      std::vector<std::byte> file, const std::string& name);

  const foosball::MatchDesc& match() const { return match_; }

  using Bytes = std::shared_ptr<const std::vector<std::byte>>;  // of a whole file
  const Bytes& bytes() const { return file_; }
  // Another reader of the same bytes, from their beginning.
  std::unique_ptr<Playback> twin() const;
  // The file has grown: goes on in the longer one. Precondition: it begins with bytes().
  void extend(Bytes longer);

  // How far it has been read: to go back there with a match that is restored to the same tick. A
  // place is good for the playback it came from and its twins, whichever of them were extended.
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

  // Checks what the journal says about the match as it stands, then gives the inputs of its next
  // tick; nothing at the end. The match must have been stepped with every tick given before.
  const wire::JournalTick* next(const foosball::Match& match);

  Verdict verdict() const;
  std::string verdict_sentence() const;
  std::uint64_t ticks() const { return ticks_; }  // given so far
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
  bool ended_ = false;                             // the recorded end was seen
  bool exhausted_ = false;                         // nothing more can be read
};

// What a program that replays ends with: 0, 1 or 4 (server/exit_code.h).
int exit_code(Playback::Verdict verdict);

// Steps the match with one journaled tick: the only way in which a replay steps.
void step_recorded(foosball::Match& match, const wire::JournalTick& tick);

}  // namespace server
