// World queries against brute force over all colliders, after all kinds of changes to the world.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <memory>

#include "collide/ray.h"
#include "collide/shape_query.h"
#include "rig.h"
#include "shape_truth.h"
#include "surfaces.h"

namespace vp::test {
namespace {

// A world of random shapes, and the expected data of its colliders.
struct Known {
  ColliderId id;
  BodyId body;
  Shape shape;
  SE3 T_body_shape;
  bool sensor = false;
  CollisionFilter filter;
};
struct Scene {
  World world{{.gravity = {0, 0, -9.81}}};
  std::vector<Known> colliders;  // in order of creation

  SE3 pose(const Known& k) const { return world.pose(k.body) * k.T_body_shape; }
  const Known& of(ColliderId id) const {
    return *std::find_if(colliders.begin(), colliders.end(),
                         [&](const Known& k) { return k.id == id; });
  }
};

void add(Scene& scene, BodyId body, const Shape& shape, const SE3& T, Random& random) {
  ColliderDesc desc;
  desc.shape = shape;
  desc.T_body_shape = T;
  desc.sensor = random.word() % 8 == 0;
  desc.filter.category = 1u << random.word() % 3;
  desc.user_data = scene.colliders.size() + 1000;
  const ColliderId id = must(scene.world.add_collider(body, desc));
  scene.colliders.push_back({id, body, shape, T, desc.sensor, desc.filter});
}

BodyId fixed_body(World& world, const SE3& T) {
  BodyDesc desc;
  desc.motion = Motion::fixed;
  desc.T_world_body = T;
  return must(world.create_body(desc));
}

// Shapes with parts: a bumpy mesh or height field for fixed bodies, a compound for others.
Shape random_parted(Random& random, bool fixed) {
  if (!fixed) {
    std::vector<CompoundPart> parts;
    for (int i = 0; i < 4; ++i) {
      parts.push_back({random_solid(random, kBounded[random.word() % 6]).shape, random.pose(0.8)});
    }
    return Compound::of(parts).value();
  }
  if (random.word() % 2 == 0) {
    MeshPoints points = sphere_mesh(1.0, 1);
    for (Vec3& v : points.vertices) v = random.uniform(0.7, 1.2) * v;
    return points.made({random.word() % 2 == 0, false});
  }
  std::vector<double> heights(49);
  for (double& h : heights) h = random.uniform(-0.3, 0.3);
  HeightGrid grid;
  grid.columns = grid.rows = 7;
  grid.spacing_x = grid.spacing_y = 0.5;
  grid.heights = heights;
  return HeightField::of(grid).value();
}

Scene random_scene(Random& random, int bodies, double size) {
  Scene scene;
  for (int i = 0; i < bodies; ++i) {
    BodyDesc desc;
    desc.motion = i % 3 == 0 ? Motion::fixed : i % 3 == 1 ? Motion::kinematic : Motion::dynamic;
    desc.T_world_body = random.pose(size);
    desc.inertia = Inertia(1.0, Vec3{1, 1, 1});
    desc.velocity = {5.0 * random.direction(), 10.0 * random.direction()};
    const BodyId body = must(scene.world.create_body(desc));
    const int parts = 1 + static_cast<int>(random.word() % 2);
    if (i % 5 == 0) {
      add(scene, body, random_parted(random, i % 3 == 0), random.pose(0.5), random);
    }
    for (int k = 0; k < parts; ++k) {
      add(scene, body, random_solid(random, kBounded[random.word() % 6]).shape, random.pose(0.5),
          random);
    }
  }
  add(scene, fixed_body(scene.world, SE3{}), HalfSpace{}, SE3(Vec3{0, 0, -size}), random);
  return scene;
}

// The collider with the smallest value, the older one of equals. f returns nothing for colliders
// that do not count.
struct Least {
  const Known* collider = nullptr;
  double value = kInfinity;
};
Least least_of(const Scene& scene, const std::function<bool(const Known&)>& accepts,
               const std::function<std::optional<double>(const Geometry&, const SE3&)>& f) {
  Least best;
  for (const Known& k : scene.colliders) {
    if (!accepts(k)) continue;
    const auto value = f(collide::make_geometry(k.shape), scene.pose(k));
    if (value && *value < best.value) best = {&k, *value};
  }
  return best;
}
bool is_solid(const Known& k) {
  return !k.sensor;
}

struct AskedRay {
  Vec3 origin, direction;
  double reach;
};
AskedRay random_ray(Random& random, double size) {
  return {random.in_cube(1.5 * size), random.uniform(0.1, 7.0) * random.direction(),
          random.uniform(0.1, 4.0) * size};
}
std::optional<double> entry_of(const AskedRay& r, const Geometry& g, const SE3& T) {
  collide::CastScratch scratch;
  collide::RayEntry entry{};
  const Vec3 unit = (1.0 / norm(r.direction)) * r.direction;
  if (!cast_ray(g, {inverse_times(T, r.origin), T.unrotate(unit)}, r.reach, scratch, entry)) {
    return std::nullopt;
  }
  return entry.distance;
}
std::optional<double> fraction_of(const Geometry& shape, const SE3& T, const CastMotion& m,
                                  const Geometry& g, const SE3& T_g) {
  collide::PartsScratch scratch;
  collide::PartsImpact found{};
  const double sizes = core_extent(shape) + (is_convex_body(g) ? core_extent(g) : 0.0);
  const collide::ImpactQuery q{{&shape, T, {T.position(), m.translation, m.rotation}},
                               {&g, T_g, {T_g.position(), {}, {}}},
                               1.0,
                               1e-9 + 1e-12 * sizes};
  if (!first_impact(q, 0.0, scratch, found)) return std::nullopt;
  return found.time;
}

// Each kind of query once, against brute force over all colliders.
void expect_as_linear_scan(const Scene& scene, Random& random, double size, int rounds,
                           std::array<int, 4>& found) {
  std::vector<RayHit> rays;
  std::vector<ShapeHit> casts;
  std::vector<ColliderId> touched;
  for (int i = 0; i < rounds; ++i) {
    const AskedRay r = random_ray(random, size);
    const auto hit = must(scene.world.ray_cast(r.origin, r.direction, r.reach));
    const auto along = [&](const Geometry& g, const SE3& T) { return entry_of(r, g, T); };
    const Least first = least_of(scene, is_solid, along);
    ASSERT_EQ(hit.has_value(), first.collider != nullptr);
    if (hit) {
      ++found[0];
      EXPECT_EQ(hit->collider, first.collider->id);
      EXPECT_EQ(hit->body, first.collider->body);
      EXPECT_NEAR(hit->distance, first.value, 1e-12);
    }
    rays.clear();
    must(scene.world.ray_cast_all(r.origin, r.direction, r.reach, rays));
    std::size_t all = 0;
    for (const Known& k : scene.colliders) {
      all += !k.sensor && along(collide::make_geometry(k.shape), scene.pose(k)) ? 1 : 0;
    }
    EXPECT_EQ(rays.size(), all);
    for (std::size_t k = 1; k < rays.size(); ++k) {
      EXPECT_LE(rays[k - 1].distance, rays[k].distance);
    }

    const Solid solid = random_solid(random, kBounded[i % 6]);
    const SE3 T = random.pose(size);
    const CastMotion m{random.uniform(0, 1.5) * size * random.direction(),
                       random.uniform(0, 3) * random.direction()};
    const auto cast = must(scene.world.shape_cast(solid.shape, T, m));
    const SE3 proper(orthonormalized(T.rotation()), T.position());
    const auto by = [&](const Geometry& g, const SE3& T_g) {
      return fraction_of(solid.geometry, proper, m, g, T_g);
    };
    const Least meets = least_of(scene, is_solid, by);
    ASSERT_EQ(cast.has_value(), meets.collider != nullptr);
    if (cast) {
      ++found[1];
      EXPECT_NEAR(cast->fraction, meets.value, 1e-9);
      // Of colliders that overlap at the start, the oldest is reported.
      EXPECT_EQ(cast->collider, meets.collider->id);
    }
    casts.clear();
    must(scene.world.shape_cast_all(solid.shape, T, m, casts));
    all = 0;
    for (const Known& k : scene.colliders) {
      all += !k.sensor && by(collide::make_geometry(k.shape), scene.pose(k)) ? 1 : 0;
    }
    EXPECT_EQ(casts.size(), all);

    touched.clear();
    must(scene.world.overlapping(solid.shape, T, touched));
    std::vector<ColliderId> expected;
    for (const Known& k : scene.colliders) {
      collide::PartsScratch scratch;
      if (!k.sensor && parts_touch(solid.geometry, proper, collide::make_geometry(k.shape),
                                   scene.pose(k), scratch)) {
        expected.push_back(k.id);
      }
    }
    EXPECT_EQ(touched, expected);
    found[2] += static_cast<int>(expected.size());

    const double reach = random.uniform(0.1, 1.0) * size;
    const auto near = must(scene.world.nearest(solid.shape, T, reach));
    const Least nearest = least_of(scene, is_solid, [&](const Geometry& g, const SE3& T_g) {
      collide::PartsScratch scratch;
      collide::NearestParts parts;
      nearest_parts(solid.geometry, proper, g, T_g, 1e9, scratch, parts);
      return parts.points.distance;
    });
    ASSERT_EQ(near.has_value(), nearest.value <= reach);
    if (near) {
      ++found[3];
      EXPECT_EQ(near->collider, nearest.collider->id);
      EXPECT_NEAR(near->distance, nearest.value, 1e-9);
      EXPECT_NEAR(norm(near->on_shape - near->on_collider), std::fabs(near->distance), 1e-9);
    }
  }
}

TEST(Queries, AnswerAsALinearScanWhateverHasHappened) {
  Random random(701);
  std::array<int, 4> found{};
  Scene scene = random_scene(random, 90, 6.0);
  const auto ask = [&] { expect_as_linear_scan(scene, random, 6.0, 12, found); };
  ask();
  for (int i = 0; i < 20; ++i) must(scene.world.step(0.004));
  ask();
  std::vector<std::byte> bytes;
  scene.world.snapshot(bytes);
  // Moved without a step, out of the AABBs that the broad phase has.
  for (std::size_t i = 0; i < scene.colliders.size(); i += 5) {
    if (i + 1 < scene.colliders.size()) {
      must(scene.world.set_pose(scene.colliders[i].body, random.pose(6.0)));
    }
  }
  ask();
  must(scene.world.step(0.004));
  ask();
  must(scene.world.restore(bytes));
  ask();
  for (int k = 0; k < 15; ++k) {
    const BodyId gone = scene.colliders[3 * static_cast<std::size_t>(k)].body;
    must(scene.world.destroy_body(gone));
    std::erase_if(scene.colliders, [&](const Known& c) { return c.body == gone; });
  }
  ask();
  for (int k = 0; k < 15; ++k) {
    const BodyId body = fixed_body(scene.world, random.pose(6.0));
    add(scene, body, Sphere{random.uniform(0.1, 0.5)}, SE3{}, random);
  }
  ask();
  for (const int count : found) EXPECT_GE(count, 20);
}

TEST(Queries, ChangeNeitherTheHashNorWhatComes) {
  Random random(702);
  Scene asked = random_scene(random, 60, 4.0);
  Random again(702);
  Scene quiet = random_scene(again, 60, 4.0);
  std::array<int, 4> found{};
  for (int i = 0; i < 20; ++i) {
    const std::uint64_t before = asked.world.state_hash();
    expect_as_linear_scan(asked, random, 4.0, 1, found);
    ASSERT_EQ(asked.world.state_hash(), before);
    must(asked.world.step(0.004));
    must(quiet.world.step(0.004));
    ASSERT_EQ(asked.world.state_hash(), quiet.world.state_hash()) << i;
  }
}

// Bit for bit, though the trees of a restored world have another shape.
TEST(Queries, AnswerTheSameBitsAfterRestore) {
  Random random(703);
  Scene scene = random_scene(random, 80, 5.0);
  for (int i = 0; i < 30; ++i) must(scene.world.step(0.004));
  std::vector<std::byte> bytes;
  scene.world.snapshot(bytes);
  Random same(703);
  Scene other = random_scene(same, 80, 5.0);
  must(other.world.restore(bytes));
  const Shape shape = Box{{0.2, 0.4, 0.3}};
  int hits = 0;
  for (int i = 0; i < 200; ++i) {
    const AskedRay r = random_ray(random, 5.0);
    const SE3 T = random.pose(5.0);
    const CastMotion m{random.in_cube(4.0), random.in_cube(1.0)};
    const auto a = must(scene.world.ray_cast(r.origin, r.direction, r.reach)),
               b = must(other.world.ray_cast(r.origin, r.direction, r.reach));
    const auto c = must(scene.world.shape_cast(shape, T, m)),
               d = must(other.world.shape_cast(shape, T, m));
    const auto e = must(scene.world.nearest(shape, T, 9.0)),
               f = must(other.world.nearest(shape, T, 9.0));
    ASSERT_EQ(a.has_value(), b.has_value());
    ASSERT_EQ(c.has_value(), d.has_value());
    if (a) {
      EXPECT_EQ(a->distance, b->distance);
      EXPECT_EQ(a->collider, b->collider);
      EXPECT_EQ(a->normal, b->normal);
    }
    if (c) {
      ++hits;
      EXPECT_EQ(c->fraction, d->fraction);
      EXPECT_EQ(c->point, d->point);
    }
    EXPECT_EQ(e->distance, f->distance);
    EXPECT_EQ(e->on_collider, f->on_collider);
  }
  EXPECT_GE(hits, 50);
}

TEST(Queries, FindInAStatedOrder) {
  World world;
  const BodyId gone = add_fixed(world, Sphere{1}, {});
  add_fixed(world, Sphere{1}, {}, SE3(Vec3{1, 0, 0}));
  must(world.destroy_body(gone));
  // One reuses the free slot but is younger; another is in the same place.
  add_fixed(world, Sphere{1}, {}, SE3(Vec3{-1, 0, 0}));
  add_fixed(world, Sphere{1}, {}, SE3(Vec3{-1, 0, 0}));
  add_fixed(world, Sphere{1}, {}, SE3(Vec3{9, 0, 0}));
  std::vector<ColliderId> found;
  must(world.overlapping(Sphere{0.5}, SE3{}, found));
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].index, 2u);
  EXPECT_EQ(found[1].index, 1u);
  EXPECT_EQ(found[2].index, 3u);
  std::vector<RayHit> hits;
  must(world.ray_cast_all({-5, 0, 0}, {1, 0, 0}, 20, hits));
  ASSERT_EQ(hits.size(), 4u);
  EXPECT_EQ(hits[0].collider.index, 1u);  // the older of two in one place
  EXPECT_EQ(hits[1].collider.index, 3u);
  EXPECT_EQ(hits[2].collider.index, 2u);
  EXPECT_EQ(hits[3].collider.index, 4u);
  EXPECT_EQ(must(world.ray_cast({-5, 0, 0}, {1, 0, 0}, 20))->collider.index, 1u);
  EXPECT_EQ(
      must(world.shape_cast(Sphere{0.5}, SE3(Vec3{-5, 0, 0}), {{9, 0, 0}, {}}))->collider.index,
      1u);
  EXPECT_EQ(must(world.nearest(Vec3{-5, 0, 0}, 20))->collider.index, 1u);
  // Results are appended.
  must(world.overlapping(Sphere{0.5}, SE3{}, found));
  EXPECT_EQ(found.size(), 6u);
}

