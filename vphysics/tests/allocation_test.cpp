// A warm step does not allocate. The test replaces operator new and counts every call in the
// program.
#include <gtest/gtest.h>

#include <malloc.h>

#include <cstdlib>
#include <new>

#include "collide/pair_finder.h"
#include "random.h"
#include "surfaces.h"
#include "tree_scenes.h"
#include "trees.h"
#include "vphysics/multibody/configuration.h"
#include "vphysics/multibody/constrained_step.h"
#include "vphysics/multibody/derivatives.h"
#include "vphysics/multibody/impulse.h"
#include "vphysics/multibody/integrators.h"
#include "vphysics/multibody/jacobians.h"
#include "vphysics/multibody/quantities.h"

namespace {
long g_allocations = 0;
std::size_t g_live = 0;  // bytes allocated

void* taken(void* p) {
  if (!p) std::abort();
  ++g_allocations;
  g_live += malloc_usable_size(p);
  return p;
}
void give_back(void* p) {
  g_live -= malloc_usable_size(p);
  std::free(p);
}
}  // namespace

void* operator new(std::size_t size) {
  return taken(std::malloc(size ? size : 1));
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  const auto a = static_cast<std::size_t>(alignment);
  return taken(std::aligned_alloc(a, (size + a - 1) / a * a));
}
void operator delete(void* p, std::align_val_t) noexcept {
  give_back(p);
}
void operator delete(void* p, std::size_t, std::align_val_t) noexcept {
  give_back(p);
}
void operator delete(void* p) noexcept {
  give_back(p);
}
void operator delete(void* p, std::size_t) noexcept {
  give_back(p);
}

