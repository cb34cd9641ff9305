// rigid-stages HZ SCENE...: the wall time of each stage of a step of Virtual Physics and its
// counters, as means over each scene, and the quality of the scene's final state.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>

#include "load.h"
#include "scenes/measure.h"
#include "scenes/scene_world.h"
#include "table_scene.h"

namespace {

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

struct Sum {
  const char* name;
  std::uint32_t vp::StepCounters::*of;
  double sum = 0.0;
};

int fail(const std::string& sentence) {
  std::fprintf(stderr, "rigid-stages: %s\n", sentence.c_str());
  return 1;
}

void print_standing(const scenes::SceneWorld& world) {
  double fastest = 0.0;
  for (const vp::BodyId body : world.bodies()) {
    if (body) fastest = std::max(fastest, norm(world.world().velocity(body).v));
  }
  const scenes::Standing s = scenes::measure(world.scene(), world.poses(), world.time());
  std::printf("  %d of %d in place, penetration %.3f mm, fastest %.3f m/s\n", s.in_place, s.of,
              1e3 * s.penetration, fastest);
}

int run(const std::string& name, double rate) {
  auto scene = rigid::load(name);
  if (!scene) return fail(scene.error().message);
  auto world = scenes::SceneWorld::create(std::move(*scene));
  if (!world) return fail(world.error().message);
  std::optional<rigid::Rods> rods;
  if (rigid::is_table(name)) {
    auto made = rigid::Rods::create(world->world());
    if (!made) return fail(made.error().message);
    rods = std::move(*made);
  }
  const auto clock = std::make_shared<vp::StageClock>(now_ns);
  world->world().observe_stages(clock);
  using C = vp::StepCounters;
  std::array sums{Sum{"pairs", &C::pairs},         Sum{"narrow phase", &C::narrow_phase_pairs},
                  Sum{"manifolds", &C::manifolds}, Sum{"recycled", &C::recycled},
                  Sum{"contacts", &C::contacts},   Sum{"colours", &C::colours},
                  Sum{"regions", &C::regions},     Sum{"impacts", &C::impacts},
                  Sum{"events", &C::events}};
  vp::StepStatus status;
  const long steps = std::lround(world->scene().seconds * rate);
  for (long i = 0; i < steps; ++i) {
    if (rods) rods->drive(world->world(), i);
    const auto stepped = world->step(1.0 / rate);
    if (!stepped) return fail(stepped.error().message);
    status |= *stepped;
    for (Sum& sum : sums) sum.sum += world->world().counters().*sum.of;
  }
  const auto each = 1.0 / static_cast<double>(steps);
  double all = 0.0;
  for (const vp::Stage stage : vp::kStages)
    all += 1e-3 * each * static_cast<double>(clock->total(stage));
  std::printf("\n%s at %g Hz, means of %ld steps: %.1f us\n", name.c_str(), rate, steps, all);
  for (const vp::Stage stage : vp::kStages) {
    const double us = 1e-3 * each * static_cast<double>(clock->total(stage));
    if (us > 0.0) std::printf("  %-14s%10.1f us%6.1f%%\n", name_of(stage), us, 100.0 * us / all);
  }
  for (const Sum& sum : sums) {
    if (sum.sum > 0.0) std::printf("  %-14s%10.1f\n", sum.name, each * sum.sum);
  }
  print_standing(*world);
  for (const vp::Limit limit : vp::kLimits) {
    if (reached(status, limit)) std::printf("  %s\n", sentence(limit));
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const double rate = argc > 2 ? std::atof(argv[1]) : 0.0;
  if (!(rate >= 10.0 && rate <= 100000.0)) {
    std::fprintf(stderr, "usage: %s HZ SCENE...; see ./bench rigid --stages\n", argv[0]);
    return 2;
  }
  for (int i = 2; i < argc; ++i) {
    if (const int failed = run(argv[i], rate); failed != 0) return failed;
  }
  return 0;
}
