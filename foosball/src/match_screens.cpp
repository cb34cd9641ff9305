// The screens and the modes, and the transitions between them.
#include <algorithm>
#include <utility>

#include "match_impl.h"
#include "random.h"

namespace foosball {
namespace {

// A push right after the goal is the end of the shot, not a request to continue.
constexpr double kCeremonyAtLeast = 0.5;  // [s]

}  // namespace

void Match::Impl::run_screen() {
  count_tick(state.screen_ticks);
  switch (state.screen) {
    case Screen::logo:
    case Screen::selection:
      break;
    case Screen::play:
      run_play();
      break;
    case Screen::ceremony:
      if (state.screen_ticks >= to_ticks(rules().ceremony_seconds)) {
        start_play(opponent(state.last_scorer));
      }
      break;
    case Screen::end:
      if (state.screen_ticks >= to_ticks(rules().end_seconds)) go_on_after_end();
      break;
  }
}

void Match::Impl::run_play() {
  if (state.time_out_left > 0) return run_time_out();
  count_tick(state.play_ticks);
  count_tick(state.tally.set_ticks);
  const std::uint64_t limit = to_ticks(rules().match_seconds);
  const bool time_over = limit > 0 && state.tally.set_ticks >= limit && !state.ball_in_goal;
  if (time_over && !state.tally.golden_goal && mode() != Mode::training) {
    if (const auto winner = foosball::winner(rules(), state.tally.score, last_set(), true)) {
      return finish_set(*winner);
    }
    if (!rules().golden_goal) return finish_undecided();
    state.tally.golden_goal = true;
  }
  if (state.ball_in_play) return;
  if (state.serve_in > 0) {
    --state.serve_in;
  } else {
    put_in_play();
  }
}

// Serves to the team that pushed; if a computer plays it, to the person's team.
void Match::Impl::begin_training(int team) {
  state.confirmed = {true, true};
  if (state.feed_man < 0)
    state.feed_rod = rod_of(state.computer[team] ? person() : team, Line::attack);
}

// (9.1) A time-out ends after its time, or when both teams have pushed.
void Match::Impl::run_time_out() {
  --state.time_out_left;
  if (state.ready[0] && state.ready[1]) state.time_out_left = 0;
}

// (9) Between balls either team may request a time-out; during play only the team with the ball.
// (10) Afterwards the rod that had the ball restarts play.
void Match::Impl::ask_time_out(int team) {
  if (state.screen != Screen::play || state.time_out_left > 0 || state.attract ||
      state.ball_in_goal) {
    return;
  }
  const auto holder = state.watch.rod();
  const bool has_ball =
      state.ball_in_play && state.watch.in_reach() && holder && table().rods[*holder].team == team;
  int& taken = state.tally.time_outs[team];
  if (state.ball_in_play && !has_ball) return foul(Foul::time_out, team);  // (9.6.1)
  if (taken >= rules().time_outs) {                                        // (9.8)
    foul(Foul::time_out, team);
    if (has_ball) serve_from(rod_of(opponent(team), Line::midfield), kServeDelay);
    return;
  }
  ++taken;
  state.time_out_left = to_ticks(rules().time_out_seconds);
  state.time_out_team = team;
  state.ready = {state.computer[0], state.computer[1]};
  if (has_ball) serve_from(*holder, kServeDelay);
  reset_gestures();
  emit(EventKind::time_out, team);
}

void Match::Impl::feed(int team, int value) {
  if (mode() != Mode::training || value >= kFeedValues) return;
  const int rod = rod_of(team, static_cast<Line>(value / 8));
  const int man = value % 8;
  if (man >= table().rods[rod].men) return;
  feed_to(rod, man);
}

void Match::Impl::feed_to(int rod, int man) {
  state.feed_rod = rod;
  state.feed_man = man;
  if (state.screen == Screen::play) serve_again();
}

// Chooses the man who is served in training with the rods alone: turning a rod after a goal moves
// the serve there; forward to the next man, back to the previous one. The end of a shot's swing
// does not count.
void Match::Impl::feed_by_turn(int rod, int turn) {
  const bool between =
      state.screen == Screen::ceremony && state.screen_ticks >= to_ticks(kCeremonyAtLeast);
  if (mode() != Mode::training || !between) return;
  const int men = table().rods[rod].men;
  feed_to(rod, rod == state.feed_rod ? (feed_man() + turn + men) % men : middle_man(rod));
}

void Match::Impl::read_gestures() {
  for (int rod = 0; rod < kRods; ++rod) {
    const int team = table().rods[rod].team;
    const Gesture gesture = state.gestures[rod].update(team, world->rod(rod));
    if (state.attract) continue;  // the computers' rods; the server reports a person's hand
    if (gesture.turn != 0) {
      choose(team, (state.character[team] + gesture.turn + characters()) % characters());
      feed_by_turn(rod, gesture.turn);
    }
    if (gesture.push) {
      const bool chooses = mode() == Mode::training && state.screen == Screen::selection;
      push(team);
      // The rod that starts training gets the ball.
      if (chooses && state.screen != Screen::selection) feed_to(rod, middle_man(rod));
    }
  }
}

void Match::Impl::push(int team) {
  const bool long_enough = state.screen_ticks >= to_ticks(kCeremonyAtLeast);
  switch (state.screen) {
    case Screen::logo:
      enter(Screen::selection);
      if (mode() == Mode::challenge) start_match();
      break;
    case Screen::selection:
      // In training a computer waits until the person has confirmed.
      if (mode() == Mode::training && state.computer[team] && !state.computer[opponent(team)])
        break;
      state.confirmed[team] = true;
      if (mode() == Mode::training) begin_training(team);
      if (state.confirmed[0] && state.confirmed[1]) start_match();
      break;
    case Screen::play:
      if (state.time_out_left > 0) state.ready[team] = true;
      break;
    case Screen::ceremony:
      if (long_enough) start_play(opponent(state.last_scorer));
      break;
    case Screen::end:
      if (long_enough) go_on_after_end();
      break;
  }
}

void Match::Impl::choose(int team, int character) {
  if (state.screen == Screen::selection && !state.confirmed[team]) {
    state.character[team] = character;
  }
}

void Match::Impl::enter(Screen screen) {
  state.screen = screen;
  state.screen_ticks = 0;
  state.time_out_left = 0;
  if (screen == Screen::logo || screen == Screen::selection) {
    state.ball_in_play = state.ball_in_goal = false;
    state.ball_parked = true;
    state.tally = {};
    state.confirmed = {};
    state.play_ticks = 0;
    state.fouled = false;
  }
  if (screen == Screen::ceremony || screen == Screen::end) {
    state.ball_in_play = false;
    state.ball_parked = !state.ball_in_goal;  // after a goal it stays visible there
  }
  if (screen == Screen::logo) {
    state.game = state.next;
    state.attract = false;
    state.rung = 0;
    state.feed_man = -1;
    state.idle_ticks = 0;
  }
  reset_gestures();
  emit(EventKind::screen, 0, static_cast<double>(screen));
}

// --- matches -------------------------------------------------------------------------------------

int Match::Impl::dice(int n) {
  Random random(0);
  random.set_state(state.random);
  const int result = random.below(n);
  state.random = random.state();
  return result;
}

// From the selection: starts a new match; the random generator decides the serve (3).
void Match::Impl::start_match() {
  if (mode() == Mode::challenge) state.random = Random(state.game.challenge).state();
  if (mode() == Mode::challenge || state.attract) {
    for (int& character : state.character) character = dice(characters_to_draw());
  }
  const int server = dice(kTeams);
  ++matches_begun;
  state.tally = {};
  state.absent_ticks = {};
  state.last_server = server;
  state.first = server;
  state.last_shot = state.last_goal = {};
  state.built = state.character;
  rebuild_world();
  start_play(server);
}

// A challenge draws only built-in characters; they come first in a longer list.
int Match::Impl::characters_to_draw() const {
  if (mode() != Mode::challenge) return characters();
  return std::min(characters(), static_cast<int>(built_in_characters().size()));
}

// The rules of a running match do not change: the new setup applies at the next logo. On the
// selection screen it applies at once, unless the mode changes: then the logo follows.
void Match::Impl::set_up(const GameSetup& setup) {
  if (!playable(setup)) return;
  if (setup.mode == Mode::challenge && !(state.tuning == Tuning{})) return;
  state.next = {setup.mode, rules_of(setup, state.game.rules), setup.date};
  const bool other_mode = state.next.mode != state.game.mode;
  if (state.attract || (state.screen == Screen::selection && other_mode))
    return enter(Screen::logo);
  if (state.screen == Screen::logo || state.screen == Screen::selection) state.game = state.next;
}

// Nobody is present: two computers play until a hand touches a rod.
void Match::Impl::show_match() {
  enter(Screen::selection);
  state.attract = true;
  start_match();
}

// From the ceremony: the team that conceded serves (5); in a new set, the team that lost the
// previous one.
void Match::Impl::start_play(int server) {
  if (state.tally.set_over) {
    new_set();
    if (rules().change_sides) server = opponent(server);
  }
  state.fouled = false;
  enter(Screen::play);
  if (mode() == Mode::training) return serve_again();
  serve_from(rod_of(server, Line::midfield), kServeDelay);
}

// (13) When the teams change sides, their characters, sets and counts of jarring move with them.
void Match::Impl::new_set() {
  Tally next;
  next.sets = state.tally.sets;
  next.jars = state.tally.jars;
  if (rules().change_sides) {
    std::swap(next.sets[0], next.sets[1]);
    std::swap(next.jars[0], next.jars[1]);
    std::swap(state.character[0], state.character[1]);
    state.built = state.character;
    rebuild_world();
  }
  state.tally = next;
}

// The team that people play; team 0 if it is unknown.
int Match::Impl::person() const {
  return state.computer[0] && !state.computer[1] ? 1 : 0;
}

void Match::Impl::go_on_after_end() {
  const bool climbs = mode() == Mode::ladder && !state.attract &&
                      state.tally.sets[person()] >= rules().sets_to_win &&
                      state.rung + 1 < kLadderRungs;
  if (!climbs) return enter(Screen::logo);
  ++state.rung;
  enter(Screen::selection);
}

// Builds the world for state.built, first and tuning. Rods and ball keep their states. A challenge
// always begins at rest instead.
void Match::Impl::rebuild_world() {
  auto rebuilt =
      std::make_unique<TableWorld>(desc.layout, bodies_of(desc, state), state.first, state.tuning);
  // The new world reports no end of old contacts, but a begin of those that continue.
  state.touching.clear();
  if (mode() == Mode::challenge && state.screen != Screen::play) {
    world = std::move(rebuilt);
    return;
  }
  rebuilt->set_ball(world->ball());
  for (int rod = 0; rod < kRods; ++rod) {
    rebuilt->set_rod(rod, world->rod(rod));
    for (int man = 0; man < table().rods[rod].men; ++man) {
      rebuilt->set_man(rod, man, world->men()[rod][man]);
    }
  }
  world = std::move(rebuilt);
}

void Match::Impl::reset_gestures() {
  for (int rod = 0; rod < kRods; ++rod) {
    state.gestures[rod].reset(world->rod(rod));
    state.spins[rod].reset(world->rod(rod).angle);
  }
}

}  // namespace foosball
