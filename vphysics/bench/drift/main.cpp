// drift-bench: 10^6 steps of 1 ms of a tumbling body and of a ten-link pendulum, with each
// integrator of each engine. Measures the errors of energy and angular momentum relative to the
// start.
//
// Errors are sampled in windows of time, 20 a decade, up to 40 times in each. The value of a window
// is the maximum, so that a curve shows the amplitude of an oscillating error.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <ctime>
#include <fstream>

#include "system.h"
#include "vphysics/multibody/quantities.h"

namespace vp::bench {
namespace {

struct Errors {
  double energy = 0.0, momentum = 0.0;
};
struct Point {
  long steps;  // since the start
  Errors errors;
};

class Watcher {
 public:
  explicit Watcher(const System& system) : system_(system), data_(system.model) {
    begin_ = quantities(system.start);
  }
  Errors errors(const State& s) {
    const Quantities now = quantities(s);
    Errors e{std::fabs(now.energy - begin_.energy) / system_.energy_scale, 0.0};
    if (system_.momentum_scale > 0.0) {
      e.momentum = norm(now.momentum - begin_.momentum) / system_.momentum_scale;
    }
    return e;
  }

 private:
  struct Quantities {
    double energy = 0.0;
    Vec3 momentum;
  };
  Quantities quantities(const State& s) {
    forward_kinematics<double>(system_.model, data_, s.q, s.v);
    return {kinetic_energy<double>(system_.model, data_) +
                potential_energy<double>(system_.model, data_, system_.gravity),
            momentum<double>(system_.model, data_, {}).m};
  }

  const System& system_;
  Data data_;
  Quantities begin_;
};

std::vector<long> window_ends(long steps) {
  std::vector<long> ends;
  for (int k = 0;; ++k) {
    const long end = std::min(steps, std::lround(std::pow(10.0, k / 20.0)));
    if (ends.empty() || end > ends.back()) ends.push_back(end);
    if (end == steps) return ends;
  }
}

struct Curve {
  std::string subject, name;
  std::vector<Point> points;
  double step_us = 0.0;
};

Curve watch(const System& system, Mover& mover, long steps) {
  constexpr long kLooks = 40;
  Watcher watcher(system);
  Curve curve{system.name, mover.name, {}, 0.0};
  long done = 0;
  std::clock_t spent = 0;  // processor time: other processes may run
  for (const long end : window_ends(steps)) {
    Point point{end, {}};
    while (done < end && !mover.failed) {
      const long each = std::max(1L, (end - done) / kLooks);
      const std::clock_t before = std::clock();
      mover.advance(static_cast<int>(each));
      spent += std::clock() - before;
      done += each;
      const Errors e = watcher.errors(mover.state());
      if (!std::isfinite(e.energy) || !std::isfinite(e.momentum)) mover.failed = true;
      if (mover.failed) break;
      point.errors.energy = std::max(point.errors.energy, e.energy);
      point.errors.momentum = std::max(point.errors.momentum, e.momentum);
    }
    if (mover.failed) break;
    curve.points.push_back(point);
  }
  curve.step_us =
      1e6 * static_cast<double>(spent) / CLOCKS_PER_SEC / static_cast<double>(std::max(done, 1L));
  return curve;
}

// The maximum error until a time.
Errors until(const Curve& curve, long steps) {
  Errors worst;
  for (const Point& p : curve.points) {
    if (p.steps > steps) break;
    worst = {std::max(worst.energy, p.errors.energy), std::max(worst.momentum, p.errors.momentum)};
  }
  return worst;
}

void write_curves(std::ofstream& out, const std::vector<Curve>& curves) {
  out << "subject,engine,time_s,energy_error,momentum_error\n";
  for (const Curve& c : curves) {
    for (const Point& p : c.points) {
      out << fmt::format("{},{},{:g},{:.3e},{:.3e}\n", c.subject, c.name,
                         static_cast<double>(p.steps) * kStep, p.errors.energy, p.errors.momentum);
    }
  }
}

void write_figures(std::ofstream& out, const std::vector<Curve>& curves, long steps) {
  out << "subject,engine,metric,value,unit\n";
  for (const Curve& c : curves) {
    for (long at = 1000; at <= steps; at *= 10) {
      const std::string when = fmt::format("{}s", at / 1000);
      if (c.points.empty() || c.points.back().steps < at) {
        out << fmt::format("{},{},energy_{},gave up,\n", c.subject, c.name, when);
        continue;
      }
      const Errors e = until(c, at);
      out << fmt::format("{},{},energy_{},{:.1e},\n", c.subject, c.name, when, e.energy);
      if (c.subject == "pendulum") continue;
      out << fmt::format("{},{},momentum_{},{:.1e},\n", c.subject, c.name, when, e.momentum);
    }
    out << fmt::format("{},{},step,{:.2f},us\n", c.subject, c.name, c.step_us);
  }
}

}  // namespace
}  // namespace vp::bench

int main(int argc, char** argv) {
  using namespace vp::bench;
  CLI::App app("How energy and momentum drift in 10^6 steps of 1 ms.");
  long steps = 1'000'000;
  std::string figures, curves_file;
  app.add_option("--steps", steps)->check(CLI::Range(1000L, 100'000'000L));
  app.add_option("--csv", figures, "the largest errors after 1 s, 10 s, ...")->required();
  app.add_option("--curves", curves_file, "errors against time")->required();
  CLI11_PARSE(app, argc, argv);

  std::ofstream figures_out(figures), curves_out(curves_file);
  if (!figures_out || !curves_out) {
    fmt::print(stderr, "drift-bench: {} or {} cannot be written\n", figures, curves_file);
    return 1;
  }
  std::vector<Curve> curves;
  for (const System& system : {tumbling_body(), ten_link_pendulum()}) {
    for (const auto& awake_bodies :
         {our_movers(system), mujoco_movers(system), dart_movers(system)}) {
      for (const auto& mover : awake_bodies) {
        curves.push_back(watch(system, *mover, steps));
        const Curve& c = curves.back();
        const Errors e = until(c, steps);
        const bool kept = system.momentum_scale > 0.0;
        fmt::print("{:9} {:30} energy {:.1e}{}  {:.2f} us a step{}\n", c.subject, c.name, e.energy,
                   kept ? fmt::format("  momentum {:.1e}", e.momentum) : "", c.step_us,
                   mover->failed ? "  gave up" : "");
        std::fflush(stdout);
      }
    }
  }
  write_curves(curves_out, curves);
  write_figures(figures_out, curves, steps);
  return figures_out && curves_out ? 0 : 1;
}
