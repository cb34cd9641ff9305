// The results file: round trips, older and later versions, damaged and locked files.
#include "results/store.h"

#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>

#include "samples.h"

namespace results {
namespace {

namespace fs = std::filesystem;

class StoreTest : public testing::Test {
 protected:
  StoreTest() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(testing::TempDir()) /
              ("sf_results_" + std::string(test->name()) + "_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    path_ = (folder_ / "results.sqlite").string();
  }
  ~StoreTest() override { fs::remove_all(folder_); }

  Store made() {
    auto store = Store::open(path_, Access::create);
    EXPECT_TRUE(store) << store.error();
    return std::move(*store);
  }
  std::string refused(Access access) {
    const auto store = Store::open(path_, access);
    EXPECT_FALSE(store);
    return store ? "" : store.error();
  }
  void execute(const std::string& sql) {
    sqlite3* db = nullptr;
    ASSERT_EQ(sqlite3_open(path_.c_str(), &db), SQLITE_OK);
    char* message = nullptr;
    EXPECT_EQ(sqlite3_exec(db, sql.c_str(), nullptr, nullptr, &message), SQLITE_OK) << message;
    sqlite3_free(message);
    sqlite3_close(db);
  }

  fs::path folder_;
  std::string path_;
};

TEST_F(StoreTest, GivesBackWhatWasAddedInTheOrderOfPlay) {
  std::vector<MatchResult> added{match_between("Ann", "Bob", 5, 3, 2),
                                 match_between("Ann", "Cleo", 1, 5, 1)};
  added[1].teams[1].statistics.reset();
  added[1].shot_speeds.reset();
  added[1].teams[1].players.push_back({"D'Arcy \"the wall\"; DROP TABLE match", "person"});
  {
    Store store = made();
    for (MatchResult& match : added) match.id = store.add(match).value();
  }
  const Store store = Store::open(path_, Access::read_only).value();
  const auto found = store.matches({}).value();
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0], added[1]) << "finished first";
  EXPECT_EQ(found[1], added[0]);
  EXPECT_EQ(store.matches({.player = "Cleo", .newest = 0}).value().size(), 1u);
  EXPECT_EQ(store.matches({.player = "nobody", .newest = 0}).value().size(), 0u);
  const auto newest = store.matches({.player = "", .newest = 1}).value();
  ASSERT_EQ(newest.size(), 1u);
  EXPECT_EQ(newest[0], added[0]);
}

TEST_F(StoreTest, AddsABatchWholeOrNotAtAll) {
  Store store = made();
  std::vector<MatchResult> batch(40, match_between("Ann", "Bob", 5, 3));
  ASSERT_TRUE(store.add(batch));
  batch[39].finished_at = "yesterday";
  EXPECT_FALSE(store.add(batch));
  EXPECT_EQ(store.matches({}).value().size(), 40u);
  execute(
      "CREATE TRIGGER full BEFORE INSERT ON match WHEN NEW.seed = '7' "
      "BEGIN SELECT RAISE(ABORT, 'as a disk that fills'); END");
  batch[39] = batch[0];
  batch[39].seed = 7;
  const auto failed = store.add(batch);
  ASSERT_FALSE(failed);
  EXPECT_NE(failed.error().find("as a disk that fills"), std::string::npos) << failed.error();
  EXPECT_EQ(store.matches({}).value().size(), 40u) << "nothing of the second";
}

// A limit on the file's size simulates a disk that becomes full while the tables are created.
TEST_F(StoreTest, SaysThatItIsTheDiskThatFailed) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto ignored = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit tight{8192, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &tight), 0);
  const auto failed = Store::open(path_, Access::create);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, ignored);
  ASSERT_FALSE(failed);
  EXPECT_NE(failed.error().find("check the disk"), std::string::npos) << failed.error();
  EXPECT_TRUE(Store::open(path_, Access::create)) << "once there is room";
}

