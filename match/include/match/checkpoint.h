// The results of finished games in a file, one line each, appended as they come and on disk
// (fdatasync) before the next: a run that was killed goes on from there and gives the same totals.
// A last line that was cut off, or any line that was changed, is not read, and its game is played
// again. One run at a time has the file.
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
    std::uint64_t series = 0;  // SeriesDesc::digest() of the series that the game is of
    GameResult result;
  };
  struct Opened {
    std::unique_ptr<Checkpoint> checkpoint;
    std::vector<Line> lines;  // what was finished before
    int unreadable = 0;       // lines
  };

  // Creates the file, or continues it if its head is that of the same series played by the same
  // game with the same players. plan: what else the games depend on, if these series are only the
  // first. The error is a sentence.
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

// Differs between programs that would play these series otherwise: of all numbers of all players
// (foosball::players_digest()), of the default rules and tuning, and of a few seconds of play of
// each player of the series, which tell of what is no number, the physics and the players' code.
std::uint64_t game_fingerprint(const std::vector<SeriesDesc>& series);

}  // namespace match