namespace vp::test {
namespace {

// Ray casts, shape casts, overlap and nearest queries, in a world that moves on between them.
TEST(Queries, AllocateNothingOnceWarm) {
  World world;
  add_ground(world, {});
  Random random(11);
  for (int i = 0; i < 60; ++i) {
    Part part;
    part.shape = i % 2 ? Shape{Box{{0.2, 0.3, 0.1}}} : Shape{Cylinder{0.2, 0.3}};
    part.pose = SE3(random.rotation(), random.in_cube(2.0) + Vec3{0, 0, 3});
    add_dynamic(world, part);
  }
  std::vector<RayHit> rays;
  std::vector<ShapeHit> casts;
  std::vector<ColliderId> touched;
  const Shape shape = Capsule{0.3, 0.4};
  std::size_t found = 0;
  const auto ask = [&](int times) {
    for (int i = 0; i < times; ++i) {
      const Vec3 from = random.in_cube(3.0);
      rays.clear(), casts.clear(), touched.clear();
      must(world.ray_cast_all(from, {0, 0, -1}, 9, rays));
      must(world.shape_cast_all(shape, SE3(from), {{0, 0, -4}, {1, 0, 0}}, casts));
      must(world.overlapping(shape, SE3(from), touched));
      found += rays.size() + casts.size() + touched.size();
      found += must(world.ray_cast(from, {1, 2, 0}, 9)).has_value() ? 1 : 0;
      found += must(world.shape_cast(shape, SE3(from), {{1, 2, 0}, {}})).has_value() ? 1 : 0;
      found += must(world.nearest(shape, SE3(from), 5)).has_value() ? 1 : 0;
    }
  };
  rays.reserve(100), casts.reserve(100), touched.reserve(100);
  for (int i = 0; i < 100; ++i) must(world.step(0.002));
  ask(300);
  long allocated = 0;
  for (int i = 0; i < 20; ++i) {
    must(world.step(0.002));
    const long before = g_allocations;
    ask(10);
    allocated += g_allocations - before;
  }
  EXPECT_EQ(allocated, 0);
  EXPECT_GT(found, 1000u);
}

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
  BodyId box;
  for (int i = 0; i < 3; ++i) {
    box = add_dynamic(
        world, {.shape = Box{{0.02, 0.02, 0.02}}, .pose = SE3(Vec3{-0.1, 0.1, 0.03 + 0.05 * i})});
  }
  add_walker(world, {-0.1, -0.1, 0.8}, m);
  Random random(51);
  long during = 0, hits = 0;
  for (int i = 0; i < 4000; ++i) {
    if (i % 40 == 0)
      must(world.set_drive(rod.articulation, 0, 1, {random.uniform(-2, 2), 0, 100, 0.8, 20}));
    if (i % 500 == 0) must(world.set_velocity(ball, {{}, {8, 5, 0}}));
    const long before = g_allocations;
    if (i % 3 == 0) {
      for (const BodyId body : {ball, box, rod.body}) must(world.apply_force(body, {0.1, 0, 0.1}));
      must(world.apply_torque(box, {1e-3, 0, 0}));
      must(world.apply_joint_force(rod.articulation, 0, 1, 0.01));
    }
    const auto status = world.step(0.001);
    if (i >= 1000) {
      during += g_allocations - before;
      hits += static_cast<long>(world.contact_events().size());
    }
    ASSERT_TRUE(status);
  }
  EXPECT_GT(g_allocations, 0);  // checks that the counter works
  EXPECT_GT(hits, 10);          // and that queries had hits
  EXPECT_EQ(during, 0);
}

// A sensor is added to a world in which all bodies sleep.
TEST(Step, OfAWorldAsleepAllocatesNothing) {
  WorldDesc desc;
  desc.sleep_after = 0.1;
  World world(desc);
  add_ground(world, {});
  for (int i = 0; i < 20; ++i) {
    add_dynamic(world, {.shape = Box{{0.1, 0.1, 0.1}}, .pose = SE3(Vec3{0.3 * i, 0, 0.1})});
  }
  for (int i = 0; i < 300; ++i) must(world.step(0.001));
  ASSERT_EQ(world.counters().awake, 0u);
  const BodyId zone = add_fixed(world, Sphere{0.01}, {}, SE3(Vec3{0, 0, 5}));
  ColliderDesc gate;
  gate.shape = Sphere{0.3};
  gate.sensor = true;
  gate.T_body_shape = SE3(Vec3{0, 0, -4.9});
  must(world.add_collider(zone, gate));
  must(world.step(0.001));
  EXPECT_EQ(world.contact_events().size(), 2u);
  must(world.step(0.001));
  const long before = g_allocations;
  for (int i = 0; i < 300; ++i) must(world.step(0.001));
  EXPECT_EQ(g_allocations - before, 0);
  EXPECT_EQ(world.counters().awake, 0u);
}

// Tables and balls fall on a mesh: contacts of many parts begin and end.
TEST(Step, WithMeshesAndCompoundsAllocatesNothingOnceWarm) {
  World world({.gravity = {0, 0, -9.81}});
  Random random(55);
  MeshPoints rough = random_plane(random, 20, 4.0);
  for (Vec3& v : rough.vertices) v.z = random.uniform(-0.05, 0.05);
  add_fixed(world, rough.made(), {}, SE3(Vec3{-2, -2, 0}));
  std::vector<CompoundPart> parts{{Box{{0.3, 0.2, 0.02}}, SE3(Vec3{0, 0, 0.3})}};
  for (const double x : {-0.25, 0.25}) {
    for (const double y : {-0.15, 0.15}) {
      parts.push_back({Capsule{0.03, 0.12}, SE3(Vec3{x, y, 0.15})});
    }
  }
  const Shape table = Compound::of(parts).value();
  std::vector<BodyId> bodies;
  for (int i = 0; i < 8; ++i) {
    const SE3 pose{random.rotation(), Vec3{random.uniform(-1, 1), random.uniform(-1, 1), 0.5 + i}};
    bodies.push_back(add_dynamic(
        world, {.shape = i % 2 ? table : Shape(Sphere{0.1}), .pose = pose, .continuous = i == 2}));
  }
  long during = 0, hits = 0;
  for (int i = 0; i < 12000; ++i) {
    if (i % 500 == 0) {
      for (const BodyId body : bodies) {
        must(world.set_pose(body, SE3{random.rotation(), random.in_cube(1.0) + Vec3{0, 0, 1.5}}));
        must(world.set_velocity(body, {random.in_cube(3.0), random.in_cube(2.0)}));
      }
    }
    const long before = g_allocations;
    const auto status = world.step(0.001);
    if (i >= 10000) {
      during += g_allocations - before;
      hits += static_cast<long>(world.contact_events().size());
    }
    ASSERT_TRUE(status);
  }
  EXPECT_GT(hits, 100);
  EXPECT_EQ(during, 0);
}

// Takes one grain after the other.
class OneByOne final : public TaskScheduler {
 public:
  void run(std::size_t count, std::size_t grain, const Task& task) override {
    for (std::size_t i = 0; i < count; i += grain) task(i, std::min(count, i + grain));
  }
};

// Each grain of contacts with parts has memory of its own.
TEST(Step, WithSharedContactsOfPartsAllocatesNothingOnceWarm) {
  World world;
  world.set_task_scheduler(std::make_shared<OneByOne>());
  add_fixed(world, wave_mesh(60, 0.25, 0.1).made(), {});
  const std::vector<CompoundPart> parts{{Sphere{0.1}, SE3(Vec3{0.15, 0, 0})},
                                        {Box{{0.1, 0.1, 0.1}}, SE3(Vec3{-0.15, 0, 0})}};
  const Shape dumbbell = Compound::of(parts).value();
  Random random(5);
  std::vector<BodyId> bodies;
  for (int i = 0; i < 80; ++i) bodies.push_back(add_dynamic(world, {.shape = dumbbell}));
  long during = 0;
  for (int i = 0; i < 1200; ++i) {
    for (std::size_t k = 0; i % 100 == 0 && k < bodies.size(); ++k) {
      const Vec3 at{0.8 * (static_cast<double>(k % 9) - 4), 0.8 * (static_cast<double>(k / 9) - 4),
                    0.5};
      must(world.set_pose(bodies[k], SE3{random.rotation(), at}));
      must(world.set_velocity(bodies[k], {random.in_cube(3.0), random.in_cube(2.0)}));
    }
    const long before = g_allocations;
    const auto status = world.step(0.01);
    if (i >= 1000) during += g_allocations - before;
    ASSERT_TRUE(status);
  }
  EXPECT_GT(world.counters().manifolds, 80u);
  EXPECT_EQ(during, 0);
}

// A heap is thrown about in a pit, then lies still; its regions are recomputed every quarter of a
// second. While it is thrown, a few allocations still occur: hundreds of region colours, and lists,
// each have to reach their largest number of contacts first.
TEST(Step, WithRegionsAllocatesNothingOnceWarm) {
  constexpr int kThrow = 60, kThrown = 20 * kThrow, kLies = kThrown + 200, kSteps = kLies + 400;
  WorldDesc desc;
  desc.region_bodies = 64;
  World world(desc);
  add_ground(world, {});
  for (const double at : {-0.9, 0.9}) {
    add_fixed(world, Box{{0.1, 1.0, 3}}, {}, SE3(Vec3{at, 0, 3}));
    add_fixed(world, Box{{1.0, 0.1, 3}}, {}, SE3(Vec3{0, at, 3}));
  }
  Random random(59);
  std::vector<BodyId> bodies;
  for (int i = 0; i < 200; ++i) {
    const int level = i / 25;
    const Vec3 at{0.3 * (i % 5) - 0.6, 0.3 * (i / 5 % 5) - 0.6, 0.2 + 0.3 * level};
    const Shape shape = i % 2 ? Shape(Box{{0.1, 0.1, 0.1}}) : Shape(Sphere{0.1});
    bodies.push_back(add_dynamic(world, {.shape = shape, .pose = SE3(random.rotation(), at)}));
  }
  long thrown = 0, lying = 0;
  for (int i = 0; i < kSteps; ++i) {
    if (i < kThrown && i % kThrow == 0) {
      for (const BodyId body : bodies) must(world.set_velocity(body, {{}, random.in_cube(3.0)}));
    }
    const long before = g_allocations;
    must(world.step(0.004));
    (i < kLies ? thrown : lying) += g_allocations - before;
  }
  EXPECT_EQ(world.counters().regions, 4u);
  EXPECT_GT(world.counters().manifolds, 300u);
  EXPECT_GT(thrown, 0);
  EXPECT_EQ(lying, 0);
}

// Continuous boxes, hulls and compounds. The second run of the same scene counts.
TEST(Step, WithContinuousBodiesOfAnyShapeAllocatesNothingOnceWarm) {
  World world;
  Random random(57);
  MeshPoints rough = random_plane(random, 12, 12.0);
  for (Vec3& v : rough.vertices) v.z = random.uniform(-0.1, 0.1);
  add_fixed(world, rough.made(), {}, SE3(Vec3{-6, -6, 0}));
  const Shape hammer = Compound::of(std::vector<CompoundPart>{
                                        {Capsule{0.02, 0.2}, SE3{}},
                                        {Box{{0.05, 0.1, 0.05}}, SE3(Vec3{0, 0, 0.2})},
                                    })
                           .value();
  for (int i = 0; i < 8; ++i) {
    add_dynamic(world, {.shape = i % 2 ? hammer : Shape(Box{{0.1, 0.02, 0.05}}),
                        .material = {0.4, 0.5},
                        .pose = SE3(random.rotation(), random.in_cube(0.5) + Vec3{0, 0, 1.0}),
                        .velocity = {40.0 * random.direction(), 5.0 * random.direction()},
                        .continuous = true});
  }
  std::vector<std::byte> start;
  world.snapshot(start);
  long during = 0, impacts = 0;
  for (int pass = 0; pass < 2; ++pass) {
    must(world.restore(start));
    for (int i = 0; i < 800; ++i) {
      const long before = g_allocations;
      const auto status = world.step(0.002);
      if (pass == 1 && i > 2) {  // restore() takes memory that the steps return
        during += g_allocations - before;
        impacts += world.counters().impacts;
      }
      ASSERT_TRUE(status);
    }
  }
  EXPECT_GT(impacts, 20);
  EXPECT_EQ(during, 0);
}

// A world's first contact may come long after its first step: a ball that is served late.
TEST(Step, WithTheFirstContactOfAContinuousBodyAllocatesNothing) {
  const Shape ball = Sphere{0.05}, box = Box{{0.1, 0.1, 0.1}}, rod = Capsule{0.05, 0.2};
  for (const Shape& shape : {ball, box, rod}) {
    World world;
    add_fixed(world, Box{{6, 6, 0.5}}, {}, SE3(Vec3{0, 0, -0.5}));
    add_dynamic(world, {.shape = shape,
                        .material = {0.4, 0.5},
                        .pose = SE3(Vec3{0.1, 0.2, 3.0}),
                        .continuous = true});
    long during = 0, hits = 0;
    for (int i = 0; i < 1200; ++i) {
      const long before = g_allocations;
      const auto status = world.step(0.001);
      if (i >= 300) during += g_allocations - before;
      hits += static_cast<long>(world.contact_events().size());
      ASSERT_TRUE(status);
      ASSERT_TRUE(hits == 0 || i >= 300) << "the ground is too near";
    }
    EXPECT_GT(hits, 0);
    EXPECT_EQ(during, 0);
  }
}

// Standing robots, welded to one another and to a crate that is later released.
TEST(Step, WithJointsOfLinksAllocatesNothingOnceWarm) {
  World world;
  add_ground(world, {0.8, 0.0, 0.0});
  Walker walkers[2];
  for (int i = 0; i < 2; ++i) {
    walkers[i] = add_walker(world, {0, 0.8 * i, Walker::kHeight}, {0.8, 0.0, 0.0});
    for (int link = 1; link < world.model(walkers[i].id)->links(); ++link) {
      must(world.set_drive(walkers[i].id, link, 0, {0.0, 0.0, 200.0, 10.0, 200.0}));
    }
  }
  const BodyId first = world.link_body(walkers[0].id, 0),
               second = world.link_body(walkers[1].id, 0);
  JointDesc weld;
  weld.kind = Weld{};
  weld.T_a_joint = SE3(Vec3{0, 0.4, 0});
  weld.T_b_joint = SE3(Vec3{0, -0.4, 0});
  must(world.create_joint(first, second, weld));
  const BodyId crate = add_dynamic(world, {.shape = Box{{0.1, 0.1, 0.1}},
                                           .material = {0.5, 0.0, 0.0},
                                           .density = 200.0,
                                           .pose = SE3(Vec3{0.6, 0, Walker::kHeight})});
  weld.T_a_joint = SE3(Vec3{0.6, 0, 0});
  weld.T_b_joint = {};
  const JointId held = must(world.create_joint(first, crate, weld));
  long during[2] = {};
  for (int i = 0; i < 1000; ++i) {
    if (i == 500) must(world.destroy_joint(held));
    const long before = g_allocations;
    must(world.step(0.001));
    if (i % 500 >= 50) during[i / 500] += g_allocations - before;
  }
  EXPECT_EQ(during[0], 0);
  EXPECT_EQ(during[1], 0);
}

// Repeated rollback, as look-ahead does it, allocates nothing: restore() swaps the world's memory
// with that of the decoded snapshot.
TEST(Restore, AllocatesNothingOnceWarm) {
  World world;
  Random random(57);
  const Material m{0.4, 0.3};
  add_ground(world, m);
  add_rod(world, 0.2, 0.09, 3, 0.15, m);
  add_ball(world, {0, 0, 0.05}, {3, 2, 0}, m);
  for (int i = 0; i < 12; ++i) {
    add_dynamic(world, {.shape = Box{{0.05, 0.04, 0.03}},
                        .material = m,
                        .pose = SE3(random.rotation(), random.in_cube(0.2) + Vec3{-1, 0, 0.5})});
  }
  for (int i = 0; i < 800; ++i) must(world.step(0.001));
  std::vector<std::byte> start;
  world.snapshot(start);
  long during = 0;
  for (int round = 0; round < 6; ++round) {
    for (int i = 0; i < 20; ++i) must(world.step(0.001));
    const long before = g_allocations;
    const bool restored = world.restore(start).has_value();
    if (round > 3) during += g_allocations - before;
    ASSERT_TRUE(restored);
  }
  EXPECT_EQ(during, 0);
}

// Every algorithm besides the dynamics, on a tree with every kind of joint.
TEST(TreeAlgorithms, AllocateNothing) {
  Random random(52);
  const Model model = random_tree(random, 40);
  const State s = random_state(random, model);
  const std::size_t n = s.v.size();
  Data data(model);
  DerivativesData memory(model);
  using Four = PackT<double, 4>;
  DataT<Four> packs(model);
  DerivativesDataT<Four> packed_memory(model);
  const std::vector<Four> q4(s.q.begin(), s.q.end()), v4(s.v.begin(), s.v.end());
  std::vector<Four> x4(n), A4(n * n), B4(n * n), C4(n * n);
  std::vector<double> q(s.q.size()), x(n), A(n * n), B(n * n), C(n * n);
  std::vector<se3> J(n);
  std::vector<Vec3> P(n);
  std::vector<dse3> H(n);
  const int last = model.links() - 1;
  const long before = g_allocations;
  integrate<double>(model, s.q, s.v, q);
  difference<double>(model, s.q, q, x);
  forward_kinematics<double>(model, data, s.q, s.v);
  link_jacobian<double>(model, data, last, Frame::link, J);
  point_jacobian<double>(model, data, last, {1, 2, 3}, Frame::world, P);
  const bool rates =
      link_jacobian_rate<double>(model, data, s.q, s.v, last, Frame::world, J).has_value() &&
      point_jacobian_rate<double>(model, data, s.q, s.v, last, {}, Frame::link, P).has_value();
  link_drift<double>(model, data, s.q, s.v, last, Frame::world_at_link);
  momentum_matrix<double>(model, data, centre_of_mass<double>(model, data), H);
  centre_of_mass_jacobian<double>(model, data, P);
  bias_forces<double>(model, data, s.q, s.v, {}, x);
  gravity_forces<double>(model, data, s.q, {0, 0, -9.81}, x);
  const bool inverse =
      inverse_dynamics_derivatives<double>(model, data, memory, s.q, s.v, s.a, {}, {A, B, C})
          .has_value();
  const bool forward =
      forward_dynamics_derivatives<double>(model, data, memory, s.q, s.v, s.tau, {}, {x, A, B, C})
          .has_value();
  const bool of_packs =
      inverse_dynamics_derivatives<Four>(model, packs, packed_memory, q4, v4, v4, {}, {A4, B4, C4})
          .has_value() &&
      forward_dynamics_derivatives<Four>(model, packs, packed_memory, q4, v4, v4, {},
                                         {x4, A4, B4, C4})
          .has_value();
  EXPECT_EQ(g_allocations - before, 0);
  EXPECT_TRUE(rates && inverse && forward && of_packs);
}

TEST(Integrators, AllocateNothingInAStep) {
  Random random(52);
  const Model model = random_tree(random, 20);
  State s = random_state(random, model);
  IntegratorData data(model);
  const double spring = 2.0;
  const auto forces = [&](std::span<const double> q, std::span<const double> v, double,
                          std::span<double> tau) {
    for (std::size_t i = 0; i < tau.size(); ++i) tau[i] = -spring * q[i] - v[i];
  };
  const StepT<double> step{.h = 1e-3, .forces = forces};
  AdaptiveReport report;
  const long before = g_allocations;
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(step_semi_implicit<double>(model, data, s.q, s.v, step));
    ASSERT_TRUE(step_rk4<double>(model, data, s.q, s.v, step));
    ASSERT_TRUE(step_variational<double>(model, data, s.q, s.v, step));
    ASSERT_TRUE(advance_adaptive<double>(model, data, s.q, s.v, step, {}, report));
  }
  EXPECT_EQ(g_allocations - before, 0);
}

