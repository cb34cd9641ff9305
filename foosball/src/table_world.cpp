#include "table_world.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "vphysics/assert.h"

namespace foosball {
namespace {

using vp::Box;
using vp::Mat3;
using vp::SE3;
using vp::Vec3;

constexpr std::uint32_t kBallCategory = 1;
constexpr std::uint32_t kTableCategory = 2;
constexpr std::uint32_t kManCategory = 4;

// Absorbs the ball: a ball that scored stays visible in the box.
constexpr vp::Material kGoalBox{0.60, 0.0, 0.010};

// Thick enough that a penetrating ball is always pushed out on the inner side.
constexpr double kWallThickness = 0.20;  // [m]

// A joint's axis is its z; a rod's axis is the table's y. Columns: the joint's axes in the world.
constexpr Mat3 kRodAxes{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}};

// All ids and sizes here come from the table, so that no call of the engine can fail. A failure is
// a defect of this file: VP_ASSERT reports it in Debug. In Release a failed update has no effect,
// and a failed creation returns the null id, which the world then rejects.
template <class T>
T must(vp::Expected<T> result) {
  VP_ASSERT(result.has_value());
  return result ? std::move(*result) : T{};
}
void must([[maybe_unused]] const vp::Expected<void>& result) {
  VP_ASSERT(result.has_value());
}

// Inertia of a rod and its men. They are balanced about the axis as on tournament tables, so that a
// released rod stays at its angle. Link frame: z along the rod.
vp::Inertia link_inertia(const RodInertia& rod) {
  constexpr double kHalfLength = 0.55;
  const double across = rod.rod_and_men * kHalfLength * kHalfLength / 3.0;
  return {rod.rod_and_men, Vec3{across, across, rod.axial}};
}

// Index of the i-th man from the player's left.
int man_from_left(const RodSpec& rod, int i) {
  return rod.team == 0 ? i : rod.men - 1 - i;
}

// Links. A row slides as one; the slide has no mass of its own.
// On a rod (tournament) its men belong to the rotating link.
// Hinged men (paper, section 5.1) are separate links, each balanced about the rod's axis. There is
// no rod between them: the rotating link is the hand alone, without colliders. The armature of his
// hinge gives each man the effective inertia of a row on a rod. So a character strikes alike on
// both tables, and without an obstacle a man moves exactly as the hand does.
constexpr int kSlide = 0, kTurn = 1, kFirstMan = 2;
vp::Model rod_model(const TableSpec& table, const RodSpec& rod, const RodInertia& inertia,
                    const Tuning& tuning) {
  const bool hinged = hinged_men(table.layout);
  vp::ModelBuilder builder;
  vp::LinkSpec slide;
  slide.joint = vp::PrismaticJoint{};
  slide.T_parent_joint = SE3(kRodAxes, Vec3{rod.x, 0.0, table.rod_height});
  slide.armature = hinged ? inertia.slide - rod.men * inertia.man : tuning.hand_mass;
  slide.forces = {{.lower = -rod.slide_limit, .upper = rod.slide_limit}};
  vp::LinkSpec turn;
  turn.parent = must(builder.add(slide));
  turn.joint = vp::RevoluteJoint{};
  if (!hinged) turn.inertia = link_inertia(inertia);
  const double man_armature = inertia.turn - inertia.man_axial;
  // The same sum as for a man's hinge: otherwise hand and men would differ in the last bit.
  turn.armature = hinged ? inertia.man_axial + man_armature : tuning.hand_inertia;
  must(builder.add(turn));
  for (int i = 0; hinged && i < rod.men; ++i) {
    vp::LinkSpec man;
    man.parent = turn.parent;
    man.joint = vp::RevoluteJoint{};
    man.T_parent_joint = SE3(Vec3{0.0, 0.0, man_offset(rod, man_from_left(rod, i))});
    man.inertia =
        vp::Inertia(inertia.man, Vec3{inertia.man_axial, inertia.man_axial, inertia.man_axial});
    man.armature = man_armature;
    must(builder.add(man));
  }
  return builder.build().value();
}

}  // namespace

