// A warm step takes nothing from the heap: every operator new of the program is counted.
#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include "random.h"
#include "rig.h"

namespace {
long g_allocations = 0;
}

void* operator new(std::size_t size) {
  ++g_allocations;
  if (void* p = std::malloc(size ? size : 1)) return p;
  std::abort();
}
void operator delete(void* p) noexcept {
  std::free(p);
}
void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}

namespace vp::test {
namespace {

TEST(Step, AllocatesNothingOnceWarm) {
  World world;
  const Material m{0.4, 0.6, 0.0};
  add_ground(world, m);
  for (const double x : {-0.2, 0.2}) {
    add_fixed(world, Box{{0.02, 0.3, 0.1}}, m, SE3(Vec3{x, 0, 0.1}));
    add_fixed(world, Box{{0.3, 0.02, 0.1}}, m, SE3(Vec3{0, x, 0.1}));
  }
  const Rod rod = add_rod(world, 0, 0.09, 3, 0.1, m);
  const BodyId ball = add_ball(world, {0.05, 0.02, 0.03}, {8, 5, 0}, m);
  for (int i = 0; i < 3; ++i) {
    add_dynamic(world,
                {.shape = Box{{0.02, 0.02, 0.02}}, .pose = SE3(Vec3{-0.1, 0.1, 0.03 + 0.05 * i})});
  }
  Random random(51);
  long during = 0, hits = 0;
  for (int i = 0; i < 4000; ++i) {
    if (i % 40 == 0)
      must(world.set_drive(rod.articulation, 0, 1, {random.uniform(-2, 2), 0, 100, 0.8, 20}));
    if (i % 500 == 0) must(world.set_velocity(ball, {{}, {8, 5, 0}}));
    const long before = g_allocations;
    const auto status = world.step(0.001);
    if (i >= 1000) {
      during += g_allocations - before;
      hits += static_cast<long>(world.contact_events().size());
    }
    ASSERT_TRUE(status);
  }
  EXPECT_GT(g_allocations, 0);  // the counter counts
  EXPECT_GT(hits, 10);          // and there was something to do
  EXPECT_EQ(during, 0);
}

}  // namespace
}  // namespace vp::test
