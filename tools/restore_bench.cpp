// restore-bench: measures the cost of saving and restoring a state, compared with a step: for a
// foosball match and for other kinds of world. Prints a table and writes the rows that ./bench
// stores.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "foosball/computer_player.h"
#include "foosball/match.h"
#include "scenes/catalogue.h"
#include "scenes/scene_world.h"
#include "server/exit_code.h"

namespace {

// A subject of the measurement, through these three calls.
struct Subject {
  std::string name;
  std::function<void()> step;
  std::function<void(std::vector<std::byte>&)> snapshot;  // appends
  std::function<bool(const std::vector<std::byte>&)> restore;
};

struct Costs {
  std::size_t bytes = 0;
  double step = 0.0, snapshot = 0.0;  // medians [us]
  // To the present state, and to one kLookAhead steps old, as in look-ahead and rollback.
  double restore_now = 0.0, restore_back = 0.0, step_after = 0.0;
};

constexpr int kLookAhead = 27;  // steps

double us_of(const std::function<void()>& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin)
      .count();
}
double median(std::vector<double>& times) {
  const auto middle = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
  std::nth_element(times.begin(), middle, times.end());
  return *middle;
}

// The subject advances between the iterations, so that many states are measured.
bool measure(const Subject& subject, int rounds, Costs& costs) {
  std::vector<double> step, snapshot, now, back, after;
  std::vector<std::byte> bytes;
  bool ok = true;
  for (int round = 0; round < rounds; ++round) {
    bytes.clear();
    snapshot.push_back(us_of([&] { subject.snapshot(bytes); }));
    now.push_back(us_of([&] { ok = subject.restore(bytes) && ok; }));
    for (int i = 0; i < kLookAhead; ++i) step.push_back(us_of(subject.step));
    back.push_back(us_of([&] { ok = subject.restore(bytes) && ok; }));
    after.push_back(us_of(subject.step));
  }
  costs = {bytes.size(), median(step), median(snapshot), median(now), median(back), median(after)};
  return ok;
}

// Two computer players play the match; the restore target is the match itself.
struct Played {
  foosball::Match match;
  foosball::ComputerPlayer home{{.team = 0, .seed = 1}}, away{{.team = 1, .seed = 2}};
  foosball::TickInput input{};

  void tick() {
    home.play(match.view(), input.rods);
    away.play(match.view(), input.rods);
    match.step(input);
  }
};
Subject foosball_match(const std::string& name, foosball::Layout layout) {
  foosball::MatchDesc desc;
  desc.layout = layout;
  auto played = std::make_shared<Played>(Played{foosball::Match::create(desc).value()});
  for (int i = 0; i < 6000; ++i) played->tick();
  return {name, [played] { played->match.step(played->input); },
          [played](auto& bytes) { played->match.snapshot(bytes); },
          [played](const auto& bytes) {
            const bool ok = played->match.restore(bytes).has_value();
            return ok;
          }};
}

Subject world_of(const std::string& name, const std::shared_ptr<scenes::SceneWorld>& scene,
                 double dt, int warm) {
  for (int i = 0; i < warm; ++i) (void)scene->step(dt);
  return {name, [scene, dt] { (void)scene->world().step(dt); },
          [scene](auto& bytes) { scene->world().snapshot(bytes); },
          [scene](const auto& bytes) { return scene->world().restore(bytes).has_value(); }};
}
Subject of_scene(const std::string& name, scenes::Scene scene, vp::WorldDesc settings, int warm) {
  auto world = scenes::SceneWorld::create(std::move(scene), settings);
  return world_of(name, std::make_shared<scenes::SceneWorld>(std::move(world).value()), 1.0 / 240,
                  warm);
}