BallContact ball_contact(const vp::ContactEvent& event) {
  const Tag a = decode_tag(event.user_data_a);
  const Tag b = decode_tag(event.user_data_b);
  return {a.what == Tag::What::ball ? b : a, event.kind, event.impulse, event.point};
}

std::uint64_t encode(const Tag& tag) {
  return static_cast<std::uint64_t>(tag.what) | std::uint64_t{tag.rod} << 8 |
         std::uint64_t{tag.man} << 16 | std::uint64_t{tag.part} << 24;
}

Tag decode_tag(std::uint64_t user_data) {
  return {static_cast<Tag::What>(user_data & 0xff), static_cast<std::uint8_t>(user_data >> 8),
          static_cast<std::uint8_t>(user_data >> 16), static_cast<std::uint8_t>(user_data >> 24)};
}

TableWorld::TableWorld(Layout layout, const TeamBodies& bodies, int first, const Tuning& tuning)
    : TableWorld(InParts{}, layout, bodies, first, tuning) {
  while (!is_built()) build_part();
}

TableWorld::TableWorld(InParts /*later*/, Layout layout, const TeamBodies& bodies, int first,
                       const Tuning& tuning)
    : table_(table_spec(layout)),
      first_(first),
      tuning_(tuning),
      bodies_(bodies),
      world_(
          {.gravity = {0.0, 0.0, -tuning.gravity}, .restitution_threshold = tuning.still_speed}) {}

// --- building ------------------------------------------------------------------------------------

void TableWorld::build_part() {
  VP_ASSERT(!is_built());
  if (parts_ == 0) {
    vp::BodyDesc fixed;
    fixed.motion = vp::Motion::fixed;
    fixed_ = must(world_.create_body(fixed));
    add_field_and_walls();
    add_corners();
    add_ball();
    found_.reserve(64);
  } else {
    const int row = parts_ - 1;
    const int team = row < kRods / 2 ? first_ : 1 - first_;
    add_rod(rods_of_team(table_, team)[static_cast<std::size_t>(row % (kRods / 2))]);
  }
  ++parts_;
  if (!is_built()) return;
  park_ball();
  (void)free_for_ball({});  // the first query of a world allocates
}

void TableWorld::add_fixed(const vp::Shape& shape, const SE3& T_world_shape,
                           const vp::Material& material, Tag::What what) {
  vp::ColliderDesc desc;
  desc.shape = shape;
  desc.T_body_shape = T_world_shape;
  desc.material = material;
  desc.filter = {kTableCategory, kBallCategory};
  desc.user_data = encode({what});
  must(world_.add_collider(fixed_, desc));
}

vp::Material TableWorld::field() const {
  return {tuning_.field_friction, 0.0,
          tuning_.rolling_resistance};  // restitution: see exaggerate_bounce
}
vp::Material TableWorld::wall() const {
  return {tuning_.wall_friction, tuning_.wall_restitution, 0.0};
}

void TableWorld::add_field_and_walls() {
  add_fixed(vp::HalfSpace{}, SE3{}, field(), Tag::What::field);
  const double t = 0.5 * kWallThickness;
  const double h = 0.5 * table_.wall_height;
  const double beyond = table_.goal_depth + kWallThickness;
  const Box side{{0.5 * table_.length + beyond, t, h}};
  for (const double s : ends()) {
    add_fixed(side, SE3(Vec3{0.0, s * (0.5 * table_.width + t), h}), wall(), Tag::What::wall);
  }
  for (const double s : ends()) add_goal(s);
  // A pane above the table, from wall to wall. lift_ball() ends a hop at the ceiling, but a foot
  // under the ball could carry it higher. If the tuning allows hops above the walls, balls leave
  // between the walls and the pane.
  constexpr double kCarried = 0.020;
  constexpr double kHalfThickness = 0.0025;
  const double under = tuning_.hop_ceiling + kCarried + 2.0 * table_.ball_radius;
  add_fixed(Box{{0.5 * table_.length, 0.5 * table_.width, kHalfThickness}},
            SE3(Vec3{0.0, 0.0, under + kHalfThickness}), {}, Tag::What::wall);
}

