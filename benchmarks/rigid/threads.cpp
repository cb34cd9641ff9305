// rigid-threads CSV SCENE...: the time of a step of Virtual Physics at 60 Hz with one thread and
// with 2, 4, ... by oneTBB, as many as the machine has cores. One world for each number of threads;
// they take turns of a quarter of a second, so that what else the machine does slows all. Prints a
// table and writes the rows that ./bench stores. All worlds must end in the same state.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "load.h"
#include "scenes/scene_world.h"
#include "vphysics/tbb_task_scheduler.h"

namespace {

constexpr double kRate = 60.0;  // [Hz]
constexpr int kTurn = 15;       // steps
// Goal: with two threads 1.7 times as fast as with one.
constexpr double kGoalOfTwo = 1.0 / 1.7;

struct Runner {
  int threads;
  scenes::SceneWorld world;
  double seconds = 0.0;  // of wall time, in all steps
};

int fail(const std::string& sentence) {
  std::fprintf(stderr, "rigid-threads: %s\n", sentence.c_str());
  return 1;
}

int run(const std::string& name, std::FILE* csv) {
  std::vector<Runner> runners;
  const int cores = std::max(2, static_cast<int>(std::thread::hardware_concurrency()));
  for (int threads = 1; threads <= cores; threads *= 2) {
    auto scene = rigid::load(name);
    if (!scene) return fail(scene.error().message);
    auto world = scenes::SceneWorld::create(std::move(*scene));
    if (!world) return fail(world.error().message);
    if (threads > 1) world->world().set_task_scheduler(vp::make_tbb_task_scheduler(threads));
    runners.push_back({threads, std::move(*world)});
  }
  const long steps = std::lround(runners.front().world.scene().seconds * kRate);
  for (long done = 0; done < steps; done += kTurn) {
    for (Runner& runner : runners) {
      const auto start = std::chrono::steady_clock::now();
      for (long i = done; i < std::min(steps, done + kTurn); ++i) {
        const auto stepped = runner.world.step(1.0 / kRate);
        if (!stepped) return fail(stepped.error().message);
      }
      runner.seconds +=
          std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }
  }
  const double alone = runners.front().seconds;
  for (Runner& runner : runners) {
    if (runner.world.world().state_hash() != runners.front().world.world().state_hash())
      return fail(name + " ends in another state with " + std::to_string(runner.threads) +
                  " threads");
    const double mean = 1e6 * runner.seconds / static_cast<double>(steps);
    std::printf("%-12s %3d threads %10.1f us a step, %.2f times as fast\n", name.c_str(),
                runner.threads, mean, alone / runner.seconds);
    std::fprintf(csv, "%s@60,Virtual Physics,step_mean_%d_us,%.1f,us\n", name.c_str(),
                 runner.threads, mean);
    if (runner.threads == 1) continue;
    std::fprintf(csv, "%s@60,Virtual Physics,time_of_%d_threads,%.3g,of one\n", name.c_str(),
                 runner.threads, runner.seconds / alone);
  }
  std::fprintf(csv, "%s@60,goal,time_of_2_threads,%.3g,of one\n", name.c_str(), kGoalOfTwo);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: %s CSV SCENE...; see ./bench threads\n", argv[0]);
    return 2;
  }
  std::FILE* const csv = std::fopen(argv[1], "w");
  if (!csv) return fail(std::string("cannot write ") + argv[1]);
  std::fprintf(csv, "subject,engine,metric,value,unit\n");
  int failed = 0;
  for (int i = 2; i < argc && failed == 0; ++i) failed = run(argv[i], csv);
  return std::fclose(csv) == 0 ? failed : fail(std::string("cannot write ") + argv[1]);
}
