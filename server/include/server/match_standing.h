// The standing of a match, for lists of recordings: the score of the last match with a goal, who
// played, and how many matches were won. A recording can hold several matches. Each starts at 0 :
// 0, which would hide the result of the match before it.
#pragma once

#include <algorithm>

#include "foosball/match.h"
#include "wire/journal.h"

namespace server {

class MatchStanding {
 public:
  // Call after each tick. Does not allocate.
  void observe(const foosball::Match& match) {
    const foosball::MatchView& view = match.view();
    for (const foosball::Event& event : match.events())
      if (event.kind == foosball::EventKind::match_won && standing_.won < 0xffff) ++standing_.won;
    if (view.score[0] + view.score[1] + view.sets[0] + view.sets[1] == 0 && scored_) return;
    scored_ = view.score[0] + view.score[1] > 0;
    for (std::size_t t = 0; t < standing_.score.size(); ++t) {
      standing_.score[t] = byte_of(view.score[t]);
      standing_.sets[t] = byte_of(view.sets[t]);
      standing_.character[t] = byte_of(view.character[t]);
      standing_.computer[t] = view.computer[t];
    }
  }
  wire::JournalStanding at(std::uint64_t tick) const {
    wire::JournalStanding standing = standing_;
    standing.tick = tick;
    return standing;
  }

 private:
  static std::uint8_t byte_of(int number) {
    return static_cast<std::uint8_t>(std::clamp(number, 0, 255));
  }
  wire::JournalStanding standing_;
  bool scored_ = false;
};

}  // namespace server
