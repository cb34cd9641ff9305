// The match: screens, serve, goals. One step: commands, rods, world, ball, screen.
#include "foosball/match.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "match_save.h"
#include "random.h"

namespace foosball {
namespace {

constexpr double kServeDelay = 0.5;  // [s] for the eye to find the new ball
// A push in the same breath as the goal is the end of the shot, not a wish to go on.
constexpr double kCeremonyAtLeast = 0.5;  // [s]
// A change of the ball's motion by less than about 0.1 m/s is neither heard nor felt.
constexpr double kLeastHit = 0.003;  // [N s]

std::uint64_t ticks(double seconds) {
  return static_cast<std::uint64_t>(std::lround(seconds / kTick));
}

bool plausible(const MatchDesc& desc) {
  const Rules& rules = desc.rules;
  const auto duration = [](double s) { return s > 0.0 && s <= kMaxDuration; };
  return static_cast<int>(desc.layout) < kLayouts && rules.goals_to_win >= 1 &&
         rules.goals_to_win <= rules.max_goals && rules.max_goals <= kMaxScore &&
         duration(rules.dead_ball_seconds) && duration(rules.ceremony_seconds) &&
         duration(rules.end_seconds);
}

bool usable(const RodTarget& target) {
  return target.live && std::isfinite(target.slide) && std::isfinite(target.slide_rate) &&
         std::isfinite(target.angle_rate) && std::fabs(target.angle) <= kMaxAngle;
}

}  // namespace

struct Match::Impl {
  explicit Impl(const MatchDesc& d)
      : desc(d), world(std::make_unique<TableWorld>(d.layout, state.built, state.first)) {
    state.random = Random(d.seed).state();
    events.reserve(kMaxEventsPerStep);
    reset_gestures();
    refresh_view();
  }

  MatchDesc desc;
  MatchState state;
  std::unique_ptr<TableWorld> world;
  MatchView view;
  std::vector<Event> events;
  std::uint64_t events_dropped = 0;

  const TableSpec& table() const { return world->table(); }

  void step(const TickInput& input);

  void apply(const Command& command);
  void drive_rods(const RodTargets& targets);
  void watch_ball(const vp::Vec3& velocity_before);
  void note_contacts(const vp::Vec3& velocity_before);
  void judge_ball();
  void score_goal(int team);
  void put_in_play();
  bool find_place(int rod, vp::Vec3& place);
  void run_screen();
  void read_gestures();
  void push(int team);
  void choose(int team, int character);
  void enter(Screen screen);
  void start_play();
  void serve_from(int rod, double delay);
  int rod_of(int team, Line line) const {
    return rods_of_team(table(), team)[static_cast<std::size_t>(line)];
  }
  void rebuild_world();
  void reset_gestures();
  void emit(const Event& event) {
    if (events.size() < kMaxEventsPerStep) {
      events.push_back(event);
    } else {
      ++events_dropped;
    }
  }
  void emit(EventKind kind, int team = 0, double value = 0.0) {
    emit(Event{kind, static_cast<std::uint8_t>(team), 0, 0, value, world->ball().pose.position()});
  }
  void refresh_view();