TEST(Queries, AreRightInClosedForm) {
  World world;
  add_fixed(world, Box{{1, 1, 1}}, {}, SE3(Vec3{5, 0, 0}));
  const auto hit = must(world.ray_cast({0, 0.5, 0}, {2, 0, 0}, 10.0));
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->distance, 4.0, 1e-12);
  EXPECT_NEAR(norm(hit->point - Vec3{4, 0.5, 0}), 0.0, 1e-12);
  EXPECT_NEAR(hit->normal.x, -1.0, 1e-12);
  EXPECT_FALSE(must(world.ray_cast({0, 0, 0}, {1, 0, 0}, 3.999)));
  EXPECT_FALSE(must(world.ray_cast({0, 0, 0}, {-1, 0, 0}, 10)));
  EXPECT_FALSE(must(world.ray_cast({0, 0, 0}, {1, 0, 0}, 0.0)));
  EXPECT_EQ(must(world.ray_cast({5, 0, 0.9}, {1, 0, 0}, 0.0))->distance, 0.0);
  EXPECT_NEAR(must(world.ray_cast({5, 0, 0.9}, {1, 0, 0}, 0.0))->normal.z, 1.0, 1e-12);

  const auto cast = must(world.shape_cast(Sphere{0.5}, SE3{}, {{7, 0, 0}, {}}));
  ASSERT_TRUE(cast);
  EXPECT_NEAR(cast->fraction, 0.5, 1e-9);
  EXPECT_NEAR(cast->separation, 0.0, 1.1e-9);
  EXPECT_NEAR(norm(cast->point - Vec3{4, 0, 0}), 0.0, 1e-8);
  EXPECT_NEAR(cast->normal.x, -1.0, 1e-12);
  EXPECT_FALSE(must(world.shape_cast(Sphere{0.5}, SE3{}, {{3.4, 0, 0}, {}})));
  const auto inside = must(world.shape_cast(Sphere{0.5}, SE3(Vec3{3.8, 0, 0}), {{1, 0, 0}, {}}));
  EXPECT_EQ(inside->fraction, 0.0);
  EXPECT_NEAR(inside->separation, -0.3, 1e-12);
  // Without a displacement, the cast tests the pose itself.
  EXPECT_FALSE(must(world.shape_cast(Sphere{0.5}, SE3{}, {})));

  // A rod along y, 4.2 m long, rotates about z, 4 m beside the box's centre. Its tip hits the near
  // face where 2.1 cos(angle) + 0.1 = 2, 2 m from the rod's centre.
  const auto swung = must(world.shape_cast(
      Capsule{0.1, 2.0}, SE3(Exp(Vec3{-kPi / 2, 0, 0}), {2, 0, 0}), {{}, {0, 0, -kPi / 2}}));
  ASSERT_TRUE(swung);
  EXPECT_NEAR(2.0 * std::sin(swung->fraction * kPi / 2) + 0.1, 2.0, 1e-6);

  const auto near = must(world.nearest(Vec3{0, 0, 0}, 10.0));
  EXPECT_NEAR(near->distance, 4.0, 1e-12);
  EXPECT_NEAR(norm(near->on_collider - Vec3{4, 0, 0}), 0.0, 1e-12);
  EXPECT_FALSE(must(world.nearest(Vec3{0, 0, 0}, 3.9)));
  EXPECT_NEAR(must(world.nearest(Vec3{5, 0, 0.75}, 0.0))->distance, -0.25, 1e-12);
}