// An end wall as deep as the goal, with the opening, and the box behind it.
void TableWorld::add_goal(double side) {
  const double front = 0.5 * table_.length;
  const double depth = 0.5 * table_.goal_depth;
  const double x = side * (front + depth);
  const double post = 0.5 * table_.goal_width;
  const double flank = 0.5 * (0.5 * table_.width - post);
  const double h = 0.5 * table_.wall_height;
  for (const double s : ends()) {
    add_fixed(Box{{depth, flank, h}}, SE3(Vec3{x, s * (post + flank), h}), wall(), Tag::What::wall);
  }
  const double lintel = 0.5 * (table_.wall_height - table_.goal_height);
  add_fixed(Box{{depth, post, lintel}}, SE3(Vec3{x, 0.0, table_.goal_height + lintel}), wall(),
            Tag::What::wall);
  const double t = 0.5 * kWallThickness;
  add_fixed(Box{{t, 0.5 * table_.width, h}},
            SE3(Vec3{side * (front + table_.goal_depth + t), 0.0, h}), kGoalBox, Tag::What::wall);
  // A mat that stops a ball that scored. It begins where the whole ball has passed the line, so
  // that its edge deflects no rolling ball before the goal counts.
  const double mat = 0.5 * table_.goal_depth - table_.ball_radius;
  constexpr double kMatHeight = 0.0005;
  add_fixed(Box{{mat, post, 0.01}},
            SE3(Vec3{side * (front + table_.goal_depth - mat), 0.0, kMatHeight - 0.01}), kGoalBox,
            Tag::What::field);
}

// Each corner is the top face of a slab. Its plane passes through two points on the field's edges,
// one leg away from the corner, and the point corner_rise above the corner.
void TableWorld::add_corners() {
  const double leg = table_.corner_size;
  const double half_thickness = 0.03;
  for (const double sx : ends()) {
    for (const double sy : ends()) {
      const Vec3 corner{sx * 0.5 * table_.length, sy * 0.5 * table_.width, 0.0};
      const Vec3 foot = corner - 0.5 * leg * Vec3{sx, sy, 0.0};  // centre of the ramp's lower edge
      const Vec3 rise = corner + Vec3{0.0, 0.0, table_.corner_rise} - foot;
      const Vec3 up = (1.0 / vp::norm(rise)) * rise;
      const Vec3 along = (1.0 / std::sqrt(2.0)) * Vec3{-sx, sy, 0.0};
      Vec3 normal = cross(along, up);
      if (normal.z < 0.0) normal = -normal;
      const Vec3 y = cross(normal, along);
      const Vec3 centre = foot + 0.5 * rise - half_thickness * normal;
      add_fixed(Box{{0.5 * leg * std::sqrt(2.0), 0.5 * vp::norm(rise), half_thickness}},
                SE3(Mat3{along, y, normal}, centre), field(), Tag::What::field);
    }
  }
}

void TableWorld::add_ball() {
  const double r = table_.ball_radius;
  const double m = tuning_.ball_mass;
  const double i = 0.4 * m * r * r;
  vp::BodyDesc desc;
  desc.inertia = vp::Inertia(m, Vec3{i, i, i});
  desc.continuous = true;
  ball_ = must(world_.create_body(desc));
  vp::ColliderDesc shape;
  shape.shape = vp::Sphere{r};
  shape.material = vp::Material{tuning_.ball_friction, 0.0, 0.0};
  shape.filter = {kBallCategory, kTableCategory | kManCategory};
  shape.user_data = encode({Tag::What::ball});
  must(world_.add_collider(ball_, shape));
}

