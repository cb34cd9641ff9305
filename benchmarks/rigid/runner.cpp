// The main of each engine's program: rigid-ENGINE SCENE HZ CPU_SECONDS FILE. It steps the scene on
// request, so that engines take turns, and writes its results to FILE.
//
//   output     ready SETTINGS           the scene is built
//              cannot SENTENCE          the engine cannot run the scene; the program ends
//   input      N                        number of steps to run
//   output     more                     they are done
//              end WHY                  FILE is written, the program ends; WHY: finished, budget,
//                                       or stopped with the reason
//
// FILE: "simulated S", "rss_mb M", "fastest V" [m/s] or -1, "steps K" and K lines [us], "poses B"
// and B lines, each the three columns of the rotation and the position. It ends with "whole".
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include "cpu.h"
#include "engine.h"
#include "load.h"

namespace {

using rigid::cpu_us;

struct Order {
  std::string scene, file;
  double rate = 60.0, budget_us = 10e6;
};

int print_answer(const char* word, const std::string& text) {
  std::printf("%s %s\n", word, text.c_str());
  std::fflush(stdout);
  return 0;
}

class Run {
 public:
  Run(const scenes::Scene& scene, rigid::Engine& engine, const Order& order)
      : scene_(scene),
        engine_(engine),
        order_(order),
        events_(scenes::events_of(scene)),
        steps_(std::lround(scene.seconds * order.rate)) {
    times_.reserve(static_cast<std::size_t>(steps_));
  }

  // Runs the steps of a turn. Returns why the run is over, or nothing. The first step finds the
  // caches as the last engine has left them; its time is dropped, except in turns of less than ten
  // steps.
  std::string turn(long count) {
    const bool drop_first = count >= 10;
    for (long i = 0; i < count && done_ < steps_; ++i) {
      if (!step(i > 0 || !drop_first)) return "stopped: " + engine_.trouble();
      if (spent_us_ > order_.budget_us && done_ < steps_) return "budget";
    }
    return done_ == steps_ ? "finished" : "";
  }

  bool write() const {
    std::ofstream out(order_.file);
    out.precision(17);
    const auto poses = engine_.poses();
    out << "simulated " << static_cast<double>(done_) / order_.rate << "\nrss_mb "
        << rigid::peak_mb() << "\nfastest " << fastest(poses) << "\nsteps " << times_.size()
        << '\n';
    for (const double t : times_) out << t << '\n';
    out << "poses " << poses.size() << '\n';
    for (const vp::SE3& T : poses) {
      for (int k = 0; k < 9; ++k) out << T.rotation()(k % 3, k / 3) << ' ';
      out << T.position().x << ' ' << T.position().y << ' ' << T.position().z << '\n';
    }
    out << "whole\n";
    out.close();
    return static_cast<bool>(out);
  }

 private:
  void handle(const scenes::Event& event) {
    using Kind = scenes::Event::Kind;
    switch (event.kind) {
      case Kind::remove_joint:
        return engine_.remove_joint(event.index);
      case Kind::remove_body:
        return engine_.remove_body(event.index);
      case Kind::add_body:
        return engine_.add_body(event.index);
      case Kind::add_joint:
        return engine_.add_joint(event.index);
      case Kind::launch:
        return engine_.launch(scene_.launches[event.index]);
    }
  }

  // The maximum mean speed of a body in the last step; -1 if the run did not reach the end.
  double fastest(const std::vector<vp::SE3>& poses) const {
    if (done_ < steps_) return -1.0;
    double longest = 0.0;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (scene_.bodies[i].motion != scenes::Motion::dynamic) continue;
      longest = std::max(longest, norm(poses[i].position() - before_last_[i].position()));
    }
    return longest * order_.rate;
  }

  bool step(bool keep) {
    const double dt = 1.0 / order_.rate, now = static_cast<double>(done_) * dt;
    while (happened_ < events_.size() && events_[happened_].time <= now + 0.5 * dt) {
      handle(events_[happened_++]);
    }
    if (done_ + 1 == steps_) before_last_ = engine_.poses();
    const double begun = cpu_us();
    const bool went = engine_.step();
    const double took = cpu_us() - begun;
    spent_us_ += took;
    if (!went) return false;
    if (keep) times_.push_back(took);
    ++done_;
    return true;
  }

  const scenes::Scene& scene_;
  rigid::Engine& engine_;
  const Order& order_;
  std::vector<scenes::Event> events_;
  long steps_, done_ = 0;
  double spent_us_ = 0.0;
  std::size_t happened_ = 0;
  std::vector<vp::SE3> before_last_;  // poses before the last step
  std::vector<double> times_;
};

int run(const Order& order) {
  const auto scene = rigid::load(order.scene);
  if (!scene) return print_answer("cannot", scene.error().message);
  const auto engine = rigid::make_engine(*scene, 1.0 / order.rate);
  if (!engine) return print_answer("cannot", engine.error());
  print_answer("ready", (*engine)->settings());
  Run run(*scene, **engine, order);
  char line[64];
  while (std::fgets(line, sizeof(line), stdin)) {
    const std::string why = run.turn(std::atol(line));
    if (why.empty()) {
      print_answer("more", "");
      continue;
    }
    if (!run.write()) return print_answer("cannot", "write " + order.file);
    return print_answer("end", why);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Order order;
  if (argc == 5) {
    order = {argv[1], argv[4], std::atof(argv[2]), 1e6 * std::atof(argv[3])};
  }
  if (argc != 5 || !(order.rate >= 1.0) || !(order.budget_us > 0.0)) {
    std::fprintf(stderr, "usage: %s SCENE HZ CPU_SECONDS FILE; see ./bench rigid\n", argv[0]);
    return 2;
  }
  return run(order);
}
