#include "table_scene.h"

#include "foosball/table.h"

namespace rigid {
namespace {

using vp::SE3;
using vp::Vec3;

const foosball::TableSpec& spec() {
  return foosball::table_spec(foosball::Layout::paper);
}

constexpr scenes::Material kField{0.3, 0.3, 0.00015}, kWall{0.2, 0.75, 0.0}, kBall{0.5, 0.0, 0.0};
// A man for the benchmark only, so that changes of the game's characters do not change the
// comparison.
constexpr foosball::CharacterBody kMan{.foot_width = 0.020,
                                       .foot_depth = 0.018,
                                       .foot_reach = 0.0735,
                                       .torso_width = 0.024,
                                       .torso_depth = 0.020,
                                       .head_height = 0.040,
                                       .mass = 0.060,
                                       .friction = 0.60,
                                       .restitution = 0.80};

void add_fixed(scenes::Scene& scene, const scenes::Shape& shape, const Vec3& at,
               const scenes::Material& material) {
  scenes::Body body;
  body.motion = scenes::Motion::fixed;
  body.T_world_body = SE3(at);
  body.parts.push_back({shape, SE3{}, 1000.0, material});
  scene.bodies.push_back(body);
}

// Side walls, end walls with goals, and the boxes behind the goals.
void add_walls(scenes::Scene& scene) {
  const foosball::TableSpec& t = spec();
  constexpr double kThick = 0.1;  // half [m]
  const double h = 0.5 * t.wall_height, post = 0.5 * t.goal_width;
  const double flank = 0.5 * (0.5 * t.width - post), lintel = 0.5 * (t.wall_height - t.goal_height);
  const double front = 0.5 * t.length, depth = 0.5 * t.goal_depth;
  for (const double s : {-1.0, 1.0}) {
    add_fixed(scene, scenes::Box{{front + 2.0 * depth + 2.0 * kThick, kThick, h}},
              {0.0, s * (0.5 * t.width + kThick), h}, kWall);
    const double x = s * (front + depth);
    for (const double side : {-1.0, 1.0}) {
      add_fixed(scene, scenes::Box{{depth, flank, h}}, {x, side * (post + flank), h}, kWall);
    }
    add_fixed(scene, scenes::Box{{depth, post, lintel}}, {x, 0.0, t.goal_height + lintel}, kWall);
    add_fixed(scene, scenes::Box{{kThick, 0.5 * t.width, h}},
              {s * (front + 2.0 * depth + kThick), 0.0, h}, kWall);
  }
}

void add_ball(scenes::Scene& scene, const Vec3& at, const Vec3& velocity) {
  const foosball::TableSpec& t = spec();
  const scenes::Sphere shape{t.ball_radius};
  scenes::Body ball;
  ball.T_world_body = SE3(at);
  ball.velocity = velocity;
  ball.fast = true;
  ball.parts.push_back({shape, SE3{}, t.ball_mass / scenes::mass_of(shape, 1.0).mass, kBall});
  scene.bodies.push_back(ball);
}

// The slide has only the hand's mass; the rotating link carries rod and men.
vp::Expected<vp::Model> rod_model(const foosball::RodSpec& rod) {
  const foosball::TableSpec& t = spec();
  const foosball::CharacterBody& man = kMan;
  const double mass = t.rod_mass + rod.men * man.mass;
  constexpr double kHalfLength = 0.55, kGyration = 0.6;  // [m]; of a man's reach
  const double swing = kGyration * man.foot_reach;
  const double axial =
      0.5 * t.rod_mass * t.rod_radius * t.rod_radius + rod.men * man.mass * swing * swing;
  const double across = mass * kHalfLength * kHalfLength / 3.0;
  vp::ModelBuilder builder;
  vp::LinkSpec slide;
  slide.joint = vp::PrismaticJoint{};
  slide.T_parent_joint =
      SE3(vp::Mat3{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}, {rod.x, 0.0, t.rod_height});
  slide.armature = 0.4;
  slide.forces = {{.lower = -rod.slide_limit, .upper = rod.slide_limit}};
  const auto first = builder.add(slide);
  if (!first) return tl::make_unexpected(first.error());
  vp::LinkSpec turn;
  turn.parent = *first;
  turn.joint = vp::RevoluteJoint{};
  turn.inertia = vp::Inertia(mass, Vec3{across, across, axial});
  turn.armature = 5e-4;
  if (const auto added = builder.add(turn); !added) return tl::make_unexpected(added.error());
  return builder.build();
}

vp::Expected<void> add_men(vp::World& world, vp::BodyId rod, const foosball::RodSpec& where) {
  const foosball::CharacterBody& man = kMan;
  for (int i = 0; i < where.men; ++i) {
    // The rod's z axis is the table's y axis, its y axis the table's -z axis.
    for (const foosball::ManBox& box : foosball::boxes_of(man)) {
      const Vec3 &c = box.centre, &h = box.half_extents;
      vp::ColliderDesc desc;
      desc.shape = vp::Box{{h.x, h.z, h.y}};
      desc.T_body_shape = SE3(Vec3{c.x, -c.z, c.y + foosball::man_offset(where, i)});
      desc.material.friction = man.friction;
      desc.material.restitution = man.restitution;
      if (const auto added = world.add_collider(rod, desc); !added) {
        return tl::make_unexpected(added.error());
      }
    }
  }
  return {};
}

}  // namespace

scenes::Scene table_scene(int balls) {
  const foosball::TableSpec& t = spec();
  scenes::Scene scene;
  scene.name = "table" + std::to_string(balls);
  scene.gravity = {0.0, 0.0, -14.0};
  add_fixed(scene, scenes::Ground{}, {}, kField);
  add_walls(scene);
  scene.in_place.lower = {-0.5 * t.length - t.goal_depth, -0.5 * t.width, 0.0};
  scene.in_place.upper = {0.5 * t.length + t.goal_depth, 0.5 * t.width, 1e9};
  if (balls == 1) {
    add_ball(scene, {0.01, 0.02, t.ball_radius}, {3.0, 2.0, 0.0});
    return scene;
  }
  // Above the men, in layers of 20 by 10.
  constexpr int kX = 20, kY = 10;
  const double pitch = 2.6 * t.ball_radius;
  for (int i = 0; i < balls; ++i) {
    const int layer = i / (kX * kY), x = i % kX, y = i / kX % kY;
    add_ball(scene,
             {pitch * (x - 0.5 * (kX - 1)), pitch * (y - 0.5 * (kY - 1)),
              t.wall_height + 0.03 + pitch * layer},
             {});
  }
  return scene;
}

vp::Expected<Rods> Rods::create(vp::World& world) {
  Rods out;
  for (const foosball::RodSpec& rod : spec().rods) {
    const auto model = rod_model(rod);
    if (!model) return tl::make_unexpected(model.error());
    const auto made = world.create_articulation({*model});
    if (!made) return tl::make_unexpected(made.error());
    if (const auto men = add_men(world, world.link_body(*made, 1), rod); !men) {
      return tl::make_unexpected(men.error());
    }
    out.rods_.push_back(*made);
  }
  return out;
}

void Rods::drive(vp::World& world, long step) {
  constexpr double kSwing = 1.5;  // [rad]
  if (step % 100 != 0) return;
  const long target = step / 100;
  for (std::size_t i = 0; i < rods_.size(); ++i) {
    // Non-repeating angles, sufficiently random here.
    const double phase = static_cast<double>(target) * 2.4 + static_cast<double>(i) * 1.7;
    const double reach = spec().rods[i].slide_limit;
    const auto [s, c] = vp::sin_cos(phase * phase);
    (void)world.set_drive(rods_[i], 0, 0, {reach * s, 0.0, 3e4, 400.0, 350.0});
    (void)world.set_drive(rods_[i], 1, 0, {kSwing * c, 0.0, 100.0, 0.8, 14.0});
  }
}

}  // namespace rigid
