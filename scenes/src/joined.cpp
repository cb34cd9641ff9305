// Scenes with joints: ragdolls, a chain, a bridge, Newton's cradle.
#include <cmath>

#include "parts.h"
#include "scenes/catalogue.h"

namespace scenes {
namespace {

// Joins two bodies at a point of the world, with the joint's z axis along a given axis of the
// world.
void join(Scene& scene, Joint::Kind kind, int a, int b, const Vec3& point,
          const vp::Mat3& axes = vp::Mat3::identity(), double lower = -Joint::kNever,
          double upper = Joint::kNever) {
  const SE3 frame(axes, point);
  scene.joints.push_back({kind, a, b, Inv(scene.bodies[a].T_world_body) * frame,
                          Inv(scene.bodies[b].T_world_body) * frame, lower, upper});
}
// A rotation whose z axis is the world's y axis.
constexpr vp::Mat3 kAlongY{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}};

// A figure of 1.8 m and 68 kg that faces x, with its arms down. Positions are relative to the
// ground below it.
enum Limb {
  pelvis,
  abdomen,
  chest,
  head,
  arm_l,
  arm_r,
  forearm_l,
  forearm_r,
  thigh_l,
  thigh_r,
  shin_l,
  shin_r
};
struct LimbSpec {
  Shape shape;
  Vec3 centre;
};
const LimbSpec kLimbs[kRagdollBodies] = {
    {Box{{0.10, 0.16, 0.08}}, {0, 0, 1.00}}, {Box{{0.09, 0.13, 0.07}}, {0, 0, 1.16}},
    {Box{{0.11, 0.18, 0.14}}, {0, 0, 1.38}}, {Sphere{0.11}, {0, 0, 1.68}},
    {Capsule{0.05, 0.09}, {0, 0.25, 1.34}},  {Capsule{0.05, 0.09}, {0, -0.25, 1.34}},
    {Capsule{0.04, 0.10}, {0, 0.25, 1.04}},  {Capsule{0.04, 0.10}, {0, -0.25, 1.04}},
    {Capsule{0.07, 0.14}, {0, 0.10, 0.70}},  {Capsule{0.07, 0.14}, {0, -0.10, 0.70}},
    {Capsule{0.05, 0.15}, {0, 0.10, 0.28}},  {Capsule{0.05, 0.15}, {0, -0.10, 0.28}}};
struct LimbJoint {
  Joint::Kind kind;
  Limb a, b;
  Vec3 point;
  double lower, upper;
};
constexpr double kFlex = 2.4, kStretch = 0.05;  // elbows and knees bend in one direction [rad]
const LimbJoint kLimbJoints[] = {
    {Joint::Kind::ball, pelvis, abdomen, {0, 0, 1.085}, 0, 0},
    {Joint::Kind::ball, abdomen, chest, {0, 0, 1.235}, 0, 0},
    {Joint::Kind::ball, chest, head, {0, 0, 1.545}, 0, 0},
    {Joint::Kind::ball, chest, arm_l, {0, 0.25, 1.43}, 0, 0},
    {Joint::Kind::ball, chest, arm_r, {0, -0.25, 1.43}, 0, 0},
    {Joint::Kind::hinge, arm_l, forearm_l, {0, 0.25, 1.19}, -kFlex, kStretch},
    {Joint::Kind::hinge, arm_r, forearm_r, {0, -0.25, 1.19}, -kFlex, kStretch},
    {Joint::Kind::ball, pelvis, thigh_l, {0, 0.10, 0.915}, 0, 0},
    {Joint::Kind::ball, pelvis, thigh_r, {0, -0.10, 0.915}, 0, 0},
    {Joint::Kind::hinge, thigh_l, shin_l, {0, 0.10, 0.485}, -kStretch, kFlex},
    {Joint::Kind::hinge, thigh_r, shin_r, {0, -0.10, 0.485}, -kStretch, kFlex}};

// Bars of equal weight between two hinges are in equilibrium if the tangents of their slopes
// increase by the same step from each bar to the next: the horizontal force is equal everywhere,
// and the vertical force increases by a bar's weight. The first end is at start; the function
// returns the other end.
struct BarSpec {
  int count;
  double pitch;  // between hinges [m]
  double step;   // of the tangent
  Shape shape;
};
Vec3 add_hanging_bars(Scene& scene, const BarSpec& bars, const Vec3& start, int post) {
  Vec3 end = start;
  int last = post;
  for (int i = 0; i < bars.count; ++i) {
    const double slope = bars.step * (i - 0.5 * (bars.count - 1));
    const double c = 1.0 / std::sqrt(1.0 + slope * slope), s = slope * c;
    const Vec3 along{c, 0.0, s};
    const vp::Mat3 R{along, {0, 1, 0}, {-s, 0.0, c}};
    const int bar = add(scene, body_of(bars.shape, SE3(R, end + 0.5 * bars.pitch * along)));
    join(scene, Joint::Kind::hinge, last, bar, end, kAlongY);
    end += bars.pitch * along;
    last = bar;
  }
  return end;
}

}  // namespace

