// The screens and the modes: what leads from one to the next.
#include <algorithm>
#include <utility>

#include "match_impl.h"
#include "random.h"

namespace foosball {
namespace {

// A push in the same breath as the goal is the end of the shot, not a request to go on.
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

// For whoever pushed, unless a computer did.
void Match::Impl::begin_training(int team) {
  state.confirmed = {true, true};
  if (state.feed_man < 0)
    state.feed_rod = rod_of(state.computer[team] ? person() : team, Line::attack);
}

// (9.1) Ends after its time, or as soon as both sides push.
void Match::Impl::run_time_out() {
  --state.time_out_left;
  if (state.ready[0] && state.ready[1]) state.time_out_left = 0;
}

// (9) Between balls either side may, else the one that has the ball. (10) The ball is then put in
// play again at the rod that had it.
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

// By the rods alone: whoever spins a rod after a goal has the ball served there, forward to the
// next man, back to the one before. The end of a shot's swing is no choice.
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
    if (state.attract) continue;  // the computers' rods; a hand is told by the server
    if (gesture.turn != 0) {
      choose(team, (state.character[team] + gesture.turn + characters()) % characters());
      feed_by_turn(rod, gesture.turn);
    }
    if (gesture.push) {
      const bool chooses = mode() == Mode::training && state.screen == Screen::selection;
      push(team);
      // Who begins with a rod has the ball there.
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
      // In training a computer waits until the person has chosen.
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
    state.ball_parked = !state.ball_in_goal;  // else it stays to be seen where it scored
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

// From the selection: a new match, the serve decided by lot (3).
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

// A challenge draws from the built-in ones, which come first where there are others.
int Match::Impl::characters_to_draw() const {
  if (mode() != Mode::challenge) return characters();
  return std::min(characters(), static_cast<int>(built_in_characters().size()));
}

// In play, rules do not change under the players' hands: at the next logo. The selection stays, but
// where another mode leads elsewhere.
void Match::Impl::set_up(const GameSetup& setup) {
  if (!playable(setup)) return;
  if (setup.mode == Mode::challenge && !(state.tuning == Tuning{})) return;
  state.next = {setup.mode, rules_of(setup, state.game.rules), setup.date};
  const bool other_mode = state.next.mode != state.game.mode;
  if (state.attract || (state.screen == Screen::selection && other_mode))
    return enter(Screen::logo);
  if (state.screen == Screen::logo || state.screen == Screen::selection) state.game = state.next;
}

// Nobody is there: two computers play until a hand touches a rod.
void Match::Impl::show_match() {
  enter(Screen::selection);
  state.attract = true;
  start_match();
}

// From the ceremony: the side that conceded serves (5), in a new set the one that lost the last.
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

// (13) Where sides are changed the players walk round the table: what belongs to them goes along.
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

// The side that people play; the first, where it is not told.
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

// As state.built, first and tuning say. Rods and ball stay as they are; but each try of a challenge
// begins at rest, whatever was played before.
void Match::Impl::rebuild_world() {
  auto rebuilt =
      std::make_unique<TableWorld>(desc.layout, bodies_of(desc, state), state.first, state.tuning);
  state.touching.clear();  // the new world tells of no contact that ends, those that last begin
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
