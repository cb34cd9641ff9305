// Shell scripts imitate engines' programs with all kinds of failures: each is a line in the table.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "agreement.h"
#include "load.h"
#include "measure.h"
#include "report.h"
#include "scene_json.h"
#include "scenes/touchstone.h"

namespace rigid {
namespace {

class Race : public testing::Test {
 public:
  ~Race() override { std::filesystem::remove_all(folder_); }

 protected:
  Race() {
    std::string name = (std::filesystem::temp_directory_path() / "rigid-race-XXXXXX").string();
    folder_ = mkdtemp(name.data());
    plan_.scenes = {"tower10"};
    plan_.rates = {60};
    plan_.engines = {"bullet"};
    plan_.seconds = plan_.seconds_at_60 = 0.5;
    plan_.patience = 10.0;
    plan_.programs = folder_;
  }

  void script(const std::string& name, const std::string& text) {
    const std::string path = folder_ + "/" + name;
    std::ofstream(path) << "#!/bin/sh\n" << text;
    chmod(path.c_str(), 0755);
  }
  std::vector<Figure> run() {
    return measure(plan_, [](const std::string&) {});
  }
  // Why the only engine has no results.
  std::string missing() {
    const auto figures = run();
    EXPECT_EQ(figures.size(), 1u);
    EXPECT_NE(table(figures).find(figures[0].missing), std::string::npos);
    return figures[0].missing;
  }

  std::string folder_;
  Plan plan_{.scenes = {}, .rates = {}, .engines = {}};
};

TEST_F(Race, LeavesOutWhoIsNotThere) {
  plan_.engines = {"bullet", "vphysics-wasm", "jolt"};
  const auto figures = run();
  ASSERT_EQ(figures.size(), 3u);
  EXPECT_EQ(figures[0].missing, "not built: its package is missing");
  EXPECT_EQ(figures[1].missing, "not built for WebAssembly");
  EXPECT_EQ(figures[2].missing, "its npm package is not installed");
}

TEST_F(Race, SurvivesWhoCrashesBeforeAndAfterItsFirstTurn) {
  script("rigid-bullet", "kill -SEGV $$\n");
  EXPECT_EQ(missing(), "crashed: Segmentation fault");
  script("rigid-bullet", "echo ready; read turn; kill -ABRT $$\n");
  EXPECT_EQ(missing(), "crashed: Aborted");
  script("rigid-bullet", "echo ready; read turn; echo more; read turn; exit 7\n");
  EXPECT_EQ(missing(), "ended with exit code 7");
}

TEST_F(Race, EndsWhoDoesNotAnswer) {
  plan_.patience = 0.2;
  script("rigid-bullet", "exec sleep 1000\n");
  EXPECT_EQ(missing(), "gave no answer within 0 s");
}

TEST_F(Race, PassesOverWhatIsNoAnswer) {
  script("rigid-bullet", "echo hello; head -c 300000 /dev/zero; echo; echo cannot do it\n");
  EXPECT_EQ(missing(), "do it");
}

TEST_F(Race, TellsWhatIsLeftBehindBroken) {
  for (const char* left :
       {"", "simulated 10", "simulated 10\\nrss_mb 1\\nfastest 0\\nsteps 2\\n1\\n",
        "simulated 10\\nrss_mb 1\\nfastest 0\\nsteps 0\\nposes 3\\n"}) {
    script("rigid-bullet",
           std::string("echo ready; read turn; printf '") + left + "' >$4; echo end finished\n");
    EXPECT_EQ(missing(), "what it left behind cannot be read") << left;
  }
}

TEST_F(Race, LeavesOutWhoStopsEarlyAndCountsLostBodies) {
  const std::string poses =
      " for i in 1 2 3 4 5 6 7 8 9 10 11; do echo nan 0 0 0 1 0 0 0 1 0 0 0; done;";
  const auto leaving = [&](const std::string& seconds) {
    script("rigid-bullet",
           "echo ready; read turn; (echo simulated " + seconds +
               "; echo rss_mb 1; echo fastest 0; echo steps 2; echo 5; echo 7; echo poses 11;" +
               poses + " echo whole) >$4; echo end stopped: diverged\n");
  };
  leaving("0.5");
  EXPECT_EQ(missing(), "stopped: diverged, after 0.5 s");
  leaving("5");
  const auto figures = run();
  ASSERT_EQ(figures[0].missing, "");
  EXPECT_EQ(figures[0].standing.lost, 10);
  EXPECT_EQ(figures[0].standing.in_place, 0);
  EXPECT_EQ(figures[0].settled_us, 0.0);
  EXPECT_NE(table(figures).find("stopped: diverged"), std::string::npos);
}

// Programs whose times differ in every run n.
class Repeated : public Race {
 protected:
  Repeated() { plan_.engines = {"vphysics", "bullet"}; }