// A linkage with friction, a stop and a motor. The model's data is sized once.
TEST(ConstrainedDynamics, AllocatesNothing) {
  const Inertia bar = Inertia(1.0, Vec3{1e-3, 0.02, 0.02}).InvXform(SE3(Vec3{0.25, 0, 0}));
  ModelBuilder builder;
  LinkSpec crank{.joint = RevoluteJoint{}, .inertia = bar, .damping = 0.1};
  crank.forces = {{.lower = 0.2, .upper = 2.0, .stiffness = 1.0, .friction = 0.5}};
  must(builder.add(crank));
  must(builder.add({"coupler", 0, RevoluteJoint{}, SE3(Vec3{0.5, 0, 0}), bar}));
  must(builder.add({"rocker", kWorld, RevoluteJoint{}, SE3(Vec3{1, 0, 0}), bar}));
  const Model model = must(builder.build());
  ConstrainedData data(
      model, must(ConstraintSet::make(
                 model, {close_hinge({1, SE3(Vec3{1, 0, 0})}, {2, SE3(Vec3{0.5, 0, 0})})})));
  InverseInertias inertias(model);
  std::vector<double> q{0.8, -0.7, 0.9}, v(3), tau(3), a(3);
  std::vector<Motor> motors(3);
  const int held[] = {0};
  const long before = g_allocations;
  ASSERT_TRUE(close_loops(model, data, q, {.held = held}));
  for (int i = 0; i < 300; ++i) {
    motors[0] = {i < 150 ? 3.0 : -3.0, 0.0, 1e6, 1.0, 40.0};
    ASSERT_TRUE(constrained_step(model, data, q, v, tau, motors, {}, 0.01));
    ASSERT_TRUE(constrained_forward_dynamics(model, data, q, v, tau, {}, 1.0, a));
    ASSERT_TRUE(project_velocities(model, data, q, v));
    joint_forces<double>(model, q, v, motors, tau);
    inertias.update(model, data.links());
    impulse_response<double>(model, data.links(), 1, {{1, 2, 3}, {4, 5, 6}}, a);
    ASSERT_NE(inertias.between(model, data.links(), 0, 1).columns[2].w.z, 0.0);
    std::fill(tau.begin(), tau.end(), 0.0);
  }
  EXPECT_EQ(g_allocations - before, 0);
  EXPECT_NEAR(q[0], 0.2, 1e-9);  // it reached its stop
}

