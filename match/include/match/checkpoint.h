// The results of finished games in a file, one line each, appended as they come and on disk
// (fdatasync) before the next: a run that was killed goes on from there and gives the same totals.
// A last line that was cut off, or any line that was changed, is not read, and its game is played
// again.
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
    GameResult result;
  };
  struct Opened {
    std::unique_ptr<Checkpoint> checkpoint;
    std::vector<Line> lines;  // what was finished before
    int unreadable = 0;       // lines
  };

  // Creates the file, or continues it if its head is that of the same series played by the same
  // game. plan: what else the games depend on, if these series are only the first. The error is a
  // sentence.
  static tl::expected<Opened, std::string> open(const std::string& path,
                                                const std::vector<SeriesDesc>& series,
                                                const std::string& plan = {});
  tl::expected<void, std::string> append(JobId id, const GameResult& result);

 private:
  Checkpoint(std::string path, os::FileDescriptor file)
      : path_(std::move(path)), file_(std::move(file)) {}
  tl::expected<void, std::string> write(const std::string& text);

  std::string path_;
  os::FileDescriptor file_;
};

// Differs between programs that do not play the same game: a hash of a few seconds of play.
std::uint64_t game_fingerprint();

}  // namespace match