  // Runs three steps; `end` is a coordinate of its bodies' final poses.
  void play(const std::string& program, const std::string& end, const std::string& steps) {
    const std::string count = folder_ + "/" + program + ".count";
    std::ofstream(count) << "0\n";
    script(program, "read n <" + count + "; n=$((n + 1)); echo $n >" + count +
                        "; echo ready; read turn; (echo simulated 10; echo rss_mb 1; echo fastest "
                        "0.5; echo steps 3; for us in " +
                        steps +
                        "; do echo $us; done; echo poses 11; for i in 1 2 3 4 5 6 7 8 9 10 11; do "
                        "echo 1 0 0 0 1 0 0 0 1 " +
                        end + " 0 0; done; echo whole) >$4; echo end finished\n");
  }
};

TEST_F(Repeated, KeepsTheLeastOfEachStep) {
  play("rigid-ours", "0", "$((10 + n)) $((30 - n)) 25");
  play("rigid-bullet", "0", "$((100 + n)) $((100 - n)) $((400 / n))");
  const auto figures = run();
  ASSERT_EQ(figures.size(), 2u);
  EXPECT_EQ(figures[0].runs, 3);
  EXPECT_EQ(figures[0].min_us, (std::vector<double>{11, 27, 25}));
  EXPECT_EQ(figures[0].median_us, 25.0);
  EXPECT_EQ(figures[0].steps_us, (std::vector<double>{11, 29, 25}));
  EXPECT_EQ(figures[1].min_us, (std::vector<double>{101, 97, 133}));
  EXPECT_DOUBLE_EQ(share(figures[0], figures[1]), 25.0 / 101.0);
  EXPECT_NE(csv(figures).find("tower10@60,Bullet,runs,3,\n"), std::string::npos);
  // If one engine was run only once, the first runs are compared.
  Figure once = figures[1];
  once.runs = 1;
  EXPECT_DOUBLE_EQ(share(figures[0], once), 25.0 / 101.0);
  once.steps_us = {50, 50, 50};
  EXPECT_DOUBLE_EQ(share(figures[0], once), 0.5);

  plan_.rates = {240};
  EXPECT_EQ(run()[0].runs, 1);
}

TEST_F(Repeated, CountsAllOrNone) {
  play("rigid-ours", "0", "$((40 / n)) $((40 / n)) $((40 / n))");
  play("rigid-bullet", "$n", "$((80 / n)) $((80 / n)) $((80 / n))");
  const auto elsewhere = run();
  EXPECT_EQ(elsewhere[0].runs, 1);
  EXPECT_EQ(elsewhere[1].runs, 1);
  EXPECT_DOUBLE_EQ(share(elsewhere[0], elsewhere[1]), 0.5);

  play("rigid-ours", "0", "$((40 / n)) $((40 / n)) $((40 / n))");
  play("rigid-bullet", "0", "1000000 1000000 1000000");
  plan_.repeated_within = 2.0;
  const auto too_long = run();
  EXPECT_EQ(too_long[0].runs, 1);
  EXPECT_EQ(too_long[0].median_us, 40.0);
}

// Our own complete program: two engines that take turns, one of which does not answer.
TEST_F(Race, GoesOnWithTheOthers) {
  std::filesystem::create_symlink(RIGID_OURS, folder_ + "/rigid-ours");
  script("rigid-bullet", "echo ready; read turn; echo more; kill -KILL $$\n");
  plan_.engines = {"bullet", "vphysics"};
  plan_.seconds_at_60 = 10.0;
  const auto figures = run();
  ASSERT_EQ(figures.size(), 2u);
  EXPECT_EQ(figures[0].missing, "crashed: Killed");
  EXPECT_EQ(figures[1].missing, "");
  EXPECT_EQ(figures[1].ended, "finished");
  EXPECT_DOUBLE_EQ(figures[1].simulated, 10.0);
  EXPECT_EQ(figures[1].steps_us.size(), 560u);  // 600 without the first of each of 40 turns
  EXPECT_GT(figures[1].p99_us, figures[1].median_us);
  EXPECT_GT(figures[1].rss_mb, 1.0);
  EXPECT_GE(figures[1].fastest, 0.0);
  EXPECT_LT(figures[1].fastest, 1e-3);  // [m/s]: the tower is at rest
  EXPECT_EQ(figures[1].standing.of, 10);
  const std::string rows = csv(figures);
  EXPECT_NE(rows.find("tower10@60,Bullet,missing,crashed: Killed,"), std::string::npos);
  EXPECT_NE(rows.find("tower10@60,Virtual Physics,step_median_us,"), std::string::npos);
}

TEST_F(Race, LeavesHigherRatesOutWhereItIsTold) {
  plan_.rates = {60, 240};
  EXPECT_EQ(run().size(), 2u);
  plan_.at_60_alone = {"tower10"};
  EXPECT_EQ(run().size(), 1u);
}

TEST_F(Race, TimesNobodyWhoHasTheScenesWrong) {
  // Does not move.
  script("rigid-bullet",
         "echo ready; read turn; (echo simulated 1; echo rss_mb 1; echo fastest -1; echo steps 0; "
         "echo poses " +
             std::to_string(scenes::touchstone().scene.bodies.size()) +
             "; for i in 1 2 3 4 5 6 7 8; do echo 1 0 0 0 1 0 0 0 1 0 0 0; done; echo whole) >$4;"
             " echo end finished\n");
  std::filesystem::create_symlink(RIGID_OURS, folder_ + "/rigid-ours");
  plan_.engines = {"bullet", "vphysics"};
  const auto agreed = agreement(plan_);
  ASSERT_EQ(agreed.size(), 2u);
  EXPECT_TRUE(agreed[0].wrong.starts_with("a box slides: off by")) << agreed[0].wrong;
  EXPECT_EQ(agreed[1].wrong, "");
  EXPECT_LT(agreed[1].worst, 0.03);
  plan_ = of_those_who_agree(plan_, agreed);
  const auto figures = run();
  EXPECT_EQ(figures[0].missing, agreed[0].wrong);
  EXPECT_EQ(figures[1].missing, "");
}

Figure timed(const char* engine, const std::vector<double>& steps) {
  Figure figure{.scene = "tower10", .engine = engine, .rate = 60};
  figure.steps_us = steps;
  return figure;
}

// A pile costs little while it falls: an engine that was stopped then must not appear faster.
TEST(Share, IsOfTheStepsThatBothHaveMade) {
  const Figure whole = timed("Bullet", {10, 10, 10, 90, 90, 90, 90, 90});
  const Figure cut = timed("ODE", {20, 20, 20});
  EXPECT_DOUBLE_EQ(share(cut, whole), 2.0);
  EXPECT_DOUBLE_EQ(share(whole, cut), 0.5);
  EXPECT_DOUBLE_EQ(share(whole, timed("MuJoCo", {})), 0.0);
}

// A crash must not remove a goal from the report.
TEST(Goals, AreKeptWhereThereIsNothingToShow) {
  const std::vector<Figure> crashed = {
      {.scene = "towers1120", .engine = kOurs, .rate = 60, .missing = "crashed"}};
  EXPECT_NE(csv(crashed).find("towers1120@60,goal,drift_mm,5,mm\n"), std::string::npos);
  EXPECT_EQ(csv(crashed).find("pyramid1128"), std::string::npos);
  EXPECT_EQ(csv(crashed).find("share_of_bullet"), std::string::npos);  // Bullet was not run
  EXPECT_NE(goals_table(crashed).find("short"), std::string::npos);
  EXPECT_EQ(goals_table(crashed).find("met\n"), std::string::npos);
}

TEST(Goals, OfGrowthCountTheHeapThatCameToNoEnd) {
  std::vector<Figure> heaps;
  for (const auto& [name, us] : {std::pair("heap10", 10.0), {"heap20", 20.0}, {"heap40", 40.0}}) {
    heaps.push_back({.scene = name, .engine = kOurs, .rate = 60, .settled_us = us});
  }
  EXPECT_NE(csv(heaps).find("heaps@60,Virtual Physics,growth_exponent,1,\n"), std::string::npos);
  heaps[2].settled_us = 0.0;
  EXPECT_EQ(csv(heaps).find("heaps@60,Virtual Physics"), std::string::npos);
  EXPECT_NE(csv(heaps).find("heaps@60,goal,growth_exponent,1.11,\n"), std::string::npos);
}

std::string json_of(const std::string& name) {
  const auto file = std::filesystem::temp_directory_path() / ("rigid-race-" + name + ".json");
  EXPECT_TRUE(write_json(load(name).value(), file.string()));
  std::ifstream in(file);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  std::filesystem::remove(file);
  return text;
}
int count_of(const std::string& text, const std::string& word) {
  int count = 0;
  for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

TEST(SceneJson, WritesWhatBodiesShareOnce) {
  const std::string trees = json_of("trees100");
  EXPECT_EQ(count_of(trees, "\"points\""), 22);
  EXPECT_EQ(count_of(trees, "\"vertices\""), 1);
  EXPECT_EQ(count_of(trees, "\"kind\":\"hull\""), 22 * 50);
}

TEST(SceneJson, TellsWhatComesAndGoes) {
  const std::string rain = json_of("rain");
  const int figures = 30;
  EXPECT_EQ(count_of(rain, "\"from_start\":true"), 100 + figures * (12 + 11));
  EXPECT_EQ(count_of(rain, "\"addBody\""), 14 * figures * 12);
  EXPECT_EQ(count_of(rain, "\"removeJoint\""), 15 * figures * 11);
}

TEST(Load, RefusesTablesThatAreNone) {
  for (const char* name : {"table", "table0", "table-1", "table1001", "table1x"}) {
    EXPECT_FALSE(load(name).has_value()) << name;
  }
  EXPECT_EQ(load("table200").value().bodies.size(), 211u);
}

}  // namespace
}  // namespace rigid
