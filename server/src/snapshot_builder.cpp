#include "snapshot_builder.h"

#include "wire/enums.h"

namespace server {
namespace {

std::array<float, 3> to_wire(const vp::Vec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

void put_pose(const vp::SE3& T_world_body, wire::PoseVelocity& out) {
  const vp::Quaternion q = vp::to_quaternion(T_world_body.rotation());
  out.position = to_wire(T_world_body.position());
  out.orientation = {static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z),
                     static_cast<float>(q.w)};
}

// A man's origin lies on the rod's axis, so that the rotation does not move it.
wire::ManState man_state(const foosball::TableSpec& table, int rod, int man,
                         const foosball::RodState& state) {
  wire::ManState out;
  out.rod = static_cast<std::uint8_t>(rod);
  out.man = static_cast<std::uint8_t>(man);
  put_pose(foosball::man_pose(table, rod, man, state), out.body);
  out.body.linear_velocity = {0.0f, static_cast<float>(state.slide_rate), 0.0f};
  out.body.angular_velocity = {0.0f, static_cast<float>(state.angle_rate), 0.0f};
  return out;
}

void put_men(const foosball::MatchView& view, wire::Snapshot& snapshot) {
  const foosball::TableSpec& table = foosball::table_spec(view.layout);
  snapshot.men.clear();
  for (int rod = 0; rod < foosball::kRods; ++rod) {
    for (int man = 0; man < table.rods[rod].men; ++man) {
      snapshot.men.push_back(
          man_state(table, rod, man, foosball::with_man(view.rods[rod], view.men[rod][man])));
    }
  }
}

void put_rods(const foosball::MatchView& view, wire::Snapshot& snapshot) {
  for (int rod = 0; rod < foosball::kRods; ++rod) {
    const foosball::RodState& state = view.rods[rod];
    wire::RodSnapshot& out = snapshot.rods[rod];
    out.slide = static_cast<float>(state.slide);
    out.angle = static_cast<float>(state.angle);
    out.slide_rate = static_cast<float>(state.slide_rate);
    out.angle_rate = static_cast<float>(state.angle_rate);
  }
}

void put_ball(const foosball::MatchView& view, wire::PoseVelocity& out) {
  put_pose(view.ball_pose, out);
  out.linear_velocity = to_wire(view.ball_velocity);
  out.angular_velocity = to_wire(view.ball_spin);
}

wire::ShotSnapshot to_wire(const foosball::Shot& shot) {
  return {static_cast<std::uint8_t>(shot.team), static_cast<std::uint8_t>(shot.rod),
          static_cast<std::uint8_t>(shot.man), static_cast<float>(shot.speed),
          static_cast<float>(shot.angle)};
}

void put_rules(const foosball::MatchView& view, wire::Snapshot& out) {
  out.mode = static_cast<std::uint8_t>(view.mode);
  out.rule_set = static_cast<std::uint8_t>(view.rule_set);
  for (int team = 0; team < foosball::kTeams; ++team) {
    out.sets[team] = static_cast<std::uint8_t>(view.sets[team]);
    out.time_outs_left[team] = static_cast<std::uint8_t>(view.time_outs_left[team]);
    out.computer[team] = view.computer[team];
  }
  out.time_out_seconds = static_cast<float>(view.time_out_seconds);
  out.time_out_team = static_cast<std::uint8_t>(view.time_out_team);
  out.timed = view.timed;
  out.golden_goal = view.golden_goal;
  out.seconds_left = static_cast<float>(view.seconds_left);
  out.next_server = static_cast<std::uint8_t>(view.next_server);
  out.fouled = view.fouled;
  out.last_foul = static_cast<std::uint8_t>(view.last_foul);
  out.last_foul_team = static_cast<std::uint8_t>(view.last_foul_team);
  out.possession_team = static_cast<std::uint8_t>(view.possession_team);
  out.possession_seconds = static_cast<float>(view.possession_seconds);
  out.attract = view.attract;
  out.rung = static_cast<std::uint8_t>(view.rung);
  out.feed_rod = static_cast<std::uint8_t>(view.feed_rod);
  out.feed_man = static_cast<std::uint8_t>(view.feed_man);
  out.ball_visible = view.ball_visible;
  out.last_goal = to_wire(view.last_goal);
  out.last_goal_own = view.last_goal_own;
  out.last_shot = to_wire(view.last_shot);
}

}  // namespace

void build_snapshot(const foosball::MatchView& view, wire::Snapshot& snapshot) {
  snapshot.tick = view.tick;
  snapshot.layout = static_cast<std::uint8_t>(view.layout);
  snapshot.screen = static_cast<std::uint8_t>(view.screen);
  snapshot.paused = view.paused;
  snapshot.ball_in_play = view.ball_in_play;
  for (int team = 0; team < foosball::kTeams; ++team) {
    snapshot.score[team] = static_cast<std::uint8_t>(view.score[team]);
    snapshot.character[team] = static_cast<std::uint8_t>(view.character[team]);
    snapshot.confirmed[team] = view.confirmed[team];
  }
  snapshot.last_scorer = static_cast<std::uint8_t>(view.last_scorer);
  snapshot.screen_seconds = static_cast<float>(view.screen_seconds);
  snapshot.play_seconds = static_cast<float>(view.play_seconds);
  put_rules(view, snapshot);
  put_ball(view, snapshot.ball);
  put_rods(view, snapshot);
  put_men(view, snapshot);
}

void put_replay_drivers(const wire::JournalTick& tick, wire::Snapshot& snapshot) {
  for (int rod = 0; rod < foosball::kRods; ++rod) {
    std::uint8_t& status = snapshot.rods[rod].status;
    if (tick.rods[rod].live) {
      status = wire::number(wire::RodStatus::live);
    } else if (status != wire::number(wire::RodStatus::absent)) {
      status = wire::number(wire::RodStatus::held);
    }
    snapshot.rods[rod].source = wire::number(wire::RodSource::replay);
  }
}

}  // namespace server