// Phases in which nothing moves, few move and all move; queries, snapshots and rollbacks.
TEST(PairFinder, AllocatesNothingOnceWarm) {
  collide::PairFinder finder;
  Random random(7);
  std::vector<Vec3> centres;
  for (std::uint32_t i = 0; i < 400; ++i) {
    centres.push_back(random.in_cube(5.0));
    finder.add({.bounds = {centres[i] - Vec3{.5, .5, .5}, centres[i] + Vec3{.5, .5, .5}},
                .mobility = i < 100 ? collide::Mobility::fixed : collide::Mobility::moving,
                .margin = 0.05});
  }
  struct Words {
    std::vector<std::uint64_t> words;
    std::size_t at = 0;
    void u64(std::uint64_t w) { words.push_back(w); }
    std::uint64_t u64() { return words[at++]; }
    void check(bool condition) { EXPECT_TRUE(condition); }
    bool ok() const { return true; }
  } words;
  std::vector<collide::ProxyPair> found;
  std::vector<std::uint32_t> inside;
  collide::CastScratch scratch;
  found.reserve(100000);
  words.words.reserve(100000);
  inside.reserve(400);
  scratch.reserve(500);
  long during = 0;
  for (int k = 0; k < 400; ++k) {
    const long before = g_allocations;
    const double step = k % 40 == 0 ? 3.0 : 0.02;
    for (std::uint32_t i = 100; i < 400; ++i) {
      const Vec3 c = centres[i] + random.in_cube(step);
      finder.set_bounds(i, {c - Vec3{.5, .5, .5}, c + Vec3{.5, .5, .5}}, 0.05);
    }
    finder.update(found);
    for (std::uint32_t i = 0; i < 400; ++i) {
      for (std::uint32_t j = i + 1; k % 10 == 0 && j < 400; ++j) {
        if (!finder.should_pair(i, j)) finder.remove_pair(i, j);
      }
    }
    finder.overlapping({{-1, -1, -1}, {1, 1, 1}}, inside);
    finder.cast({{{-9, 0, 0}, {-9, 0, 0}}, {18, 1, 1}}, 1.0, scratch,
                [](std::uint32_t, float) { return 1.0; });
    words.words.clear();
    words.at = 0;
    finder.write(words);
    finder.read(words);
    finder.adopt();
    found.clear();
    inside.clear();
    if (k >= 200) during += g_allocations - before;
  }
  EXPECT_GT(finder.pairs(), 500u);
  EXPECT_EQ(during, 0);
}

