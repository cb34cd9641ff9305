// The cost of a foosball tick: 8 driven rods of 1-2-5-3 men of 4 boxes, 10 walls, a field, one
// ball.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <vector>

#include "../tests/random.h"
#include "vphysics/world.h"

namespace {

using namespace vp;

struct Table {
  World world;
  std::vector<ArticulationId> rods;
  BodyId ball;
};

void add_box(World& world, BodyId body, const Vec3& centre, const Vec3& half,
             CollisionFilter filter) {
  ColliderDesc desc;
  desc.shape = Box{half};
  desc.T_body_shape = SE3(centre);
  desc.material = {0.3, 0.6, 0.0};
  desc.filter = filter;
  (void)world.add_collider(body, desc);
}

// As in the game: a slide without mass, and the rod that rotates on it.
ArticulationDesc rod(double x) {
  ModelBuilder builder;
  LinkSpec slide;
  slide.joint = PrismaticJoint{};
  slide.forces = {{.lower = -0.06, .upper = 0.06}};
  slide.T_parent_joint = SE3(Mat3{{-1, 0, 0}, {0, 0, 1}, {0, 1, 0}}, {x, 0, 0.085});
  LinkSpec turn;
  turn.parent = builder.add(slide).value();
  turn.joint = RevoluteJoint{};
  turn.inertia = Inertia(1.5, Vec3{0.2, 0.2, 0.0015});
  (void)builder.add(turn);
  return {builder.build().value()};
}

Table make_table() {
  Table table;
  World& world = table.world;
  BodyDesc fixed;
  fixed.motion = Motion::fixed;
  const BodyId field = world.create_body(fixed).value();
  ColliderDesc ground;
  ground.shape = HalfSpace{};
  (void)world.add_collider(field, ground);
  for (const double s : {-1.0, 1.0}) {
    add_box(world, field, {0, s * 0.36, 0.05}, {0.62, 0.02, 0.05}, {1, 4});
    add_box(world, field, {s * 0.62, s * 0.22, 0.05}, {0.02, 0.12, 0.05}, {1, 4});
    add_box(world, field, {s * 0.62, -s * 0.22, 0.05}, {0.02, 0.12, 0.05}, {1, 4});
    add_box(world, field, {s * 0.62, 0, 0.09}, {0.02, 0.1, 0.01}, {1, 4});
    add_box(world, field, {s * 0.72, 0, 0.05}, {0.02, 0.12, 0.05}, {1, 4});
  }
  constexpr int kMen[8] = {1, 2, 3, 5, 5, 3, 2, 1};
  for (int i = 0; i < 8; ++i) {
    table.rods.push_back(world.create_articulation(rod(-0.525 + 0.15 * i)).value());
    const BodyId body = world.link_body(table.rods.back(), 1);
    for (int man = 0; man < kMen[i]; ++man) {
      const double y = 0.11 * (man - 0.5 * (kMen[i] - 1));
      add_box(world, body, {0, -0.0665, y}, {0.011, 0.0095, 0.011}, {2, 4});
      add_box(world, body, {0, -0.04, y}, {0.007, 0.02, 0.008}, {2, 4});
      add_box(world, body, {0, 0, y}, {0.01, 0.022, 0.013}, {2, 4});
      add_box(world, body, {0, 0.033, y}, {0.009, 0.011, 0.009}, {2, 4});
    }
  }
  BodyDesc ball;
  ball.inertia = solid_inertia(Sphere{0.01727}, 1100.0);
  ball.T_world_body = SE3(Vec3{0.01, 0.02, 0.02});
  ball.velocity = {{}, {3, 2, 0}};
  ball.continuous = true;
  table.ball = world.create_body(ball).value();
  ColliderDesc sphere;
  sphere.shape = Sphere{0.01727};
  sphere.material = {0.3, 0.6, 2e-4};
  sphere.filter = {4, ~0u};
  (void)world.add_collider(table.ball, sphere);
  return table;
}

// The rods swing and slide at random, so that they hit the ball repeatedly.
void drive(Table& table, test::Random& random) {
  for (const ArticulationId rod : table.rods) {
    (void)table.world.set_drive(rod, 0, 0, {random.uniform(-0.06, 0.06), 0, 3e4, 400, 300});
    (void)table.world.set_drive(rod, 1, 0, {random.uniform(-1.5, 1.5), 0, 100, 0.8, 20});
  }
}

void FoosballTick(benchmark::State& state) {
  Table table = make_table();
  test::Random random(5);
  std::vector<std::byte> start;
  table.world.snapshot(start);
  std::uint64_t impacts = 0, limited = 0, ticks = 0;
  for ([[maybe_unused]] auto _ : state) {
    if (ticks % 100 == 0) drive(table, random);
    const auto status = table.world.step(0.001);
    impacts += table.world.counters().impacts;
    limited += status->impact_limit;
    // Puts a ball that has left the table back, as the game does.
    if (++ticks % 2000 == 0) (void)table.world.restore(start);
  }
  state.counters["impacts"] = static_cast<double>(impacts) / static_cast<double>(ticks);
  state.counters["limited"] = static_cast<double>(limited);
}
BENCHMARK(FoosballTick)->Unit(benchmark::kMicrosecond)->MinTime(1.0);

void StateHash(benchmark::State& state) {
  const Table table = make_table();
  for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(table.world.state_hash());
}
BENCHMARK(StateHash)->Unit(benchmark::kMicrosecond);

}  // namespace

BENCHMARK_MAIN();
