#include "foosball/statistics.h"

#include <cmath>

#include "referee.h"

namespace foosball {
namespace {

// --- definitions (docs/match-runner.md) ----------------------------------------------------------

constexpr double kMovingSlide = 0.05;       // a faster rod counts as moving [m/s] ...
constexpr double kMovingSwing = 1.0;        // ... or one that rotates faster [rad/s]
constexpr double kSlideHysteresis = 0.005;  // smallest reversal of a hand [m]
constexpr double kSwingHysteresis = 0.1;    // [rad]
// A spin ends when the rod rotates back by this much [rad].
constexpr double kSpinHysteresis = 0.5;
// A foot closer to the ball touches it: the engine's contacts have a margin of about a millimetre.
constexpr double kTouchGap = 0.0015;       // [m]
constexpr std::uint64_t kTouchPause = 50;  // maximum pause within one touch of a man [ticks]
constexpr double kOwnDrive = 0.3;  // foot towards its own goal, for an own goal by swing [m/s]
constexpr double kStroke = 0.2;    // foot along the ball's direction of departure [m/s]
constexpr std::uint64_t kPassControl = 300;  // time limit to bring a pass under control [ticks]
constexpr double kPassSlowed = 0.4, kPassRest = 0.3;  // fraction of the arrival speed; [m/s]
constexpr std::uint64_t kShotFrom = 50;               // maximum delay after the touch [ticks]
constexpr double kShotOver = 0.75 * kShotSpeed;
constexpr std::uint64_t kSaveHolds = 500;  // time without a goal [ticks]
constexpr double kHop = 0.002;             // height at which the ball has left the ground [m]
constexpr double kDrop = 0.020;            // minimum height from which a bounce is compared [m]
constexpr double kNearGround = 0.010;      // maximum height of a bounce between two ticks [m]
constexpr std::uint64_t kNoRebound = 60;   // time on the ground after a bounce [ticks]

// True if the distance from the man's boxes to the ball's surface is at most kTouchGap.
bool touches(const TableSpec& table, int rod, int man, const CharacterBody& body,
             const RodState& state, const vp::Vec3& ball) {
  const vp::SE3 T_table_man = man_pose(table, rod, man, state);
  const vp::Vec3 p = vp::inverse_times(T_table_man, ball);
  const double limit = table.ball_radius + kTouchGap;
  for (const ManBox& box : boxes_of(body)) {
    const double x = std::max(0.0, std::fabs(p.x - box.centre.x) - box.half_extents.x);
    const double y = std::max(0.0, std::fabs(p.y - box.centre.y) - box.half_extents.y);
    const double z = std::max(0.0, std::fabs(p.z - box.centre.z) - box.half_extents.z);
    if (x * x + y * y + z * z <= limit * limit) return true;
  }
  return false;
}

int rod_nearest(const TableSpec& table, int team, double x) {
  int nearest = 0;
  double best = 1e9;
  for (int i = 0; i < kRods; ++i) {
    const double distance = std::fabs(table.rods[i].x - x);
    if (table.rods[i].team != team || distance >= best) continue;
    best = distance;
    nearest = i;
  }
  return nearest;
}

struct Collect {
  std::uint64_t* out;
  void sum(const char*, const std::uint64_t& count) { *out++ = count; }
  void max(const char*, const std::uint64_t& count) { *out++ = count; }
};

}  // namespace

// --- geometry ------------------------------------------------------------------------------------

double ground_height(const TableSpec& table, double x, double y) {
  const double inside = (0.5 * table.length - std::fabs(x)) + (0.5 * table.width - std::fabs(y));
  return inside < table.corner_size ? table.corner_rise * (1.0 - inside / table.corner_size) : 0.0;
}

// --- totals --------------------------------------------------------------------------------------

void Statistics::merge(const Statistics& other) {
  struct Merger {
    const std::uint64_t* from;
    void sum(const char*, std::uint64_t& count) { count += *from++; }
    void max(const char*, std::uint64_t& count) { count = std::max(count, *from++); }
  };
  static_assert(sizeof(Statistics) % sizeof(std::uint64_t) == 0);
  std::array<std::uint64_t, sizeof(Statistics) / sizeof(std::uint64_t)> counts{};
  Collect collect{counts.data()};
  visit(collect, other);
  Merger merger{counts.data()};
  visit(merger, *this);
}

// --- one tick ------------------------------------------------------------------------------------

void StatisticsObserver::observe(const MatchView& view, std::span<const Event> events,
                                 const RodTargets& targets) {
  ++now_;
  ++totals_.ticks;
  if (view.paused) return;
  if (view.screen == Screen::play) {
    begun_ = true;
    ++totals_.play_ticks;
    watch_hands(view, targets);
  } else {
    for (Rod& rod : rods_) rod.followed = false;
  }
  // In the tick of a goal the ball is no longer in play, but still at its last position.
  if (in_play_) watch_ball(view, events);
  note_events(view, events);
  in_play_ = view.ball_in_play;
  velocity_before_ = view.ball_velocity;
  men_before_ = view.men;
}

void StatisticsObserver::abandon() {
  if (begun_) ++totals_.undecided;
  if (in_play_) end_rally();
  const Statistics totals = totals_;
  const auto fastest = fastest_shots_;
  *this = StatisticsObserver{};
  totals_ = totals;
  fastest_shots_ = fastest;
}

void StatisticsObserver::begin_match() {
  abandon();
  fastest_shots_ = {};
}

// --- events --------------------------------------------------------------------------------------

void StatisticsObserver::note_events(const MatchView& view, std::span<const Event> events) {
  for (const Event& event : events) {
    switch (event.kind) {
      case EventKind::goal:
        note_goal(event.team);
        break;
      case EventKind::match_won:
        note_match_won(view, event.team);
        break;
      case EventKind::dead_ball:
        ++totals_.dead_balls;
        end_rally();
        break;
      case EventKind::ball_out:
        ++totals_.balls_out;
        end_rally();
        break;
      case EventKind::foul:
        ++totals_.fouls;
        break;
      case EventKind::match_drawn:
        abandon();
        break;
      case EventKind::serve:
        begin_rally(view, event);
        break;
      case EventKind::screen:
        if (event.value < static_cast<double>(Screen::play)) abandon();
        break;
      default:
        break;
    }
  }
  const auto& score = view.score;
  const int leader = score[0] == score[1] ? -1 : score[0] > score[1] ? 0 : 1;
  if (leader >= 0 && leader_ >= 0 && leader != leader_) ++totals_.lead_changes;
  if (leader >= 0) leader_ = leader;
}

void StatisticsObserver::begin_rally(const MatchView& view, const Event& serve) {
  const TableSpec& table = table_spec(view.layout);
  if (table.rods[rod_nearest(table, serve.team, view.ball_position.x)].line == Line::midfield) {
    server_ = serve.team;
    ++totals_.serves[serve.team];
  }
  touch_ = previous_touch_ = {};
  rally_changes_ = 0;
  shot_ = {};
  saver_ = -1;
  pass_open_ = false;
  meant_ = {};
  stuck_at_ = view.ball_position;
  stuck_ticks_ = unreachable_ticks_ = 0;
  airborne_ = falling_clean_ = false;
  bounced_from_ = 0.0;
}

void StatisticsObserver::end_rally() {
  end_shot();
  if (saver_ >= 0) ++totals_.saves[saver_];
  saver_ = -1;
  totals_.rally.add(static_cast<double>(rally_changes_));
  rally_changes_ = 0;
  touch_ = {};
}

void StatisticsObserver::note_goal(int scorer) {
  ++totals_.goals[scorer];
  if (server_ >= 0) {
    ++(scorer == server_ ? totals_.goals_of_server : totals_.goals_of_receiver)[server_];
  }
  server_ = -1;
  const int toucher = touch_.team;
  if (toucher >= 0 && toucher != scorer) {
    const double home = -attack_sign(toucher);
    const bool sped_up = home * touch_.departure_vx > home * touch_.arrival_vx;
    const bool swing = touch_.drive >= kOwnDrive && sped_up;
    // A shot on target that a defender deflects into the goal is not an own goal.
    if (swing) {
      ++totals_.own_goals_swing[toucher];
    } else if (!touch_.faced_shot) {
      ++totals_.own_goals_deflected[toucher];
    }
  }
  if (saver_ == opponent(scorer)) saver_ = -1;
  if (shot_.team == scorer) shot_.on_target = true;
  end_rally();
}

void StatisticsObserver::note_match_won(const MatchView& view, int team) {
  ++totals_.wins[team];
  totals_.length.add(view.play_seconds);
  begun_ = false;
  leader_ = -1;
}

// --- hands ---------------------------------------------------------------------------------------

bool StatisticsObserver::Reversals::update(double value, double hysteresis) {
  if (direction == 0) {
    if (std::fabs(value - extreme) < hysteresis) return false;
    direction = value > extreme ? 1 : -1;
    extreme = value;
    return false;
  }
  if (direction * (value - extreme) >= 0.0) {
    extreme = value;
    return false;
  }
  if (direction * (extreme - value) < hysteresis) return false;
  direction = -direction;
  extreme = value;
  return true;
}

void StatisticsObserver::watch_hands(const MatchView& view, const RodTargets& targets) {
  const TableSpec& table = table_spec(view.layout);
  std::array<std::size_t, kTeams> moving{};
  for (int i = 0; i < kRods; ++i) {
    Rod& rod = rods_[i];
    const RodTarget& hand = targets[i];
    if (!hand.live || !std::isfinite(hand.slide) || !std::isfinite(hand.angle)) {
      rod.followed = false;
      continue;
    }
    const RodState& state = view.rods[i];
    const bool moves =
        std::fabs(state.slide_rate) > kMovingSlide || std::fabs(state.angle_rate) > kMovingSwing;
    if (moves) ++moving[table.rods[i].team];
    ++totals_.hand_ticks[i];
    if (!rod.followed) {
      rod = {{hand.slide, 0}, {hand.angle, 0}, state.angle, {state.angle, 0}, true, hand.angle};
      continue;
    }
    rod.hand_angle_rate = (hand.angle - rod.hand_angle) / kTick;
    rod.hand_angle = hand.angle;
    if (rod.slide.update(hand.slide, kSlideHysteresis)) ++totals_.slide_reversals[i];
    if (rod.swing.update(hand.angle, kSwingHysteresis)) ++totals_.swing_reversals[i];
    if (rod.spin.update(state.angle, kSpinHysteresis)) rod.spin_from = state.angle;
    if (std::fabs(state.angle - rod.spin_from) >= 2.0 * vp::kPi) {
      ++totals_.spins[i];
      rod.spin_from = state.angle;
    }
  }
  for (int team = 0; team < kTeams; ++team) ++totals_.moving_ticks[team][moving[team]];
}

// --- the ball ------------------------------------------------------------------------------------

void StatisticsObserver::watch_ball(const MatchView& view, std::span<const Event> events) {
  ++totals_.ball_ticks;
  if (vp::norm(view.ball_velocity) < kStillSpeed) ++totals_.still_ticks;
  find_touches(view, events);
  if (touch_.team >= 0) ++totals_.possession_ticks[touch_.team];
  watch_pass(view);
  watch_shot(view);
  watch_height(view, events);
  watch_reach(view);
  watch_stuck(view);
  if (saver_ >= 0 && now_ - saved_at_ >= kSaveHolds) {
    ++totals_.saves[saver_];
    saver_ = -1;
  }
}

// Uses the match's hits, and for contacts too soft for a hit the distance of the men.
void StatisticsObserver::find_touches(const MatchView& view, std::span<const Event> events) {
  const TableSpec& table = table_spec(view.layout);
  touched_now_ = false;
  for (const Event& event : events) {
    if (event.kind == EventKind::man_hit) touch(view, event.rod, event.man);
  }
  for (int rod = 0; rod < kRods && !touched_now_; ++rod) {
    const RodSpec& spec = table.rods[rod];
    const CharacterBody& body = view.bodies[spec.team];
    const double reach = body.foot_reach + table.ball_radius + kTouchGap;
    if (std::fabs(view.ball_position.x - spec.x) > reach) continue;
    const int man = man_nearest(spec, view.ball_position.y - view.rods[rod].slide);
    const double beside = view.ball_position.y - man_offset(spec, man) - view.rods[rod].slide;
    if (std::fabs(beside) > reach) continue;
    const RodState state = with_man(view.rods[rod], view.men[rod][man]);
    if (touches(table, rod, man, body, state, view.ball_position)) {
      touch(view, rod, man);
    }
  }
}

void StatisticsObserver::touch(const MatchView& view, int rod, int man) {
  touched_now_ = true;
  const TableSpec& table = table_spec(view.layout);
  const bool same = touch_.rod == rod && touch_.man == man && now_ - touch_.last <= kTouchPause;
  if (!same) begin_touch(view, rod, man);
  touch_.last = now_;
  // Velocity of the foot at the ball's position.
  const RodState state = with_man(view.rods[rod], view.men[rod][man]);
  const double dx = view.ball_position.x - table.rods[rod].x;
  const double dz = view.ball_position.z - table.rod_height;
  const vp::Vec3 foot{state.angle_rate * dz, state.slide_rate, -state.angle_rate * dx};
  const double speed = vp::norm(view.ball_velocity);
  touch_.departure_vx = view.ball_velocity.x;
  // The ball's impact on a resting foot does not count as a swing.
  const double swung = same ? rods_[rod].hand_angle_rate : men_before_[rod][man].angle_rate;
  touch_.drive = std::max(touch_.drive, -attack_sign(touch_.team) * swung * dz);
  if (speed > 0.0) touch_.stroke = std::max(touch_.stroke, dot(foot, view.ball_velocity) / speed);
  rods_[rod].spin_from = view.rods[rod].angle;
}

void StatisticsObserver::meant(const PlayedPass& pass, Layout layout) {
  if (pass.to_rod < 0) return;
  meant_ = pass;
  ++totals_.passes_meant[table_spec(layout).rods[pass.from_rod].team];
}

void StatisticsObserver::begin_touch(const MatchView& view, int rod, int man) {
  const int team = table_spec(view.layout).rods[rod].team;
  previous_touch_ = touch_;
  const bool faces_shot = shot_.team == opponent(team) && shot_.on_target;
  if (faces_shot) {
    saver_ = team;
    saved_at_ = now_;
  } else if (saver_ >= 0) {
    ++totals_.saves[saver_];
    saver_ = -1;
  }
  end_shot();
  if (previous_touch_.team == opponent(team)) ++rally_changes_;
  touch_ = {};
  touch_.team = team;
  touch_.rod = rod;
  touch_.man = man;
  touch_.since = now_;
  touch_.faced_shot = faces_shot;
  touch_.arrival_vx = velocity_before_.x;
  touch_.arrival_speed = vp::norm(velocity_before_);
  ++totals_.touches[team];
  if (meant_.to_rod >= 0 && rod != meant_.from_rod) {
    if (rod == meant_.to_rod && man == meant_.to_man) ++totals_.passes_arrived[team];
    meant_ = {};
  }
  const Touch& from = previous_touch_;
  const bool other_man = from.rod != rod || from.man != man;
  pass_open_ =
      from.team == team && other_man && from.stroke >= kStroke && now_ - from.last >= kTouchPause;
}

// A pass has arrived when its receiver controls the ball, or plays it on.
void StatisticsObserver::watch_pass(const MatchView& view) {
  if (!pass_open_) return;
  const double slow = std::max(kPassSlowed * touch_.arrival_speed, kPassRest);
  const bool controlled = vp::norm(view.ball_velocity) < slow;
  if (controlled || touch_.stroke >= kStroke) ++totals_.passes[touch_.team];
  if (controlled || touch_.stroke >= kStroke || now_ - touch_.since > kPassControl) {
    pass_open_ = false;
  }
}

void StatisticsObserver::watch_shot(const MatchView& view) {
  const TableSpec& table = table_spec(view.layout);
  const vp::Vec3& v = view.ball_velocity;
  const double speed = vp::norm(v);
  if (shot_.team < 0) {
    const bool forward = touch_.team >= 0 && attack_sign(touch_.team) * v.x > 0.5 * speed;
    if (!forward || speed < kShotSpeed || now_ - touch_.last > kShotFrom) return;
    shot_.team = touch_.team;
  }
  if (speed < kShotOver) return end_shot();
  shot_.peak = std::max(shot_.peak, speed);
  const double ahead = attack_sign(shot_.team) * v.x;
  const double to_line = 0.5 * table.length - attack_sign(shot_.team) * view.ball_position.x;
  const double y = ahead > 0.0 ? view.ball_position.y + v.y * to_line / ahead : table.width;
  shot_.on_target = std::fabs(y) < 0.5 * table.goal_width - table.ball_radius;
}

void StatisticsObserver::end_shot() {
  if (shot_.team < 0) return;
  ++totals_.shots[shot_.team];
  if (shot_.on_target) ++totals_.shots_on_target[shot_.team];
  totals_.shot_speed.add(shot_.peak);
  fastest_shots_[shot_.team] = std::max(fastest_shots_[shot_.team], shot_.peak);
  shot_ = {};
}

// Counts hops, and compares the heights before and after a bounce on the ground without other
// contacts.
void StatisticsObserver::watch_height(const MatchView& view, std::span<const Event> events) {
  const TableSpec& table = table_spec(view.layout);
  const vp::Vec3& ball = view.ball_position;
  if (std::fabs(ball.x) > 0.5 * table.length) return;
  const double height = ball.z - table.ball_radius - ground_height(table, ball.x, ball.y);
  bool met = touched_now_;
  for (const Event& event : events) met = met || event.kind == EventKind::wall_hit;
  if (met) {
    falling_clean_ = false;
    bounced_from_ = 0.0;
  }
  rebound_ = std::max(rebound_, height);
  const bool bounced =
      velocity_before_.z < 0.0 && view.ball_velocity.z > 0.0 && height < kNearGround && !met;
  if (airborne_ && (height <= kHop || bounced)) {
    totals_.hop_height.add(peak_);
    if (bounced_from_ > 0.0) totals_.bounce_ratio.add(peak_ / bounced_from_);
    bounced_from_ = falling_clean_ && peak_ >= kDrop ? peak_ : 0.0;
    landed_at_ = now_;
    rebound_ = 0.0;
    airborne_ = false;
  }
  if (height > kHop) {
    if (!airborne_ || height > peak_) {
      peak_ = height;
      falling_clean_ = !met;
    }
    airborne_ = true;
  } else if (bounced_from_ > 0.0 && now_ - landed_at_ >= kNoRebound) {
    totals_.bounce_ratio.add(rebound_ / bounced_from_);
    bounced_from_ = 0.0;
  }
}

void StatisticsObserver::watch_reach(const MatchView& view) {
  const TableSpec& table = table_spec(view.layout);
  for (int rod = 0; rod < kRods; ++rod) {
    if (!can_reach(table, rod, view.bodies[table.rods[rod].team], view.ball_position)) continue;
    unreachable_ticks_ = 0;
    return;
  }
  ++totals_.unreachable_ticks;
  totals_.longest_unreachable_ticks =
      std::max(totals_.longest_unreachable_ticks, ++unreachable_ticks_);
}

// The same criterion as the referee's (BallWatch): a touch restarts the time, but keeps the
// reference point.
void StatisticsObserver::watch_stuck(const MatchView& view) {
  if (vp::norm(view.ball_position - stuck_at_) > kStuckDistance) {
    stuck_at_ = view.ball_position;
    stuck_ticks_ = 0;
  }
  ++stuck_ticks_;
  if (touched_now_) stuck_ticks_ = 0;
  totals_.longest_stuck_ticks = std::max(totals_.longest_stuck_ticks, stuck_ticks_);
}

}  // namespace foosball
