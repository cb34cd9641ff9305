// The file that keeps results: an SQLite database, in WAL mode, with a versioned schema.
//
// Calls read and write files and may wait for other programs' locks, for kBusy_ms at most: never
// for a tick's thread. Errors are sentences; a file that is damaged, locked, of a later version or
// no database is left as it is. A store is used by one thread at a time; several programs may have
// the same file open.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "results/match_result.h"
#include "results/questionnaire.h"

struct sqlite3;

namespace results {

inline constexpr int kSchemaVersion = 6;
inline constexpr int kBusy_ms = 2000;

enum class Access { read_only, create };

class Store {
 public:
  // create: makes the file if there is none, and brings an older one's schema up to date, within
  // one transaction. read_only: needs the file, and reads older ones as they are.
  static tl::expected<Store, std::string> open(const std::string& path, Access access);

  // All of it or nothing. Refused: what problem_with() finds. The id that it got.
  tl::expected<std::int64_t, std::string> add(const MatchResult& result);
  // Several in one transaction: all of them or none.
  tl::expected<void, std::string> add(std::span<const MatchResult> results);
  // The same of a player's answers. Refused too: of a match that is not there, of rods that have
  // answered for it already.
  tl::expected<std::int64_t, std::string> add(const Answers& answers);

  struct Filter {
    std::string player;      // of any team; empty: all
    std::size_t newest = 0;  // so many of the newest; 0: all
  };
  // In the order in which they were played.
  tl::expected<std::vector<MatchResult>, std::string> matches(const Filter& filter) const;
  // All, in the order in which they were given; of a file from before there were any: none.
  tl::expected<std::vector<Answers>, std::string> answers() const;

 private:
  struct Close {
    void operator()(sqlite3* database) const;
  };
  Store(std::string path, std::unique_ptr<sqlite3, Close> database, int version);
  std::string error() const;

  std::string path_;
  std::unique_ptr<sqlite3, Close> database_;
  int version_;
};

}  // namespace results
