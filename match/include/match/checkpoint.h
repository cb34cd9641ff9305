// A file with the results of finished games, one per line. Each line is on disk (fdatasync) before
// the next is appended. A killed run can continue from the file and gives the same totals.
// Truncated or changed lines are ignored, and their games are played again. Only one run at a time
// can use the file.
//
//   space-foosball-match checkpoint 2; N series, DIGEST; game FINGERPRINT
//   SERIES GAME DIGEST_OF_SERIES RESULT                                    (match/codec.h)
#pragma once

#include <memory>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "match/schedule.h"
#include "os/file_descriptor.h"

namespace match {

class Checkpoint {
 public:
  struct Line {
    JobId id;
    std::uint64_t series = 0;  // SeriesDesc::digest() of the game's series
    GameResult result;
  };
  struct Opened {
    std::unique_ptr<Checkpoint> checkpoint;
    std::vector<Line> lines;  // results of earlier runs
    int unreadable = 0;       // number of lines
  };

  // Creates the file. Continues an existing file if its header matches: same series, same game,
  // same players. plan: further data that the games depend on, if these series are only the first.
  // The error is a sentence.
  static tl::expected<Opened, std::string> open(const std::string& path,
                                                const std::vector<SeriesDesc>& series,
                                                const std::string& plan = {});
  tl::expected<void, std::string> append(JobId id, std::uint64_t series, const GameResult& result);

 private:
  Checkpoint(std::string path, os::FileDescriptor file)
      : path_(std::move(path)), file_(std::move(file)) {}
  tl::expected<void, std::string> write(const std::string& text);

  std::string path_;
  os::FileDescriptor file_;
};

// Fingerprint of the program: differs between programs that would play these series differently. It
// covers all numbers of all players (foosball::players_digest()), the default rules and tuning, and
// a few seconds of play of each player of the series. The play detects changes of the physics and
// of the players' code.
std::uint64_t game_fingerprint(const std::vector<SeriesDesc>& series);

}  // namespace match