void TableWorld::add_rod(int rod) {
  const RodSpec& spec = table_.rods[rod];
  const CharacterBody& c = body_of(rod);
  inertias_[rod] = rod_inertia(table_, spec, c, tuning_);
  rods_[rod] = must(world_.create_articulation({rod_model(table_, spec, inertias_[rod], tuning_)}));
  const bool hinged = hinged_men(table_.layout);
  const SE3 T_link_table(transpose(kRodAxes), Vec3{});
  for (int i = 0; i < spec.men; ++i) {
    const int man = man_from_left(spec, i);
    const vp::BodyId body = world_.link_body(rods_[rod], hinged ? kFirstMan + i : kTurn);
    const Vec3 offset{0.0, hinged ? 0.0 : man_offset(spec, man), 0.0};  // in the link's frame
    const auto boxes = boxes_of(c);
    for (std::size_t part = 0; part < boxes.size(); ++part) {
      const Vec3 centre = boxes[part].centre + offset;
      vp::ColliderDesc desc;
      desc.shape = Box{boxes[part].half_extents};
      desc.T_body_shape = T_link_table * SE3(centre);
      desc.material = {tuning_.man_friction * c.friction,
                       std::min(1.0, tuning_.man_restitution * c.restitution), 0.0};
      desc.filter = {kManCategory, kBallCategory};
      desc.user_data = encode({Tag::What::man, static_cast<std::uint8_t>(rod),
                               static_cast<std::uint8_t>(man), static_cast<std::uint8_t>(part)});
      must(world_.add_collider(body, desc));
    }
  }
  drive(rod, {});
}

// --- rods ----------------------------------------------------------------------------------------

namespace {

vp::JointDrive joint_drive(const AxisDrive& d) {
  return {d.position, d.velocity, d.stiffness, d.damping, d.max_force};
}

}  // namespace

// If all men of a row match their hand, its drives are unchanged unless the drives of slide or hand
// change. Those depend only on the row's state and its target.
void TableWorld::drive(int rod, const RodTarget& target) {
  const RodInertia& inertia = inertias_[rod];
  const RodState& now = this->rod(rod);
  RowDrive& row = driven_[rod];
  const bool stays = row.at_hand && at_hand_[rod];
  if (stays && row.now_slide == now.slide && row.now_angle == now.angle && row.target == target)
    return;
  const AxisDrive slide = slide_drive(table_.rods[rod], inertia, now, target);
  const AxisDrive angle = angle_drive(inertia, now.angle, target);
  const bool same = stays && row.slide == slide && row.hand == angle;
  row = {target, now.slide, now.angle, slide, angle, at_hand_[rod]};
  if (same) return;
  const std::span<const double> q = world_.coordinates(rods_[rod]);
  std::array<vp::JointDrive, kFirstMan + kMaxMenOnRod> drives;  // uses q.size() of them
  const vp::JointDrive hand = joint_drive(row.hand);
  drives[kSlide] = joint_drive(row.slide);
  drives[kTurn] = hand;
  for (std::size_t man = kFirstMan; man < q.size(); ++man) {
    drives[man] =
        q[man] == now.angle ? hand : joint_drive(man_drive(inertia, q[man], now.angle, target));
  }
  must(world_.set_drives(rods_[rod], std::span(drives).first(q.size())));
}

// Every joint has one coordinate, so a link's index is also the index of its coordinate.
void TableWorld::read_rods() {
  const bool hinged = hinged_men(table_.layout);
  for (int rod = 0; rod < kRods; ++rod) {
    const std::span<const double> q = world_.coordinates(rods_[rod]);
    const std::span<const double> v = world_.velocities(rods_[rod]);
    const RodSpec& spec = table_.rods[rod];
    const RodState hand{q[kSlide], q[kTurn], v[kSlide], v[kTurn]};
    rod_states_[rod] = hand;
    at_hand_[rod] = true;
    for (int i = 0; i < spec.men; ++i) {
      man_states_[rod][i] = {hand.angle, hand.angle_rate};
      const int link = kFirstMan + i;
      if (!hinged || (q[link] == hand.angle && v[link] == hand.angle_rate)) continue;
      at_hand_[rod] = false;
    }
    for (int i = 0; i < spec.men && !at_hand_[rod]; ++i) {
      const int link = kFirstMan + i;
      man_states_[rod][man_from_left(spec, i)] = {q[link] - turns_ahead(q[link], hand.angle),
                                                  v[link]};
    }
  }
}

