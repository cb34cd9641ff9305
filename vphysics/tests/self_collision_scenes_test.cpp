// Self-collision in heaps, hands and robots, with free bodies, and the state of such worlds.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>

#include "random.h"
#include "self_collision_rig.h"
#include "vphysics/recording.h"

namespace vp::test {
namespace {

// --- heaps

struct Segment {
  Vec3 a, b;
};
// Distance of two segments, from their ends and their common perpendicular.
double distance_between(const Segment& s, const Segment& t) {
  const auto to_point = [](const Segment& u, const Vec3& p) {
    const Vec3 d = u.b - u.a;
    const double along = std::clamp(dot(p - u.a, d) / dot(d, d), 0.0, 1.0);
    return norm(u.a + along * d - p);
  };
  double least = std::min({to_point(s, t.a), to_point(s, t.b), to_point(t, s.a), to_point(t, s.b)});
  const Vec3 d = s.b - s.a, e = t.b - t.a, r = t.a - s.a;
  const double dd = dot(d, d), de = dot(d, e), ee = dot(e, e), det = dd * ee - de * de;
  if (det > 1e-12 * dd * ee) {
    const double x = (dot(r, d) * ee - dot(r, e) * de) / det;
    const double y = (dot(r, d) * de - dot(r, e) * dd) / det;
    if (x >= 0.0 && x <= 1.0 && y >= 0.0 && y <= 1.0) {
      least = std::min(least, norm(s.a + x * d - t.a - y * e));
    }
  }
  return least;
}

constexpr double kChainRadius = 0.02, kChainLength = 0.1;
struct Rope {
  ArticulationId id;
  int links = 0;
};
Rope add_rope(World& world, int links, const Joint& joint, bool collide, const Vec3& top,
              Random& random) {
  const Capsule shape{kChainRadius, 0.5 * kChainLength};
  const SE3 middle(Vec3{0, 0, -0.5 * kChainLength});
  std::vector<LinkSpec> specs;
  for (int i = 0; i < links; ++i) {
    specs.push_back(link_of(i - 1, i == 0 ? Joint{FreeJoint{}} : joint,
                            i == 0 ? Vec3{} : Vec3{0, 0, -kChainLength},
                            solid_inertia(shape, 1000.0).InvXform(middle)));
    specs.back().damping = i == 0 ? 0.0 : 2e-3;
  }
  Rope rope;
  rope.links = links;
  const Model model = model_of(specs);
  rope.id = must(world.create_articulation({model, collide}));
  for (int i = 0; i < links; ++i) {
    must(world.add_collider(world.link_body(rope.id, i), collider_of(shape, kRough, middle)));
  }
  std::vector<double> q = model.zero_coordinates(), v(static_cast<std::size_t>(model.velocities()));
  for (int k = 0; k < 3; ++k) q[static_cast<std::size_t>(k)] = top[k];
  for (std::size_t k = 6; k < v.size(); ++k) v[k] = random.uniform(-0.5, 0.5);
  must(world.set_joint_states(rope.id, q, v));
  return rope;
}
// Maximum penetration between links of a rope that are not neighbours.
double deepest_in_itself(const World& world, const Rope& rope) {
  std::vector<Segment> segments;
  for (int i = 0; i < rope.links; ++i) {
    const SE3 T = world.pose(world.link_body(rope.id, i));
    segments.push_back({T.position(), T * Vec3{0, 0, -kChainLength}});
  }
  double deepest = 0.0;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    for (std::size_t j = i + 2; j < segments.size(); ++j) {
      deepest = std::max(deepest, 2.0 * kChainRadius - distance_between(segments[i], segments[j]));
    }
  }
  return deepest;
}

TEST(SelfCollision, AChainFallsIntoAHeapOfItself) {
  for (const bool planar : {true, false}) {
    for (const double rate : {1000.0, 240.0}) {
      double deepest[2] = {}, at_end[2] = {}, speed[2] = {};
      for (const bool collide : {false, true}) {
        World world;
        Random random(74);
        add_ground(world, kRough);
        const Rope rope =
            add_rope(world, 20, planar ? Joint{RevoluteJoint{kY}} : Joint{BallJoint{}}, collide,
                     {0, 0, 2.2}, random);
        StepStatus status;
        for (int i = 0; i < static_cast<int>(8.0 * rate); ++i) {
          status |= must(world.step(1.0 / rate));
          if (i % 8 == 0)  // it takes longer than a step
            deepest[collide] = std::max(deepest[collide], deepest_in_itself(world, rope));
        }
        EXPECT_FALSE(status.non_finite);
        at_end[collide] = deepest_in_itself(world, rope);
        speed[collide] = fastest(world, rope.id);
      }
      std::printf(
          "%s, %g Hz: at most %.2g m deep (off %.2g), at the end %.2g (off %.2g), %.2g rad/s\n",
          planar ? "planar" : "balls", rate, deepest[1], deepest[0], at_end[1], at_end[0],
          speed[1]);
      EXPECT_GT(deepest[0], 0.02);
      EXPECT_LT(at_end[1], 1e-3);
      EXPECT_LT(speed[1], 0.05);
    }
  }
}

// --- equivalent scenes

// Two carriages on a rail, each with an arm that hangs from it, collide: as two roots of one
// articulation, and as two articulations. Without arms they could be remote.
TEST(SelfCollision, TwoRootsOfOneArticulationMeetAsTwoArticulationsDo) {
  for (const bool arms : {false, true}) {
    World one, two;
    std::vector<BodyId> carriages[2];
    const Box box{{0.1, 0.1, 0.1}};
    const Inertia J = solid_inertia(box, 500.0);
    const Material bouncy{0.5, 0.4, 0.0};
    const auto add_links = [&](std::vector<LinkSpec>& links, double x) {
      const int root = static_cast<int>(links.size());
      links.push_back(link_of(kWorld, PrismaticJoint{{1, 0, 0}}, {x, 0, 1}, J));
      if (arms) links.push_back(link_of(root, RevoluteJoint{kY}, {0, 0, -0.1}, bar(1.0, 0.3)));
    };
    const int per_carriage = arms ? 2 : 1;
    std::vector<LinkSpec> both;
    add_links(both, -0.5);
    add_links(both, 0.5);
    const ArticulationId whole = must(one.create_articulation({model_of(both), true}));
    std::vector<ArticulationId> halves;
    for (int k = 0; k < 2; ++k) {
      std::vector<LinkSpec> single;
      add_links(single, k - 0.5);
      halves.push_back(must(two.create_articulation({model_of(single)})));
      carriages[0].push_back(one.link_body(whole, k * per_carriage));
      carriages[1].push_back(two.link_body(halves.back(), 0));
      const JointDrive drive{1.0 - 2.0 * k, 0.0, 500.0, 20.0, 200.0};
      must(one.set_drive(whole, k * per_carriage, 0, drive));
      must(two.set_drive(halves.back(), 0, 0, drive));
    }
    for (World* world : {&one, &two}) {
      for (const BodyId body : carriages[world == &two]) {
        must(world->add_collider(body, collider_of(box, bouncy)));
      }
    }
    double apart = 0.0, nearest = 1.0;
    long hits[2] = {};
    for (int i = 0; i < 3000; ++i) {
      must(one.step(0.001));
      must(two.step(0.001));
      for (std::size_t k = 0; k < 2; ++k) {
        apart = std::max(apart, norm(one.pose(carriages[0][k]).position() -
                                     two.pose(carriages[1][k]).position()));
        for (const ContactEvent& e : (k == 0 ? one : two).contact_events()) {
          hits[k] += e.kind == ContactEvent::Kind::hit ? 1 : 0;
        }
      }
      nearest = std::min(nearest, one.pose(carriages[0][1]).position().x -
                                      one.pose(carriages[0][0]).position().x - 0.2);
    }
    std::printf("%.2g m apart, gap %.2g m, %ld hits\n", apart, nearest, hits[0]);
    EXPECT_LT(apart, 1e-9);
    EXPECT_GT(nearest, -2e-4);
    EXPECT_EQ(hits[0], hits[1]);
    EXPECT_GT(hits[0], 1);
  }
}

// A motor drives a carriage on a rail, far from other bodies, until it stops at the next carriage.
// This holds with and without queries.
TEST(SelfCollision, ARemoteArticulationStillMeetsItself) {
  World world({.gravity = {}});
  const Box box{{0.1, 0.1, 0.1}};
  std::vector<LinkSpec> links;
  for (const double x : {-0.5, 0.5}) {
    links.push_back(
        link_of(kWorld, PrismaticJoint{{1, 0, 0}}, {x, 0, 0}, solid_inertia(box, 500.0)));
  }
  const ArticulationId id = must(world.create_articulation({model_of(links), true}));
  for (int l = 0; l < 2; ++l) {
    must(world.add_collider(world.link_body(id, l), collider_of(box, kSmooth)));
    must(world.set_drive(id, l, 0, {1.0 - 2.0 * l, 0.0, 1e4, 500.0, 300.0}));
  }
  add_ball(world, {0, 5, 0}, {}, kSmooth);  // far away: with it, articulations can be remote
  for (int i = 0; i < 2000; ++i) must(world.step(0.001));
  const auto q = world.coordinates(id);
  EXPECT_NEAR(q[0] - q[1], 0.8, 2e-4);
}

// --- state

// An arm on its table, a rope on a floor, a box on the arm's table: contacts between links only,
// and contacts in sub-steps.
struct Mixed {
  Folded arm;
  Rope rope;
};
Mixed build_mixed(World& world) {
  Random random(75);
  add_ground(world, kRough, {0, 0, 1});
  Mixed out;
  out.arm = add_folded(world, kRough);
  add_dynamic(
      world,
      {.shape = Box{{0.05, 0.05, 0.05}}, .material = kRough, .pose = SE3(Vec3{-0.4, 0.1, 0.06})});
  out.rope = add_rope(world, 8, BallJoint{}, true, {2, 0, 0.9}, random);
  return out;
}

TEST(SelfCollision, StepsToTheSameBitsFromASnapshot) {
  World straight, rolled;
  build_mixed(straight);
  build_mixed(rolled);
  std::vector<std::byte> bytes;
  long begun = 0;
  for (int i = 0; i < 600; ++i) {
    bytes.clear();
    rolled.snapshot(bytes);
    must(rolled.step(0.004));
    must(rolled.restore(bytes));
    must(rolled.step(0.002));
    must(straight.step(0.002));
    begun += begins(straight);
    ASSERT_EQ(straight.state_hash(), rolled.state_hash()) << i;
  }
  EXPECT_GT(begun, 5);
  // Taken while contacts exist, restored into a world without any steps.
  bytes.clear();
  straight.snapshot(bytes);
  World fresh;
  build_mixed(fresh);
  must(fresh.restore(bytes));
  for (int i = 0; i < 100; ++i) {
    must(fresh.step(0.002));
    must(straight.step(0.002));
  }
  EXPECT_EQ(fresh.state_hash(), straight.state_hash());
}

TEST(SelfCollision, IsRecordedAndReplayed) {
  World world;
  const auto recorder = std::make_shared<Recorder>(1);
  must(world.record(recorder));
  build_mixed(world);
  for (int i = 0; i < 500; ++i) must(world.step(0.002));
  must(world.record(nullptr));
  auto opened = Replay::open(recorder->take(), recorder->parts());
  ASSERT_TRUE(opened);
  Replay replay = std::move(*opened);
  for (;;) {
    const auto state = replay.step();
    ASSERT_TRUE(state) << state.error().message;
    if (*state == ReplayState::end) break;
  }
  EXPECT_EQ(replay.first_difference(), std::nullopt);
  EXPECT_EQ(replay.world().state_hash(), world.state_hash());
}

TEST(SelfCollision, IsPartOfWhatASnapshotIsKnownBy) {
  World on, off;
  add_folded(on, kRough, true);
  add_folded(off, kRough, false);
  std::vector<std::byte> bytes;
  on.snapshot(bytes);
  EXPECT_FALSE(off.restore(bytes));
  EXPECT_TRUE(on.restore(bytes));
}

TEST(SelfCollision, QueriesSeeTheSame) {
  World on, off;
  const Folded a = add_folded(on, kRough, true), b = add_folded(off, kRough, false);
  for (const Vec3& origin : {Vec3{0, 0, 3}, Vec3{0.5, 0, 3}, Vec3{0.1, 0.1, 3}}) {
    const auto p = must(on.ray_cast(origin, {0, 0, -1}, 10.0));
    const auto q = must(off.ray_cast(origin, {0, 0, -1}, 10.0));
    ASSERT_EQ(p.has_value(), q.has_value());
    if (p) {
      EXPECT_EQ(p->distance, q->distance);
    }
  }
  std::vector<ColliderId> found[2];
  must(on.overlapping(Sphere{1.0}, SE3(Vec3{0, 0, 0.2}), found[0]));
  must(off.overlapping(Sphere{1.0}, SE3(Vec3{0, 0, 0.2}), found[1]));
  EXPECT_EQ(found[0].size(), found[1].size());
  (void)a, (void)b;
}

// --- with free bodies, in sub-steps

// The arm rests on its table while a box lies on the table, or on the arm's tip.
TEST(SelfCollision, LinksTouchInSubStepsToo) {
  for (const double rate : kRates) {
    World world;
    const Folded arm = add_folded(world, kSmooth, true, {}, false, 0.3);
    const BodyId on_table = add_dynamic(
        world,
        {.shape = Box{{0.05, 0.05, 0.05}}, .material = kRough, .pose = SE3(Vec3{0.2, 0.1, 0.051})});
    double deepest = 0.0;
    for (int i = 0; i < static_cast<int>(2.0 * rate); ++i) {
      must(world.step(1.0 / rate));
      deepest = std::max(deepest, -gap(world, arm));
    }
    std::printf("%g Hz: %.2g m deep, ends at %.2g m, %.2g m/s\n", rate, deepest, gap(world, arm),
                fastest(world, arm.id));
    EXPECT_LT(deepest, 2e-3) << rate;
    EXPECT_NEAR(gap(world, arm), 0.0, 3e-4) << rate;
    EXPECT_LT(fastest(world, arm.id), 2e-3) << rate;
    EXPECT_NEAR(world.pose(on_table).position().z, 0.05, 3e-4) << rate;
    std::vector<ContactPoint> points;
    world.contacts_of(arm.arm, points);
    double force = 0.0;
    for (const ContactPoint& p : points) force += p.normal_impulse * rate;
    EXPECT_NEAR(force, 0.5 * 9.81, 0.1) << rate;
  }
}

// Two fingers of one hand close on a ball, and on each other once the ball is removed.
TEST(SelfCollision, AHandGripsABallAndThenItself) {
  for (const double rate : {1000.0, 240.0}) {
    World world;
    std::vector<LinkSpec> links;
    links.push_back(
        link_of(kWorld, PrismaticJoint{{0, 0, 1}}, {0, 0, 1}, Inertia(1.0, Vec3{1, 1, 1})));
    links[0].forces = {locked()};
    for (const double x : {-0.1, 0.1}) {
      links.push_back(link_of(0, RevoluteJoint{kY}, {x, 0, 0}, bar(0.2, 0.2)));
    }
    const ArticulationId id = must(world.create_articulation({model_of(links), true}));
    const Capsule finger{0.02, 0.09};
    for (int l = 1; l <= 2; ++l) {
      must(world.add_collider(world.link_body(id, l),
                              collider_of(finger, {1.0, 0.0, 0.0}, SE3(Vec3{0, 0, -0.1}))));
      must(world.set_drive(id, l, 0, {l == 1 ? -1.0 : 1.0, 0.0, 20.0, 0.5, 3.0}));
    }
    const BodyId ball = add_dynamic(world, {.shape = Sphere{0.05},
                                            .material = {1.0, 0.0, 0.0},
                                            .density = 300.0,
                                            .pose = SE3(Vec3{0, 0, 0.86})});
    for (int i = 0; i < static_cast<int>(rate); ++i) must(world.step(1.0 / rate));
    EXPECT_GT(world.pose(ball).position().z, 0.7) << "let go";
    EXPECT_LT(norm(world.velocity(ball).v), 0.05);
    must(world.destroy_body(ball));
    double deepest = 0.0;
    for (int i = 0; i < static_cast<int>(rate); ++i) {
      must(world.step(1.0 / rate));
      Segment s[2];
      for (int l = 1; l <= 2; ++l) {
        const SE3 T = world.pose(world.link_body(id, l));
        s[l - 1] = {T * Vec3{0, 0, -0.01}, T * Vec3{0, 0, -0.19}};
      }
      deepest = std::max(deepest, 0.04 - distance_between(s[0], s[1]));
    }
    std::printf("%g Hz: fingers %.2g m in each other, %.2g m/s\n", rate, deepest,
                fastest(world, id));
    EXPECT_LT(deepest, 1e-3);
    EXPECT_LT(fastest(world, id), 0.01);
  }
}

// --- robots

// Humanoid: 27 velocities, 19 capsules and balls. Hips and shoulders consist of several hinges at
// one point, with links without shapes between them. The same model as in ./bench robots.
class Humanoid {
 public:
  explicit Humanoid(World& world, bool collide, double height) {
    const int chest = add(kWorld, {}, FreeJoint{}, {},
                          {{{0, -0.07, 0}, {0, 0.07, 0}, 0.07},
                           {{0, 0, 0.19}, {0, 0, 0.19}, 0.09},
                           {{-0.01, -0.06, -0.12}, {-0.01, 0.06, -0.12}, 0.06}});
    damping_ = 5.0, armature_ = 0.02;
    int last = hinge(chest, {-0.01, 0, -0.2}, {0, 0, 1}, -0.8, 0.8);
    last = hinge(last, {}, kY, -1.3, 0.5, {{{0, -0.06, 0}, {0, 0.06, 0}, 0.06}});
    const int pelvis = hinge(last, {0, 0, -0.16}, {1, 0, 0}, -0.6, 0.6,
                             {{{-0.02, -0.07, 0}, {-0.02, 0.07, 0}, 0.09}});
    for (const double side : {1.0, -1.0}) {
      last = hinge(pelvis, {0, 0.1 * side, -0.04}, {1, 0, 0}, -0.4, 0.4);
      last = hinge(last, {}, {0, 0, 1}, -1.0, 0.6);
      last = hinge(last, {}, kY, -1.9, 0.3, {{{0, 0, 0}, {0, 0.01 * side, -0.34}, 0.06}});
      damping_ = 1.0, armature_ = 0.008;
      last = hinge(last, {0, 0.01 * side, -0.4}, kY, -2.7, 0.0, {{{0, 0, 0}, {0, 0, -0.3}, 0.049}});
      last = hinge(last, {0, 0, -0.39}, kY, -0.8, 0.8);
      hinge(last, {}, {1, 0, 0}, -0.8, 0.8,
            {{{-0.07, 0.01, 0}, {0.14, 0.03, 0}, 0.027},
             {{-0.07, -0.01, 0}, {0.14, -0.03, 0}, 0.027}});
      damping_ = 5.0, armature_ = 0.02;
    }
    damping_ = 0.5, armature_ = 0.005;
    for (const double side : {1.0, -1.0}) {
      last = hinge(chest, {0, 0.17 * side, 0.06}, {1, 0, 0}, -1.4, 1.4);
      last = hinge(last, {}, kY, -1.4, 1.4, {{{0, 0, 0}, {0.1, 0.12 * side, -0.14}, 0.04}});
      hinge(last, {0.12, 0.16 * side, -0.17}, kY, -1.5, 0.9,
            {{{0.01, 0, 0.01}, {0.15, -0.12 * side, 0.15}, 0.031},
             {{0.18, -0.15 * side, 0.18}, {0.18, -0.15 * side, 0.18}, 0.04}});
    }
    id = must(world.create_articulation({model_of(links_), collide}));
    for (std::size_t l = 0; l < links_.size(); ++l) {
      for (const Pass& r : shapes_[l]) {
        must(world.add_collider(world.link_body(id, static_cast<int>(l)),
                                collider_of(shape_of(r), kRough, pose_of(r))));
      }
    }
    std::vector<double> q = world.model(id)->zero_coordinates();
    q[2] = height;
    must(world.set_joint_states(
        id, q, std::vector<double>(static_cast<std::size_t>(world.model(id)->velocities()))));
  }
  ArticulationId id;

