#include "results/store.h"

#include <sqlite3.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>

namespace results {
namespace {

// Application id of the file: "SFrs". Databases of other programs have another number, or 0.
constexpr int kApplicationId = 0x53467273;

// Additions of each version to the previous one. Must not change once released.
constexpr const char* kMigrations[kSchemaVersion] = {
    // 1: results
    R"(CREATE TABLE match (
         id INTEGER PRIMARY KEY,
         finished_at TEXT NOT NULL,
         layout TEXT NOT NULL,
         goals_to_win INTEGER NOT NULL,
         max_goals INTEGER NOT NULL,
         seed TEXT NOT NULL,
         play_seconds REAL NOT NULL,
         recording TEXT NOT NULL) STRICT;
       CREATE TABLE team (
         match INTEGER NOT NULL REFERENCES match(id) ON DELETE CASCADE,
         team INTEGER NOT NULL CHECK (team IN (0, 1)),
         goals INTEGER NOT NULL CHECK (goals >= 0),
         PRIMARY KEY (match, team)) STRICT, WITHOUT ROWID;
       CREATE TABLE player (
         match INTEGER NOT NULL,
         team INTEGER NOT NULL,
         seat INTEGER NOT NULL,
         name TEXT NOT NULL,
         kind TEXT NOT NULL,
         PRIMARY KEY (match, team, seat),
         FOREIGN KEY (match, team) REFERENCES team(match, team) ON DELETE CASCADE)
         STRICT, WITHOUT ROWID;
       CREATE INDEX player_by_name ON player(name);
       CREATE INDEX match_by_date ON match(finished_at, id);)",
    // 2: statistics; null if not recorded
    R"(ALTER TABLE match ADD COLUMN shot_speed_median REAL;
       ALTER TABLE match ADD COLUMN shot_speed_fastest REAL;
       ALTER TABLE team ADD COLUMN shots INTEGER;
       ALTER TABLE team ADD COLUMN shots_on_target INTEGER;
       ALTER TABLE team ADD COLUMN saves INTEGER;
       ALTER TABLE team ADD COLUMN passes INTEGER;
       ALTER TABLE team ADD COLUMN touches INTEGER;
       ALTER TABLE team ADD COLUMN own_goals INTEGER;
       ALTER TABLE team ADD COLUMN possession_seconds REAL;)",
    // 3: the questionnaire; an unanswered question has no row
    R"(CREATE TABLE sheet (
         id INTEGER PRIMARY KEY,
         match INTEGER NOT NULL REFERENCES match(id) ON DELETE CASCADE,
         team INTEGER NOT NULL CHECK (team IN (0, 1)),
         rods INTEGER NOT NULL CHECK (rods BETWEEN 1 AND 255)) STRICT;
       CREATE INDEX sheet_by_match ON sheet(match);
       CREATE TABLE answer (
         sheet INTEGER NOT NULL REFERENCES sheet(id) ON DELETE CASCADE,
         question TEXT NOT NULL,
         score INTEGER NOT NULL CHECK (score BETWEEN 1 AND 5),
         PRIMARY KEY (sheet, question)) STRICT, WITHOUT ROWID;)",
    // 4: fraction of the match that each player played
    R"(ALTER TABLE player ADD COLUMN share REAL NOT NULL DEFAULT 1.0
         CHECK (share BETWEEN 0.0 AND 1.0);)",
    // 5: players who left
    R"(ALTER TABLE player ADD COLUMN has_left INTEGER NOT NULL DEFAULT 0
         CHECK (has_left IN (0, 1));)",
    // 6: each team's own fastest shot
    R"(ALTER TABLE team ADD COLUMN fastest_shot REAL;)"};

std::string sentence(const std::string& path, const std::string& why) {
  return "results in " + path + ": " + why;
}

// A prepared statement. step() returns SQLITE_ROW, SQLITE_DONE or a database error.
class Statement {
 public:
  Statement(sqlite3* database, const std::string& sql) {
    code_ = sqlite3_prepare_v2(database, sql.c_str(), -1, &statement_, nullptr);
  }
  ~Statement() { sqlite3_finalize(statement_); }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  template <class... Values>
  Statement& bind(const Values&... values) {
    int at = 0;
    (bind_one(++at, values), ...);
    return *this;
  }
  bool row() {
    if (code_ != SQLITE_OK && code_ != SQLITE_ROW) return false;
    code_ = sqlite3_step(statement_);
    return code_ == SQLITE_ROW;
  }
  bool run() {
    while (row()) {
    }
    return code_ == SQLITE_DONE;
  }
  bool done() const { return code_ == SQLITE_DONE; }