TEST(Queries, FarFromTheOriginAreAsGood) {
  Random random(704);
  for (int i = 0; i < 50; ++i) {
    const Solid target = random_solid(random, kBounded[i % 6]),
                asker = random_solid(random, kBounded[i / 6 % 6]);
    const SE3 Tt = random.pose(0.2), Ta(random.rotation(), Vec3{4, 0, 0});
    const auto ask = [&](const Vec3& origin) {
      World world;
      add_fixed(world, target.shape, {}, SE3(Tt.rotation(), origin + Tt.position()));
      const auto ray = must(world.ray_cast(origin + Vec3{4, 0, 0}, {-1, 0, 0}, 10));
      const auto cast = must(world.shape_cast(
          asker.shape, SE3(Ta.rotation(), origin + Ta.position()), {{-4, 0, 0}, {0.3, 1, 0}}));
      const auto near =
          must(world.nearest(asker.shape, SE3(Ta.rotation(), origin + Ta.position()), 10));
      return std::array<double, 3>{ray ? ray->distance : -1.0, cast ? cast->fraction : -1.0,
                                   near->distance};
    };
    const auto here = ask({}), there = ask({1048576.0, -2097152.0, 524288.0});
    // Positions there have a spacing of 2.4e-10 m.
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(here[k], there[k], 1e-8) << k;
  }
}

