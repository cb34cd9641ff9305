// The table as a physical world: field, walls, goals, corners, ball, and eight rows of men. Each
// row is an articulation driven by bounded forces: men on a rod, or each man on a hinge at his
// shoulder (hinged_men()). It does not know scores and screens.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "foosball/match.h"
#include "foosball/rod_motion.h"
#include "foosball/tuning.h"
#include "vphysics/world.h"

namespace foosball {

// The role of a collider on the table; stored as the collider's user data.
struct Tag {
  enum class What : std::uint8_t { ball, field, wall, man } what;
  std::uint8_t rod = 0, man = 0, part = 0;  // of a man; part indexes boxes_of()
};
std::uint64_t encode(const Tag& tag);
Tag decode_tag(std::uint64_t user_data);

struct BallState {
  vp::SE3 pose;
  vp::Vec3 velocity, spin;  // world
};

// A contact from the ball's point of view.
struct BallContact {
  Tag other;
  vp::ContactEvent::Kind kind;
  double impulse;
  vp::Vec3 point;
};
BallContact ball_contact(const vp::ContactEvent& event);

class TableWorld {
 public:
  TableWorld(const TableWorld&) = delete;
  TableWorld& operator=(const TableWorld&) = delete;

  // All rods at slide 0, angle 0; the ball is parked. Preconditions: each body is in its ranges.
  //
  // Symmetry: the engine solves contacts in the order in which their colliders were created. This
  // affects the last bits when the ball touches two things at once. So the world is built in the
  // order of the team `first`: its side before the other's, its rods in order from its goal, the
  // men of each rod from the player's left. A world with the other team as `first`, and with
  // characters, targets and ball rotated by half a turn about z, moves exactly like this one,
  // rotated.
  TableWorld(Layout layout, const TeamBodies& bodies, int first = 0, const Tuning& tuning = {});
  // Builds the same world in kParts parts, one per call of build_part(), for callers that cannot
  // spend the total time at once. Precondition of every other call: is_built().
  struct InParts {};
  TableWorld(InParts, Layout layout, const TeamBodies& bodies, int first, const Tuning& tuning);
  static constexpr int kParts = 1 + kRods;  // the table, and each row of men
  void build_part();
  bool is_built() const { return parts_ == kParts; }

  const TableSpec& table() const { return table_; }
  int first() const { return first_; }
  const Tuning& tuning() const { return tuning_; }

  // Drives a rod towards a target. Preconditions: finite, within the slide limit.
  void drive(int rod, const RodTarget& target);
  const RodState& rod(int rod) const { return rod_states_[rod]; }
  const ManStates& men() const { return man_states_; }
  // Sets a rod and all its men. Clamps a slide that is slightly beyond the stop.
  void set_rod(int rod, const RodState& state);
  void set_man(int rod, int man, const ManState& state);  // one man alone, if he is hinged

  const BallState& ball() const { return ball_state_; }
  void set_ball(const vp::Vec3& position, const vp::Vec3& velocity);
  void set_ball(const BallState& state);
  // Moves the ball away from all objects, at rest, for this step.
  void park_ball();
  // Keeps the centre of a ball in the goal at least one radius beyond the goal line.
  void keep_ball_in_goal();
  // True if no man would touch a ball here. The caller keeps clear of walls and corners.
  bool free_for_ball(const vp::Vec3& position) const;

  // One kTick. Returns false if the world had to stop a body whose values were out of range.
  bool step();
  // All contacts of the ball in the last step, read in place, so none is lost.
  std::span<const vp::ContactEvent> contacts() const { return world_.contact_events(); }
  const vp::StepStatus& status() const { return status_; }
  const vp::StepCounters& counters() const { return world_.counters(); }

  void snapshot(std::vector<std::byte>& bytes) const { world_.snapshot(bytes); }
  std::uint64_t state_hash() const { return world_.state_hash(); }
  vp::Expected<void> restore(std::span<const std::byte> bytes);

 private:
  void add_fixed(const vp::Shape& shape, const vp::SE3& T_world_shape, const vp::Material& material,
                 Tag::What what);
  vp::Material field() const;
  vp::Material wall() const;
  void add_field_and_walls();
  void add_goal(double side);
  // Signs of x or y; first the side of the team `first`.
  std::array<double, 2> ends() const { return {-attack_sign(first_), attack_sign(first_)}; }
  void add_corners();
  void add_ball();
  void add_rod(int rod);
  const CharacterBody& body_of(int rod) const { return bodies_[table_.rods[rod].team]; }
  void let_field_sag();
  void read_rods();
  void join_hands();
  void read_ball();
  void exaggerate_bounce(const vp::Vec3& velocity_before);
  void lift_ball(double speed);

  const TableSpec& table_;
  int first_;
  int parts_ = 0;  // number built
  Tuning tuning_;
  TeamBodies bodies_;
  vp::World world_;
  vp::BodyId fixed_;
  vp::BodyId ball_;
  std::array<vp::ArticulationId, kRods> rods_{};
  std::array<RodInertia, kRods> inertias_{};
  std::array<RodState, kRods> rod_states_{};  // cached once per step
  ManStates man_states_{};
  std::array<bool, kRods> at_hand_{};  // all men rotate exactly like the hand, to the bit
  struct RowDrive {
    RodTarget target;
    double now_slide, now_angle;
    AxisDrive slide, hand;
    bool at_hand = false;  // the men have the hand's drive; false also: not known, after restore()
  };
  std::array<RowDrive, kRods> driven_{};  // as set in the world
  BallState ball_state_;                  // cached after each change
  mutable std::vector<vp::ColliderId> found_;
  vp::StepStatus status_;
};

}  // namespace foosball