// Memory of a world of boxes, with all scratch memory of its steps: separated boxes, and the same
// number in stacks of ten. Each body includes capacity for its first contacts, reserved in advance
// so that a busy step need not allocate. Vectors hold up to twice what they need.
TEST(Memory, OfABodyAndOfAContactIsAsTheDocumentationSays) {
  struct Taken {
    double bytes = 0.0, contacts = 0.0;
  };
  constexpr int kBoxes = 4000;
  const auto world_of = [](bool stacked) {
    const std::size_t before = g_live;
    World world;
    add_ground(world, {});
    for (int i = 0; i < kBoxes; ++i) {
      const int tower = i / 10, row = tower / 20;
      const double along = 3.0 * (tower % 20), across = 3.0 * row;
      const double up = stacked ? 0.5 + 1.0 * (i % 10) : 2.0 + 3.0 * (i % 10);
      add_dynamic(world, {.shape = Box{{0.5, 0.5, 0.5}}, .pose = SE3(Vec3{along, across, up})});
    }
    for (int i = 0; i < 5; ++i) must(world.step(0.001));
    return Taken{static_cast<double>(g_live - before),
                 static_cast<double>(world.counters().manifolds)};
  };
  const Taken apart = world_of(false), stacked = world_of(true);
  ASSERT_EQ(apart.contacts, 0.0);
  ASSERT_EQ(stacked.contacts, kBoxes);
  const double body = apart.bytes / kBoxes;
  const double contact = (stacked.bytes - apart.bytes) / stacked.contacts;
  std::printf("%.0f bytes a body with its collider, %.0f more a contact of four points\n", body,
              contact);
  EXPECT_LT(body, 8500.0);    // measured: 8485
  EXPECT_LT(contact, 300.0);  // measured: 13
}

}  // namespace
}  // namespace vp::test