TEST(QueryFilter, TellsWhatIsFound) {
  World world;
  const auto add_box = [&](double x, bool sensor, CollisionFilter filter, std::uint64_t user) {
    const BodyId body = fixed_body(world, SE3(Vec3{x, 0, 0}));
    ColliderDesc desc;
    desc.shape = Box{{0.5, 0.5, 0.5}};
    desc.sensor = sensor;
    desc.filter = filter;
    desc.user_data = user;
    must(world.add_collider(body, desc));
    return body;
  };
  const BodyId sensor = add_box(2, true, {}, 10);
  const BodyId two = add_box(4, false, {2, ~0u}, 11);
  const BodyId shy = add_box(6, false, {1, 4}, 12);  // collides with category 4 only
  const BodyId plain = add_box(8, false, {}, 13);
  const auto first = [&](const QueryFilter& filter) {
    const auto hit = must(world.ray_cast({0, 0, 0}, {1, 0, 0}, 100, filter));
    const auto cast = must(world.shape_cast(Sphere{0.1}, SE3{}, {{100, 0, 0}, {}}, filter));
    const auto near = must(world.nearest(Vec3{0, 0, 0}, 100, filter));
    std::vector<ColliderId> touched;
    must(world.overlapping(Box{{100, 1, 1}}, SE3{}, touched, filter));
    std::vector<RayHit> all;
    must(world.ray_cast_all({0, 0, 0}, {1, 0, 0}, 100, all, filter));
    EXPECT_EQ(all.size(), touched.size());
    if (!hit) {
      EXPECT_FALSE(cast);
      EXPECT_FALSE(near);
      EXPECT_TRUE(touched.empty());
      return BodyId{};
    }
    EXPECT_EQ(cast->body, hit->body);
    EXPECT_EQ(near->body, hit->body);
    EXPECT_EQ(touched.front(), hit->collider);
    EXPECT_GE(hit->user_data, 10u);
    return hit->body;
  };
  EXPECT_EQ(first({}), two);
  EXPECT_EQ(first({.sensors = true}), sensor);
  EXPECT_EQ(first({.collision = {1, 1}}), plain);
  EXPECT_EQ(first({.collision = {4, 1}}), shy);
  EXPECT_EQ(first({.collision = {1, 0}}), BodyId{});
  const BodyId both[] = {two, plain};
  EXPECT_EQ(first({.ignored = both}), BodyId{});
  EXPECT_EQ(first({.sensors = true, .ignored = both}), sensor);
  EXPECT_EQ(first({.accepts = [](ColliderId, BodyId, std::uint64_t user) { return user == 13; }}),
            plain);
  EXPECT_EQ(first({.accepts = [&](ColliderId, BodyId body, std::uint64_t) { return body != two; }}),
            plain);
}

