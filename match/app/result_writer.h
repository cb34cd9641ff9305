// Adds the matches of a run to a file of results (results/store.h), so many in one transaction. A
// file that fails ends nothing: what it does not take is written beside it, as CSV.
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
  static constexpr std::size_t kBatch = 256;   // results in memory, at most
  static constexpr std::int64_t kEvery_s = 2;  // a batch is added after so long, too

  // The error says what is wrong with the file.
  static tl::expected<ResultWriter, std::string> open(const std::string& path);

  // recording: of its journal, or empty. May wait for other programs' locks, for results::kBusy_ms.
  void add(const match::GameDesc& game, const match::GameResult& result, std::string recording);
  // Adds what is left. Empty, or the sentence that says what was not kept, and where it is.
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
  std::string problem_;  // the first one of the file
};

}  // namespace app