  bool null(int column) const { return sqlite3_column_type(statement_, column) == SQLITE_NULL; }
  std::int64_t integer(int column) const { return sqlite3_column_int64(statement_, column); }
  std::uint64_t count(int column) const {
    return static_cast<std::uint64_t>(std::max<std::int64_t>(0, integer(column)));
  }
  std::uint32_t small(int column) const {
    return static_cast<std::uint32_t>(std::min<std::uint64_t>(count(column), 0xffffffffu));
  }
  double real(int column) const { return sqlite3_column_double(statement_, column); }
  std::string text(int column) const {
    const auto* bytes = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
    const int size = sqlite3_column_bytes(statement_, column);
    return bytes == nullptr ? std::string() : std::string(bytes, static_cast<std::size_t>(size));
  }

 private:
  void bind_one(int at, std::int64_t x) { note(sqlite3_bind_int64(statement_, at, x)); }
  void bind_one(int at, int x) { bind_one(at, std::int64_t{x}); }
  void bind_one(int at, std::uint32_t x) { bind_one(at, std::int64_t{x}); }
  void bind_one(int at, std::uint64_t x) { bind_one(at, static_cast<std::int64_t>(x)); }
  void bind_one(int at, double x) { note(sqlite3_bind_double(statement_, at, x)); }
  void bind_one(int at, const std::string& x) {
    note(sqlite3_bind_text(statement_, at, x.data(), static_cast<int>(x.size()), SQLITE_TRANSIENT));
  }
  template <class T>
  void bind_one(int at, const std::optional<T>& x) {
    if (x) return bind_one(at, *x);
    note(sqlite3_bind_null(statement_, at));
  }
  void note(int code) {
    if (code_ == SQLITE_OK) code_ = code;
  }

  sqlite3_stmt* statement_ = nullptr;
  int code_ = SQLITE_OK;
};

bool run(sqlite3* database, const std::string& sql) {
  return sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK;
}

// Rolled back unless committed. The rollback overwrites the error that caused it: read that first.
class Transaction {
 public:
  explicit Transaction(sqlite3* database) : database_(database) {
    begun_ = run(database, "BEGIN IMMEDIATE");
  }
  ~Transaction() {
    // SQLite itself has already rolled back after a full disk.
    if (begun_ && sqlite3_get_autocommit(database_) == 0) run(database_, "ROLLBACK");
  }
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  bool begun() const { return begun_; }
  bool commit() {
    if (!run(database_, "COMMIT")) return false;
    begun_ = false;
    return true;
  }

 private:
  sqlite3* database_;
  bool begun_ = false;
};

std::optional<std::int64_t> pragma(sqlite3* database, const std::string& name) {
  Statement statement(database, "PRAGMA " + name);
  if (!statement.row()) return std::nullopt;
  return statement.integer(0);
}

std::string what_is_wrong(sqlite3* database) {
  switch (sqlite3_errcode(database) & 0xff) {
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return "another program has them locked; end it and try again";
    case SQLITE_NOTADB:
      return "the file is not a database of results; choose another file";
    case SQLITE_CORRUPT:
      return "the file is damaged; move it away, a new one is made";
    case SQLITE_CANTOPEN:
      return "the file cannot be opened; check its folder and permissions";
    case SQLITE_READONLY:
    case SQLITE_PERM:
      return "the file cannot be written; check its permissions";
    case SQLITE_FULL:
      return "the disk is full; make room";
    case SQLITE_IOERR:
      return "the file cannot be read or written to its end; check the disk, and limits on files";
    default:
      return std::string(sqlite3_errmsg(database));
  }
}

