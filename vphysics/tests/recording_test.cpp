// Recording and replaying a world's calls.
#include "vphysics/recording.h"

#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <vector>

#include "random.h"
#include "rig.h"

namespace vp::test {
namespace {

// Holds the sum of two bodies' heights.
class Balance : public PairConstraint {
 public:
  explicit Balance(double sum) : sum_(sum) {}
  int rows() const override { return 1; }
  void evaluate(const SE3& a, const SE3& b, std::span<double> residual,
                std::span<PairRow> jacobian) const override {
    residual[0] = a.position().z + b.position().z - sum_;
    jacobian[0].a = dse3{{}, a.unrotate({0, 0, 1})};
    jacobian[0].b = dse3{{}, b.unrotate({0, 0, 1})};
  }
  std::vector<double> constants() const override { return {sum_}; }

 private:
  double sum_;
};

std::vector<Vec3> wedge(double size) {
  return {{-size, -size, -size}, {size, -size, -size}, {0, size, -size}, {0, 0, size}};
}
Shape hull_of(double size) {
  return must(ConvexHull::of(wedge(size)));
}

// Several kinds of body and joint: boxes on a floor, a rod, a hinged pair, a six-degree pair, two
// bodies in balance.
struct Yard {
  World world;
  std::vector<BodyId> boxes;
  ArticulationId rod, hanging;
  JointId hinge, six;
};
ArticulationDesc hanging_desc() {
  LinkSpec ball;
  ball.joint = BallJoint{};
  ball.inertia = Inertia(1.0, Vec3{0.1, 0.1, 0.1}).InvXform(SE3(Vec3{0, 0, -0.2}));
  ball.T_parent_joint = SE3(Vec3{3, 3, 1});
  LinkSpec screw;
  screw.parent = 0;
  screw.joint = HelicalJoint{{1, 0, 1}, 0.1};
  screw.T_parent_joint = SE3(Vec3{0, 0, -0.4});
  screw.inertia = Inertia(0.5, Vec3{0.05, 0.04, 0.03});
  return {model_of({ball, screw})};
}
void build(Yard& yard, double hull_size = 0.1, double sum = 2.0) {
  World& world = yard.world;
  const Material m{0.5, 0.1, 1e-3};
  add_ground(world, m);
  for (int i = 0; i < 8; ++i) {
    Part part{.shape = Box{{0.1, 0.1, 0.1}}, .material = m};
    if (i % 4 == 1) part.shape = Capsule{0.1, 0.05};
    if (i % 4 == 2) part.shape = Cylinder{0.1, 0.1};
    if (i % 4 == 3) part.shape = Cone{0.1, 0.1};
    if (i == 7) part.shape = hull_of(hull_size);
    part.pose = SE3(Vec3{0.3 * i, 0.02 * i, 0.15 + 0.02 * i});
    if (i >= 6) part.pose = SE3(Vec3{0.5 * i, 2.0, i == 6 ? 1.2 : 0.8});
    yard.boxes.push_back(add_dynamic(world, part));
  }
  yard.rod = add_rod(world, 2.0, 0.09, 2, 0.15, m).articulation;
  yard.hanging = must(world.create_articulation(hanging_desc()));
  JointDesc joint;
  joint.T_a_joint = SE3(Vec3{0.15, 0, 0});
  joint.T_b_joint = SE3(Vec3{-0.15, 0, 0});
  joint.kind = Hinge{-1.0, 1.0, {}};
  yard.hinge = must(world.create_joint(yard.boxes[0], yard.boxes[1], joint));
  SixDof six;
  six.axes[0] = {AxisMotion::limited, -0.1, 0.1, {}};
  six.axes[2].motion = AxisMotion::locked;
  joint.kind = six;
  yard.six = must(world.create_joint(yard.boxes[2], yard.boxes[3], joint));
  joint.kind = UserConstraint{std::make_shared<Balance>(sum)};
  must(world.create_joint(yard.boxes[6], yard.boxes[7], joint));
}
void play(Yard& yard, int steps) {
  for (int i = 0; i < steps; ++i) must(yard.world.step(kLongDt));
}

// Every call that changes a world.
struct Change {
  const char* name;
  std::function<void(Yard&)> make;
};
std::vector<Change> changes() {
  return {
      {"create_body",
       [](Yard& y) {
         add_dynamic(y.world, {.pose = SE3(Vec3{-1, 0, 0.09})});
       }},
      {"destroy_body", [](Yard& y) { must(y.world.destroy_body(y.boxes[4])); }},
      {"add_collider",
       [](Yard& y) {
         ColliderDesc desc;
         desc.shape = Sphere{0.3};
         must(y.world.add_collider(y.boxes[5], desc));
       }},
      {"set_mass_from_colliders",
       [](Yard& y) { must(y.world.set_mass_from_colliders(y.boxes[5])); }},
      {"create_articulation",
       [](Yard& y) { must(y.world.create_articulation(rod_desc(-2.0, 0.5))); }},
      {"create_articulation of links that meet each other",
       [](Yard& y) {
         ArticulationDesc desc = hanging_desc();
         desc.links_collide = true;
         must(y.world.create_articulation(desc));
       }},
      {"create_articulation of an inertia that no body has",
       [](Yard& y) {
         LinkSpec link;
         link.joint = RevoluteJoint{{0, 1, 0}};
         link.inertia = Inertia(1.0, Vec3{3.0, 1.0, 1.0});
         link.inertia_as_stated = true;
         must(y.world.create_articulation({model_of({link})}));
       }},
      {"create_joint",
       [](Yard& y) {
         JointDesc desc;
         desc.kind = Distance{0, 0.2};
         must(y.world.create_joint(y.boxes[0], y.boxes[5], desc));
       }},
      {"destroy_joint", [](Yard& y) { must(y.world.destroy_joint(y.hinge)); }},
      {"set_pose",
       [](Yard& y) {
         must(y.world.set_pose(y.boxes[0], SE3(Vec3{0, 0, 0.3})));
       }},
      {"set_velocity",
       [](Yard& y) {
         must(y.world.set_velocity(y.boxes[1], {{1, 2, 3}, {}}));
       }},
      {"apply_impulse",
       [](Yard& y) {
         must(y.world.apply_impulse(y.boxes[2], {1, 0, 9}, {0.5, 0, 0.2}));
       }},
      {"apply_impulse to a link",
       [](Yard& y) {
         must(y.world.apply_impulse(y.world.link_body(y.rod, 0), {0, 1, 0}, {2, 0, 0.1}));
       }},
      {"apply_force",
       [](Yard& y) {
         must(y.world.apply_force(y.boxes[2], {100, 0, 900}, {0.5, 0, 0.2}));
       }},
      {"apply_force to a link",
       [](Yard& y) {
         must(y.world.apply_force(y.world.link_body(y.rod, 0), {0, 100, 0}, {2, 0, 0.1}));
       }},
      {"apply_torque",
       [](Yard& y) {
         must(y.world.apply_torque(y.boxes[6], {1, 2, 3}));
       }},
      {"apply_joint_force", [](Yard& y) { must(y.world.apply_joint_force(y.hanging, 0, 2, 0.5)); }},
      {"set_motion", [](Yard& y) { must(y.world.set_motion(y.boxes[5], Motion::kinematic)); }},
      {"set_motion to fixed", [](Yard& y) { must(y.world.set_motion(y.boxes[5], Motion::fixed)); }},
      {"set_inertia",
       [](Yard& y) {
         must(y.world.set_inertia(y.boxes[3], Inertia(2.0, Vec3{1, 1, 1})));
       }},
      {"set_damping", [](Yard& y) { must(y.world.set_damping(y.boxes[2], 1.0, 2.0)); }},
      {"set_gravity_scale", [](Yard& y) { must(y.world.set_gravity_scale(y.boxes[2], 0.5)); }},
      {"set_allow_sleep", [](Yard& y) { must(y.world.set_allow_sleep(y.boxes[2], false)); }},
      {"set_material",
       [](Yard& y) {
         must(y.world.set_material({1, 1}, {0.1, 0.2, 0.3, 0.4}));
       }},
      {"set_filter",
       [](Yard& y) {
         must(y.world.set_filter({3, 1}, {5, 3}));
       }},
      {"set_surface_velocity",
       [](Yard& y) {
         must(y.world.set_surface_velocity({1, 1}, {1, 2, 3}));
       }},
      {"remove_collider",
       [](Yard& y) {
         must(y.world.remove_collider({4, 1}));
       }},
      {"destroy_articulation",
       [](Yard& y) {
         must(y.world.destroy_articulation(must(y.world.create_articulation(rod_desc(-3.0, 0.5)))));
       }},
      {"create_body of other gravity that does not sleep",
       [](Yard& y) {
         BodyDesc desc;
         desc.gravity_scale = 0.3;
         desc.allow_sleep = false;
         desc.T_world_body = SE3(Vec3{-5, 0, 1});
         must(y.world.create_body(desc));
       }},
      {"set_joint_states",
       [](Yard& y) {
         const std::vector<double> q{0.6, 0, 0, 0.8, 0.3}, v{1, 0, 0, -2};
         must(y.world.set_joint_states(y.hanging, q, v));
       }},
      {"set_joint_state", [](Yard& y) { must(y.world.set_joint_state(y.rod, 0, 1, 0.5, 3.0)); }},
      {"set_drive of a link",
       [](Yard& y) {
         must(y.world.set_drive(y.rod, 0, 1, {1.0, 0, 100, 1, 20}));
       }},
      {"set_drives of an articulation",
       [](Yard& y) {
         const JointDrive drives[] = {{}, {1.0, 0, 100, 1, 20}};
         must(y.world.set_drives(y.rod, drives));
       }},
      {"set_drive of a joint",
       [](Yard& y) {
         must(y.world.set_drive(y.hinge, {0.5, 0, 1e4, 100, 1e3}));
       }},
      {"set_drive of an axis",
       [](Yard& y) {
         must(y.world.set_drive(y.six, JointAxis::rotation_z, {0, 5, 0, 100, 1e3}));
       }},
      {"restore",
       [](Yard& y) {
         std::vector<std::byte> bytes;
         y.world.snapshot(bytes);
         play(y, 3);
         must(y.world.restore(bytes));
         must(y.world.set_velocity(y.boxes[0], {{}, {0, 1, 0}}));
       }},
      {"step of another length", [](Yard& y) { must(y.world.step(0.011)); }},
  };
}

struct Recorded {
  std::shared_ptr<Recorder> recorder;
  std::vector<std::byte> bytes;
  std::uint64_t hash = 0;  // of the final world
};
// All changes, with a few steps after each.
Recorded record_all(std::uint32_t hash_every = 1) {
  Recorded out{std::make_shared<Recorder>(hash_every), {}, 0};
  Yard yard;
  must(yard.world.record(out.recorder));
  build(yard);
  for (const Change& change : changes()) {
    play(yard, 5);
    if (std::strcmp(change.name, "destroy_joint") == 0) continue;  // its drive is set later
    change.make(yard);
  }
  must(yard.world.destroy_joint(yard.hinge));
  play(yard, 5);
  must(yard.world.record(nullptr));
  out.hash = yard.world.state_hash();
  out.bytes.assign(out.recorder->bytes().begin(), out.recorder->bytes().end());
  return out;
}
// A short recording, for tests that process each of its bytes.
Recorded record_drop(std::uint32_t hash_every = 1) {
  Recorded out{std::make_shared<Recorder>(hash_every), {}, 0};
  World world;
  must(world.record(out.recorder));
  add_ground(world, {});
  const BodyId ball = add_dynamic(world, {.pose = SE3(Vec3{0, 0, 0.11})});
  for (int i = 0; i < 12; ++i) {
    if (i == 4) must(world.apply_impulse(ball, {1, 0, 0}, {0, 0, 0.15}));
    must(world.step(kLongDt));
  }
  must(world.record(nullptr));
  out.bytes = out.recorder->take();
  return out;
}

Replay must_move(Expected<Replay> replay) {
  if (!replay) ADD_FAILURE() << replay.error().message;
  return std::move(replay.value());
}

// Replays to the end, or to an error.
Expected<ReplayState> run(Replay& replay) {
  for (;;) {
    auto state = replay.step();
    if (!state || *state == ReplayState::end || *state == ReplayState::cut_short) return state;
  }
}

TEST(Replay, MakesEveryCallAgainToTheSameBits) {
  const Recorded recorded = record_all();
  Replay replay = must_move(Replay::open(recorded.bytes, recorded.recorder->parts()));
  EXPECT_EQ(must(run(replay)), ReplayState::end);
  EXPECT_EQ(replay.first_difference(), std::nullopt);
  EXPECT_EQ(replay.steps(), recorded.recorder->steps());
  EXPECT_EQ(replay.world().state_hash(), recorded.hash);
  EXPECT_EQ(must(replay.step()), ReplayState::end);
  std::printf("%zu bytes, %llu steps\n", recorded.bytes.size(),
              static_cast<unsigned long long>(replay.steps()));
}

// Each change alone, so that no change hides another, in a recording that starts from a complete
// world.
TEST(Recorder, NotesEachCallThatChangesAWorld) {
  for (const Change& change : changes()) {
    SCOPED_TRACE(change.name);
    Yard yard, twin;
    build(yard);
    build(twin);
    play(yard, 20);
    const auto recorder = std::make_shared<Recorder>();
    must(yard.world.record(recorder));
    play(yard, 2);
    const std::uint64_t unchanged = yard.world.state_hash();
    change.make(yard);
    EXPECT_NE(yard.world.state_hash(), unchanged);
    play(yard, 3);
    must(yard.world.record(nullptr));

    const std::vector<std::byte> bytes(recorder->bytes().begin(), recorder->bytes().end());
    Replay replay = must_move(Replay::open(bytes, recorder->parts(), std::move(twin.world)));
    EXPECT_EQ(must(run(replay)), ReplayState::end);
    EXPECT_EQ(replay.first_difference(), std::nullopt);
    EXPECT_EQ(replay.world().state_hash(), yard.world.state_hash());
  }
}

TEST(Recorder, NotesWhoIsWoken) {
  WorldDesc desc;
  desc.sleep_after = 0.05;
  World world(desc);
  const auto recorder = std::make_shared<Recorder>();
  must(world.record(recorder));
  add_ground(world, {});
  const BodyId box = add_dynamic(world, {.shape = Box{{1, 1, 1}}, .pose = SE3(Vec3{0, 0, 1})});
  for (int i = 0; i < 40; ++i) must(world.step(kLongDt));
  ASSERT_TRUE(world.is_asleep(box));
  must(world.wake(box));
  must(world.step(kLongDt));
  EXPECT_FALSE(world.is_asleep(box));
  must(world.record(nullptr));
  Replay replay = must_move(Replay::open(recorder->take()));
  for (int i = 0; i < 40; ++i) ASSERT_EQ(must(replay.step()), ReplayState::same);
  EXPECT_TRUE(replay.world().is_asleep(box));
  EXPECT_EQ(must(replay.step()), ReplayState::same);
  EXPECT_FALSE(replay.world().is_asleep(box));
}

TEST(Recorder, LeavesOutWhatIsRefused) {
  Yard yard;
  const auto recorder = std::make_shared<Recorder>(0);
  must(yard.world.record(recorder));
  build(yard);
  must(yard.world.step(kLongDt));
  const std::size_t before = recorder->bytes().size();
  EXPECT_FALSE(yard.world.set_pose({}, {}));
  EXPECT_FALSE(yard.world.step(0.0));
  EXPECT_FALSE(yard.world.set_drive(yard.rod, 7, 0, {}));
  EXPECT_FALSE(yard.world.restore({}));
  must(yard.world.step(kLongDt));
  // length, code, check
  EXPECT_EQ(recorder->bytes().size() - before, 9u);
}

TEST(Recorder, GivesItsBytesInPieces) {
  const auto whole = std::make_shared<Recorder>(), pieces = std::make_shared<Recorder>();
  std::vector<std::byte> file;
  Yard a, b;
  must(a.world.record(whole));
  must(b.world.record(pieces));
  build(a);
  build(b);
  for (int i = 0; i < 5; ++i) {
    play(a, 3);
    play(b, 3);
    const std::vector<std::byte> piece = pieces->take();
    file.insert(file.end(), piece.begin(), piece.end());
  }
  EXPECT_EQ(std::vector(whole->bytes().begin(), whole->bytes().end()), file);
}

TEST(Recorder, GoesWithTheWorldAndEndsWithIt) {
  const auto recorder = std::make_shared<Recorder>();
  {
    Yard yard;
    must(yard.world.record(recorder));
    build(yard);
    World moved = std::move(yard.world);
    must(moved.step(kLongDt));
    World other;
    EXPECT_FALSE(other.record(recorder)) << "it has been used";
  }
  const std::vector<std::byte> bytes(recorder->bytes().begin(), recorder->bytes().end());
  Replay replay = must_move(Replay::open(bytes, recorder->parts()));
  EXPECT_EQ(must(run(replay)), ReplayState::end);
  EXPECT_EQ(replay.steps(), 1u);
}

// The cost of a recording: apart from its hashes, at most 17 bytes for a step without calls.
// Golden: the bytes of a world that is built, stepped without hashes, and extended.
TEST(Recorder, WritesGoldenBytes) {
  const Recorded drop = record_drop(0);
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const std::byte b : drop.bytes) {
    hash = (hash ^ std::to_integer<std::uint64_t>(b)) * 0x100000001b3u;
  }
  EXPECT_EQ(drop.bytes.size(), 1183u);
  EXPECT_EQ(hash, 5594701112508436519u);
}

TEST(Replay, TellsTheFirstStepThatDiffers) {
  const Recorded recorded = record_drop();
  Replay replay = must_move(Replay::open(recorded.bytes));
  for (int i = 0; i < 6; ++i) EXPECT_EQ(must(replay.step()), ReplayState::same);
  const BodyId ball{2, 1};
  se3 velocity = replay.world().velocity(ball);
  velocity.v.x += 1e-6;
  must(replay.world().set_velocity(ball, velocity));
  EXPECT_EQ(must(replay.step()), ReplayState::differs);
  EXPECT_EQ(replay.first_difference(), 7u);
  EXPECT_EQ(must(run(replay)), ReplayState::end);
  EXPECT_EQ(replay.first_difference(), 7u);
  EXPECT_EQ(replay.steps(), 12u);
}

TEST(Replay, FindsADifferenceAtTheNextHash) {
  const Recorded recorded = record_drop(5);
  Replay replay = must_move(Replay::open(recorded.bytes));
  for (int i = 0; i < 6; ++i) EXPECT_EQ(must(replay.step()), ReplayState::same);
  must(replay.world().apply_impulse({2, 1}, {0, 0, 1e-9}, {}));
  for (int i = 7; i < 10; ++i) EXPECT_EQ(must(replay.step()), ReplayState::same) << i;
  EXPECT_EQ(must(replay.step()), ReplayState::differs);
  EXPECT_EQ(replay.first_difference(), 10u);
}

TEST(Replay, OfBytesCutShortGoesToTheLastWholeStep) {
  const Recorded recorded = record_drop();
  std::uint64_t most = 0;
  for (std::size_t n = 0; n < recorded.bytes.size(); ++n) {
    auto replay = Replay::open(
        {recorded.bytes.begin(), recorded.bytes.begin() + static_cast<std::ptrdiff_t>(n)});
    if (!replay) {
      ASSERT_EQ(replay.error().code, Errc::bad_data);
      ASSERT_EQ(most, 0u) << n;
      continue;
    }
    ASSERT_EQ(must(run(*replay)), ReplayState::cut_short) << n;
    ASSERT_EQ(replay->first_difference(), std::nullopt);
    ASSERT_TRUE(replay->steps() == most || replay->steps() == most + 1) << n;
    most = replay->steps();
  }
  EXPECT_EQ(most, 12u);
}

TEST(Replay, RefusesDamagedBytesBeforeDoingThem) {
  const Recorded recorded = record_drop();
  std::vector<std::uint64_t> truth;
  Replay good = must_move(Replay::open(recorded.bytes));
  do truth.push_back(good.world().state_hash());
  while (must(good.step()) != ReplayState::end);
  int refused = 0, short_ones = 0;
  for (std::size_t i = 0; i < recorded.bytes.size(); ++i) {
    std::vector<std::byte> bytes = recorded.bytes;
    bytes[i] ^= std::byte{0x10};
    auto replay = Replay::open(std::move(bytes));
    if (!replay) {
      ++refused;
      continue;
    }
    const auto state = run(*replay);
    ASSERT_TRUE(!state || *state == ReplayState::cut_short) << i;
    ASSERT_EQ(replay->world().state_hash(), truth[static_cast<std::size_t>(replay->steps())]) << i;
    ASSERT_EQ(replay->first_difference(), std::nullopt);
    state ? ++short_ones : ++refused;
    if (!state) {
      ASSERT_EQ(state.error().code, Errc::bad_data);
      ASSERT_EQ(replay->step().error().message, state.error().message) << "for good";
    }
  }
  // Only an increased frame length looks like a truncated recording.
  std::printf("%d flips refused, %d taken for an end that is missing\n", refused, short_ones);
  EXPECT_LE(short_ones, 4 * 13);
}

TEST(Replay, WantsAWorldExactlyWhereTheRecordingHasNone) {
  Yard yard, twin, other;
  build(yard);
  const auto recorder = std::make_shared<Recorder>();
  must(yard.world.record(recorder));
  play(yard, 3);
  const std::vector<std::byte> bytes(recorder->bytes().begin(), recorder->bytes().end());
  const auto none = Replay::open(bytes, recorder->parts());
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, Errc::invalid_argument);
  build(other, 0.11);
  const auto wrong = Replay::open(bytes, recorder->parts(), std::move(other.world));
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().code, Errc::bad_data);
  build(twin);
  EXPECT_TRUE(Replay::open(bytes, recorder->parts(), std::move(twin.world)));
  const Recorded drop = record_drop();
  EXPECT_FALSE(Replay::open(drop.bytes, {}, World{}));
}

TEST(Replay, RefusesOtherParts) {
  const Recorded recorded = record_all();
  const auto with = [&](RecordedParts parts) {
    Replay replay = must_move(Replay::open(recorded.bytes, std::move(parts)));
    return run(replay);
  };
  const RecordedParts& good = recorded.recorder->parts();
  ASSERT_EQ(good.shapes.size(), 1u);
  ASSERT_EQ(good.constraints.size(), 1u);
  RecordedParts larger = good, sum = good, sphere = good;
  larger.shapes[0] = hull_of(0.11);
  sum.constraints[0] = std::make_shared<Balance>(2.1);
  sphere.shapes[0] = Sphere{0.1};
  for (const RecordedParts& parts : {RecordedParts{}, larger, sum, sphere}) {
    const auto state = with(parts);
    ASSERT_FALSE(state);
    EXPECT_EQ(state.error().code, Errc::bad_data);
    EXPECT_NE(state.error().message.find("parts"), std::string::npos) << state.error().message;
  }
}

}  // namespace
}  // namespace vp::test