TEST_F(StoreTest, RefusesWhatIsNoResultAndKeepsNothingOfIt) {
  Store store = made();
  std::vector<MatchResult> bad(10, match_between("Ann", "Bob", 5, 3));
  bad[0].finished_at = "yesterday";
  bad[1].finished_at = "2026-13-22T20:00:00Z";
  bad[2].teams[0].players.clear();
  bad[3].teams[1].players[0].name = "";
  bad[4].play_seconds = std::numeric_limits<double>::quiet_NaN();
  bad[5].teams[0].players.resize(9, {"Ann", "person"});
  bad[6].recording.resize(5000, 'x');
  bad[7].teams[0].players[0].share = 1.01;
  bad[8].teams[0].players[0].share = std::numeric_limits<double>::quiet_NaN();
  bad[9].teams[1].statistics->fastest_shot = std::numeric_limits<double>::infinity();
  for (const MatchResult& match : bad) EXPECT_FALSE(store.add(match));
  EXPECT_TRUE(store.matches({}).value().empty());
}

Answers answers_of(std::int64_t match, int team, std::uint32_t rods) {
  return {.match = match, .team = team, .rods = rods, .scores = {5, 4, 0, 1, 3, 2}};
}

TEST_F(StoreTest, ReadsAndMigratesTheFirstVersion) {
  execute(R"(
    CREATE TABLE match (id INTEGER PRIMARY KEY, finished_at TEXT NOT NULL, layout TEXT NOT NULL,
      goals_to_win INTEGER NOT NULL, max_goals INTEGER NOT NULL, seed TEXT NOT NULL,
      play_seconds REAL NOT NULL, recording TEXT NOT NULL) STRICT;
    CREATE TABLE team (match INTEGER NOT NULL REFERENCES match(id) ON DELETE CASCADE,
      team INTEGER NOT NULL CHECK (team IN (0, 1)), goals INTEGER NOT NULL CHECK (goals >= 0),
      PRIMARY KEY (match, team)) STRICT, WITHOUT ROWID;
    CREATE TABLE player (match INTEGER NOT NULL, team INTEGER NOT NULL, seat INTEGER NOT NULL,
      name TEXT NOT NULL, kind TEXT NOT NULL, PRIMARY KEY (match, team, seat),
      FOREIGN KEY (match, team) REFERENCES team(match, team) ON DELETE CASCADE)
      STRICT, WITHOUT ROWID;
    CREATE INDEX player_by_name ON player(name);
    CREATE INDEX match_by_date ON match(finished_at, id);
    INSERT INTO match VALUES (7, '2026-01-02T03:04:05Z', 'paper', 5, 8, '42', 99.5, '');
    INSERT INTO team VALUES (7, 0, 5), (7, 1, 2);
    INSERT INTO player VALUES (7, 0, 0, 'Ann', 'person'), (7, 1, 0, 'Bob', 'computer');
    PRAGMA application_id = 1397125747;
    PRAGMA user_version = 1;)");
  const auto check = [](const Store& store) {
    const auto found = store.matches({}).value();
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].seed, 42u);
    EXPECT_EQ(found[0].teams[0].goals, 5u);
    EXPECT_EQ(found[0].teams[1].players[0], (Player{"Bob", "computer", 1.0}));
    EXPECT_FALSE(found[0].teams[0].statistics || found[0].shot_speeds);
  };
  check(Store::open(path_, Access::read_only).value());
  Store store = made();
  check(store);
  ASSERT_TRUE(store.add(match_between("Ann", "Bob", 5, 3)));
  EXPECT_TRUE(store.matches({.player = "", .newest = 1}).value()[0].teams[0].statistics);
  EXPECT_TRUE(store.add(answers_of(7, 0, 1))) << "of a match from before there were answers";
}

TEST_F(StoreTest, KeepsHowMuchOfAMatchEachHasPlayedAndWhoHasLeft) {
  MatchResult match = match_between("Ann", "Bob", 5, 3);
  match.teams[0].players = {{"Ann", "person", 0.625, true}, {"computer 2", "computer", 0.375}};
  ASSERT_TRUE(made().add(match));
  const auto found = Store::open(path_, Access::read_only).value().matches({}).value();
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].teams, match.teams);
}