// Trees of links: chains of capsules that swing on universal joints over a floor.
Subject articulations(const std::string& name, int chains, int links) {
  auto world = std::make_shared<vp::World>();
  vp::BodyDesc fixed;
  fixed.motion = vp::Motion::fixed;
  vp::ColliderDesc floor;
  floor.shape = vp::HalfSpace{};
  (void)world->add_collider(world->create_body(fixed).value(), floor);
  for (int c = 0; c < chains; ++c) {
    vp::ModelBuilder builder;
    for (int l = 0; l < links; ++l) {
      vp::LinkSpec link;
      link.parent = l - 1;
      link.joint = vp::UniversalJoint{};
      link.T_parent_joint =
          vp::SE3(l == 0 ? vp::Vec3{0.5 * c, 0, 0.2 * links} : vp::Vec3{0, 0, -0.2});
      link.inertia =
          vp::Inertia(0.5, vp::Vec3{2e-3, 2e-3, 1e-3}).InvXform(vp::SE3(vp::Vec3{0, 0, -0.1}));
      (void)builder.add(link);
    }
    const auto id = world->create_articulation({builder.build().value()}).value();
    for (int l = 0; l < links; ++l) {
      vp::ColliderDesc capsule;
      capsule.shape = vp::Capsule{0.03, 0.07};
      capsule.T_body_shape = vp::SE3(vp::Vec3{0, 0, -0.1});
      (void)world->add_collider(world->link_body(id, l), capsule);
    }
    (void)world->set_joint_state(id, 0, 0, 0.7, 0.1 * c);
  }
  for (int i = 0; i < 500; ++i) (void)world->step(1e-3);
  return {name, [world] { (void)world->step(1e-3); },
          [world](auto& bytes) { world->snapshot(bytes); },
          [world](const auto& bytes) { return world->restore(bytes).has_value(); }};
}

std::vector<std::function<Subject()>> subjects() {
  vp::WorldDesc drowsy;
  drowsy.sleep_after = 0.5;
  drowsy.region_bodies = 64;
  return {[] { return foosball_match("foosball match", foosball::Layout::tournament); },
          [] { return foosball_match("foosball paper", foosball::Layout::paper); },
          [] { return of_scene("pile of 200", scenes::pile(200, scenes::Pour::mixed), {}, 600); },
          [] { return of_scene("24 ragdolls", scenes::ragdolls(3, 2, 4), {}, 480); },
          [] { return articulations("8 chains of 8", 8, 8); },
          [drowsy] { return of_scene("asleep 320", scenes::towers(8, 4, 10), drowsy, 600); }};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("What it costs to save a state and to go back to it, in us, beside a step.");
  int rounds = 2000;
  std::string csv_path, only;
  app.add_option("--rounds", rounds, "Rounds of each kind of world")->check(CLI::Range(1, 1000000));
  app.add_option("--csv", csv_path, "Where to write the rows");
  app.add_option("--only", only, "Only the subject whose name begins like this");
  CLI11_PARSE(app, argc, argv);

  std::string csv = "subject,engine,metric,value,unit\n";
  fmt::print("{:<16}{:>10}{:>10}{:>13}{:>12}{:>21}{:>18}\n", "world", "bytes", "step us",
             "snapshot us", "restore us", fmt::format("restore {} back us", kLookAhead),
             "step after us");
  for (const auto& make : subjects()) {
    const Subject subject = make();
    if (!subject.name.starts_with(only)) continue;
    Costs costs;
    if (!measure(subject, rounds, costs)) {
      std::fprintf(stderr, "restore-bench: %s refused its own snapshot\n", subject.name.c_str());
      return server::kExitFailed;
    }
    fmt::print("{:<16}{:>10}{:>10.2f}{:>13.2f}{:>12.2f}{:>21.2f}{:>18.2f}\n", subject.name,
               costs.bytes, costs.step, costs.snapshot, costs.restore_now, costs.restore_back,
               costs.step_after);
    const auto row = [&](const char* metric, double value, const char* unit) {
      csv += fmt::format("{},Virtual Physics,{},{:.4g},{}\n", subject.name, metric, value, unit);
    };
    row("bytes", static_cast<double>(costs.bytes), "bytes");
    row("step", costs.step, "us");
    row("snapshot", costs.snapshot, "us");
    row("restore", costs.restore_now, "us");
    row("restore_back", costs.restore_back, "us");
    row("step_after", costs.step_after, "us");
  }
  if (csv_path.empty()) return 0;
  std::FILE* file = std::fopen(csv_path.c_str(), "w");
  const bool written = file != nullptr && std::fputs(csv.c_str(), file) >= 0;
  if (file == nullptr || std::fclose(file) != 0 || !written) {
    std::fprintf(stderr, "restore-bench: cannot write %s\n", csv_path.c_str());
    return server::kExitFailed;
  }
  return 0;
}
