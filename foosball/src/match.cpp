// One step of the match: commands, rods, world, ball, screen.
#include "foosball/match.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "match_impl.h"
#include "match_save.h"
#include "random.h"

namespace foosball {
namespace {

bool plausible(const MatchDesc& desc) {
  return static_cast<int>(desc.layout) < kLayouts && static_cast<int>(desc.mode) < kModes &&
         playable(desc.rules) && in_range(desc.tuning) && in_range(desc.characters);
}

bool usable(const RodTarget& target) {
  return target.live && std::isfinite(target.slide) && std::isfinite(target.slide_rate) &&
         std::isfinite(target.angle_rate) && std::fabs(target.angle) <= kMaxAngle;
}

// Both teams start with the second character, or the only one.
MatchState first_state(const MatchDesc& desc) {
  MatchState state;
  const int first = std::min(1, static_cast<int>(desc.characters.size()) - 1);
  state.character = state.built = {first, first};
  return state;
}

double seconds(std::uint64_t ticks) {
  return static_cast<double>(ticks) * kTick;
}

}  // namespace

bool playable(const Rules& rules) {
  const auto duration = [](double s) { return s > 0.0 && s <= kMaxDuration; };
  const auto or_never = [](double s) { return s >= 0.0 && s <= kMaxDuration; };
  return static_cast<int>(rules.set) < kRuleSets && static_cast<int>(rules.spin) < kSpinRules &&
         rules.goals_to_win >= 1 && rules.goals_to_win <= rules.max_goals &&
         rules.max_goals <= kMaxScore && rules.lead >= 1 && rules.lead <= kMaxScore &&
         rules.sets_to_win >= 1 && rules.sets_to_win <= kMaxSetsToWin &&
         (rules.golden_goal || rules.sets_to_win == 1) && rules.time_outs >= 0 &&
         rules.time_outs <= kMaxCount && duration(rules.dead_ball_seconds) &&
         duration(rules.possession_midfield_seconds) && duration(rules.possession_seconds) &&
         duration(rules.time_out_seconds) && duration(rules.ceremony_seconds) &&
         duration(rules.end_seconds) && or_never(rules.match_seconds) &&
         or_never(rules.still_seconds) && or_never(rules.idle_seconds) &&
         or_never(rules.attract_seconds);
}

MatchDesc challenge_of(std::uint32_t date) {
  return {.seed = date, .rules = challenge_rules(), .mode = Mode::challenge};
}

Match::Impl::Impl(const MatchDesc& d) : desc(d), state(first_state(d)) {
  world = std::make_unique<TableWorld>(d.layout, bodies_of(d, state), state.first, d.tuning);
  state.tuning = d.tuning;
  state.random = Random(d.seed).state();
  state.game = state.next = {d.mode, d.rules, d.mode == Mode::challenge ? d.seed : 0};
  state.feed_rod = rod_of(0, Line::attack);
  events.reserve(kMaxEventsPerStep);
  reset_gestures();
  refresh_view();
}

// --- one step ------------------------------------------------------------------------------------

void Match::Impl::step(const TickInput& input) {
  events.clear();
  const bool played = state.screen == Screen::play;
  for (const Command& command : input.commands) apply(command);
  if (!(world->tuning() == state.tuning)) rebuild_world();
  watch_hands(input.rods, !input.commands.empty());
  if (!state.paused) {
    // Targets from before the start of a challenge do not affect it.
    const bool begins = !played && state.screen == Screen::play && state.play_ticks == 0;
    if (!(begins && mode() == Mode::challenge)) drive_rods(input.rods);
    if (state.ball_parked) world->park_ball();
    const vp::Vec3 velocity_before = world->ball().velocity;
    const bool sane = world->step();
    if (state.ball_in_goal) world->keep_ball_in_goal();
    watch_ball(velocity_before);
    watch_rods(input.rods);
    if (!sane && state.ball_in_play) serve_from(rod_of(state.last_server, Line::midfield), 0.0);
    read_gestures();
    run_screen();
  }
  count_tick(state.tick);
  refresh_view();
}

void Match::Impl::apply(const Command& command) {
  if (command.team >= kTeams) return;
  switch (command.kind) {
    case Command::Kind::push:
      if (state.attract) return enter(Screen::logo);
      if (!state.paused) push(command.team);
      break;
    case Command::Kind::choose_character:
      if (command.value < characters()) choose(command.team, command.value);
      break;
    case Command::Kind::pause:
      state.paused = command.value != 0 && state.screen == Screen::play && !state.attract;
      break;
    case Command::Kind::restart:
      state.paused = false;
      enter(Screen::logo);
      break;
    case Command::Kind::time_out:
      if (!state.paused) ask_time_out(command.team);
      break;
    case Command::Kind::feed:
      if (!state.paused) feed(command.team, command.value);
      break;
    case Command::Kind::seat:
      state.computer[command.team] = command.value != 0;
      break;
    case Command::Kind::touch:
      if (state.attract) enter(Screen::logo);
      break;
    case Command::Kind::tune:
      tune(command.value, command.amount);
      break;
    case Command::Kind::set_up:
      set_up(command.setup);
      break;
  }
}

// Takes effect in this tick: step() rebuilds the world.
void Match::Impl::tune(int index, double value) {
  const bool challenge = state.game.mode == Mode::challenge || state.next.mode == Mode::challenge;
  if (index >= kTuningValues || challenge) return;
  const TuningField& field = kTuningFields[static_cast<std::size_t>(index)];
  if (in_range(field, value)) state.tuning.*field.value = value;
}

// A rod that no hand moves stays where its hand left it.
void Match::Impl::drive_rods(const RodTargets& targets) {
  for (int rod = 0; rod < kRods; ++rod) {
    RodTarget& hold = state.hold[rod];
    if (usable(targets[rod])) {
      hold.live = true;
      world->drive(rod, targets[rod]);
      continue;
    }
    if (hold.live) {
      const RodState now = world->rod(rod);
      hold = {now.slide, now.angle, 0.0, 0.0, false};
    }
    world->drive(rod, hold);
  }
}

// Detects absence: of a person who has left the table, and of a team that does not play the ball.
// It uses the hands' targets, because the ball can move a free rod.
void Match::Impl::watch_hands(const RodTargets& hands, bool commanded) {
  RodTargets held = hands;
  for (RodTarget& rod : held) rod.live = usable(rod);
  const std::uint8_t moved = state.moved_rods.update(held);
  std::uint8_t people = 0;
  std::array<bool, kTeams> plays{};
  for (int rod = 0; rod < kRods; ++rod) {
    const int team = table().rods[rod].team;
    const bool person = !state.attract && !state.computer[team];
    people |= static_cast<std::uint8_t>((person ? 1u : 0u) << rod);
    plays[team] = plays[team] || (moved >> rod & 1u) != 0;
  }
  for (int team = 0; team < kTeams; ++team) {
    if (state.ball_in_play && !state.paused) count_tick(state.absent_ticks[team]);
    if (plays[team]) state.absent_ticks[team] = 0;
  }
  count_tick(state.idle_ticks);
  const bool away = people == 0 && state.screen != Screen::logo;
  if (commanded || away || (moved & people) != 0) state.idle_ticks = 0;
  leave_idle_screen();
}

// When nobody is present, the logo starts a demonstration match, and every other screen returns to
// the logo.
void Match::Impl::leave_idle_screen() {
  const bool logo = state.screen == Screen::logo;
  const double limit = logo ? rules().attract_seconds : rules().idle_seconds;
  if (limit == 0.0 || state.idle_ticks < to_ticks(limit)) return;
  if (logo) return show_match();
  state.paused = false;
  enter(Screen::logo);
}

// --- view ----------------------------------------------------------------------------------------

void Match::Impl::refresh_view() {
  const BallState ball = world->ball();
  view.tick = state.tick;
  view.layout = desc.layout;
  view.mode = state.game.mode;
  view.rule_set = rules().set;
  view.rules = rules();
  view.challenge = state.game.challenge;
  view.setup =
      setup_of(state.next.mode, state.next.rules, static_cast<std::uint32_t>(state.next.challenge));
  view.setup_waits = !(state.next == state.game);
  view.screen = state.screen;
  view.paused = state.paused;
  view.characters = characters();
  view.character = state.character;
  view.bodies = bodies_of(desc, state);
  view.confirmed = state.confirmed;
  view.screen_seconds = seconds(state.screen_ticks);
  view.tuning = state.tuning;
  view.events_dropped = events_dropped;
  view.matches_begun = matches_begun;
  view.ball_in_play = state.ball_in_play;
  view.ball_visible = !state.ball_parked;
  view.ball_position = ball.pose.position();
  view.ball_velocity = ball.velocity;
  view.ball_pose = ball.pose;
  view.ball_spin = ball.spin;
  for (int rod = 0; rod < kRods; ++rod) view.rods[rod] = world->rod(rod);
  view.men = world->men();
  refresh_match_view();
}

void Match::Impl::refresh_match_view() {
  view.score = state.tally.score;
  view.sets = state.tally.sets;
  for (int team = 0; team < kTeams; ++team) {
    view.time_outs_left[team] = std::max(0, rules().time_outs - state.tally.time_outs[team]);
  }
  view.play_seconds = seconds(state.play_ticks);
  view.last_scorer = state.last_scorer;
  view.last_goal = state.last_goal;
  view.last_goal_own = state.last_goal_own;
  view.last_shot = state.last_shot;
  view.time_out_seconds = seconds(state.time_out_left);
  view.time_out_team = state.time_out_team;
  view.timed = rules().match_seconds > 0.0;
  const std::uint64_t limit = to_ticks(rules().match_seconds);
  view.seconds_left = seconds(limit > state.tally.set_ticks ? limit - state.tally.set_ticks : 0);
  view.golden_goal = state.tally.golden_goal;
  view.next_server = table().rods[state.serve_rod].team;
  view.fouled = state.fouled;
  view.last_foul = state.last_foul;
  view.last_foul_team = state.last_foul_team;
  const auto rod = state.watch.rod();
  view.possession_team = rod ? table().rods[*rod].team : state.last_server;
  view.possession_seconds = seconds(state.watch.ticks_possessed());
  view.computer = state.computer;
  view.attract = state.attract;
  view.rung = state.rung;
  view.feed_rod = state.feed_rod;
  view.feed_man = feed_man();
}

vp::Expected<void> Match::Impl::restore(std::span<const std::byte> bytes) {
  if (auto result = load_match(desc, bytes, state, world); !result) return result;
  events.clear();
  refresh_view();
  return {};
}

// --- public interface ----------------------------------------------------------------------------

vp::Expected<Match> Match::create(const MatchDesc& desc) {
  if (!plausible(desc)) {
    return tl::unexpected(vp::Error{
        vp::Errc::invalid_argument,
        "The match cannot be played: check layout, mode, goals (1 <= to win <= most <= 99), sets "
        "(1 to 9 to win; a timed set of several needs a golden goal), durations (above 0, at most "
        "3600 s), tuning and characters (1 to 12, within their ranges)."});
  }
  return Match(std::make_unique<Impl>(desc));
}

Match::Match(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Match::~Match() = default;
Match::Match(Match&&) noexcept = default;
Match& Match::operator=(Match&&) noexcept = default;

void Match::step(const TickInput& input) {
  impl_->step(input);
}
const MatchView& Match::view() const {
  return impl_->view;
}
std::span<const Event> Match::events() const {
  return impl_->events;
}

void Match::snapshot(std::vector<std::byte>& bytes) const {
  save_match(impl_->desc, impl_->state, *impl_->world, bytes);
}
vp::Expected<void> Match::restore(std::span<const std::byte> bytes) {
  return impl_->restore(bytes);
}
std::uint64_t Match::state_hash() const {
  return hash_match(impl_->desc, impl_->state, *impl_->world);
}

RodState with_man(const RodState& rod, const ManState& man) {
  return {rod.slide, man.angle, rod.slide_rate, man.angle_rate};
}

vp::SE3 man_pose(const TableSpec& table, int rod, int man, const RodState& state) {
  const RodSpec& spec = table.rods[rod];
  return {vp::Exp(vp::Vec3{0.0, state.angle, 0.0}),
          vp::Vec3{spec.x, man_offset(spec, man) + state.slide, table.rod_height}};
}

}  // namespace foosball