void add_ragdoll(Scene& scene, const SE3& T_world_ground) {
  const int first = static_cast<int>(scene.bodies.size());
  for (const LimbSpec& limb : kLimbs) {
    add(scene, body_of(limb.shape, T_world_ground * SE3(limb.centre)));
  }
  for (const LimbJoint& j : kLimbJoints) {
    const bool hinge = j.kind == Joint::Kind::hinge;
    join(scene, j.kind, first + j.a, first + j.b, T_world_ground * j.point,
         T_world_ground.rotation() * kAlongY, hinge ? j.lower : -Joint::kNever,
         hinge ? j.upper : Joint::kNever);
  }
}

Scene ragdolls(int along_x, int along_y, int layers) {
  constexpr double kPitch = 1.2, kLayer = 2.0, kLowest = 0.5, kMiddle = 0.9;  // [m]
  constexpr double kLean = 0.25;                                              // [rad]
  Scene scene;
  add_pit(scene, kPitch * std::max(along_x, along_y), kLowest + kLayer * (layers + 1));
  for (int k = 0; k < layers; ++k) {
    for (int i = 0; i < along_x; ++i) {
      for (int j = 0; j < along_y; ++j) {
        // Each figure leans in another direction, about the middle of its height, so that none
        // stays on its feet.
        const double yaw = 0.7 * i + 1.9 * j + 2.3 * k;
        const auto [s, c] = vp::sin_cos(3.1 * yaw);
        const SE3 T_world_centre = turned(
            {0, 0, yaw}, {kPitch * (i - 0.5 * (along_x - 1)), kPitch * (j - 0.5 * (along_y - 1)),
                          kLowest + kLayer * k + kMiddle});
        add_ragdoll(scene, T_world_centre * turned({kLean * c, kLean * s, 0}, {}) *
                               SE3(Vec3{0, 0, -kMiddle}));
      }
    }
  }
  return scene;
}

Scene chain(int links, double tilt) {
  constexpr Capsule kLink{0.04, 0.06};
  constexpr double kPitch = 0.2, kWeightRadius = 0.3, kIron = 7800.0;
  Scene scene;
  add_floor(scene);
  const double top = kPitch * links + 2.0;
  const vp::Mat3 R = vp::Exp(Vec3{0.0, -tilt, 0.0}).matrix();
  int last = add(scene, fixed_body(Box{{0.2, 0.2, 0.2}}, SE3(Vec3{0.0, 0.0, top + 0.2})));
  Vec3 end{0.0, 0.0, top};
  for (int i = 0; i < links; ++i) {
    const int link = add(scene, body_of(kLink, SE3(R, end - 0.5 * kPitch * R.cz)));
    join(scene, Joint::Kind::ball, last, link, end);
    end -= kPitch * R.cz;
    last = link;
  }
  const int weight =
      add(scene, body_of(Sphere{kWeightRadius}, SE3(R, end - kWeightRadius * R.cz), {}, kIron));
  join(scene, Joint::Kind::ball, last, weight, end);
  return scene;
}