template <class T>
void expect_refused(const Expected<T>& result, Errc code = Errc::invalid_argument) {
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().code, code);
  EXPECT_GT(result.error().message.size(), 30u);
}

// An observer may ask during a step; what moves after that is found where it ends.
TEST(Queries, AskedWithinAStepDoNotSpoilLaterOnes) {
  struct Asks final : StageObserver {
    explicit Asks(const World& of) : world(of) {}
    void begin(Stage) override { (void)world.nearest(Vec3{}, 100.0); }
    void end(Stage) override {}
    const World& world;
  };
  for (const bool continuous : {false, true}) {
    World world;
    BodyDesc desc;
    desc.motion = Motion::dynamic;
    desc.continuous = continuous;
    desc.velocity = {{}, {10, 0, 0}};
    const BodyId ball = must(world.create_body(desc));
    ColliderDesc sphere;
    sphere.shape = Sphere{0.1};
    must(world.add_collider(ball, sphere));
    world.observe_stages(std::make_shared<Asks>(world));
    must(world.step(0.1));
    const Vec3 at = world.pose(ball).position();
    EXPECT_NEAR(at.x, 1.0, 1e-9);
    const auto hit = must(world.ray_cast(at - Vec3{0, 5, 0}, {0, 1, 0}, 10.0));
    ASSERT_TRUE(hit) << continuous;
    EXPECT_NEAR(hit->distance, 4.9, 1e-9);
  }
}

