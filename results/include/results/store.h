// The results file: an SQLite database in WAL mode with a versioned schema.
//
// Calls access files and may wait for other programs' locks, up to kBusy_ms: do not call them from
// the tick's thread. Errors are sentences. A file that is damaged, locked, of a later version or
// not a database is left unchanged. Use a store from one thread at a time. Several programs may
// have the same file open.
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
  // create: creates the file if it does not exist, and upgrades an older schema in one transaction.
  // read_only: the file must exist; reads older schemas unchanged.
  static tl::expected<Store, std::string> open(const std::string& path, Access access);

  // Adds a result in one transaction. Returns its id. Rejects results for which problem_with()
  // reports a problem.
  tl::expected<std::int64_t, std::string> add(const MatchResult& result);
  // Adds several results in one transaction: all or none.
  tl::expected<void, std::string> add(std::span<const MatchResult> results);
  // Adds a player's answers in the same way. Also rejects answers for a match that does not exist,
  // and for rods that have already answered for it.
  tl::expected<std::int64_t, std::string> add(const Answers& answers);

  struct Filter {
    std::string player;      // in any team; empty: all
    std::size_t newest = 0;  // number of newest matches; 0: all
  };
  // In the order of play.
  tl::expected<std::vector<MatchResult>, std::string> matches(const Filter& filter) const;
  // All, in the order of arrival. Empty for a file of a schema without answers.
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
