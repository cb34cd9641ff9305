// Adds the matches of a run to a results file (results/store.h), in batches of one transaction. If
// the file fails, the run continues, and the rejected results go to a CSV file beside it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "match/game.h"
#include "results/store.h"

namespace app {

class ResultWriter {
 public:
  static constexpr std::size_t kBatch = 256;   // maximum number of results in memory
  static constexpr std::int64_t kEvery_s = 2;  // maximum time before a batch is added

  // The error describes the problem with the file.
  static tl::expected<ResultWriter, std::string> open(const std::string& path);

  // recording: path of the journal, or empty. May wait for other programs' locks, up to
  // results::kBusy_ms.
  void add(const match::GameDesc& game, const match::GameResult& result, std::string recording);
  // Adds the remaining results. Returns an empty text, or a sentence that says what the file did
  // not accept and where it is.
  std::string finish();
  std::uint64_t kept() const { return kept_; }

 private:
  ResultWriter(std::string path, results::Store store)
      : path_(std::move(path)), store_(std::move(store)) {}
  void flush();
  void put_aside();

  std::string path_;
  results::Store store_;
  std::vector<results::MatchResult> waiting_;
  std::int64_t flushed_s_ = 0;
  std::uint64_t kept_ = 0, aside_ = 0, lost_ = 0;
  std::string problem_;  // the first problem of the file
};

}  // namespace app