// Migrates in one transaction: if the program dies, the old version remains. Returns the problem,
// if any.
std::optional<std::string> migrate(sqlite3* database, int from) {
  Transaction transaction(database);
  const auto steps = [&] {
    // Another program may have migrated the file meanwhile.
    from = static_cast<int>(pragma(database, "user_version").value_or(from));
    for (int version = from; version < kSchemaVersion; ++version) {
      if (!run(database, kMigrations[version])) return false;
    }
    return run(database, "PRAGMA application_id = " + std::to_string(kApplicationId)) &&
           run(database, "PRAGMA user_version = " + std::to_string(kSchemaVersion)) &&
           transaction.commit();
  };
  if (transaction.begun() && steps()) return std::nullopt;
  return what_is_wrong(database);
}

std::optional<std::string> problem_with_file(const std::string& path, Access access) {
  std::error_code error;
  const auto kind = std::filesystem::status(path, error).type();
  if (kind == std::filesystem::file_type::not_found) {
    if (access == Access::create) return std::nullopt;
    return "there is no such file; a server writes it when it is started with --results";
  }
  if (kind != std::filesystem::file_type::regular)
    return "it is not a regular file; choose another";
  return std::nullopt;
}

}  // namespace

void Store::Close::operator()(sqlite3* database) const {
  sqlite3_close_v2(database);
}

Store::Store(std::string path, std::unique_ptr<sqlite3, Close> database, int version)
    : path_(std::move(path)), database_(std::move(database)), version_(version) {}

