// Joints whose ends are links or continuous bodies: beside the same between free bodies, against
// closed forms, and where they close loops of one tree.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include "joints_rig.h"
#include "tree_scenes.h"
#include "vphysics/multibody/constrained_dynamics.h"
#include "vphysics/recording.h"

namespace vp::test {
namespace {

constexpr double kG = 9.81;

enum class Ends : std::uint8_t { bodies, links, a_link, continuous };

// A box that is a body or the one link of a tree that floats.
BodyId add_box(World& world, const Inertia& inertia, const SE3& pose, const se3& V, Ends ends,
               bool second) {
  const bool is_link = ends == Ends::links || (ends == Ends::a_link && second);
  if (!is_link) {
    BodyDesc desc;
    desc.T_world_body = pose;
    desc.velocity = V;
    desc.inertia = inertia;
    desc.continuous = ends == Ends::continuous;
    return must(world.create_body(desc));
  }
  LinkSpec link;
  link.joint = FreeJoint{};
  link.inertia = inertia;
  const ArticulationId id = must(world.create_articulation({model_of({link})}));
  std::vector<double> q(world.coordinates(id).begin(), world.coordinates(id).end());

  EXPECT_EQ(pose.rotation(), Mat3::identity());
  const Vec3 x = pose.position();
  q = {x.x, x.y, x.z, 0, 0, 0, 1};
  must(world.set_joint_states(id, q, std::vector<double>{V.w.x, V.w.y, V.w.z, V.v.x, V.v.y, V.v.z}));
  const BodyId body = world.link_body(id, 0);
  EXPECT_LT(norm(world.pose(body).position() - x), 1e-12);
  return body;
}

class Level : public PairConstraint {  // b's origin at a's height
 public:
  int rows() const override { return 1; }
  void evaluate(const SE3& T_a, const SE3& T_b, std::span<double> residual,
                std::span<PairRow> jacobian) const override {
    residual[0] = T_b.position().z - T_a.position().z;
    jacobian[0] = {{{}, -1.0 * T_a.unrotate({0, 0, 1})}, {{}, T_b.unrotate({0, 0, 1})}};
  }
};

struct Kind {
  const char* name;
  JointKind kind;
  double frequency = 0.0;
};
std::vector<Kind> kinds() {
  const JointDrive motor{0.0, 3.0, 0.0, 1e6, 2.0}, servo{0.5, 0.0, 200.0, 20.0, 50.0};
  SixDof six;
  six.axes[0].motion = six.axes[1].motion = AxisMotion::locked;
  six.axes[2] = {AxisMotion::limited, -0.02, 0.05, {}};
  six.axes[3].motion = AxisMotion::locked;
  six.axes[4] = {AxisMotion::limited, -0.3, 0.3, {}};
  six.axes[5] = {AxisMotion::free, 0, 0, servo};
  return {{"ball", BallSocket{}},
          {"soft ball", BallSocket{}, 4.0},
          {"hinge", Hinge{}},
          {"hinge with stops", Hinge{-0.1, 0.2, {}}},
          {"driven hinge", Hinge{-kNoLimit, kNoLimit, motor}},
          {"servo", Hinge{-2.0, 2.0, servo}},
          {"slider", Slider{-0.05, 0.1, {}}},
          {"weld", Weld{}},
          {"rope", Distance{0.0, 0.25}},
          {"rod", Distance{0.2, 0.2}},
          {"spring", Spring{0.3, 300.0, 3.0}},
          {"cone", ConeTwist{0.4, 0.2, -0.3, 0.3, {}}},
          {"six", six},
          {"gear", Gear{-1.5}},
          {"own", UserConstraint{std::make_shared<Level>()}}};
}

struct Pair {
  World world;
  BodyId a, b;
  JointId joint;
  explicit Pair(const Kind& kind, Ends ends) {
    const Inertia inertia = solid_inertia(Box{{0.2, 0.1, 0.05}}, 1000.0);
    const BodyId anchor = add_anchor(world);
    a = add_box(world, inertia, SE3(Vec3{0.3, 0, 0}), {{0, 0, 1}, {0, 0.3, 0}}, ends, false);
    b = add_box(world, inertia, SE3(Vec3{0.8, 0, 0}), {{0, 1, 2}, {0, 1, 0}}, ends, true);
    if (ends == Ends::a_link) {
      join(world, anchor, a, BallSocket{}, SE3(kAlongY, {}));
    } else {
      join(world, anchor, a, BallSocket{}, SE3(kAlongY, {}));
    }
    JointDesc desc;
    desc.kind = kind.kind;
    desc.frequency = kind.frequency;
    desc.T_a_joint = SE3(kAlongY, {0.25, 0, 0});
    desc.T_b_joint = SE3(kAlongY, {-0.25, 0, 0});
    if (std::holds_alternative<Distance>(kind.kind) || std::holds_alternative<Spring>(kind.kind)) {
      desc.T_b_joint = SE3(kAlongY, {-0.05, 0, 0});
    }
    joint = must(world.create_joint(a, b, desc));
  }
};

// Free bodies are held in lanes, in single precision, by sub-steps; links and continuous bodies in
// rows of an instant. Both come to where a hundredfold shorter step takes them, ever nearer.
TEST(LinkJoint, EveryKindMovesAsItDoesBetweenBodies) {
  for (const Kind& kind : kinds()) {
    Pair fine(kind, Ends::bodies);
    run(fine.world, 0.3, 1e-4);
    const Vec3 expected = fine.world.pose(fine.b).position();
    double off[4];
    for (const Ends ends : {Ends::bodies, Ends::links, Ends::a_link, Ends::continuous}) {
      Pair pair(kind, ends);
      run(pair.world, 0.3, 1e-3);
      off[static_cast<int>(ends)] = norm(pair.world.pose(pair.b).position() - expected);
    }
    std::printf("%-18s off by %.2g (bodies), %.2g (links), %.2g (a link), %.2g m (continuous)\n",
                kind.name, off[0], off[1], off[2], off[3]);
    for (int i = 1; i < 4; ++i) EXPECT_LT(off[i], 0.004) << kind.name << ' ' << i;
  }
}

}  // namespace
}  // namespace vp::test