Scene joint_grid(int side) {
  constexpr double kPitch = 1.0, kRadius = 0.4;  // [m]: they do not collide while it swings
  Scene scene;
  std::vector<int> column_before, column;
  for (int k = 0; k < side; ++k) {
    column.clear();
    for (int i = 0; i < side; ++i) {
      const Vec3 at{kPitch * k, 0.0, -kPitch * i};
      const Shape ball = Sphere{kRadius};
      column.push_back(add(scene, i == 0 ? fixed_body(ball, SE3(at)) : body_of(ball, SE3(at))));
      if (i == 0) continue;
      join(scene, Joint::Kind::ball, column[i - 1], column[i], at + Vec3{0, 0, 0.5 * kPitch});
      if (k == 0) continue;
      join(scene, Joint::Kind::ball, column_before[i], column[i], at - Vec3{0.5 * kPitch, 0, 0});
    }
    column_before = column;
  }
  scene.in_place.lower.z = -1e9;
  return scene;
}

Scene bridge(int planks, int crates) {
  constexpr double kPitch = 0.5, kSteepest = 0.46, kHeight = 15.0;  // [m], tangent, [m]
  const BarSpec bars{planks, kPitch, kSteepest / (0.5 * planks), Box{{0.24, 1.0, 0.05}}};
  const Box post{{0.5, 1.0, 0.5}};
  Scene scene;
  add_floor(scene);
  const int near = add(scene, fixed_body(post, SE3(Vec3{-0.55, 0.0, kHeight})));
  const int first = near + 1;
  const Vec3 end = add_hanging_bars(scene, bars, {0.0, 0.0, kHeight}, near);
  const int last = static_cast<int>(scene.bodies.size()) - 1;
  const int far = add(scene, fixed_body(post, SE3(end + Vec3{0.55, 0.0, 0.0})));
  join(scene, Joint::Kind::hinge, last, far, end, kAlongY);
  constexpr double kCrate = 0.25, kDrop = 0.3;  // [m]
  for (int i = 0; i < crates; ++i) {
    const int below = first + (2 * i + 1) * planks / (2 * crates);
    const Vec3 at = scene.bodies[below].T_world_body.position();
    add(scene, body_of(Box{{kCrate, kCrate, kCrate}}, SE3(at + Vec3{0, 0, 2.0 * kCrate + kDrop})));
  }
  if (crates == 0) {
    scene.in_place.rule = InPlace::Rule::near_start;
    scene.in_place.distance = 0.01;
  }
  return scene;
}

Scene cradle(int balls) {
  constexpr double kRadius = 0.1, kLength = 1.0, kIron = 7800.0, kRaised = 0.8;  // [m], [rad]
  const Material steel{0.0, 1.0, 0.0};
  Scene scene;
  const double half = kRadius * balls;
  const int beam = add(scene, fixed_body(Box{{half, 0.05, 0.05}}, SE3(Vec3{0, 0, 1.5}), steel));
  for (int i = 0; i < balls; ++i) {
    const Vec3 pivot{2.0 * kRadius * (i - 0.5 * (balls - 1)), 0.0, 1.4};
    const vp::Mat3 R = vp::Exp(Vec3{0.0, i == 0 ? kRaised : 0.0, 0.0}).matrix();
    const int ball =
        add(scene, body_of(Sphere{kRadius}, SE3(R, pivot - kLength * R.cz), steel, kIron));
    join(scene, Joint::Kind::hinge, beam, ball, pivot, kAlongY);
  }
  return scene;
}

}  // namespace scenes