  vp::Expected<void> restore(std::span<const std::byte> bytes);
};

// --- one step ------------------------------------------------------------------------------------

void Match::Impl::step(const TickInput& input) {
  events.clear();
  for (const Command& command : input.commands) apply(command);
  if (!state.paused) {
    drive_rods(input.rods);
    if (state.ball_parked) world->park_ball();
    const vp::Vec3 velocity_before = world->ball().velocity;
    const bool sane = world->step();
    watch_ball(velocity_before);
    if (!sane && state.ball_in_play) serve_from(rod_of(state.last_server, Line::midfield), 0.0);
    read_gestures();
    run_screen();
  }
  ++state.tick;
  refresh_view();
}

void Match::Impl::apply(const Command& command) {
  switch (command.kind) {
    case Command::Kind::push:
      if (command.team < kTeams && !state.paused) push(command.team);
      break;
    case Command::Kind::choose_character:
      if (command.team < kTeams && command.value < kCharacters) choose(command.team, command.value);
      break;
    case Command::Kind::pause:
      state.paused = command.value != 0 && state.screen == Screen::play;
      break;
    case Command::Kind::restart:
      state.paused = false;
      enter(Screen::logo);
      break;
  }
}

// A rod that no hand moves stays where it was when the hand left it.
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

// --- the ball ------------------------------------------------------------------------------------

void Match::Impl::watch_ball(const vp::Vec3& velocity_before) {
  if (!state.ball_in_play) return;
  note_contacts(velocity_before);
  judge_ball();
}

void Match::Impl::note_contacts(const vp::Vec3& velocity_before) {
  // A ball pressed against something has contacts without end, and none of them is a hit.
  const vp::Vec3 change = world->ball().velocity - velocity_before;
  const bool felt = table().ball_mass * vp::norm(change) >= kLeastHit;
  for (const vp::ContactEvent& event : world->contacts()) {
    const BallContact contact = ball_contact(event);
    const Tag& other = contact.other;
    const bool man = other.what == Tag::What::man;
    const int team = man ? table().rods[other.rod].team : 0;
    if (man) {
      state.touching.set(other.rod, other.man, other.part,
                         contact.kind != vp::ContactEvent::Kind::end);
      state.touched |= std::uint64_t{1} << (other.rod * kMaxMenOnRod + other.man);
      state.last_toucher = team;
    }
    if (!felt || contact.kind != vp::ContactEvent::Kind::hit) continue;
    const EventKind kind = man                             ? EventKind::man_hit
                           : other.what == Tag::What::wall ? EventKind::wall_hit
                                                           : EventKind::field_hit;
    emit(Event{kind, static_cast<std::uint8_t>(team), other.rod, other.man, contact.impulse,
               contact.point});
  }
}

void Match::Impl::judge_ball() {
  const vp::Vec3 ball = world->ball().pose.position();
  if (const auto scorer = goal_by(table(), ball)) {
    const bool direct = state.served && std::popcount(state.touched) < 2;
    if (!direct) return score_goal(*scorer);
    // Straight from the serve into the goal: the other team serves.
    emit(EventKind::dead_ball);
    return serve_from(rod_of(opponent(state.last_server), Line::midfield), kServeDelay);
  }
  if (out_of_table(table(), ball)) {
    emit(EventKind::ball_out, state.last_toucher);
    return serve_from(rod_of(opponent(state.last_toucher), Line::defence), kServeDelay);
  }
  bool touched = state.touching.any();
  for (const vp::ContactEvent& event : world->contacts()) {
    touched = touched || ball_contact(event).other.what == Tag::What::man;
  }
  if (state.dead_ball.update(table(), desc.rules, ball, touched)) {
    emit(EventKind::dead_ball);
    serve_from(rod_for_dead_ball(table(), ball.x, state.last_server), kServeDelay);
  }
}

void Match::Impl::score_goal(int team) {
  ++state.score[team];
  state.last_scorer = team;
  state.ball_in_play = false;
  emit(EventKind::goal, team);
  if (winner(desc.rules, state.score)) {
    emit(EventKind::match_won, team);
    enter(Screen::end);
  } else {
    enter(Screen::ceremony);
  }
}

void Match::Impl::serve_from(int rod, double delay) {
  state.ball_in_play = false;
  state.ball_parked = true;
  state.serve_rod = rod;
  state.serve_in = ticks(delay);
}

// Puts the ball in front of a man, as soon as there is a place that no man fills.
void Match::Impl::put_in_play() {
  vp::Vec3 place;
  if (!find_place(state.serve_rod, place)) return;
  const RodSpec& rod = table().rods[state.serve_rod];
  world->set_ball(place, vp::Vec3{});
  state.ball_in_play = true;
  state.ball_parked = false;
  state.served = rod.line == Line::midfield;
  if (state.served) state.last_server = rod.team;
  state.last_toucher = rod.team;
  state.touched = 0;
  state.touching.clear();
  state.dead_ball.reset(place);
  emit(EventKind::serve, rod.team);
}

bool Match::Impl::find_place(int rod_index, vp::Vec3& place) {
  const RodSpec& rod = table().rods[rod_index];
  // A foot's half depth, the ball's radius and some 6 mm of air; then further off, then beside.
  constexpr double kAhead[] = {0.034, 0.042, 0.050};
  constexpr double kBeside[] = {0.0, 0.03, -0.03, 0.06, -0.06};
  const double forward = attack_sign(rod.team);
  const double slide = world->rod(rod_index).slide;
  // The man in the middle, or the one left of it as his player sees it.
  const int man = rod.team == 0 ? rod.men / 2 : rod.men - 1 - rod.men / 2;
  for (const double beside : kBeside) {
    for (const double ahead : kAhead) {
      place = {rod.x + forward * ahead, man_offset(rod, man) + slide + forward * beside,
               table().ball_radius};
      const double to_wall = 0.5 * table().width - table().ball_radius - 0.002;
      if (std::fabs(place.y) <= to_wall && world->free_for_ball(place)) return true;
    }
  }
  return false;
}

// --- screens -------------------------------------------------------------------------------------

void Match::Impl::run_screen() {
  ++state.screen_ticks;
  switch (state.screen) {
    case Screen::logo:
    case Screen::selection:
      break;
    case Screen::play:
      ++state.play_ticks;
      if (state.ball_in_play) break;
      if (state.serve_in > 0) {
        --state.serve_in;
      } else {
        put_in_play();
      }
      break;
    case Screen::ceremony:
      if (state.screen_ticks >= ticks(desc.rules.ceremony_seconds)) start_play();
      break;
    case Screen::end:
      if (state.screen_ticks >= ticks(desc.rules.end_seconds)) enter(Screen::logo);
      break;
  }
}

void Match::Impl::read_gestures() {
  for (int rod = 0; rod < kRods; ++rod) {
    const int team = table().rods[rod].team;
    const Gesture gesture = state.gestures[rod].update(team, world->rod(rod));
    if (gesture.turn != 0) {
      choose(team, (state.character[team] + gesture.turn + kCharacters) % kCharacters);
    }
    if (gesture.push) push(team);
  }
}

void Match::Impl::push(int team) {
  switch (state.screen) {
    case Screen::logo:
      enter(Screen::selection);
      break;
    case Screen::selection:
      state.confirmed[team] = true;
      if (state.confirmed[0] && state.confirmed[1]) start_play();
      break;
    case Screen::play:
      break;
    case Screen::ceremony:
      if (state.screen_ticks >= ticks(kCeremonyAtLeast)) start_play();
      break;
    case Screen::end:
      if (state.screen_ticks >= ticks(kCeremonyAtLeast)) enter(Screen::logo);
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
  if (screen == Screen::logo || screen == Screen::selection) {
    state.ball_in_play = false;
    state.ball_parked = true;
    state.score = {};
    state.confirmed = {};
    state.play_ticks = 0;
  }
  reset_gestures();
  emit(EventKind::screen, 0, static_cast<double>(screen));
}

// From the selection: a new match, the serve decided by lot. From the ceremony: the side that
// conceded serves.
void Match::Impl::start_play() {
  int server = opponent(state.last_scorer);
  if (state.screen == Screen::selection) {
    Random random(0);
    random.set_state(state.random);
    server = random.below(kTeams);
    state.random = random.state();
    state.last_server = server;
    state.first = server;
    rebuild_world();
  }
  enter(Screen::play);
  serve_from(rod_of(server, Line::midfield), kServeDelay);
}

// The men take on the chosen characters; the rods stay as they are in the hands that hold them.
void Match::Impl::rebuild_world() {
  state.built = state.character;
  auto rebuilt = std::make_unique<TableWorld>(desc.layout, state.built, state.first);
  for (int rod = 0; rod < kRods; ++rod) rebuilt->set_rod(rod, world->rod(rod));
  world = std::move(rebuilt);
}

void Match::Impl::reset_gestures() {
  for (int rod = 0; rod < kRods; ++rod) state.gestures[rod].reset(world->rod(rod));
}

void Match::Impl::refresh_view() {
  const BallState ball = world->ball();
  view.tick = state.tick;
  view.layout = desc.layout;
  view.screen = state.screen;
  view.paused = state.paused;
  view.score = state.score;
  view.character = state.character;
  view.confirmed = state.confirmed;
  view.screen_seconds = static_cast<double>(state.screen_ticks) * kTick;
  view.play_seconds = static_cast<double>(state.play_ticks) * kTick;
  view.last_scorer = state.last_scorer;
  view.events_dropped = events_dropped;
  view.ball_in_play = state.ball_in_play;
  view.ball_position = ball.pose.position();
  view.ball_velocity = ball.velocity;
  view.ball_pose = ball.pose;
  view.ball_spin = ball.spin;
  for (int rod = 0; rod < kRods; ++rod) view.rods[rod] = world->rod(rod);
}

vp::Expected<void> Match::Impl::restore(std::span<const std::byte> bytes) {
  if (auto result = load_match(desc, bytes, state, world); !result) return result;
  events.clear();
  refresh_view();
  return {};
}

// --- the public face -----------------------------------------------------------------------------

vp::Expected<Match> Match::create(const MatchDesc& desc) {
  if (!plausible(desc)) {
    return tl::unexpected(vp::Error{
        vp::Errc::invalid_argument,
        "The match cannot be played: check layout, goals (1 <= to win <= most <= 99) and durations "
        "(above 0, at most 3600 s)."});
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

vp::SE3 man_pose(const TableSpec& table, int rod, int man, const RodState& state) {
  const RodSpec& spec = table.rods[rod];
  return {vp::Exp(vp::Vec3{0.0, state.angle, 0.0}),
          vp::Vec3{spec.x, man_offset(spec, man) + state.slide, table.rod_height}};
}

}  // namespace foosball