 private:
  struct Pass {
    Vec3 from, to;
    double radius;
  };
  static Shape shape_of(const Pass& r) {
    const double length = norm(r.to - r.from);
    if (length == 0.0) return Sphere{r.radius};
    return Capsule{r.radius, 0.5 * length};
  }
  static SE3 pose_of(const Pass& r) {
    const double length = norm(r.to - r.from);
    const Mat3 R = length > 0.0 ? facing((1.0 / length) * (r.to - r.from)) : Mat3::identity();
    return SE3(R, 0.5 * (r.from + r.to));
  }
  int add(int parent, const Vec3& at, const Joint& joint, const std::vector<JointForces>& forces,
          const std::vector<Pass>& shapes) {
    Inertia sum;
    for (const Pass& r : shapes) {
      sum = sum + solid_inertia(shape_of(r), 1000.0).InvXform(pose_of(r));
    }
    links_.push_back(link_of(parent, joint, at, sum));
    links_.back().forces = forces;
    shapes_.push_back(shapes);
    return static_cast<int>(links_.size()) - 1;
  }
  int hinge(int parent, const Vec3& at, const Vec3& axis, double lower, double upper,
            const std::vector<Pass>& shapes = {}) {
    const int link = add(parent, at, RevoluteJoint{axis}, {stops(lower, upper)}, shapes);
    links_.back().damping = damping_;
    links_.back().armature = armature_;
    return link;
  }
  double damping_ = 0.0, armature_ = 0.0;
  std::vector<LinkSpec> links_;
  std::vector<std::vector<Pass>> shapes_;
};

TEST(SelfCollision, AHumanoidFallsOnItselfAndLiesStill) {
  for (const double rate : {1000.0, 200.0}) {
    double time[2] = {};
    for (const bool collide : {false, true}) {
      World world;
      add_ground(world, kRough);
      const Humanoid human(world, collide, 1.6);
      const double start = energy_of(world, human.id);
      double energy = start, grown = 0.0, quickest = 0.0;
      long own = 0;
      StepStatus status;
      for (int i = 0; i < 2000; ++i) {
        const auto before = std::chrono::steady_clock::now();
        status |= must(world.step(1.0 / rate));
        time[collide] +=
            std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
        const double now = energy_of(world, human.id);
        ASSERT_TRUE(std::isfinite(now));
        grown = std::max(grown, now - energy);
        energy = std::min(energy, now);
        quickest = std::max(quickest, fastest(world, human.id));
        for (const ContactEvent& e : world.contact_events()) {
          const bool self =
              world.body_of(e.a) != BodyId{1, 1} && world.body_of(e.b) != BodyId{1, 1};
          own += self && e.kind == ContactEvent::Kind::begin ? 1 : 0;
        }
      }
      std::printf(
          "%g Hz, %s: %ld contacts with itself began, at most %.3g m/s, energy grew by %.2g "
          "of %.3g J, ends at %.2g m/s, %.1f us a step\n",
          rate, collide ? "on" : "off", own, quickest, grown, start, fastest(world, human.id),
          1e6 * time[collide] / 2000);
      EXPECT_FALSE(status.non_finite);
      EXPECT_LT(grown, 0.01 * start);
      EXPECT_LT(quickest, 40.0);
      if (rate < 500.0) {  // after ten seconds
        EXPECT_LT(fastest(world, human.id), 0.05);
      }
      EXPECT_EQ(own > 0, collide);
    }
  }
}

// Links that overlap deeply when created and are not neighbours. They separate as far as their
// joints allow, at moderate speeds, or stay.
TEST(SelfCollision, LinksThatOverlapDeeplyAtFirstDoNotExplode) {
  for (const double rate : kRates) {
    for (const double offset : {0.0, 0.002, 0.03}) {  // between the joints
      for (const bool box_on_it : {false, true}) {
        SCOPED_TRACE(testing::Message() << rate << " Hz, " << offset << " m, " << box_on_it);
        World world;
        add_ground(world, kRough);
        std::vector<LinkSpec> links;
        const Box plate{{0.3, 0.3, 0.05}};
        links.push_back(link_of(kWorld, FreeJoint{}, {}, solid_inertia(plate, 1000.0)));
        links.push_back(link_of(0, RevoluteJoint{kY}, {0.1, 0, 0.04}, bar(0.1, 0.02)));
        links.push_back(link_of(1, PrismaticJoint{{1, 0, 0}}, {offset, 0, offset}, bar(0.1, 0.02)));
        links.push_back(link_of(2, RevoluteJoint{{1, 0, 0}}, {offset, 0, 0}, bar(1.0, 0.3)));
        links[2].forces = {stops(-0.01, 0.01)};
        const ArticulationId id = must(world.create_articulation({model_of(links), true}));
        must(world.add_collider(world.link_body(id, 0), collider_of(plate, kRough)));
        must(world.add_collider(world.link_body(id, 2), collider_of(Sphere{0.06}, kRough)));
        must(world.add_collider(world.link_body(id, 3),
                                collider_of(Capsule{0.04, 0.1}, kRough, SE3(Vec3{0, 0, -0.1}))));
        std::vector<double> q = world.model(id)->zero_coordinates();
        q[2] = 0.4;
        must(world.set_joint_states(
            id, q, std::vector<double>(static_cast<std::size_t>(world.model(id)->velocities()))));
        if (box_on_it) {
          add_dynamic(world, {.shape = Box{{0.05, 0.05, 0.05}},
                              .material = kRough,
                              .pose = SE3(Vec3{-0.2, 0, 0.51})});
        }
        double quickest = 0.0, highest = 0.0, energy = energy_of(world, id), grown = 0.0;
        StepStatus status;
        for (int i = 0; i < static_cast<int>(2.0 * rate); ++i) {
          status |= must(world.step(1.0 / rate));
          const double now = energy_of(world, id);
          grown = std::max(grown, now - energy);
          energy = std::min(energy, now);
          for (int l = 0; l < 4; ++l) {
            const BodyId body = world.link_body(id, l);
            quickest = std::max(quickest, norm(world.velocity_world(body).linear));
            highest = std::max(highest, world.pose(body).position().z);
          }
        }
        std::printf(
            "%4g Hz, %g m%s: at most %.3g m/s, %.3g m high, energy grew by %.2g J, ends at "
            "%.2g\n",
            rate, offset, box_on_it ? ", box" : "", quickest, highest, grown, fastest(world, id));
        EXPECT_FALSE(status.non_finite);
        EXPECT_LT(quickest, 10.0);
        EXPECT_LT(highest, 1.0);
      }
    }
  }
}

}  // namespace
}  // namespace vp::test
