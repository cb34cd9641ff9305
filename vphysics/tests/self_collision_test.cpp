// Collisions between links of one articulation (ArticulationDesc::links_collide): their impulses,
// and which links are neighbours.
#include <gtest/gtest.h>

#include <cstdio>

#include "self_collision_rig.h"
#include "solve/link_side.h"
#include "trees.h"
#include "vphysics/multibody/jacobians.h"

namespace vp::test {
namespace {

// --- effective masses in the solver

// In random trees: the change of the relative velocity of two links by an impulse between them,
// from the rows of both sides and from J M^-1 J^T.
TEST(SelfCollision, AnImpulseBetweenTwoLinksIsFeltThroughAllThatCarriesBoth) {
  Random random(71);
  double worst = 0.0;
  int shared = 0;
  for (int k = 0; k < 60; ++k) {
    const Model model = random_tree(random, 2 + k % 14, 9);
    const State state = random_state(random, model);
    Data data(model);
    detail::ImpulseFactor factor(model);
    forward_kinematics<double>(model, data, state.q, state.v);
    ASSERT_TRUE(factor.factor(model, data));
    const auto n = static_cast<std::size_t>(model.velocities());
    const int a = static_cast<int>(random.word() % static_cast<unsigned>(model.links()));
    const int b = static_cast<int>(random.word() % static_cast<unsigned>(model.links()));
    if (a == b) continue;
    const Vec3 point = random.in_cube(1.0);
    const Vec3 directions[2] = {random.direction(), random.direction()};
    double z = 0.0;  // stands for both links' velocities; only its address counts
    solve::LinkSide side[2];
    std::vector<double> rows[2];
    std::vector<double> J[2] = {std::vector<double>(n), std::vector<double>(n)};
    for (int s = 0; s < 2; ++s) {
      const int link = s == 0 ? a : b;
      const double sign = s == 0 ? -1.0 : 1.0;
      const std::uint32_t depth = factor.depth(link);
      rows[s].resize(2 * std::size_t{depth} + 1);
      side[s] = {rows[s].data(), factor.next(), &z, nullptr, factor.first(link), depth};
      std::vector<Vec3> columns(n);
      const Vec3 local = inverse_times(T_world_link(model, data, link), point);
      point_jacobian<double>(model, data, link, local, Frame::world, columns);
      for (int r = 0; r < 2; ++r) {
        factor.force_row(link, point, sign * directions[r], rows[s].data() + r * depth);
        for (std::size_t i = 0; i < n; ++i) {
          J[r][i] += sign * dot(directions[r], columns[i]);
        }
      }
    }
    shared += side[0].depth > 0 && side[1].depth > 0 ? 1 : 0;
    for (int r = 0; r < 2; ++r) {
      std::vector<double> answer = J[r];
      factor.solve(answer);  // M^-1 J^T, tested beside the mass matrix in impulse_factor_test.cpp
      for (int other = 0; other < 2; ++other) {
        double expected = 0.0, size = 1.0;
        for (std::size_t i = 0; i < n; ++i) {
          expected += J[other][i] * answer[i];
          size += std::fabs(J[other][i] * answer[i]);
        }
        const double got = response(side[0], side[1], r, other);
        worst = std::max(worst, std::fabs(got - expected) / size);
      }
    }
  }
  std::printf("%.2g off at most, %d pairs\n", worst, shared);
  EXPECT_GT(shared, 30);
  EXPECT_LT(worst, 1e-12);
}

// A floating, jackknifed tree of three links, with balls at both ends that collide in the next
// step.
struct Floating {
  ArticulationId id;
  BodyId ends[2];
};
Floating add_jackknife(World& world, const Joint& joint, const Material& material) {
  std::vector<LinkSpec> links;
  links.push_back(link_of(kWorld, FreeJoint{}, {}, bar(1.0, 0.4)));
  links.push_back(link_of(0, joint, {0, 0, -0.4}, bar(0.3, 0.3)));
  links.push_back(link_of(1, joint, {0, 0, -0.3}, bar(2.0, 0.4)));
  Floating out;
  out.id = must(world.create_articulation({model_of(links), true}));
  out.ends[0] = world.link_body(out.id, 0);
  out.ends[1] = world.link_body(out.id, 2);
  const ColliderDesc ball = collider_of(Sphere{0.05}, material);
  must(world.add_collider(out.ends[0], ball));
  ColliderDesc tip = ball;
  tip.T_body_shape = SE3(Vec3{0.02, 0.01, -0.4});
  must(world.add_collider(out.ends[1], tip));
  return out;
}

struct Clash {
  Vec3 normal, point;
  Vec3 before, after;  // relative velocity at the point
  dse3 momentum_before, momentum_after;
  double energy_before = 0.0, energy_after = 0.0;
};
dse3 momentum_of(const World& world, ArticulationId id) {
  const Model& model = *world.model(id);
  Data data(model);
  forward_kinematics<double>(model, data, world.coordinates(id), world.velocities(id));
  return momentum<double>(model, data, {});
}
// Bends the joints until the balls almost touch, sets velocities, and takes one step of a
// microsecond.
Clash clash(Random& random, double restitution, double friction) {
  World world({.gravity = {}});
  const Floating tree =
      add_jackknife(world, RevoluteJoint{kY}, Material{friction, restitution, 0.0});
  std::vector<double> q = world.model(tree.id)->zero_coordinates();
  std::vector<double> v(static_cast<std::size_t>(world.model(tree.id)->velocities()));
  q[7] = 2.1;
  const Vec3 tip{0.02, 0.01, -0.4};
  const auto distance = [&](double angle) {
    q[8] = angle;
    must(world.set_joint_states(tree.id, q, v));
    return norm(world.pose(tree.ends[1]) * tip - world.pose(tree.ends[0]).position()) - 0.1;
  };
  double low = 0.8, high = 2.0;  // separated, overlapping
  EXPECT_GT(distance(low), 0.0);
  EXPECT_LT(distance(high), 0.0);
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (distance(middle) > 1e-9 ? low : high) = middle;  // closing it counts as an approach
  }
  for (double& x : v) x = random.uniform(-1, 1);
  v[6] = 2.0;
  v[7] = 3.0;
  must(world.set_joint_states(tree.id, q, v));
  Clash out;
  out.momentum_before = momentum_of(world, tree.id);
  out.energy_before = energy_of(world, tree.id, {});
  const Vec3 a = world.pose(tree.ends[0]).position(), b = world.pose(tree.ends[1]) * tip;
  out.normal = (1.0 / norm(b - a)) * (b - a);
  out.point = 0.5 * (a + b);
  const auto relative = [&] {
    return world.velocity_at(tree.ends[1], out.point) - world.velocity_at(tree.ends[0], out.point);
  };
  out.before = relative();
  must(world.step(1e-7));
  out.after = relative();
  out.momentum_after = momentum_of(world, tree.id);
  out.energy_after = energy_of(world, tree.id, {});
  return out;
}

TEST(SelfCollision, TwoLinksOfATreePartAtTheirRestitution) {
  Random random(72);
  double worst = 0.0, momentum = 0.0;
  for (const double e : {0.0, 0.3, 0.8, 1.0}) {
    for (int k = 0; k < 10; ++k) {
      const Clash c = clash(random, e, 0.0);
      const double before = dot(c.normal, c.before), after = dot(c.normal, c.after);
      ASSERT_LT(before, -0.1);
      worst = std::max(worst, std::fabs(after + e * before) / -before);
      momentum = std::max({momentum, norm(c.momentum_after.m - c.momentum_before.m),
                           norm(c.momentum_after.f - c.momentum_before.f)});
      EXPECT_LE(c.energy_after, c.energy_before * (1.0 + 1e-6));
      if (e == 1.0) {
        EXPECT_NEAR(c.energy_after, c.energy_before, 2e-5 * c.energy_before);
      }
    }
  }
  std::printf("speeds %.2g off, momentum %.2g\n", worst, momentum);
  EXPECT_LT(worst, 1e-5);  // the links move for a microsecond
  EXPECT_LT(momentum, 1e-12);
}

// With very high friction, the contact points of the two links stay together.
TEST(SelfCollision, FrictionBetweenTwoLinksStopsTheirSliding) {
  Random random(73);
  double worst = 0.0, momentum = 0.0;
  for (int k = 0; k < 20; ++k) {
    const Clash c = clash(random, 0.0, 1e3);
    ASSERT_GT(norm(c.before), 0.1);
    // All joints rotate about y, so the tree cannot change the balls' relative velocity along y.
    const Vec3 rest = c.after - dot(c.after, kY) * kY;
    worst = std::max(worst, norm(rest));
    momentum = std::max({momentum, norm(c.momentum_after.m - c.momentum_before.m),
                         norm(c.momentum_after.f - c.momentum_before.f)});
    EXPECT_LT(c.energy_after, c.energy_before);
  }
  std::printf("slides at %.2g m/s, momentum %.2g\n", worst, momentum);
  EXPECT_LT(worst, 1e-4);
  EXPECT_LT(momentum, 1e-12);
}

// --- arms

TEST(SelfCollision, AnArmThatFallsOnItsFirstLinkRestsThere) {
  for (const double rate : kRates) {
    World world;
    const Folded arm = add_folded(world, kSmooth);
    double energy = energy_of(world, arm.id), grown = 0.0, deepest = 0.0;
    for (int i = 0; i < static_cast<int>(2.0 * rate); ++i) {
      must(world.step(1.0 / rate));
      const double now = energy_of(world, arm.id);
      grown = std::max(grown, now - energy);
      energy = std::min(energy, now);
      deepest = std::max(deepest, -gap(world, arm));
    }
    std::printf("%g Hz: %.2g m deep, ends at %.2g m, %.2g m/s, %.2g J more\n", rate, deepest,
                gap(world, arm), fastest(world, arm.id), grown);
    EXPECT_LT(deepest, 5e-4) << rate;
    EXPECT_NEAR(gap(world, arm), 0.0, 2e-4) << rate;
    EXPECT_LT(fastest(world, arm.id), 1e-3) << rate;
    EXPECT_LT(grown, 0.02) << rate;  // explicit velocity-dependent forces; of 4 J
    std::vector<ContactPoint> points;
    world.contacts_of(arm.arm, points);
    double force = 0.0;
    for (const ContactPoint& p : points) {
      EXPECT_EQ(p.other, arm.table_collider);
      force += p.normal_impulse * rate;
    }
    // The lever: the weight acts halfway between joint and tip.
    EXPECT_NEAR(force, 0.5 * 9.81, 0.05) << rate;
  }
}

TEST(SelfCollision, OffLinksPassThroughEachOther) {
  World world;
  const Folded arm = add_folded(world, kRough, false);
  double deepest = 0.0;
  for (int i = 0; i < 1000; ++i) {
    must(world.step(0.001));
    deepest = std::max(deepest, -gap(world, arm));
    EXPECT_EQ(begins(world), 0);
  }
  EXPECT_GT(deepest, 0.2);
}

TEST(SelfCollision, FiltersAndSensorsAreAsElsewhere) {
  World unfiltered, filtered, off, seen;
  const Folded a = add_folded(filtered, kRough, true, {1, ~1u});
  const Folded b = add_folded(off, kRough, false, {1, ~1u});
  double deepest = 0.0;
  for (int i = 0; i < 1000; ++i) {
    must(filtered.step(0.001));
    must(off.step(0.001));
    const auto p = filtered.coordinates(a.id), q = off.coordinates(b.id);
    ASSERT_TRUE(std::equal(p.begin(), p.end(), q.begin())) << i;
    deepest = std::max(deepest, -gap(filtered, a));
  }
  EXPECT_GT(deepest, 0.2);

  const Folded sensor = add_folded(seen, kRough, true, {}, true);
  long entered = 0, left = 0, hits = 0;
  for (int i = 0; i < 2000; ++i) {
    must(seen.step(0.001));
    for (const ContactEvent& e : seen.contact_events()) {
      EXPECT_TRUE(e.sensor);
      entered += e.kind == ContactEvent::Kind::begin ? 1 : 0;
      left += e.kind == ContactEvent::Kind::end ? 1 : 0;
      hits += e.kind == ContactEvent::Kind::hit ? 1 : 0;
    }
  }
  EXPECT_GE(entered, 1);
  EXPECT_GE(left, 1);
  EXPECT_EQ(hits, 0);
  (void)sensor;

  // A filter that is set later ends the contact. With the old filter, it begins again.
  const Folded c = add_folded(unfiltered, kRough);
  for (int i = 0; i < 2000; ++i) must(unfiltered.step(0.001));
  EXPECT_NEAR(gap(unfiltered, c), 0.0, 2e-4);
  must(unfiltered.set_filter(c.tip_collider, {1, ~1u}));
  must(unfiltered.step(0.001));
  EXPECT_EQ(std::count_if(unfiltered.contact_events().begin(), unfiltered.contact_events().end(),
                          [](const ContactEvent& e) { return e.kind == ContactEvent::Kind::end; }),
            1);
  must(unfiltered.set_filter(c.tip_collider, {}));
  must(unfiltered.step(0.001));
  EXPECT_EQ(begins(unfiltered), 1);
}

// --- neighbours

// Large balls about every joint. Links of a chain collide with those beyond the next link. A link
// fixed to another counts as part of it, and joints at one point count as one.
TEST(SelfCollision, NeighboursNeverMeetHoweverTheyOverlap) {
  struct Chain {
    const char* name;
    std::vector<LinkSpec> links;
    std::vector<std::pair<int, int>> meet;
  };
  const Inertia J(1.0, Vec3{0.01, 0.01, 0.01});
  const RevoluteJoint hinge{kY}, other{{1, 0, 0}};
  const Vec3 step{0, 0, -0.1}, here{};
  const FixedJoint fixed;
  const std::vector<Chain> chains = {
      {"hinges",
       {link_of(kWorld, hinge, here, J), link_of(0, hinge, step, J), link_of(1, hinge, step, J)},
       {{0, 2}}},
      {"fixed to the link before",
       {link_of(kWorld, hinge, here, J), link_of(0, fixed, step, J), link_of(1, hinge, step, J),
        link_of(2, fixed, step, J), link_of(3, hinge, step, J)},
       {{0, 4}, {1, 4}}},
      {"fixed to the world",
       {link_of(kWorld, fixed, here, J), link_of(kWorld, fixed, step, J),
        link_of(1, hinge, step, J), link_of(2, hinge, step, J)},
       {{0, 3}, {1, 3}}},
      {"two roots and two branches",
       {link_of(kWorld, hinge, here, J), link_of(kWorld, hinge, step, J),
        link_of(0, hinge, step, J), link_of(0, hinge, step, J)},
       {{0, 1}, {1, 2}, {1, 3}, {2, 3}}},
      {"three hinges at one point",
       {link_of(kWorld, hinge, here, J), link_of(0, hinge, step, J), link_of(1, other, here, J),
        link_of(2, hinge, here, J), link_of(3, hinge, step, J)},
       {{0, 4}, {1, 4}, {2, 4}}},
      {"a slide between hinges is not at one point with them",
       {link_of(kWorld, hinge, here, J), link_of(0, hinge, step, J),
        link_of(1, PrismaticJoint{{0, 0, 1}}, here, J), link_of(2, hinge, here, J)},
       {{0, 2}, {0, 3}, {1, 3}}},
  };
  for (const Chain& chain : chains) {
    for (const bool box_beside : {false, true}) {  // with it, the broad phase runs
      SCOPED_TRACE(chain.name);
      World world({.gravity = {}});
      const ArticulationId id = must(world.create_articulation({model_of(chain.links), true}));
      std::vector<ColliderId> colliders;
      for (int l = 0; l < static_cast<int>(chain.links.size()); ++l) {
        colliders.push_back(
            must(world.add_collider(world.link_body(id, l), collider_of(Sphere{0.5}, kSmooth))));
      }
      if (box_beside)
        add_dynamic(world, {.shape = Box{{0.1, 0.1, 0.1}}, .pose = SE3(Vec3{0.5, 0, 0})});
      std::vector<std::pair<int, int>> met;
      const auto number = [&](ColliderId c) {
        return static_cast<int>(std::find(colliders.begin(), colliders.end(), c) -
                                colliders.begin());
      };
      must(world.step(0.001));
      const int count = static_cast<int>(colliders.size());
      for (const ContactEvent& e : world.contact_events()) {
        if (e.kind != ContactEvent::Kind::begin) continue;
        if (number(e.a) < count && number(e.b) < count) met.emplace_back(number(e.a), number(e.b));
      }
      std::sort(met.begin(), met.end());
      EXPECT_EQ(met, chain.meet) << box_beside;
    }
  }
}

}  // namespace
}  // namespace vp::test