TEST_F(StoreTest, KeepsAnswersWithTheMatchThatTheyFollow) {
  std::vector<Answers> added;
  {
    Store store = made();
    const auto first = store.add(match_between("Ann", "Bob", 5, 3)).value();
    const auto second = store.add(match_between("Ann", "Bob", 2, 5, 1)).value();
    added = {answers_of(second, 1, 0xF0), answers_of(first, 0, 0x0B), answers_of(first, 0, 0x20)};
    for (Answers& answers : added) answers.id = store.add(answers).value();
  }
  EXPECT_EQ(Store::open(path_, Access::read_only).value().answers().value(), added);
  execute("PRAGMA foreign_keys = ON; DELETE FROM match WHERE id = 1");
  const auto left = Store::open(path_, Access::read_only).value().answers().value();
  ASSERT_EQ(left.size(), 1u) << "they go with their match";
  EXPECT_EQ(left[0], added[0]);
}

TEST_F(StoreTest, RefusesAnswersOfNobodyOfNoMatchAndGivenTwice) {
  Store store = made();
  const auto match = store.add(match_between("Ann", "Bob", 5, 3)).value();
  ASSERT_TRUE(store.add(answers_of(match, 0, 0x03)));
  std::vector<Answers> bad(7, answers_of(match, 0, 0x04));
  bad[0].match = match + 1;
  bad[1].rods = 0x06;  // one of them has already answered
  bad[2].team = 2;
  bad[3].rods = 0;
  bad[4].rods = 0x100;
  bad[5].scores = {};
  bad[6].scores[2] = kMaxScore + 1;
  for (std::size_t i = 0; i < bad.size(); ++i) EXPECT_FALSE(store.add(bad[i])) << i;
  EXPECT_EQ(store.answers().value().size(), 1u);
}

// A file of the release before the questionnaire.
TEST_F(StoreTest, ReadsAndMigratesTheSecondVersion) {
  { ASSERT_TRUE(made().add(match_between("Ann", "Bob", 5, 3))); }
  execute(
      "DROP TABLE answer; DROP TABLE sheet; ALTER TABLE player DROP COLUMN share; "
      "ALTER TABLE player DROP COLUMN has_left; ALTER TABLE team DROP COLUMN fastest_shot; "
      "PRAGMA user_version = 2");
  {
    const Store old = Store::open(path_, Access::read_only).value();
    EXPECT_EQ(old.matches({}).value().size(), 1u);
    EXPECT_TRUE(old.answers().value().empty());
  }
  Store store = made();
  const auto matches = store.matches({}).value();
  ASSERT_EQ(matches.size(), 1u);
  EXPECT_TRUE(matches[0].teams[0].statistics);
  ASSERT_TRUE(store.add(answers_of(matches[0].id, 1, 0xF0)));
  EXPECT_EQ(store.answers().value().size(), 1u);
}

// A file of the release before the fractions of play.
TEST_F(StoreTest, ReadsAndMigratesTheThirdVersion) {
  { ASSERT_TRUE(made().add(match_between("Ann", "Bob", 5, 3))); }
  execute(
      "ALTER TABLE player DROP COLUMN share; ALTER TABLE player DROP COLUMN has_left; "
      "ALTER TABLE team DROP COLUMN fastest_shot; PRAGMA user_version = 3");
  const auto share = [](const Store& store) {
    return store.matches({}).value().at(0).teams[0].players.at(0).share;
  };
  EXPECT_EQ(share(Store::open(path_, Access::read_only).value()), 1.0);
  EXPECT_EQ(share(made()), 1.0) << "whoever played then played all of it";
}

// A file of the release before leavers were recorded.
TEST_F(StoreTest, ReadsAndMigratesTheFourthVersion) {
  MatchResult match = match_between("Ann", "Bob", 5, 3);
  match.teams[0].players[0].left = true;
  { ASSERT_TRUE(made().add(match)); }
  const auto left = [](const Store& store) {
    return store.matches({}).value().at(0).teams[0].players.at(0).left;
  };
  EXPECT_TRUE(left(made()));
  execute(
      "ALTER TABLE player DROP COLUMN has_left; ALTER TABLE team DROP COLUMN fastest_shot; "
      "PRAGMA user_version = 4");
  EXPECT_FALSE(left(Store::open(path_, Access::read_only).value()));
  EXPECT_FALSE(left(made())) << "nobody knows any more";
}

