// Worlds with meshes and height fields: bodies slide, roll, fall and are shot on them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "rig.h"
#include "surfaces.h"

namespace vp::test {
namespace {

constexpr double kFall = 9.81;
constexpr double kStepTimes[] = {1.0 / 60, 1.0 / 240, 0.001};

TriangleMesh flat_mesh(std::uint32_t cells = 80, double size = 16.0) {
  Random random(71);
  return random_plane(random, cells, size).made();
}
HeightField flat_field() {
  const std::vector<double> heights(81 * 81, 0.0);
  return HeightField::of({81, 81, 0.2, 0.2, heights, {}}).value();
}
struct Glider {
  const char* name;
  Shape shape;
  double height;
  bool continuous, rolls;
};
const Glider kGliders[] = {{"box", Box{{0.3, 0.2, 0.1}}, 0.1, false, false},
                           {"cylinder", Cylinder{0.2, 0.1}, 0.1, false, false},
                           {"ball", Sphere{0.1}, 0.1, false, true},
                           {"swept ball", Sphere{0.1}, 0.1, true, true}};

struct Glided {
  double speed_off = 0.0, sideways = 0.0, height_off = 0.0;  // worst
  int begins = 0, others = 0, impacts = 0;
};

// Over 7 m of triangles of 0.2 m at 5 m/s, against the closed form: v, or v - mu g t.
Glided glide(const Shape& ground, const Glider& glider, double dt, double friction) {
  World world;
  const Material material{friction, 0.0, 0.0};
  add_fixed(world, ground, material);
  const Vec3 way{0.8, 0.6, 0.0}, velocity = 5.0 * way;
  const bool rolls = glider.rolls && friction > 0.0;
  const Vec3 spin = rolls ? (1.0 / glider.height) * cross(Vec3{0, 0, 1}, velocity) : Vec3{};
  Part part{.shape = glider.shape, .material = material, .continuous = glider.continuous};
  const SE3 turn = SE3(Exp(Vec3{0, 0, 0.3}), {});
  part.pose = SE3(turn.rotation(), Vec3{2.03, 2.01, glider.height});
  part.velocity = {turn.unrotate(spin), turn.unrotate(velocity)};
  const BodyId body = add_dynamic(world, part);
  Glided slid;
  for (double t = dt; t < 1.4; t += dt) {
    must(world.step(dt));
    slid.impacts += static_cast<int>(world.counters().impacts);
    for (const ContactEvent& e : world.contact_events()) {
      (e.kind == ContactEvent::Kind::begin ? slid.begins : slid.others) += 1;
    }
    const SE3 T = world.pose(body);
    const Vec3 v = T.rotate(world.velocity(body).v);
    const double expected = rolls ? 5.0 : 5.0 - friction * kFall * t;
    slid.speed_off = std::max(slid.speed_off, std::fabs(dot(v, way) - expected));
    slid.sideways = std::max(slid.sideways, std::fabs(cross(way, v).z));
    slid.height_off = std::max(slid.height_off, std::fabs(T.position().z - glider.height));
  }
  return slid;
}

// No ghost collisions: internal edges have no effect at any step.
TEST(SurfaceWorld, WhatSlidesOrRollsOverAPlaneOfTrianglesFeelsNothingButFriction) {
  const Shape grounds[] = {flat_mesh(), flat_field()};
  for (const Shape& ground : grounds) {
    for (const Glider& glider : kGliders) {
      for (const double dt : kStepTimes) {
        const auto place = [&] {
          return std::string(glider.name) + (&ground == grounds ? ", mesh, " : ", field, ") +
                 std::to_string(dt);
        };
        const Glided smooth = glide(ground, glider, dt, 0.0),
                     rough = glide(ground, glider, dt, 0.3);
        // Measured: 3e-14 without friction.
        EXPECT_LT(smooth.speed_off, 1e-12) << place();
        EXPECT_LT(smooth.sideways, 1e-12) << place();
        // Measured: sliding 7e-3 at 1/60 s, where the contact force has not converged in the first
        // step; rolling 2.3e-4 at 1/60 s.
        EXPECT_LT(rough.speed_off, glider.rolls ? 3e-4 : 0.5 * dt + 1.5e-3) << place();
        EXPECT_LT(rough.sideways, 1e-4) << place();  // 3.6e-5
        for (const Glided& slid : {smooth, rough}) {
          EXPECT_LT(slid.height_off, 6e-5) << place();  // 4.9e-5 at 1/60 s, by the weight
          EXPECT_EQ(slid.begins, 1) << place();
          EXPECT_EQ(slid.others, 0) << place();
          EXPECT_EQ(slid.impacts, 0) << place();
        }
      }
    }
  }
}

// A ball is shot at a surface from above, and again from each place it bounced to. Its centre is
// never below the surface. The height of the ground is computed without the engine.
double height_over(const TriangleMesh& mesh, const Vec3& p) {
  double top = -1e9;
  for (const TriangleMesh::Triangle& t : mesh.triangles()) {
    const Vec3 &a = mesh.vertices()[t[0]], &b = mesh.vertices()[t[1]], &c = mesh.vertices()[t[2]];
    const double area = cross(b - a, c - a).z;
    const double u = cross(p - a, c - a).z / area, v = cross(b - a, p - a).z / area;
    if (u < 0.0 || v < 0.0 || u + v > 1.0) continue;
    top = std::max(top, a.z + u * (b.z - a.z) + v * (c.z - a.z));
  }
  return p.z - top;
}

TEST(SurfaceWorld, AContinuousBallNeverGoesThroughAMeshOrAHeightField) {
  Random random(74);
  MeshPoints rough = random_plane(random, 12, 2.0);
  for (Vec3& v : rough.vertices) v.z = random.uniform(-0.12, 0.12);
  const TriangleMesh mesh = rough.made();
  double lowest = 1.0;
  int hits = 0, limited = 0;
  for (int shot = 0; shot < 150; ++shot) {
    World world({.gravity = {}});
    const Material material{0.3, random.uniform(0.0, 1.0), 0.0};
    add_fixed(world, mesh, material);
    Vec3 direction = random.direction();
    direction.z = -0.05 - std::fabs(direction.z);
    direction = (random.uniform(20.0, 100.0) / norm(direction)) * direction;
    const Vec3 aim{random.uniform(0.7, 1.3), random.uniform(0.7, 1.3), 0.0};
    const Vec3 start = aim - (0.3 / std::fabs(direction.z)) * direction;
    const BodyId ball = add_ball(world, start, direction, material);
    const double dt = shot % 2 == 0 ? 0.001 : 1.0 / 240;
    for (int i = 0; i < 40; ++i) {
      limited += must(world.step(dt)).impact_limit;
      for (const ContactEvent& e : world.contact_events())
        hits += e.kind == ContactEvent::Kind::hit;
      const Vec3 p = world.pose(ball).position();
      if (std::max(std::fabs(p.x - 1.0), std::fabs(p.y - 1.0)) > 0.95) break;
      lowest = std::min(lowest, height_over(mesh, p));
    }
  }
  EXPECT_GT(lowest, 0.9 * kBallRadius) << lowest;
  EXPECT_GT(hits, 150);
  EXPECT_EQ(limited, 0);
}

// A ball inside a closed mesh with inward normals stays inside. A ball outside one with outward
// normals stays outside.
TEST(SurfaceWorld, AContinuousBallStaysInACageAndOutOfACrate) {
  MeshPoints cage = box_mesh({0.5, 0.4, 0.3});
  for (TriangleMesh::Triangle& t : cage.triangles) std::swap(t[1], t[2]);
  World world;
  const Material bouncy{0.2, 1.0, 0.0};
  add_fixed(world, cage.made(), bouncy);
  add_fixed(world, box_mesh({0.1, 0.1, 0.05}).made(), bouncy, SE3(Vec3{0.1, 0, -0.2}));
  Random random(75);
  std::vector<BodyId> balls;
  for (int i = 0; i < 4; ++i) {
    balls.push_back(add_ball(world, {-0.3 + 0.1 * i, 0.1, 0.1}, 25.0 * random.direction(), bouncy));
  }
  int hits = 0;
  for (int i = 0; i < 1500; ++i) {
    EXPECT_FALSE(must(world.step(0.001)).impact_limit);
    for (const ContactEvent& e : world.contact_events()) hits += e.kind == ContactEvent::Kind::hit;
    for (const BodyId ball : balls) {
      const Vec3 p = world.pose(ball).position();
      const double r = kBallRadius - 3e-4;
      ASSERT_TRUE(std::fabs(p.x) < 0.5 - r && std::fabs(p.y) < 0.4 - r && std::fabs(p.z) < 0.3 - r);
      const Vec3 d = p - Vec3{0.1, 0, -0.2};
      ASSERT_FALSE(std::fabs(d.x) < 0.1 && std::fabs(d.y) < 0.1 && std::fabs(d.z) < 0.05);
    }
  }
  EXPECT_GT(hits, 200);
}

// A rotating kinematic paddle of triangles against balls that fly at it.
TEST(SurfaceWorld, AContinuousBallNeverGoesThroughATurningMesh) {
  Random random(76);
  MeshOptions sheet;
  sheet.two_sided = true;
  const TriangleMesh paddle = random_plane(random, 6, 0.4).made(sheet);
  int met = 0;
  for (int shot = 0; shot < 100; ++shot) {
    World world({.gravity = {}});
    const Material material{0.3, 0.5, 0.0};
    BodyDesc desc;
    desc.motion = Motion::kinematic;
    desc.T_world_body = SE3(random.rotation(), {});
    desc.velocity.w = {random.uniform(-60, 60), random.uniform(-60, 60), random.uniform(-20, 20)};
    const BodyId body = must(world.create_body(desc));
    ColliderDesc collider;
    collider.shape = paddle;
    collider.T_body_shape = SE3(Vec3{-0.2, -0.2, 0.0});
    collider.material = material;
    must(world.add_collider(body, collider));
    const Vec3 direction = random.direction();
    const BodyId ball = add_ball(world, -0.5 * direction, 20.0 * direction, material);
    const auto local = [&] { return inverse_times(world.pose(body), world.pose(ball).position()); };
    Vec3 before = local();
    for (int i = 0; i < 60; ++i) {
      must(world.step(0.001));
      for (const ContactEvent& e : world.contact_events()) met += e.kind == ContactEvent::Kind::hit;
      const Vec3 after = local();
      if (before.z * after.z < 0.0) {
        const Vec3 at = before + (before.z / (before.z - after.z)) * (after - before);
        ASSERT_FALSE(std::max(std::fabs(at.x), std::fabs(at.y)) < 0.19) << shot;
      }
      before = after;
    }
  }
  EXPECT_GT(met, 60);
}

// A box at rest costs nothing, and a moving one processes only the triangles under it. Neither
// depends on the number of triangles.
TEST(SurfaceWorld, CostDoesNotDependOnTheNumberOfTriangles) {
  std::uint32_t most[2] = {};
  for (const int large : {0, 1}) {
    const std::uint32_t cells = large ? 224 : 20;  // 800 and 100,352 triangles of 0.1 m
    const MeshPoints m = grid_mesh(cells, 0.1, 0.0, [](double, double) { return 0.0; });
    World world;
    add_fixed(world, m.made(), {});
    const Material slippery{0.1, 0.0, 0.0};
    const Part part{.shape = Box{{0.12, 0.12, 0.1}},
                    .material = slippery,
                    .pose = SE3(Vec3{0.553, 0.553, 0.1}),
                    .velocity = {{}, {0.5, 0.3, 0}}};
    const BodyId box = add_dynamic(world, part);
    std::uint32_t moving = 0;
    for (int i = 0; i < 1500; ++i) {
      must(world.step(0.001));
      most[large] = std::max(most[large], world.counters().triangles);
      moving += world.counters().triangles > 0;
    }
    EXPECT_GT(moving, 10u);
    EXPECT_LT(norm(world.velocity(box).v), 1e-4);
    for (int i = 0; i < 100; ++i) {
      must(world.step(0.001));
      EXPECT_EQ(world.counters().narrow_phase_pairs, 0u);
      EXPECT_EQ(world.counters().triangles, 0u);
    }
  }
  EXPECT_EQ(most[0], most[1]);
  EXPECT_LT(most[0], 60u) << most[0];
}

TEST(SurfaceWorld, EventsAreOfThePairOfCollidersHoweverManyPlacesTouch) {
  // A ball in a valley touches two faces.
  MeshPoints valley;
  valley.vertices = {{-1, -2, 1}, {0, -2, 0}, {1, -2, 1}, {-1, 2, 1}, {0, 2, 0}, {1, 2, 1}};
  valley.triangles = {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}};
  for (const bool continuous : {false, true}) {
    World world;
    const BodyId ground = add_fixed(world, valley.made(), {});
    Part part{.shape = Sphere{0.2}, .pose = SE3(Vec3{0, 0, 0.2 * std::sqrt(2.0) + 0.1})};
    part.continuous = continuous;
    const BodyId ball = add_dynamic(world, part);
    std::vector<ContactEvent> events;
    const auto run = [&](int steps) {
      for (int i = 0; i < steps; ++i) {
        must(world.step(0.001));
        const auto now = world.contact_events();
        events.insert(events.end(), now.begin(), now.end());
      }
    };
    run(1000);
    ASSERT_GE(events.size(), 2u);
    EXPECT_EQ(events[0].kind, ContactEvent::Kind::begin);
    EXPECT_EQ(events[1].kind, ContactEvent::Kind::hit);
    EXPECT_EQ(events.size(), 2u) << continuous;
    // It fell by 0.1 m, at 45 degrees to each face. Each face takes half of the momentum along its
    // normal.
    const double speed = std::sqrt(2 * kFall * 0.1), mass = world.inertia(ball).mass();
    EXPECT_NEAR(events[1].approach_speed, speed / std::sqrt(2.0), 0.02) << continuous;
    // In the sub-stepped solver, the event reports the impulse of the last sub-step, not the sum.
    if (continuous) {
      EXPECT_NEAR(events[1].impulse, std::sqrt(2.0) * mass * speed, 0.01 * mass * speed);
    }
    EXPECT_NEAR(world.pose(ball).position().z, 0.2 * std::sqrt(2.0), 2e-4);
    events.clear();
    must(world.destroy_body(ground));
    run(2);
    ASSERT_EQ(events.size(), 1u);
    EXPECT_EQ(events[0].kind, ContactEvent::Kind::end);
  }
}

TEST(SurfaceWorld, SensorsAndFiltersKnowMeshes) {
  for (const bool continuous : {false, true}) {
    World world;
    add_fixed(world, flat_mesh(20, 4.0), {}, SE3(Vec3{0, 0, -1}));
    BodyDesc fixed;
    fixed.motion = Motion::fixed;
    const BodyId holder = must(world.create_body(fixed));
    ColliderDesc sheet;
    sheet.shape = flat_mesh(20, 4.0);
    sheet.sensor = true;
    must(world.add_collider(holder, sheet));
    sheet.sensor = false;  // and one that collides with nothing
    sheet.filter = {2, 2};
    must(world.add_collider(holder, sheet));
    Part part{.shape = Sphere{0.1}, .pose = SE3(Vec3{2, 2, 0.5})};
    part.continuous = continuous;
    const BodyId ball = add_dynamic(world, part);
    int begins = 0, ends = 0, touches = 0;
    for (int i = 0; i < 800; ++i) {
      must(world.step(0.001));
      for (const ContactEvent& e : world.contact_events()) {
        if (!e.sensor) {
          touches += e.kind == ContactEvent::Kind::begin;
          continue;
        }
        begins += e.kind == ContactEvent::Kind::begin;
        ends += e.kind == ContactEvent::Kind::end;
      }
    }
    EXPECT_EQ(begins, 1) << continuous;
    EXPECT_EQ(ends, 1) << continuous;
    EXPECT_EQ(touches, 1) << continuous;
    EXPECT_NEAR(world.pose(ball).position().z, -0.9, 2e-4) << continuous;
  }
}

TEST(SurfaceWorld, AMovingMeshCarriesWhatLiesOnIt) {
  World world;
  BodyDesc desc;
  desc.motion = Motion::kinematic;
  desc.velocity = {{}, {0.5, 0, 0.2}};
  const BodyId lift = must(world.create_body(desc));
  ColliderDesc collider;
  collider.shape = flat_mesh(20, 4.0);
  must(world.add_collider(lift, collider));
  Part part{.shape = Box{{0.2, 0.2, 0.2}}, .pose = SE3(Vec3{2, 2, 0.2})};
  part.velocity = {{}, {0.5, 0, 0.2}};
  const BodyId box = add_dynamic(world, part);
  for (int i = 0; i < 1000; ++i) must(world.step(0.001));
  EXPECT_LT(norm(world.pose(box).position() - Vec3{2.5, 2, 0.4}), 1e-3);
}

TEST(SurfaceWorld, LinksStandOnMeshesAsOnAHalfSpace) {
  for (const bool of_triangles : {false, true}) {
    World world;
    if (of_triangles) {
      add_fixed(world, flat_mesh(20, 4.0), {}, SE3(Vec3{-2, -2, 0}));
    } else {
      add_ground(world, {});
    }
    LinkSpec link;
    link.joint = FreeJoint{};
    link.inertia = solid_inertia(Box{{0.2, 0.2, 0.1}}, 1000.0);
    const ArticulationId crate = must(world.create_articulation({model_of({link})}));
    ColliderDesc collider;
    collider.shape = Box{{0.2, 0.2, 0.1}};
    must(world.add_collider(world.link_body(crate, 0), collider));
    std::vector<double> q(world.coordinates(crate).begin(), world.coordinates(crate).end());
    const std::vector<double> v(world.velocities(crate).size(), 0.0);
    const BodyId body = world.link_body(crate, 0);
    // A box on top of it, and so connected to it, is solved with it.
    const BodyId top =
        add_dynamic(world, {.shape = Box{{0.1, 0.1, 0.1}}, .pose = SE3(Vec3{0, 0, 0.35})});
    for (std::size_t k = 0; k < q.size(); ++k) {
      std::vector<double> moved = q;
      moved[k] += 0.12;
      if (world.set_joint_states(crate, moved, v) &&
          std::fabs(world.pose(body).position().z - 0.12) < 1e-9) {
        break;
      }
    }
    for (int i = 0; i < 1500; ++i) must(world.step(0.001));
    EXPECT_NEAR(world.pose(body).position().z, 0.1, 3e-4) << of_triangles;
    EXPECT_NEAR(world.pose(top).position().z, 0.3, 5e-4) << of_triangles;
    EXPECT_LT(norm(world.velocity(body).v), 1e-3) << of_triangles;
  }
}

TEST(SurfaceWorld, RefusesSurfacesOfWhatIsPushed) {
  World world;
  const BodyId body = add_dynamic(world, {});
  LinkSpec link;
  link.joint = FreeJoint{};
  link.inertia = Inertia(1.0, Vec3{1, 1, 1});
  const ArticulationId tree = must(world.create_articulation({model_of({link})}));
  for (const BodyId of : {body, world.link_body(tree, 0)}) {
    for (const Shape& shape : {Shape(flat_mesh(4, 1.0)), Shape(flat_field())}) {
      ColliderDesc desc;
      desc.shape = shape;
      const std::uint64_t before = world.state_hash();
      const auto refused = world.add_collider(of, desc);
      ASSERT_FALSE(refused);
      EXPECT_EQ(refused.error().code, Errc::unsupported);
      EXPECT_NE(refused.error().message.find("compound"), std::string::npos);
      EXPECT_EQ(world.state_hash(), before);
    }
  }
}

}  // namespace
}  // namespace vp::test
