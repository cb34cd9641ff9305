// Robots on the ground in Virtual Physics and in MuJoCo, with steps of 5 ms: the same links,
// masses, joints, motors and torques. The engines take turns of a quarter of a second of simulated
// time.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>

#include "mujoco.h"
#include "ours.h"
#include "robots.h"

namespace {

using namespace robots;

constexpr double kStep = 0.005;  // [s]
constexpr int kSlice = 50;       // steps

struct Result {
  std::vector<double> slices;  // mean step time of each turn [us]
  double deepest = 0.0;        // maximum depth below the ground, in the second half [m]
  double speed = 0.0;          // maximum velocity at the end
};

double depth(const Robot& robot, const Simulation& simulation) {
  double deepest = 0.0;
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    if (robot.links[i].shapes.empty()) continue;
    const vp::SE3 T = simulation.pose(static_cast<int>(i));
    for (const RoundShape& shape : robot.links[i].shapes) {
      for (const vp::Vec3& end : {shape.from, shape.to}) {
        deepest = std::max(deepest, shape.radius - (T * end).z);
      }
    }
  }
  return deepest;
}

void run_slice(const Robot& robot, Simulation& simulation, bool late, Result& result) {
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < kSlice; ++i) simulation.step();
  const std::chrono::duration<double, std::micro> time = std::chrono::steady_clock::now() - begin;
  result.slices.push_back(time.count() / kSlice);
  if (late) result.deepest = std::max(result.deepest, depth(robot, simulation));
  result.speed = simulation.speed();
}

double median(std::vector<double> x) {
  const auto middle = x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2);
  std::nth_element(x.begin(), middle, x.end());
  return *middle;
}

struct Plan {
  double seconds = 10.0;  // simulated time
  int runs = 3;
  std::vector<std::string> names = robot_names();
  std::string csv;
};

void compare(const Robot& robot, const Plan& plan, std::FILE* csv) {
  Result ours, peer;
  const int slices = std::max(2, static_cast<int>(plan.seconds / (kSlice * kStep)));
  for (int run = 0; run < plan.runs; ++run) {
    const auto a = make_ours(robot, kStep);
    const auto b = make_mujoco(robot, kStep);
    for (int i = 0; i < slices; ++i) {
      run_slice(robot, *a, 2 * i >= slices, ours);
      run_slice(robot, *b, 2 * i >= slices, peer);
    }
  }
  const double mine = median(ours.slices), theirs = median(peer.slices);
  std::printf("%-10s  %8.2f us  %8.2f us  %6.2f times  %8.3f mm %8.3f mm  %8.4f %8.4f\n",
              robot.name.c_str(), mine, theirs, theirs / mine, 1e3 * ours.deepest,
              1e3 * peer.deepest, ours.speed, peer.speed);
  if (!csv) return;
  const char* subject = robot.name.c_str();
  const auto rows = [&](const char* engine, const Result& r, double step) {
    std::fprintf(csv, "%s,%s,step_us,%.4g,us\n", subject, engine, step);
    std::fprintf(csv, "%s,%s,penetration_mm,%.3g,mm\n", subject, engine, 1e3 * r.deepest);
    std::fprintf(csv, "%s,%s,speed_at_end,%.3g,rad/s\n", subject, engine, r.speed);
  };
  rows("Virtual Physics", ours, mine);
  rows("MuJoCo", peer, theirs);
  std::fprintf(csv, "%s,Virtual Physics,share_of_mujoco,%.3g,\n", subject, mine / theirs);
  std::fprintf(csv, "%s,goal,share_of_mujoco,0.5,\n", subject);
  std::fprintf(csv, "%s,goal,penetration_mm,1,mm\n", subject);
}

}  // namespace

int main(int argc, char** argv) {
  Plan plan;
  CLI::App cli("Robots on the ground, beside MuJoCo.");
  cli.add_option("--seconds", plan.seconds, "of each scene")->check(CLI::PositiveNumber);
  cli.add_option("--runs", plan.runs, "of each scene")->check(CLI::PositiveNumber);
  cli.add_option("--robots", plan.names, "only these")
      ->delimiter(',')
      ->check(CLI::IsMember(robot_names()));
  cli.add_option("--csv", plan.csv, "file for the rows subject,engine,metric,value,unit");
  CLI11_PARSE(cli, argc, argv);
  std::FILE* csv = nullptr;
  if (!plan.csv.empty() && !(csv = std::fopen(plan.csv.c_str(), "w"))) {
    std::fprintf(stderr, "%s cannot be written.\n", plan.csv.c_str());
    return 1;
  }
  if (csv) std::fprintf(csv, "subject,engine,metric,value,unit\n");
  std::printf(
      "median step, steps a second beside MuJoCo's, deepest, fastest in the end: Virtual Physics, "
      "MuJoCo\n");
  for (const std::string& name : plan.names) compare(make_robot(name), plan, csv);
  if (csv) std::fclose(csv);
  return 0;
}