// A man who was blocked approaches his hand exponentially. Below the tolerances this function sets
// him to the hand's state, modulo full turns. From then on they move identically to the bit, and
// are computed once.
void TableWorld::join_hands() {
  constexpr double kAngle = 1e-9, kRate = 1e-7;  // [rad], [rad/s]; at the foot less than an atom
  bool joined = false;
  for (int rod = 0; rod < kRods; ++rod) {
    if (at_hand_[rod]) continue;
    const std::span<const double> q = world_.coordinates(rods_[rod]);
    const std::span<const double> v = world_.velocities(rods_[rod]);
    const double angle = q[kTurn], rate = v[kTurn];
    for (int man = kFirstMan; man < kFirstMan + table_.rods[rod].men; ++man) {
      if (q[man] == angle && v[man] == rate) continue;
      if (std::fabs(v[man] - rate) > kRate) continue;
      if (std::fabs(q[man] - turns_ahead(q[man], angle) - angle) > kAngle) continue;
      must(world_.set_joint_state(rods_[rod], man, 0, angle, rate));
      joined = true;
    }
  }
  if (joined) read_rods();
}

void TableWorld::set_rod(int rod, const RodState& state) {
  const double limit = table_.rods[rod].slide_limit;
  const double slide = std::clamp(state.slide, -limit, limit);
  must(world_.set_joint_state(rods_[rod], kSlide, 0, slide, state.slide_rate));
  must(world_.set_joint_state(rods_[rod], kTurn, 0, state.angle, state.angle_rate));
  for (int man = 0; man < table_.rods[rod].men; ++man) {
    set_man(rod, man, {state.angle, state.angle_rate});
  }
  read_rods();
}

void TableWorld::set_man(int rod, int man, const ManState& state) {
  if (!hinged_men(table_.layout)) return;
  const int link = kFirstMan + man_from_left(table_.rods[rod], man);
  must(world_.set_joint_state(rods_[rod], link, 0, state.angle, state.angle_rate));
  read_rods();
}

// --- ball ----------------------------------------------------------------------------------------

void TableWorld::read_ball() {
  const SE3 pose = world_.pose(ball_);
  const vp::se3 V = world_.velocity(ball_);
  ball_state_ = {pose, pose.rotate(V.v), pose.rotate(V.w)};
}

void TableWorld::set_ball(const Vec3& position, const Vec3& velocity) {
  must(world_.set_pose(ball_, SE3(position)));
  must(world_.set_velocity(ball_, {Vec3{}, velocity}));
  read_ball();
}

void TableWorld::set_ball(const BallState& state) {
  must(world_.set_pose(ball_, state.pose));
  must(world_.set_velocity(ball_,
                           {state.pose.unrotate(state.spin), state.pose.unrotate(state.velocity)}));
  read_ball();
}

void TableWorld::park_ball() {
  set_ball(Vec3{0.0, 0.0, 1.0}, Vec3{});
}

void TableWorld::keep_ball_in_goal() {
  const BallState now = ball();
  const vp::Vec3 p = now.pose.position();
  const double side = p.x < 0.0 ? -1.0 : 1.0;
  const double line = 0.5 * table_.length + table_.ball_radius + 1e-4;
  if (side * p.x >= line) return;
  vp::Vec3 v = now.velocity;
  if (side * v.x < 0.0) v.x = 0.0;
  set_ball({side * line, p.y, p.z}, v);
}

bool TableWorld::free_for_ball(const Vec3& position) const {
  constexpr double kAir = 0.001;
  found_.clear();
  // The caller keeps clear of walls and corners; the field is always touched.
  must(world_.overlapping(vp::Sphere{table_.ball_radius + kAir}, SE3(position), found_,
                          {.collision = {kBallCategory, kManCategory}}));
  return found_.empty();
}

