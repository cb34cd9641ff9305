// The ball and the referee: touches, shots, goals, fouls, and restarts of play. Article numbers
// refer to the ITSF rule book (2016). docs/rules.md says what is judged and what differs.
#include <algorithm>
#include <bit>
#include <cmath>

#include "foosball/reach.h"
#include "match_impl.h"

namespace foosball {
namespace {

// Below this impulse the ball's velocity changes by less than about 0.1 m/s: too little to hear or
// feel.
constexpr double kMinHit = 0.003;  // [N s]
// A ball that a defender touches within this time after an attacker is a deflected shot.
constexpr double kDeflection = 0.3;  // [s]
// A hand that is faster at the rod's stop jars the table (16.3).
constexpr double kSlam = 2.5;           // [m/s]
constexpr int kJarsUntilTechnical = 2;  // (16.4)

Event shot_event(EventKind kind, const Shot& shot, const vp::Vec3& ball) {
  return {.kind = kind,
          .team = static_cast<std::uint8_t>(shot.team),
          .rod = static_cast<std::uint8_t>(shot.rod),
          .man = static_cast<std::uint8_t>(shot.man),
          .value = shot.speed,
          .point = ball,
          .angle = shot.angle};
}

Shot shot_by(const TableSpec& table, const Touch& touch, const vp::Vec3& velocity) {
  const int team = table.rods[touch.rod].team;
  const double s = attack_sign(team);
  return {team, touch.rod, touch.man, vp::norm(velocity),
          vp::arc_tangent(s * velocity.y, s * velocity.x)};
}

}  // namespace

// --- contacts of the ball ------------------------------------------------------------------------

void Match::Impl::watch_ball(const vp::Vec3& velocity_before) {
  if (!state.ball_in_play) return;
  note_contacts(velocity_before);
  note_shot();
  judge_ball();
}

void Match::Impl::note_contacts(const vp::Vec3& velocity_before) {
  // A ball pressed against an object has repeated contact events; they are not hits.
  const vp::Vec3 change = world->ball().velocity - velocity_before;
  const bool perceptible = state.tuning.ball_mass * vp::norm(change) >= kMinHit;
  for (const vp::ContactEvent& event : world->contacts()) {
    const BallContact contact = ball_contact(event);
    const Tag& other = contact.other;
    const bool man = other.what == Tag::What::man;
    const int team = man ? table().rods[other.rod].team : 0;
    if (man) {
      state.touching.set(other.rod, other.man, other.part,
                         contact.kind != vp::ContactEvent::Kind::end);
      note_touch(other.rod, other.man);
    }
    if (!perceptible || contact.kind != vp::ContactEvent::Kind::hit) continue;
    const EventKind kind = man                             ? EventKind::man_hit
                           : other.what == Tag::What::wall ? EventKind::wall_hit
                                                           : EventKind::field_hit;
    emit(Event{.kind = kind,
               .team = static_cast<std::uint8_t>(team),
               .rod = other.rod,
               .man = other.man,
               .value = contact.impulse,
               .point = contact.point});
  }
}

void Match::Impl::note_touch(int rod, int man) {
  const int team = table().rods[rod].team;
  state.touched |= std::uint64_t{1} << (rod * kMaxMenOnRod + man);
  state.last_toucher = team;
  state.touch = {rod, man, state.tick, true};
  state.touch_of[team] = state.touch;
  state.shot_pending = true;
}

// After the last man has lost contact, the ball's speed decides whether it is a shot.
void Match::Impl::note_shot() {
  if (!state.shot_pending || state.touching.any()) return;
  state.shot_pending = false;
  const BallState ball = world->ball();
  if (vp::norm(ball.velocity) < kShotSpeed) return;
  state.last_shot = shot_by(table(), state.touch, ball.velocity);
  emit(shot_event(EventKind::shot, state.last_shot, ball.pose.position()));
}

// --- conduct of the rods -------------------------------------------------------------------------

void Match::Impl::watch_rods(const RodTargets& hands) {
  for (int rod = 0; rod < kRods; ++rod) {
    const bool touches = state.ball_in_play && state.touch.any && state.touch.rod == rod &&
                         state.touch.tick == state.tick;
    state.spins[rod].update(world->rod(rod).angle, touches);
    if (rules().jarring && hands[rod].live) judge_jarring(rod, hands[rod]);
  }
}

// (16, 17) The simulated table does not shake. The referee judges the hand that drives a rod
// against its stop while the opponent has the ball. The opponent's time of possession restarts;
// from the third offence on, the opponent gets a shot.
void Match::Impl::judge_jarring(int rod, const RodTarget& hand) {
  const RodSpec& spec = table().rods[rod];
  const auto holder = state.watch.rod();
  const bool beyond = std::fabs(hand.slide) > spec.slide_limit;
  const bool slams = beyond && !state.beyond[rod] &&
                     (hand.slide < 0.0 ? -hand.slide_rate : hand.slide_rate) > kSlam;
  state.beyond[rod] = beyond;
  if (!slams || !state.ball_in_play || !state.watch.in_reach() || !holder) return;
  if (table().rods[*holder].team == spec.team) return;
  int& jars = state.tally.jars[spec.team];
  jars = std::min(jars + 1, kMaxCount);
  if (jars <= kJarsUntilTechnical) {
    foul(Foul::jarring, spec.team);
    state.watch.restart_possession();
  } else {
    foul(Foul::technical, spec.team);
    serve_from(rod_of(opponent(spec.team), Line::attack), kServeDelay);
  }
}

void Match::Impl::foul(Foul reason, int team) {
  state.fouled = true;
  state.last_foul = reason;
  state.last_foul_team = team;
  emit(EventKind::foul, team, static_cast<double>(reason));
}

// --- judging the ball ----------------------------------------------------------------------------

void Match::Impl::judge_ball() {
  const vp::Vec3 ball = world->ball().pose.position();
  if (const auto scorer = goal_by(table(), ball)) return judge_goal(*scorer);
  if (state.ball_in_goal) return;     // under review; the ball stays in the goal
  if (out_of_table(table(), ball)) {  // (7.3)
    emit(EventKind::ball_out, state.last_toucher);
    if (mode() == Mode::training) return serve_again();
    return serve_from(rod_of(opponent(state.last_toucher), Line::defence), kServeDelay);
  }
  if (judge_spin()) return;
  judge_possession();
}

// (15.1) Play stops when a spinning rod has struck the ball. The opponent could choose, and here
// always serves.
bool Match::Impl::judge_spin() {
  if (rules().spin != SpinRule::loss || !state.touch.any) return false;
  if (!state.spins[state.touch.rod].spun()) return false;
  const int team = table().rods[state.touch.rod].team;
  foul(Foul::spin, team);
  serve_from(rod_of(opponent(team), Line::midfield), kServeDelay);
  return true;
}

void Match::Impl::judge_possession() {
  const BallState ball = world->ball();
  BallWatch::Sight sight{.ball = ball.pose.position(), .velocity = ball.velocity};
  sight.rods_in_reach = rods_in_reach(table(), view.bodies, sight.ball);
  for (int team = 0; team < kTeams; ++team) {
    sight.absent[team] =
        mode() != Mode::training && state.absent_ticks[team] >= to_ticks(rules().still_seconds);
  }
  sight.touched = state.touching.any() || (state.touch.any && state.touch.tick == state.tick);
  const auto verdict = state.watch.update(table(), rules(), sight);
  if (verdict == BallWatch::Verdict::alive) return;
  if (mode() == Mode::training) return serve_again();
  if (verdict == BallWatch::Verdict::dead) {
    emit(EventKind::dead_ball);
    return serve_from(rod_for_dead_ball(table(), sight.ball.x, state.last_server), kServeDelay);
  }
  const RodSpec& holder = table().rods[*state.watch.rod()];
  foul(Foul::possession, holder.team);
  serve_from(rod_after_possession(table(), holder.team, holder.line), kServeDelay);
}

// The man who gets the credit for a goal of the team: its last toucher, if a defender only
// deflected his shot; otherwise the last toucher of the ball.
Touch Match::Impl::credited(int scorer) const {
  const Touch& last = state.touch;
  const Touch& theirs = state.touch_of[scorer];
  if (!last.any || table().rods[last.rod].team == scorer) return last;
  const bool deflected = theirs.any && last.tick - theirs.tick <= to_ticks(kDeflection);
  return deflected ? theirs : last;
}

// A ball in the goal scores at once, unless it may come from a spin (15).
void Match::Impl::judge_goal(int scorer) {
  if (state.served && std::popcount(state.touched) < 2) {  // (4.2.2)
    foul(Foul::serve, state.last_server);
    return serve_from(rod_of(opponent(state.last_server), Line::midfield), kServeDelay);
  }
  const Touch by = credited(scorer);
  const SpinWatch& spin = state.spins[by.rod];
  const bool own = by.any && table().rods[by.rod].team != scorer;
  if (rules().spin == SpinRule::allowed || own || !by.any) return score_goal(scorer, by);
  state.ball_in_goal = true;
  if (spin.spun()) {
    foul(Foul::spin, scorer);
    const Line line = rules().spin == SpinRule::loss ? Line::midfield : Line::defence;
    return serve_from(rod_of(opponent(scorer), line), kServeDelay);
  }
  if (!spin.follows_through() || ++state.review_ticks > to_ticks(kReview)) score_goal(scorer, by);
}

void Match::Impl::score_goal(int scorer, const Touch& by) {
  const BallState ball = world->ball();
  int& goals = state.tally.score[scorer];
  goals = std::min(goals + 1, kMaxScore);
  state.last_scorer = scorer;
  state.last_goal = shot_by(table(), by, ball.velocity);
  // The ball came to rest during the review: use the shot's speed.
  if (state.review_ticks > 0) state.last_goal.speed = state.last_shot.speed;
  state.last_goal_own = by.any && state.last_goal.team != scorer;
  state.ball_in_play = false;
  state.ball_in_goal = true;
  state.fouled = false;
  Event goal = shot_event(EventKind::goal, state.last_goal, ball.pose.position());
  goal.team = static_cast<std::uint8_t>(scorer);
  goal.own = state.last_goal_own;
  emit(goal);
  if (mode() == Mode::training) return enter(Screen::ceremony);
  const auto winner =
      foosball::winner(rules(), state.tally.score, last_set(), state.tally.golden_goal);
  if (winner) return finish_set(*winner);
  enter(Screen::ceremony);
}

void Match::Impl::finish_set(int winner) {
  state.last_scorer = winner;
  if (++state.tally.sets[winner] >= rules().sets_to_win) {
    emit(EventKind::match_won, winner);
    return enter(Screen::end);
  }
  emit(EventKind::set_won, winner);
  state.tally.set_over = true;
  enter(Screen::ceremony);
}

void Match::Impl::finish_undecided() {
  emit(EventKind::match_drawn);
  enter(Screen::end);
}

// --- putting the ball in play --------------------------------------------------------------------

void Match::Impl::serve_from(int rod, double delay, int man) {
  if (mode() == Mode::training) {  // always to the chosen man
    rod = state.feed_rod;
    man = state.feed_man;
  }
  state.ball_in_play = false;
  state.ball_in_goal = false;
  state.ball_parked = true;
  state.serve_rod = rod;
  state.serve_man = man;
  state.serve_in = to_ticks(delay);
  state.serve_waits = 0;
}

// Training: serves to the chosen man.
void Match::Impl::serve_again() {
  serve_from(state.feed_rod, kServeDelay, state.feed_man);
}

// Puts the ball in front of a man once a place is free of men. A team that blocks every place loses
// the ball.
void Match::Impl::put_in_play() {
  const RodSpec& rod = table().rods[state.serve_rod];
  const int man = state.serve_man >= 0 && state.serve_man < rod.men ? state.serve_man
                                                                    : middle_man(state.serve_rod);
  vp::Vec3 position;
  if (!find_position(state.serve_rod, man, position)) {
    if (++state.serve_waits < to_ticks(kServeWait)) return;
    foul(Foul::serve, rod.team);
    return serve_from(rod_of(opponent(rod.team), Line::midfield), kServeDelay);
  }
  world->set_ball(position, vp::Vec3{});
  state.ball_in_play = true;
  state.ball_parked = false;
  state.ball_in_goal = false;
  state.served = rod.line == Line::midfield && mode() != Mode::training;
  if (rod.line == Line::midfield) state.last_server = rod.team;
  state.last_toucher = rod.team;
  state.touched = 0;
  state.touching.clear();
  state.touch = {};
  state.touch_of = {};
  state.shot_pending = false;
  state.review_ticks = 0;
  state.watch.reset(position);
  emit(Event{.kind = EventKind::serve,
             .team = static_cast<std::uint8_t>(rod.team),
             .rod = static_cast<std::uint8_t>(state.serve_rod),
             .man = static_cast<std::uint8_t>(man),
             .point = position});
}

bool Match::Impl::find_position(int rod_index, int man, vp::Vec3& position) {
  const RodSpec& rod = table().rods[rod_index];
  // Offsets to try: first further from the rod, then to the side.
  constexpr double kFurther[] = {0.0, 0.008, 0.016};
  constexpr double kBeside[] = {0.0, 0.03, -0.03, 0.06, -0.06};
  const double first =
      rod.line == Line::midfield ? state.tuning.serve_ahead : state.tuning.restart_ahead;
  const double forward = attack_sign(rod.team);
  const double slide = world->rod(rod_index).slide;
  for (const double beside : kBeside) {
    for (const double further : kFurther) {
      const double ahead = first + std::copysign(further, first);
      position = {rod.x + forward * ahead, man_offset(rod, man) + slide + forward * beside,
                  table().ball_radius};
      const double to_wall = 0.5 * table().width - table().ball_radius - 0.002;
      if (std::fabs(position.y) <= to_wall && world->free_for_ball(position)) return true;
    }
  }
  return false;
}

}  // namespace foosball
