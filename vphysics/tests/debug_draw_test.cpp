#include "vphysics/debug_draw.h"

#include <algorithm>
#include <limits>
#include <set>

#include "joints_rig.h"
#include "world/wires.h"

namespace vp {
namespace {

using test::add_dynamic;
using test::add_fixed;
using test::add_ground;
using test::must;

struct Line {
  Vec3 from, to;
  DebugCategory mark;
  bool operator==(const Line&) const = default;
};
struct Point {
  Vec3 at;
  DebugCategory mark;
  bool operator==(const Point&) const = default;
};

// Records what is drawn.
struct Kept : DebugDraw {
  std::vector<Line> lines;
  std::vector<Point> points;
  std::vector<ColliderId> shapes;
  bool draws_shapes = false;

  void line(const Vec3& from, const Vec3& to, DebugCategory mark) override {
    lines.push_back({from, to, mark});
  }
  void point(const Vec3& at, DebugCategory mark) override { points.push_back({at, mark}); }
  bool shape(ColliderId collider, const Shape&, const SE3&, DebugCategory) override {
    shapes.push_back(collider);
    return draws_shapes;
  }

  std::vector<Line> of(DebugCategory mark) const {
    std::vector<Line> found;
    std::copy_if(lines.begin(), lines.end(), std::back_inserter(found),
                 [&](const Line& line) { return line.mark == mark; });
    return found;
  }
  std::vector<Vec3> points_of(DebugCategory mark) const {
    std::vector<Vec3> found;
    for (const Point& point : points) {
      if (point.mark == mark) found.push_back(point.at);
    }
    return found;
  }
};

Kept drawn(const World& world, const DebugDrawOptions& options) {
  Kept kept;
  must(world.debug_draw(options, kept));
  return kept;
}
DebugDrawOptions nothing() {
  DebugDrawOptions options;
  options.shapes = false;
  return options;
}
DebugDrawOptions contacts() {
  DebugDrawOptions options = nothing();
  options.contacts = options.normals = options.impulses = true;
  return options;
}
void run(World& world, int steps, double dt = 0.001) {
  for (int i = 0; i < steps; ++i) must(world.step(dt));
}

struct Extent {
  Vec3 low{1e9, 1e9, 1e9}, high{-1e9, -1e9, -1e9};
};
Extent extent_of(const std::vector<Line>& lines) {
  Extent e;
  for (const Line& line : lines) {
    for (const Vec3& p : {line.from, line.to}) {
      for (int i = 0; i < 3; ++i) {
        e.low[i] = std::min(e.low[i], p[i]);
        e.high[i] = std::max(e.high[i], p[i]);
      }
    }
  }
  return e;
}

ConvexHull octahedron() {
  const std::vector<Vec3> points{{0.4, 0, 0},  {-0.4, 0, 0}, {0, 0.3, 0},
                                 {0, -0.3, 0}, {0, 0, 0.5},  {0, 0, -0.5}};
  return ConvexHull::of(points).value();
}

struct Known {
  const char* name;
  Shape shape;
  Vec3 low, high;  // of the shape's AABB in its own frame
};
std::vector<Known> known_shapes() {
  const std::vector<CompoundPart> parts{{Sphere{0.2}, SE3(Vec3{0.5, 0, 0})},
                                        {Box{{0.1, 0.2, 0.3}}, SE3(Vec3{-0.5, 0, 0})}};
  return {
      {"sphere", Sphere{0.3}, {-0.3, -0.3, -0.3}, {0.3, 0.3, 0.3}},
      {"box", Box{{0.1, 0.2, 0.3}}, {-0.1, -0.2, -0.3}, {0.1, 0.2, 0.3}},
      {"capsule", Capsule{0.2, 0.3}, {-0.2, -0.2, -0.5}, {0.2, 0.2, 0.5}},
      {"cylinder", Cylinder{0.2, 0.3}, {-0.2, -0.2, -0.3}, {0.2, 0.2, 0.3}},
      {"cone", Cone{0.2, 0.3}, {-0.2, -0.2, -0.3}, {0.2, 0.2, 0.3}},
      {"hull", octahedron(), {-0.4, -0.3, -0.5}, {0.4, 0.3, 0.5}},
      {"compound", Compound::of(parts).value(), {-0.6, -0.2, -0.3}, {0.7, 0.2, 0.3}},
  };
}

// A wireframe extends as far as its shape on every side, and no line of it leaves the shape. The
// ends of its lines are on the surface: a ray from outside, through an end towards the centre, hits
// the surface there.
TEST(DebugDraw, WiresLieOnTheSurfaceAndReachAsFarAsTheShape) {
  for (const Known& known : known_shapes()) {
    if (std::holds_alternative<Compound>(known.shape)) continue;  // see below
    World world;
    add_fixed(world, known.shape, {});
    const Kept kept = drawn(world, {});
    const Extent e = extent_of(kept.lines);
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(e.low[i], known.low[i], 1e-12) << known.name << " axis " << i;
      EXPECT_NEAR(e.high[i], known.high[i], 1e-12) << known.name << " axis " << i;
    }
    for (const Line& line : kept.lines) {
      const Vec3 p = line.from, out = (1.0 / norm(p)) * p;
      const auto hit = must(world.ray_cast(p + 5.0 * out, -out, 10.0));
      ASSERT_TRUE(hit) << known.name;
      EXPECT_NEAR(hit->distance, 5.0, 1e-6) << known.name;
      EXPECT_EQ(line.mark, DebugCategory::fixed_shape);
    }
  }
}

TEST(DebugDraw, WiresAreWhereTheirCollidersAre) {
  const SE3 pose(Exp(Vec3{0.3, -0.7, 1.1}).matrix(), {3, -2, 5});
  World world;
  const BodyId body = add_fixed(world, Box{{0.1, 0.2, 0.3}}, {}, pose);
  const Kept kept = drawn(world, {});
  ASSERT_EQ(kept.lines.size(), 12u);
  std::set<std::tuple<long, long, long>> corners;
  for (const Line& line : kept.lines) {
    for (const Vec3& p : {line.from, line.to}) {
      const Vec3 q = inverse_times(world.pose(body), p);
      EXPECT_NEAR(std::fabs(q.x), 0.1, 1e-12);
      EXPECT_NEAR(std::fabs(q.y), 0.2, 1e-12);
      EXPECT_NEAR(std::fabs(q.z), 0.3, 1e-12);
      corners.insert({std::lround(q.x * 10), std::lround(q.y * 10), std::lround(q.z * 10)});
    }
  }
  EXPECT_EQ(corners.size(), 8u);
}

TEST(DebugDraw, ACompoundIsItsPartsAndAHullHasEachEdgeOnce) {
  const std::vector<CompoundPart> parts{{Sphere{0.2}, SE3(Vec3{0.5, 0, 0})},
                                        {Box{{0.1, 0.2, 0.3}}, SE3(Vec3{-0.5, 0, 0})}};
  World apart, hull;
  for (const CompoundPart& part : parts) add_fixed(apart, part.shape, {}, part.T_compound_part);
  const std::size_t of_parts = drawn(apart, {}).lines.size();
  World world;
  BodyDesc desc;
  desc.motion = Motion::fixed;
  const BodyId body = must(world.create_body(desc));
  ColliderDesc collider;
  collider.shape = Compound::of(parts).value();
  if (world.add_collider(body, collider)) {
    EXPECT_EQ(drawn(world, {}).lines.size(), of_parts);
  }
  add_fixed(hull, octahedron(), {});
  EXPECT_EQ(drawn(hull, {}).lines.size(), 12u);
}

TEST(DebugDraw, SurfacesAreTheirTrianglesWithoutHoles) {
  const std::vector<Vec3> vertices{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const std::vector<TriangleMesh::Triangle> triangles{{0, 1, 2}, {0, 1, 3}};
  const Shape mesh = TriangleMesh::of(vertices, triangles).value().scaled({1, 2, 3}).value();
  Kept kept;
  draw_wire(mesh, SE3(Vec3{10, 0, 0}), 1.0, DebugCategory::fixed_shape, kept);
  EXPECT_EQ(kept.lines.size(), 6u);
  const Extent e = extent_of(kept.lines);
  EXPECT_EQ(e.low, (Vec3{10, 0, 0}));
  EXPECT_EQ(e.high, (Vec3{11, 2, 3}));

  const std::vector<double> heights{0, 1, 2, 3, 4, 5, 6, 7, 8};
  const std::vector<std::uint8_t> holes{0, 0, 0, 1};  // beyond the centre
  HeightGrid grid;
  grid.columns = grid.rows = 3;
  grid.heights = heights;
  grid.holes = holes;
  Kept field;
  draw_wire(HeightField::of(grid).value(), SE3(), 1.0, DebugCategory::fixed_shape, field);
  EXPECT_EQ(field.lines.size(), 3 * 5u);
  EXPECT_EQ(extent_of(field.lines).high, (Vec3{2, 2, 7}));
}

TEST(DebugDraw, ABoxAtRestHasFourContactsThatCarryItsWeight) {
  World world;
  add_ground(world, {.friction = 0.6});
  // 1000 kg
  const BodyId box = add_dynamic(
      world, {.shape = Box{{0.5, 0.5, 0.5}}, .material = {}, .pose = SE3(Vec3{2, 3, 0.5})});
  run(world, 300);
  const Kept kept = drawn(world, contacts());
  const auto points = kept.points_of(DebugCategory::contact);
  ASSERT_EQ(points.size(), 4u);
  for (const Vec3& p : points) {
    const Vec3 q = inverse_times(world.pose(box), p);
    EXPECT_NEAR(std::fabs(q.x), 0.5, 1e-3);
    EXPECT_NEAR(std::fabs(q.y), 0.5, 1e-3);
    EXPECT_NEAR(p.z, 0.0, 1e-3);
  }
  const DebugDrawOptions options;
  double sum = 0.0;
  for (const Line& line : kept.of(DebugCategory::impulse)) {
    sum += (line.to.z - line.from.z) / options.impulse_scale;
  }
  EXPECT_NEAR(sum, 1000.0 * 9.81 * 0.001, 0.1);  // 9.81 N s a step
  for (const Line& line : kept.of(DebugCategory::normal)) {
    EXPECT_NEAR(norm(line.to - line.from), options.normal_length, 1e-6);
    EXPECT_NEAR(line.to.z - line.from.z, options.normal_length, 1e-6);
  }
}

// Contacts are recomputed only when bodies move relative to each other. Their points move with the
// bodies all the same.
TEST(DebugDraw, ContactPointsGoWithBodiesThatTravelTogether) {
  World world;
  BodyDesc desc;
  desc.motion = Motion::kinematic;
  desc.velocity.v = {1.0, 0, 0};
  const BodyId belt = must(world.create_body(desc));
  ColliderDesc collider;
  collider.shape = Box{{1, 1, 0.1}};
  must(world.add_collider(belt, collider));
  const BodyId box = add_dynamic(world, {.shape = Box{{0.2, 0.2, 0.2}},
                                         .material = {},
                                         .pose = SE3(Vec3{0, 0, 0.3}),
                                         .velocity = {{}, {1.0, 0, 0}}});
  double farthest = 0.0;
  for (int step = 0; step < 700; ++step) {
    must(world.step(0.001));
    if (step < 100) continue;
    const auto points = drawn(world, contacts()).points_of(DebugCategory::contact);
    ASSERT_EQ(points.size(), 4u) << step;
    for (const Vec3& p : points) {
      const Vec3 q = inverse_times(world.pose(box), p);
      farthest = std::max({farthest, std::fabs(std::fabs(q.x) - 0.2),
                           std::fabs(std::fabs(q.y) - 0.2), std::fabs(q.z + 0.2)});
    }
  }
  EXPECT_GT(world.pose(box).position().x, 0.69);
  EXPECT_LT(farthest, 1e-3);  // measured 1e-6; 0.063 if points stayed where they were found
}

// Draws the contacts at the end of each stage.
struct ContactWatcher : StageObserver {
  const World* world = nullptr;
  double highest = 0.0;  // of all contact points [m]
  int points = 0;

  void begin(Stage) override {}
  void end(Stage) override {
    DebugDrawOptions options;
    options.contacts = true;
    for (const Vec3& p : drawn(*world, options).points_of(DebugCategory::contact)) {
      highest = std::max(highest, std::fabs(p.z));
      ++points;
    }
  }
};

// As the box slides, its displacement restarts now and then.
TEST(DebugDraw, AnObserverSeesContactsWhereTheyAre) {
  World world;
  test::Part box;
  box.shape = Box{{0.3, 0.2, 0.1}};
  box.pose = SE3(Vec3{0, 0, 0.1});
  box.velocity = {{}, {6, 0, 0}};
  box.material.friction = 0.0;
  add_dynamic(world, box);
  add_fixed(world, Box{{50, 50, 0.5}}, {}, SE3(Vec3{0, 0, -0.5}));
  const auto watcher = std::make_shared<ContactWatcher>();
  watcher->world = &world;
  world.observe_stages(watcher);
  for (int i = 0; i < 60; ++i) must(world.step(1.0 / 60));
  EXPECT_GT(watcher->points, 200);
  EXPECT_LT(watcher->highest, 1e-3);
}

TEST(DebugDraw, FrictionLeansAgainstTheSlope) {
  World world;
  const double slope = 0.3;
  add_ground(world, {.friction = 1.0}, {-std::sin(slope), 0, std::cos(slope)});
  const SE3 pose(Exp(Vec3{0, -slope, 0}).matrix(),
                 {-0.5 * std::sin(slope), 0, 0.5 * std::cos(slope)});
  add_dynamic(world, {.shape = Box{{0.5, 0.5, 0.5}}, .material = {.friction = 1.0}, .pose = pose});
  run(world, 500);
  DebugDrawOptions options = nothing();
  options.impulses = true;
  Vec3 sum;
  for (const DebugCategory mark : {DebugCategory::impulse, DebugCategory::friction}) {
    for (const Line& line : drawn(world, options).of(mark))
      sum += (1.0 / options.impulse_scale) * (line.to - line.from);
  }
  EXPECT_NEAR(sum.z, 9.81, 0.1);  // together they carry the weight
  EXPECT_NEAR(sum.x, 0.0, 0.1);
}

// Another solver handles a ball that rolls over the links of an articulation.
TEST(DebugDraw, AContinuousBallAtRestShowsItsOneContact) {
  World world;
  add_ground(world, {.friction = 0.5});
  add_dynamic(world, {.shape = Sphere{0.0175},
                      .material = {},
                      .density = 1000.0,
                      .pose = SE3(Vec3{0.2, 0.1, 0.0175}),
                      .velocity = {},
                      .continuous = true});
  run(world, 200);
  const Kept kept = drawn(world, contacts());
  ASSERT_EQ(kept.points_of(DebugCategory::contact).size(), 1u);
  EXPECT_NEAR(norm(kept.points_of(DebugCategory::contact)[0] - Vec3{0.2, 0.1, 0.0}), 0.0, 2e-4);
  const auto impulses = kept.of(DebugCategory::impulse);
  ASSERT_EQ(impulses.size(), 1u);
  const double mass = 1000.0 * 4.0 / 3.0 * kPi * 0.0175 * 0.0175 * 0.0175;
  EXPECT_NEAR((impulses[0].to.z - impulses[0].from.z) / DebugDrawOptions{}.impulse_scale,
              mass * 9.81 * 0.001, 1e-6);
}

TEST(DebugDraw, FramesCentresAndBoundsAreTheBodies) {
  World world;
  const SE3 pose(Exp(Vec3{0.1, 0.2, 0.3}).matrix(), {1, 2, 3});
  const Shape cone = Cone{0.2, 0.4};
  add_dynamic(world, {.shape = cone, .material = {}, .pose = pose});
  DebugDrawOptions options = nothing();
  options.frames = options.centres = options.bounds = true;
  options.frame_size = 0.5;
  const Kept kept = drawn(world, options);
  const Vec3* axes[] = {&pose.rotation().cx, &pose.rotation().cy, &pose.rotation().cz};
  const DebugCategory marks[] = {DebugCategory::axis_x, DebugCategory::axis_y,
                                 DebugCategory::axis_z};
  for (int i = 0; i < 3; ++i) {
    const auto lines = kept.of(marks[i]);
    ASSERT_EQ(lines.size(), 1u);
    EXPECT_EQ(lines[0].from, pose.position());
    EXPECT_NEAR(norm(lines[0].to - (pose.position() + 0.5 * *axes[i])), 0.0, 1e-12);
  }
  const auto centres = kept.points_of(DebugCategory::centre);
  ASSERT_EQ(centres.size(), 1u);
  EXPECT_NEAR(norm(centres[0] - pose * Vec3{0, 0, -0.2}), 0.0, 1e-12);
  // The AABB encloses the wireframe, which is as wide as the cone.
  const Extent bounds = extent_of(kept.of(DebugCategory::bounds));
  const Extent wire = extent_of(drawn(world, {}).lines);
  for (int i = 0; i < 3; ++i) {
    EXPECT_LE(bounds.low[i], wire.low[i] + 1e-12);
    EXPECT_GE(bounds.high[i], wire.high[i] - 1e-12);
    EXPECT_NEAR(bounds.low[i], wire.low[i], 0.02);
    EXPECT_NEAR(bounds.high[i], wire.high[i], 0.02);
  }
}

TEST(DebugDraw, JointsAreWhereTheyHold) {
  World world(test::weightless());
  const BodyId anchor = test::add_anchor(world, SE3(Vec3{0, 0, 2}));
  const BodyId mass = test::add_mass(world, Inertia(1.0, {0.1, 0.1, 0.1}), SE3(Vec3{0.5, 0, 2}));
  test::join(world, anchor, mass, Hinge{}, SE3(test::kAlongY, {0.1, 0, 2}));
  DebugDrawOptions options = nothing();
  options.joints = true;
  const Kept kept = drawn(world, options);
  for (const Vec3& p : kept.points_of(DebugCategory::joint)) {
    EXPECT_NEAR(norm(p - Vec3{0.1, 0, 2}), 0.0, 1e-12);
  }
  EXPECT_EQ(kept.points_of(DebugCategory::joint).size(), 2u);
  const auto axes = kept.of(DebugCategory::joint_axis);
  ASSERT_EQ(axes.size(), 1u);
  EXPECT_NEAR(norm(axes[0].to - axes[0].from - Vec3{0, 0.25, 0}), 0.0, 1e-12);
  const auto lines = kept.of(DebugCategory::joint);
  EXPECT_TRUE(std::any_of(lines.begin(), lines.end(), [](const Line& line) {
    return norm(line.to - Vec3{0.5, 0, 2}) < 1e-12;
  })) << "none leads to the mass";
}

TEST(DebugDraw, AnArticulationsJointsFollowItsCoordinates) {
  LinkSpec upper;
  upper.joint = RevoluteJoint{{0, 1, 0}};
  upper.inertia = Inertia(1.0, {0.1, 0.1, 0.1});
  LinkSpec lower = upper;
  lower.parent = 0;
  lower.T_parent_joint = SE3(Vec3{0, 0, -1});
  World world;
  const ArticulationId arm = must(world.create_articulation({test::model_of({upper, lower})}));
  must(world.set_joint_state(arm, 0, 0, 0.5 * kPi, 0.0));
  DebugDrawOptions options = nothing();
  options.joints = true;
  const Kept kept = drawn(world, options);
  const auto points = kept.points_of(DebugCategory::joint);
  ASSERT_EQ(points.size(), 2u);
  EXPECT_NEAR(norm(points[0]), 0.0, 1e-12);
  EXPECT_NEAR(norm(points[1] - Vec3{-1, 0, 0}), 0.0, 1e-12);
  EXPECT_EQ(kept.of(DebugCategory::joint_axis).size(), 2u);
}

TEST(DebugDraw, WhoDrawsAShapeGetsNoWireOfIt) {
  World world;
  add_ground(world, {});
  add_fixed(world, Sphere{0.1}, {});
  Kept kept;
  kept.draws_shapes = true;
  must(world.debug_draw({}, kept));
  EXPECT_EQ(kept.shapes.size(), 2u);
  EXPECT_TRUE(kept.lines.empty());
}

TEST(DebugDraw, TellsTheSameTwiceAndChangesNothing) {
  World world;
  add_ground(world, {.friction = 0.6});
  for (int i = 0; i < 5; ++i) {
    add_dynamic(world, {.shape = Box{{0.5, 0.5, 0.5}},
                        .material = {},
                        .pose = SE3(Vec3{0.1 * i, 0, 0.5 + 1.05 * i})});
  }
  run(world, 300);
  const std::uint64_t hash = world.state_hash();
  DebugDrawOptions options = contacts();
  options.shapes = options.bounds = options.frames = options.centres = true;
  const Kept first = drawn(world, options), second = drawn(world, options);
  EXPECT_GT(first.lines.size(), 100u);
  EXPECT_EQ(first.lines, second.lines);
  EXPECT_EQ(first.points, second.points);
  EXPECT_EQ(world.state_hash(), hash);
}

TEST(DebugDraw, NoImpulsesAreKnownAfterARestore) {
  World world;
  add_ground(world, {});
  add_dynamic(world, {.shape = Box{{0.5, 0.5, 0.5}}, .material = {}, .pose = SE3(Vec3{0, 0, 0.5})});
  run(world, 100);
  std::vector<std::byte> bytes;
  world.snapshot(bytes);
  must(world.restore(bytes));
  const Kept restored = drawn(world, contacts());
  EXPECT_EQ(restored.points_of(DebugCategory::contact).size(), 4u);
  EXPECT_TRUE(restored.of(DebugCategory::impulse).empty());
  run(world, 1);
  EXPECT_EQ(drawn(world, contacts()).of(DebugCategory::impulse).size(), 4u);
}

TEST(DebugDraw, SizesThatAreNoneAreRefusedAndNothingIsDrawn) {
  World world;
  add_ground(world, {});
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  for (const double bad : {0.0, -1.0, 2e6, kNan, kInfinite}) {
    for (double DebugDrawOptions::*size :
         {&DebugDrawOptions::frame_size, &DebugDrawOptions::normal_length,
          &DebugDrawOptions::impulse_scale, &DebugDrawOptions::half_space_size}) {
      DebugDrawOptions options;
      options.*size = bad;
      Kept kept;
      const auto result = world.debug_draw(options, kept);
      ASSERT_FALSE(result) << bad;
      EXPECT_EQ(result.error().code, Errc::invalid_argument);
      EXPECT_TRUE(kept.lines.empty());
    }
  }
}

TEST(DebugDraw, UsualColoursTellTheMarksApart) {
  std::set<std::uint32_t> colours;
  for (int mark = 0; mark < kDebugCategories; ++mark) {
    colours.insert(default_colour(static_cast<DebugCategory>(mark)));
  }
  EXPECT_EQ(colours.size(), static_cast<std::size_t>(kDebugCategories));
  EXPECT_EQ(static_cast<int>(DebugCategory::joint_axis), kDebugCategories - 1);
}

}  // namespace
}  // namespace vp