tl::expected<Store, std::string> Store::open(const std::string& path, Access access) {
  const auto refused = [&](const std::string& why) { return tl::unexpected(sentence(path, why)); };
  if (const auto problem = problem_with_file(path, access)) return refused(*problem);
  const int flags =
      access == Access::create ? SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE : SQLITE_OPEN_READONLY;
  sqlite3* opened = nullptr;
  const int code = sqlite3_open_v2(path.c_str(), &opened, flags | SQLITE_OPEN_NOMUTEX, nullptr);
  std::unique_ptr<sqlite3, Close> database(opened);
  if (!database) return refused("there is no memory for them");
  if (code != SQLITE_OK) return refused(what_is_wrong(opened));
  sqlite3_busy_timeout(opened, kBusy_ms);
  sqlite3_db_config(opened, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(opened, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);

  const auto version = pragma(opened, "user_version"), ours = pragma(opened, "application_id"),
             tables = pragma(opened, "schema_version");
  if (!version || !ours || !tables) return refused(what_is_wrong(opened));
  const bool fresh = *version == 0 && *ours == 0 && *tables == 0;
  if (!fresh && *ours != kApplicationId) {
    return refused("the file is not a database of results; choose another file");
  }
  if (*version > kSchemaVersion) {
    return refused("they are of version " + std::to_string(*version) + ", this program knows " +
                   std::to_string(kSchemaVersion) + "; use the release that wrote them");
  }
  if (access == Access::read_only && fresh) return refused("the file is empty");
  if (access == Access::create) {
    const bool ready = run(opened, "PRAGMA journal_mode = WAL") &&
                       run(opened, "PRAGMA synchronous = NORMAL") &&
                       run(opened, "PRAGMA foreign_keys = ON");
    if (!ready) return refused(what_is_wrong(opened));
    if (*version < kSchemaVersion) {
      if (const auto problem = migrate(opened, static_cast<int>(*version)))
        return refused(*problem);
    }
    return Store(path, std::move(database), kSchemaVersion);
  }
  return Store(path, std::move(database), static_cast<int>(*version));
}

std::string Store::error() const {
  return sentence(path_, what_is_wrong(database_.get()));
}

namespace {

// Call within a transaction. Returns the id; none after a database error.
std::optional<std::int64_t> insert(sqlite3* db, const MatchResult& result) {
  const auto& speeds = result.shot_speeds;
  bool ok = Statement(db,
                      "INSERT INTO match (finished_at, layout, goals_to_win, max_goals, seed, "
                      "play_seconds, recording, shot_speed_median, shot_speed_fastest) "
                      "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)")
                .bind(result.finished_at, result.layout, result.goals_to_win, result.max_goals,
                      std::to_string(result.seed), result.play_seconds, result.recording,
                      speeds ? std::optional(speeds->median) : std::nullopt,
                      speeds ? std::optional(speeds->fastest) : std::nullopt)
                .run();
  const std::int64_t id = sqlite3_last_insert_rowid(db);
  for (int t = 0; t < kTeams && ok; ++t) {
    const Team& team = result.teams[static_cast<std::size_t>(t)];
    const auto of = [&]<class T>(T TeamStatistics::*member) -> std::optional<T> {
      if (!team.statistics) return std::nullopt;
      return (*team.statistics).*member;
    };
    using S = TeamStatistics;
    ok = Statement(db,
                   "INSERT INTO team (match, team, goals, shots, shots_on_target, saves, passes, "
                   "touches, own_goals, possession_seconds, fastest_shot) "
                   "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)")
             .bind(id, t, team.goals, of(&S::shots), of(&S::shots_on_target), of(&S::saves),
                   of(&S::passes), of(&S::touches), of(&S::own_goals), of(&S::possession_seconds),
                   team.statistics ? team.statistics->fastest_shot : std::nullopt)
             .run();
    for (int seat = 0; seat < static_cast<int>(team.players.size()) && ok; ++seat) {
      const Player& player = team.players[static_cast<std::size_t>(seat)];
      ok = Statement(db,
                     "INSERT INTO player (match, team, seat, name, kind, share, has_left) "
                     "VALUES (?, ?, ?, ?, ?, ?, ?)")
               .bind(id, t, seat, player.name, player.kind, player.share, player.left ? 1 : 0)
               .run();
    }
  }
  return ok ? std::optional(id) : std::nullopt;
}

}  // namespace

tl::expected<std::int64_t, std::string> Store::add(const MatchResult& result) {
  if (const std::string problem = problem_with(result); !problem.empty()) {
    return tl::unexpected(sentence(path_, problem));
  }
  Transaction transaction(database_.get());
  const auto id = transaction.begun() ? insert(database_.get(), result) : std::nullopt;
  if (!id || !transaction.commit()) return tl::unexpected(error());
  return *id;
}

tl::expected<void, std::string> Store::add(std::span<const MatchResult> results) {
  for (const MatchResult& result : results) {
    if (const std::string problem = problem_with(result); !problem.empty()) {
      return tl::unexpected(sentence(path_, problem));
    }
  }
  Transaction transaction(database_.get());
  bool ok = transaction.begun();
  for (const MatchResult& result : results) ok = ok && insert(database_.get(), result).has_value();
  if (!ok || !transaction.commit()) return tl::unexpected(error());
  return {};
}

tl::expected<std::int64_t, std::string> Store::add(const Answers& answers) {
  if (const std::string problem = problem_with(answers); !problem.empty()) {
    return tl::unexpected(sentence(path_, problem));
  }
  sqlite3* const db = database_.get();
  Transaction transaction(db);
  if (!transaction.begun()) return tl::unexpected(error());
  const auto exists = [&](const char* sql) {
    return Statement(db, sql).bind(answers.match, answers.rods).row();
  };
  if (!exists("SELECT 1 FROM match WHERE id = ?1 AND ?2 > 0")) {
    return tl::unexpected(sentence(path_, "answers belong to a match that is not in the file"));
  }
  if (exists("SELECT 1 FROM sheet WHERE match = ?1 AND (rods & ?2) != 0")) {
    return tl::unexpected(sentence(path_, "this player has answered for the match already"));
  }
  bool ok = Statement(db, "INSERT INTO sheet (match, team, rods) VALUES (?, ?, ?)")
                .bind(answers.match, answers.team, answers.rods)
                .run();
  const std::int64_t id = sqlite3_last_insert_rowid(db);
  for (std::size_t q = 0; q < answers.scores.size() && ok; ++q) {
    if (answers.scores[q] == 0) continue;
    ok = Statement(db, "INSERT INTO answer (sheet, question, score) VALUES (?, ?, ?)")
             .bind(id, std::string(kQuestionnaire[q].key), answers.scores[q])
             .run();
  }
  if (!ok || !transaction.commit()) return tl::unexpected(error());
  return id;
}

tl::expected<std::vector<Answers>, std::string> Store::answers() const {
  std::vector<Answers> all;
  if (version_ < 3) return all;
  Statement rows(database_.get(),
                 "SELECT sheet.id, match, team, rods, question, score FROM sheet "
                 "JOIN answer ON answer.sheet = sheet.id ORDER BY sheet.id");
  while (rows.row()) {
    if (all.empty() || all.back().id != rows.integer(0)) {
      all.push_back(
          {rows.integer(0), rows.integer(1), rows.integer(2) == 0 ? 0 : 1, rows.small(3), {}});
    }
    const std::string key = rows.text(4);
    for (std::size_t q = 0; q < kQuestionnaire.size(); ++q) {
      if (key == kQuestionnaire[q].key)
        all.back().scores[q] = std::clamp(static_cast<int>(rows.integer(5)), 0, kMaxScore);
    }
  }
  if (!rows.done()) return tl::unexpected(error());
  return all;
}

namespace {

bool read_teams(sqlite3* db, int version, std::map<std::int64_t, MatchResult*>& by_id) {
  const std::string fastest = version < 6 ? "NULL" : "fastest_shot";
  Statement teams(db, version < 2 ? "SELECT match, team, goals FROM team"
                                  : "SELECT match, team, goals, shots, shots_on_target, saves, "
                                    "passes, touches, own_goals, possession_seconds, " +
                                        fastest + " FROM team");
  while (teams.row()) {
    const auto at = by_id.find(teams.integer(0));
    if (at == by_id.end()) continue;
    Team& team = at->second->teams[teams.integer(1) == 0 ? 0 : 1];
    team.goals = teams.small(2);
    if (version < 2 || teams.null(3)) continue;
    team.statistics = {teams.count(3), teams.count(4), teams.count(5), teams.count(6),
                       teams.count(7), teams.count(8), teams.real(9)};
    if (!teams.null(10)) team.statistics->fastest_shot = teams.real(10);
  }
  const std::string share = version < 4 ? "1.0" : "share", left = version < 5 ? "0" : "has_left";
  Statement players(db, "SELECT match, team, name, kind, " + share + ", " + left +
                            " FROM player ORDER BY match, team, seat");
  while (players.row()) {
    const auto at = by_id.find(players.integer(0));
    if (at == by_id.end()) continue;
    at->second->teams[players.integer(1) == 0 ? 0 : 1].players.push_back(
        {players.text(2), players.text(3), std::clamp(players.real(4), 0.0, 1.0),
         players.integer(5) != 0});
  }
  return teams.done() && players.done();
}

}  // namespace

tl::expected<std::vector<MatchResult>, std::string> Store::matches(const Filter& filter) const {
  sqlite3* const db = database_.get();
  if (!run(db, "BEGIN"))
    return tl::unexpected(error());  // a consistent state for all following reads
  std::string sql =
      "SELECT id, finished_at, layout, goals_to_win, max_goals, seed, play_seconds, recording";
  sql += version_ < 2 ? ", NULL, NULL" : ", shot_speed_median, shot_speed_fastest";
  sql += " FROM match";
  if (!filter.player.empty()) sql += " WHERE id IN (SELECT match FROM player WHERE name = ?1)";
  sql += " ORDER BY finished_at DESC, id DESC LIMIT ?2";
  std::vector<MatchResult> found;
  bool ok = false;
  {
    Statement rows(db, sql);
    constexpr std::int64_t kAll = -1;
    rows.bind(filter.player, filter.newest == 0 ? kAll : static_cast<std::int64_t>(filter.newest));
    while (rows.row()) {
      MatchResult& match = found.emplace_back();
      match.id = rows.integer(0);
      match.finished_at = rows.text(1);
      match.layout = rows.text(2);
      match.goals_to_win = rows.small(3);
      match.max_goals = rows.small(4);
      match.seed = std::strtoull(rows.text(5).c_str(), nullptr, 10);
      match.play_seconds = rows.real(6);
      match.recording = rows.text(7);
      if (!rows.null(8)) match.shot_speeds = ShotSpeeds{rows.real(8), rows.real(9)};
    }
    std::reverse(found.begin(), found.end());
    std::map<std::int64_t, MatchResult*> by_id;
    for (MatchResult& match : found) by_id[match.id] = &match;
    ok = rows.done() && read_teams(db, version_, by_id);
  }
  const std::string problem = ok ? std::string() : error();
  run(db, "ROLLBACK");
  if (!ok) return tl::unexpected(problem);
  return found;
}

}  // namespace results