// --- step ----------------------------------------------------------------------------------------

// Midway between two rods is a strip that feet hardly reach. There a force towards the nearer rod
// acts on the ball, as if the field sagged by a millimetre: a ball at rest rolls to where it can be
// played. The effect on a shot is negligible.
void TableWorld::let_field_sag() {
  const Vec3 ball = ball_state_.pose.position();
  const bool on_field =
      ball.z < table_.ball_radius + 0.001 && std::fabs(ball.y) < 0.5 * table_.width;
  if (!on_field) return;
  double nearest = table_.length;  // from ball to rod, signed
  for (const RodSpec& rod : table_.rods) {
    if (std::fabs(rod.x - ball.x) < std::fabs(nearest)) nearest = rod.x - ball.x;
  }
  const bool before_line = std::fabs(ball.x) < 0.5 * table_.length + table_.ball_radius;
  if (!before_line || std::fabs(nearest) < tuning_.sag_from) return;
  const double impulse = tuning_.ball_mass * tuning_.sag_acceleration * kTick;
  must(world_.apply_impulse(ball_, {std::copysign(impulse, nearest), 0.0, 0.0}, ball));
  read_ball();
}

vp::Expected<void> TableWorld::restore(std::span<const std::byte> bytes) {
  auto restored = world_.restore(bytes);
  if (!restored) return restored;
  driven_.fill({});
  read_rods();
  read_ball();
  return restored;
}

// Gives the ball this upward speed, limited so that the hop stays below the ceiling.
void TableWorld::lift_ball(double speed) {
  const vp::Vec3 position = ball().pose.position();
  const double up = ball().velocity.z;
  const double height = std::max(0.0, tuning_.hop_ceiling - (position.z - table_.ball_radius));
  const double max = std::sqrt(2.0 * tuning_.gravity * height);
  const double target = std::min(speed, max);
  if (target == up) return;
  must(world_.apply_impulse(ball_, {0.0, 0.0, tuning_.ball_mass * (target - up)}, position));
  read_ball();
}

// The paper (section 5) exaggerates the bounces of the ball off characters and ground for
// visibility.
// Ground: a ball that falls faster than hop_from rebounds with field_restitution of its speed. A
// slower bounce would be invisible; without it the ball becomes playable.
// Men: the upward speed that they give the ball is multiplied by hop_gain. A ball that arrives fast
// also hops. This depends on the ball's speed, not the foot's: a shot from rest stays low, a
// blocked one flies up. bounce_most and hop_ceiling bound the result. Nothing is added along the
// field.
void TableWorld::exaggerate_bounce(const Vec3& velocity_before) {
  const Tuning& t = tuning_;
  const double up = ball().velocity.z;
  double lift = up;
  for (const vp::ContactEvent& event : world_.contact_events()) {
    if (event.kind != vp::ContactEvent::Kind::hit) continue;
    const Tag other = ball_contact(event).other;
    if (other.what == Tag::What::field && event.approach_speed > t.hop_from) {
      lift = std::max(lift, t.field_restitution * event.approach_speed);
    }
    if (other.what != Tag::What::man) continue;
    const double sign = decode_tag(event.user_data_a).what == Tag::What::ball ? 1.0 : -1.0;
    const double came = sign * dot(velocity_before, event.normal) - t.bounce_from;
    const double bounce = body_of(other.rod).bounce;
    lift = std::max(lift, std::min(t.bounce_most, bounce * t.bounce_gain * came));
    const double given = up - std::max(0.0, velocity_before.z);
    if (given > 0.0) lift = std::max(lift, up + (bounce * t.hop_gain - 1.0) * given);
  }
  if (lift > 0.0) lift_ball(lift);
}

bool TableWorld::step() {
  let_field_sag();
  const Vec3 velocity_before = ball().velocity;
  status_ = must(world_.step(kTick));
  read_ball();
  exaggerate_bounce(velocity_before);
  read_rods();
  join_hands();
  return !status_.non_finite;
}

}  // namespace foosball