TEST(Queries, RefuseWhatIsNoQuestion) {
  World world;
  add_fixed(world, Sphere{1}, {});
  std::vector<RayHit> rays;
  std::vector<ShapeHit> casts;
  std::vector<ColliderId> found;
  for (const double bad : {kNaN, kInfinity, -kInfinity, 2e9}) {
    expect_refused(world.ray_cast({bad, 0, 0}, {1, 0, 0}, 1));
    expect_refused(world.ray_cast({0, 0, 0}, {1, bad, 0}, 1));
    expect_refused(world.ray_cast({0, 0, 0}, {1, 0, 0}, bad));
    expect_refused(world.ray_cast_all({0, 0, bad}, {1, 0, 0}, 1, rays));
    expect_refused(world.shape_cast(Sphere{bad}, SE3{}, {{1, 0, 0}, {}}));
    expect_refused(world.shape_cast(Sphere{1}, SE3(Vec3{0, bad, 0}), {{1, 0, 0}, {}}));
    expect_refused(world.shape_cast(Sphere{1}, SE3{}, {{1, 0, bad}, {}}));
    expect_refused(world.shape_cast(Sphere{1}, SE3{}, {{1, 0, 0}, {bad, 0, 0}}));
    expect_refused(world.shape_cast_all(Sphere{1}, SE3{}, {{1, 0, bad}, {}}, casts));
    expect_refused(world.overlapping(Box{{1, bad, 1}}, SE3{}, found));
    expect_refused(world.overlapping(Sphere{1}, SE3(Vec3{bad, 0, 0}), found));
    expect_refused(world.nearest(Sphere{1}, SE3(Vec3{bad, 0, 0}), 1));
    expect_refused(world.nearest(Sphere{1}, SE3{}, bad));
    expect_refused(world.nearest(Vec3{0, bad, 0}, 1));
    expect_refused(world.nearest(Vec3{}, bad));
  }
  expect_refused(world.ray_cast({}, {0, 0, 0}, 1));
  expect_refused(world.ray_cast({}, {1, 0, 0}, -1e-9));
  expect_refused(world.nearest(Vec3{}, -1.0));
  expect_refused(world.shape_cast(Sphere{0}, SE3{}, {{1, 0, 0}, {}}));
  expect_refused(world.shape_cast(Sphere{-1}, SE3{}, {{1, 0, 0}, {}}));
  expect_refused(world.shape_cast(Sphere{1}, SE3{}, {{1, 0, 0}, {0, 0, 7}}));
  expect_refused(world.shape_cast(Sphere{1}, SE3({{2, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}), {}));
  Random random(705);
  for (const Shape& shape : {Shape{HalfSpace{}}, Shape{sphere_mesh(1.0, 0).made()}}) {
    expect_refused(world.shape_cast(shape, SE3{}, {{1, 0, 0}, {}}), Errc::unsupported);
  }
  EXPECT_TRUE(world.nearest(random_parted(random, false), SE3{}, 1));
  expect_refused(world.overlapping(HalfSpace{}, SE3{}, found), Errc::unsupported);
  expect_refused(world.nearest(HalfSpace{}, SE3{}, 1), Errc::unsupported);
  EXPECT_TRUE(rays.empty() && casts.empty() && found.empty());
}

}  // namespace
}  // namespace vp::test