// A file of the release before each team's fastest shot.
TEST_F(StoreTest, ReadsAndMigratesTheFifthVersion) {
  { ASSERT_TRUE(made().add(match_between("Ann", "Bob", 5, 3))); }
  const auto fastest = [](const Store& store) {
    return store.matches({}).value().at(0).teams[1].statistics.value().fastest_shot;
  };
  EXPECT_EQ(fastest(made()), 8.5);
  execute("ALTER TABLE team DROP COLUMN fastest_shot; PRAGMA user_version = 5");
  EXPECT_EQ(fastest(Store::open(path_, Access::read_only).value()), std::nullopt);
  Store store = made();
  EXPECT_EQ(fastest(store), std::nullopt) << "nobody knows whose the fastest was";
  ASSERT_TRUE(store.add(match_between("Ann", "Bob", 5, 3)));
  EXPECT_EQ(store.matches({.player = "", .newest = 1}).value()[0].teams[0].statistics->fastest_shot,
            9.25);
}

TEST_F(StoreTest, SaysWhichVersionItNeeds) {
  { (void)made(); }
  execute("PRAGMA user_version = 99");
  for (const Access access : {Access::read_only, Access::create}) {
    const std::string said = refused(access);
    EXPECT_NE(said.find("version 99"), std::string::npos) << said;
    EXPECT_NE(said.find(path_), std::string::npos) << said;
  }
}

TEST_F(StoreTest, LeavesFilesOfOthersAlone) {
  execute("CREATE TABLE theirs (x)");
  EXPECT_NE(refused(Access::create).find("not a database of results"), std::string::npos);
  const std::string text(5000, 'x');
  std::ofstream(path_) << text;
  EXPECT_NE(refused(Access::create).find("not a database of results"), std::string::npos);
  EXPECT_EQ(fs::file_size(path_), text.size());
  fs::remove(path_);
  EXPECT_NE(refused(Access::read_only).find("no such file"), std::string::npos);
  fs::create_directory(path_);
  EXPECT_NE(refused(Access::create).find("not a regular file"), std::string::npos);
  path_ = "/nowhere/at/all.sqlite";
  EXPECT_NE(refused(Access::create).find("cannot be opened"), std::string::npos);
}

// Every page except the first is overwritten: an error as a sentence, or the undamaged results; no
// crash.
TEST_F(StoreTest, SurvivesADamagedFile) {
  {
    Store store = made();
    for (int i = 0; i < 50; ++i) ASSERT_TRUE(store.add(match_between("Ann", "Bob", 5, 3, i)));
  }
  const auto size = fs::file_size(path_);
  for (std::uintmax_t at = 4096; at < size; at += 4096) {
    const std::string before = [&] {
      std::ifstream file(path_, std::ios::binary);
      return std::string(std::istreambuf_iterator<char>(file), {});
    }();
    std::fstream(path_, std::ios::binary | std::ios::in | std::ios::out)
        .seekp(static_cast<std::streamoff>(at))
        .write(std::string(4096, '\x5a').data(), 4096);
    auto store = Store::open(path_, Access::create);
    if (store) {
      const auto added = store->add(match_between("Ann", "Bob", 5, 3));
      const auto found = store->matches({});
      for (const std::string& said :
           {added ? path_ : added.error(), found ? path_ : found.error()}) {
        EXPECT_NE(said.find(path_), std::string::npos) << said;
      }
    }
    store = tl::unexpected(std::string());
    for (const char* more : {"-wal", "-shm"}) fs::remove(path_ + more);
    std::ofstream(path_, std::ios::binary) << before;
  }
}

TEST_F(StoreTest, SaysThatItIsLockedAndWaitsNoLongerThanItMust) {
  Store store = made();
  sqlite3* other = nullptr;
  ASSERT_EQ(sqlite3_open(path_.c_str(), &other), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(other, "BEGIN IMMEDIATE", nullptr, nullptr, nullptr), SQLITE_OK);
  const auto before = std::chrono::steady_clock::now();
  const auto added = store.add(match_between("Ann", "Bob", 5, 3));
  ASSERT_FALSE(added);
  EXPECT_NE(added.error().find("locked"), std::string::npos) << added.error();
  EXPECT_LT(std::chrono::steady_clock::now() - before, std::chrono::milliseconds(5 * kBusy_ms));
  EXPECT_TRUE(store.matches({})) << "readers are not held up";
  sqlite3_close(other);
  EXPECT_TRUE(store.add(match_between("Ann", "Bob", 5, 3))) << "and then it goes on";
}

}  // namespace
}  // namespace results
