// NaN, infinite and too large numbers at every call that takes numbers and has no such test
// elsewhere. Each call rejects them with an error message and changes nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "joints_rig.h"
#include "vphysics/convex_hull.h"
#include "vphysics/height_field.h"

namespace vp::test {
namespace {

constexpr double kUnusable[] = {kNaN, kInfinity, -kInfinity, 1e10, -1e10, 1e300};

struct Small {
  World world;
  BodyId ground = add_ground(world, {});
  BodyId box = add_dynamic(world, {.shape = Box{{0.1, 0.1, 0.1}}, .pose = SE3(Vec3{0, 0, 0.1})});
  Rod rod = add_rod(world, 1.0, 0.09, 1, 0.1, {});
};

// Expects that call(number) fails for every invalid number.
template <class Call>
void expect_refused(World& world, const char* what, const Call& call) {
  const std::uint64_t before = world.state_hash();
  for (const double x : kUnusable) {
    const auto result = call(x);
    ASSERT_FALSE(result.has_value()) << what << ' ' << x;
    EXPECT_EQ(result.error().code, Errc::invalid_argument) << what << ' ' << x;
    EXPECT_GT(result.error().message.size(), 20u) << what << ' ' << x;
    EXPECT_EQ(world.state_hash(), before) << what << ' ' << x;
  }
}

TEST(EveryCall, RefusesPosesAndVelocitiesThatAreNone) {
  Small s;
  for (int i = 0; i < 3; ++i) {
    const auto at = [i](double x) {
      Vec3 v;
      v[i] = x;
      return v;
    };
    expect_refused(s.world, "set_pose",
                   [&](double x) { return s.world.set_pose(s.box, SE3(at(x))); });
    expect_refused(s.world, "set_velocity w", [&](double x) {
      return s.world.set_velocity(s.box, {at(x), {}});
    });
    expect_refused(s.world, "set_velocity v", [&](double x) {
      return s.world.set_velocity(s.box, {{}, at(x)});
    });
    expect_refused(s.world, "apply_impulse",
                   [&](double x) { return s.world.apply_impulse(s.box, at(x), {}); });
    expect_refused(s.world, "apply_impulse at", [&](double x) {
      return s.world.apply_impulse(s.box, {1, 0, 0}, at(x));
    });
  }
  for (int i = 0; i < 3; ++i) {
    const auto at = [i](double x) {
      Vec3 v;
      v[i] = 1e4 * x;
      return v;
    };
    for (const BodyId body : {s.box, s.rod.body}) {
      expect_refused(s.world, "apply_force",
                     [&](double x) { return s.world.apply_force(body, at(1e3 * x), {}); });
      expect_refused(s.world, "apply_force at", [&](double x) {
        return s.world.apply_force(body, {1, 0, 0}, at(x));
      });
      expect_refused(s.world, "apply_torque",
                     [&](double x) { return s.world.apply_torque(body, at(x)); });
    }
  }
  expect_refused(s.world, "apply_joint_force",
                 [&](double x) { return s.world.apply_joint_force(s.rod.articulation, 0, 1, x); });
  expect_refused(s.world, "set_pose, turned", [&](double x) {
    return s.world.set_pose(s.box, SE3(Mat3{{x, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}));
  });
}

TEST(EveryCall, RefusesJointStatesAndDrivesThatAreNone) {
  Small s;
  const auto id = s.rod.articulation;
  expect_refused(s.world, "position",
                 [&](double x) { return s.world.set_joint_state(id, 0, 1, x, 0); });
  expect_refused(s.world, "rate",
                 [&](double x) { return s.world.set_joint_state(id, 0, 1, 0, x); });
  double JointDrive::*const fields[] = {&JointDrive::position, &JointDrive::velocity,
                                        &JointDrive::stiffness, &JointDrive::damping};
  for (double JointDrive::*const field : fields) {
    for (const double x : {kNaN, kInfinity, -kInfinity, -1e10, 1e300}) {
      JointDrive drive{0, 0, 1, 1, 1};
      drive.*field = x;
      EXPECT_FALSE(s.world.set_drive(id, 0, 0, drive)) << x;
    }
  }
  for (const JointDrive& drive : {JointDrive{0, 0, -1, 1, 1}, JointDrive{0, 0, 1, -1, 1},
                                  JointDrive{0, 0, 1, 1, -1}, JointDrive{0, 0, 1, 1, kNaN}}) {
    EXPECT_FALSE(s.world.set_drive(id, 0, 0, drive));
    const std::uint64_t before = s.world.state_hash();
    const JointDrive second_is_bad[] = {{0, 0, 1, 1, 1}, drive};
    EXPECT_FALSE(s.world.set_drives(id, second_is_bad));
    EXPECT_EQ(s.world.state_hash(), before);
  }
}

// Links, degrees of freedom and ids that do not exist.
TEST(EveryCall, RefusesWhatDoesNotExist) {
  Small s;
  must(s.world.destroy_body(s.box));
  const std::uint64_t before = s.world.state_hash();
  const auto id = s.rod.articulation;
  EXPECT_FALSE(s.world.set_velocity(s.box, {}));
  EXPECT_FALSE(s.world.set_velocity(s.rod.body, {}));
  EXPECT_FALSE(s.world.set_pose(s.rod.body, {}));
  EXPECT_FALSE(s.world.destroy_body(s.rod.body));
  EXPECT_FALSE(s.world.set_mass_from_colliders(s.box));
  EXPECT_FALSE(s.world.wake(s.box));
  EXPECT_FALSE(s.world.apply_force(s.ground, {1, 0, 0}));
  EXPECT_FALSE(s.world.apply_force(s.ground, {1, 0, 0}, {}));
  EXPECT_FALSE(s.world.apply_torque(s.ground, {1, 0, 0}));
  EXPECT_FALSE(s.world.apply_joint_force({}, 0, 0, 1.0));
  EXPECT_FALSE(s.world.destroy_joint({}));
  EXPECT_FALSE(s.world.create_joint(s.box, s.ground, {}));
  for (const int out_of_range : {-1, 2, 1 << 30}) {
    EXPECT_FALSE(s.world.set_joint_state(id, 0, out_of_range, 0, 0));
    EXPECT_FALSE(s.world.set_joint_state(id, out_of_range, 0, 0, 0));
    EXPECT_FALSE(s.world.set_drive(id, 0, out_of_range, {}));
    EXPECT_FALSE(s.world.set_drive(id, out_of_range, 0, {}));
    EXPECT_FALSE(s.world.apply_joint_force(id, 0, out_of_range, 1.0));
    EXPECT_FALSE(s.world.apply_joint_force(id, out_of_range, 0, 1.0));
    EXPECT_EQ(s.world.link_body(id, out_of_range), BodyId{});
  }
  const JointDrive three[3];
  for (const std::size_t count : {0u, 1u, 3u}) {
    EXPECT_FALSE(s.world.set_drives(id, std::span(three).first(count)));
  }
  EXPECT_FALSE(s.world.set_drives({}, std::span(three).first(2)));
  EXPECT_EQ(s.world.model({}), nullptr);
  EXPECT_EQ(s.world.state_hash(), before);
}

TEST(EveryCall, RefusesSettingsOfAWorldThatAreNone) {
  const auto refused = [](const WorldDesc& desc) {
    const auto made = World::create(desc);
    return !made && made.error().code == Errc::invalid_argument && made.error().message.size() > 20;
  };
  ASSERT_TRUE(World::create({}).has_value());
  double WorldDesc::*const fields[] = {&WorldDesc::restitution_threshold, &WorldDesc::contact_slop,
                                       &WorldDesc::sleep_after, &WorldDesc::sleep_speed};
  for (double WorldDesc::*const field : fields) {
    for (const double x : {kNaN, kInfinity, -1.0, 1e10}) {
      WorldDesc desc;
      desc.*field = x;
      EXPECT_TRUE(refused(desc)) << x;
    }
  }
  for (int i = 0; i < 3; ++i) {
    for (const double x : kUnusable) {
      WorldDesc desc;
      desc.gravity[i] = x;
      EXPECT_TRUE(refused(desc)) << x;
    }
  }
  int WorldDesc::*const counts[] = {&WorldDesc::velocity_iterations, &WorldDesc::sub_steps,
                                    &WorldDesc::max_impacts_per_step, &WorldDesc::region_bodies};
  for (int WorldDesc::*const count : counts) {
    for (const int n : {-1, 1 << 30, std::numeric_limits<int>::min()}) {
      WorldDesc desc;
      desc.*count = n;
      EXPECT_TRUE(refused(desc)) << n;
    }
  }
  WorldDesc desc;
  desc.contact_slop = 0.0;
  EXPECT_TRUE(refused(desc));
  desc = {};
  desc.velocity_iterations = 0;
  EXPECT_TRUE(refused(desc));
}

// Shapes made by their own factory calls. A scale of zero or below is invalid, too.
TEST(EveryCall, RefusesShapesThatAreNone) {
  const std::vector<double> flat(9, 0.0);
  for (const double x : {kNaN, kInfinity, -kInfinity, 1e300}) {
    std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {x, 0, 0}};
    EXPECT_FALSE(ConvexHull::of(points)) << x;
    const std::vector<TriangleMesh::Triangle> triangles{{0, 1, 4}};
    EXPECT_FALSE(TriangleMesh::of(points, triangles)) << x;
    std::vector<double> heights = flat;
    heights[4] = x;
    EXPECT_FALSE(HeightField::of({3, 3, 1.0, 1.0, heights, {}})) << x;
    EXPECT_FALSE(HeightField::of({3, 3, x, 1.0, flat, {}})) << x;
    EXPECT_FALSE(HeightField::of({3, 3, 1.0, x, flat, {}})) << x;
    const CompoundPart parts[] = {{Sphere{x}, {}}};
    EXPECT_FALSE(Compound::of(parts)) << x;
    const CompoundPart moved[] = {{Sphere{1.0}, SE3(Vec3{x, 0, 0})}};
    EXPECT_FALSE(Compound::of(moved)) << x;
  }
  for (const double x : {kNaN, kInfinity, -1.0, 0.0, 1e300}) {
    EXPECT_FALSE(scaled(Box{{1, 1, 1}}, {1, x, 1})) << x;
    EXPECT_FALSE(HeightField::of({3, 3, 1.0, 1.0, flat, {}}).value().scaled({x, 1, 1})) << x;
  }
  EXPECT_FALSE(ConvexHull::of({}));
  EXPECT_FALSE(TriangleMesh::of({}, {}));
  EXPECT_FALSE(HeightField::of({}));
  EXPECT_FALSE(Compound::of({}));
}

// Values whose inverse overflows single precision, or whose square underflows.
TEST(EveryCall, RefusesMassesAndSizesThatAreTooSmall) {
  Small s;
  const std::uint64_t before = s.world.state_hash();
  const auto refused = [&](const auto& result, const char* says) {
    EXPECT_EQ(s.world.state_hash(), before);
    return !result && result.error().code == Errc::invalid_argument &&
           result.error().message.find(says) != std::string::npos;
  };
  for (const double x : {0.9e-15, 1e-20, 1e-38, 1e-45, 1e-300, 1.1e9}) {
    BodyDesc desc;
    desc.inertia = Inertia(x, Vec3{1, 1, 1});
    EXPECT_TRUE(refused(s.world.create_body(desc), "1e-15 to 1e9 kg")) << x;
  }
  for (const double x : {0.9e-30, 1e-38, 1e-45, 1e-100}) {
    for (int i = 0; i < 3; ++i) {
      Vec3 moments{1, 1, 1};
      moments[i] = x;
      BodyDesc desc;
      desc.inertia = Inertia(1.0, moments);
      EXPECT_TRUE(refused(s.world.create_body(desc), "1e-30 kg m^2")) << x;
    }
  }
  for (const double x : {0.9e-6, 1e-12, 1e-45, 1e-160, 1e-300}) {
    for (const Shape& shape :
         {Shape(Sphere{x}), Shape(Box{{1, x, 1}}), Shape(Capsule{x, 1}), Shape(Cylinder{x, 1}),
          Shape(Cylinder{1, x}), Shape(Cone{x, 1}), Shape(Cone{1, x})}) {
      ColliderDesc desc;
      desc.shape = shape;
      EXPECT_TRUE(refused(s.world.add_collider(s.box, desc), "1e-6 to 1e9 m")) << x;
      EXPECT_TRUE(refused(s.world.nearest(shape, {}, 1.0), "1e-6 to 1e9 m")) << x;
      const CompoundPart parts[] = {{shape, {}}};
      EXPECT_TRUE(refused(Compound::of(parts), "1e-6 to 1e9 m")) << x;
    }
    const Vec3 corners[] = {{0, 0, 0}, {x, 0, 0}, {0, x, 0}, {0, 0, x}};
    EXPECT_TRUE(refused(ConvexHull::of(corners), "micrometre")) << x;
  }
}

TEST(EveryCall, RefusesMomentsThatNoMassHas) {
  Small s;
  const auto made = [&](const Sym3& about_centre) {
    BodyDesc desc;
    desc.inertia = Inertia(2.0, {}, about_centre);
    return s.world.create_body(desc);
  };
  const Mat3 R = Exp(Vec3{0.3, -1.1, 0.7}).matrix();
  const auto turned = [&](double x, double y, double z) {
    return rotated(R, Sym3{x, y, z, 0, 0, 0});
  };
  for (const Sym3& J : {Sym3{1, 1, 2.2, 0, 0, 0}, Sym3{1, 9, 1, 0, 0, 0}, turned(3, 1, 1)}) {
    const auto body = made(J);
    ASSERT_FALSE(body);
    EXPECT_EQ(body.error().code, Errc::invalid_argument);
    EXPECT_NE(body.error().message.find("solid_inertia"), std::string::npos);
  }
  // A disc, a rod, a disc with rounded values of two digits, and a rotated one.
  for (const Sym3& J : {Sym3{1, 1, 2, 0, 0, 0}, Sym3{1, 1, 1e-9, 0, 0, 0},
                        Sym3{0.083, 0.083, 0.17, 0, 0, 0}, turned(2, 1, 1)}) {
    EXPECT_TRUE(made(J)) << J.zz;
  }
}

TEST(EveryCall, TakesASteelCubeOf20Metres) {
  World world;
  add_ground(world, {});
  BodyDesc desc;
  const Shape cube = Box{{10, 10, 10}};
  desc.inertia = solid_inertia(cube, 7800.0);
  desc.T_world_body = SE3(Vec3{0, 0, 10.0});
  const BodyId body = must(world.create_body(desc));
  ColliderDesc collider;
  collider.shape = cube;
  must(world.add_collider(body, collider));
  for (int i = 0; i < 500; ++i) must(world.step(kDt));
  EXPECT_NEAR(world.pose(body).position().z, 10.0, 1e-2);
  must(world.apply_impulse(body, {0, 0, desc.inertia.mass() * 100.0}, {0, 0, 10}));
  EXPECT_NEAR(world.velocity(body).v.z, 100.0, 1e-6);
}

// Without the check, a nested step would recurse for ever, or start from the state of a
// half-finished step.
TEST(EveryCall, AStepWithinAStepIsRefused) {
  class Restless : public StageObserver {
   public:
    explicit Restless(World& world) : world_(world) {}
    void begin(Stage) override {
      const auto stepped = world_.step(kDt);
      refused += !stepped && stepped.error().code == Errc::unsupported ? 1 : 0;
    }
    void end(Stage) override {}
    int refused = 0;

   private:
    World& world_;
  };
  Small s, undisturbed;
  const auto observer = std::make_shared<Restless>(s.world);
  s.world.observe_stages(observer);
  for (int i = 0; i < 10; ++i) {
    must(s.world.step(kDt));
    must(undisturbed.world.step(kDt));
  }
  EXPECT_GE(observer->refused, 10);
  EXPECT_EQ(s.world.state_hash(), undisturbed.world.state_hash());
}

// Colliders whose total mass is below the minimum.
TEST(EveryCall, RefusesAMassFromCollidersThatIsTooSmall) {
  Small s;
  ColliderDesc thin;
  thin.shape = Sphere{1e-3};
  thin.density = 1e-9;
  BodyDesc desc;
  desc.inertia = solid_inertia(Sphere{1.0}, 1.0);
  const BodyId body = must(s.world.create_body(desc));
  must(s.world.add_collider(body, thin));
  const std::uint64_t before = s.world.state_hash();
  const auto result = s.world.set_mass_from_colliders(body);
  ASSERT_FALSE(result);
  EXPECT_NE(result.error().message.find("1e-15 to 1e9 kg"), std::string::npos);
  EXPECT_EQ(s.world.state_hash(), before);
}

// Bodies of the smallest valid masses, inertias and sizes: stacked, and welded to one another. They
// step without a status flag, with the shortest steps too, and do not affect a body beside them.
TEST(EveryCall, TakesTheLeastMassesSizesAndTimes) {
  struct Least {
    Inertia inertia;
    Shape shape;
    double size;
  };
  const Least all[] = {
      {solid_inertia(Sphere{1e-6}, 1000.0), Sphere{1e-6}, 1e-6},
      {solid_inertia(Box{{1e-6, 1e-6, 1e-6}}, 1000.0), Box{{1e-6, 1e-6, 1e-6}}, 1e-6},
      {Inertia(1e-15, Vec3{1e-30, 1e-30, 1e-30}), Box{{0.5, 0.5, 0.5}}, 0.5},
      {Inertia(1e-15, Vec3{1e-16, 1e-16, 1e-16}), Sphere{0.5}, 0.5},
      {Inertia(1.0, Vec3{1e-30, 1e-30, 1e-30}), Box{{0.5, 0.5, 0.5}}, 0.5},
      {Inertia(1e9, Vec3{1e-6, 1e9, 1e9}), Box{{0.5, 0.5, 0.5}}, 0.5},
      {Inertia(1.0, Vec3{1.0, 1.0, 1.0}), Box{{1.0, 1.0, 1e-6}}, 1e-6},
  };
  const struct {
    double dt;
    int sub_steps;
  } times[] = {{1.0 / 60.0, 0}, {0.001, 0}, {1e-7, 0}, {1e-7, 1000}};
  for (const Least& least : all) {
    for (const auto& time : times) {
      WorldDesc settings;
      settings.sub_steps = time.sub_steps;
      World world(settings);
      add_ground(world, {});
      const BodyId beside =
          add_dynamic(world, {.shape = Box{{0.5, 0.5, 0.5}}, .pose = SE3(Vec3{20, 0, 0.5})});
      BodyId last = beside;
      for (int i = 0; i < 3; ++i) {
        BodyDesc desc;
        desc.inertia = least.inertia;
        desc.T_world_body = SE3(Vec3{0, 0, (1 + 2 * i) * least.size});
        const BodyId body = must(world.create_body(desc));
        ColliderDesc collider;
        collider.shape = least.shape;
        must(world.add_collider(body, collider));
        if (i == 2) {
          JointDesc joint;
          joint.kind = Weld{};
          joint.T_b_joint = SE3(Vec3{0, 0, -2 * least.size});
          must(world.create_joint(last, body, joint));
        }
        last = body;
      }
      bool out_of_range = false;
      const int steps = time.sub_steps > 0 ? 20 : 200;
      for (int i = 0; i < steps; ++i) out_of_range |= must(world.step(time.dt)).non_finite;
      const std::ptrdiff_t which = &least - all;
      EXPECT_FALSE(out_of_range) << which << ", " << time.dt;
      EXPECT_LT(norm(world.pose(beside).position() - Vec3{20, 0, 0.5}), 1e-3) << which;
    }
  }
}

// Each message names the call and the argument.
TEST(EveryCall, SaysWhichArgumentIsStale) {
  Small s;
  const BodyId dead = s.box;
  must(s.world.destroy_body(dead));
  const auto says = [](const auto& result, const std::string& begin) {
    return !result && result.error().message.starts_with(begin + " does not exist");
  };
  EXPECT_TRUE(says(s.world.create_joint(s.ground, dead, {}), "create_joint: body b"));
  EXPECT_TRUE(says(s.world.create_joint(dead, s.ground, {}), "create_joint: body a"));
  EXPECT_TRUE(says(s.world.destroy_body(dead), "destroy_body: the body"));
  EXPECT_TRUE(says(s.world.add_collider(dead, {}), "add_collider: the body"));
  EXPECT_TRUE(says(s.world.set_pose(dead, {}), "set_pose: the body"));
  EXPECT_TRUE(says(s.world.set_velocity(dead, {}), "set_velocity: the body"));
  EXPECT_TRUE(says(s.world.apply_impulse(dead, {}, {}), "apply_impulse: the body"));
  EXPECT_TRUE(says(s.world.apply_force(dead, {}), "apply_force: the body"));
  EXPECT_TRUE(says(s.world.apply_force(dead, {}, {}), "apply_force: the body"));
  EXPECT_TRUE(says(s.world.apply_torque(dead, {}), "apply_torque: the body"));
  EXPECT_TRUE(says(s.world.wake(dead), "wake: the body"));
  EXPECT_TRUE(says(s.world.set_mass_from_colliders(dead), "set_mass_from_colliders: the body"));
  EXPECT_TRUE(says(s.world.destroy_joint({}), "destroy_joint: the joint"));
  EXPECT_TRUE(says(s.world.set_drive(JointId{}, {}), "set_drive: the joint"));
  EXPECT_TRUE(says(s.world.set_drive(JointId{}, JointAxis::x, {}), "set_drive: the joint"));
}

TEST(EveryCall, RestoresNothingFromBytesThatAreNone) {
  Small s;
  run(s.world, 0.05);
  const std::uint64_t before = s.world.state_hash();
  std::vector<std::byte> bytes(4096);
  for (const std::size_t n : {std::size_t{0}, std::size_t{1}, std::size_t{8}, bytes.size()}) {
    EXPECT_FALSE(s.world.restore(std::span(bytes).first(n))) << n;
    EXPECT_EQ(s.world.state_hash(), before);
  }
}

}  // namespace
}  // namespace vp::test
