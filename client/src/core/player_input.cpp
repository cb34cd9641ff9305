#include "client/player_input.h"

#include <algorithm>
#include <cmath>

#include "foosball/feed.h"
#include "wire/enums.h"

namespace client {
namespace {

std::uint8_t rods_of(int team, const foosball::TableSpec& table) {
  std::uint8_t rods = 0;
  for (const int rod : foosball::rods_of_team(table, team))
    rods |= static_cast<std::uint8_t>(1u << rod);
  return rods;
}

cabinet::HandOptions hand_options(int team, const foosball::TableSpec& table, std::uint8_t mine) {
  cabinet::HandOptions options;
  options.rods = foosball::rods_of_team(table, team);
  for (std::size_t i = 0; i < options.rods.size(); ++i) {
    options.has[i] = (mine >> options.rods[i] & 1) != 0;
    options.slide_limit[i] = table.rods[static_cast<std::size_t>(options.rods[i])].slide_limit;
  }
  // Away from the person is the team's push direction. Feet towards the opponents' goal is a
  // negative rotation about +y for team 0 (foosball/table.h).
  options.slide_sign = foosball::push_sign(team);
  options.angle_sign = -foosball::attack_sign(team);
  return options;
}

// cabinet::Hand has one axis that slides and one that spins; here the rods run away from the
// person.
cabinet::PadState turned(const cabinet::PadState& pad) {
  cabinet::PadState state = pad;
  state.left_x = 0;
  state.right_y = pad.right_x;
  state.right_x = 0;
  return state;
}

// The person's view of the scene, in the form that the assists take.
foosball::AssistView seen_in(const wire::Snapshot& scene, const foosball::Characters& characters) {
  foosball::AssistView view;
  view.ball_in_play = scene.ball_in_play;
  const auto vec = [](const std::array<float, 3>& v) { return vp::Vec3{v[0], v[1], v[2]}; };
  view.ball = vec(scene.ball.position);
  view.velocity = vec(scene.ball.linear_velocity);
  for (std::size_t i = 0; i < view.rods.size(); ++i) {
    const wire::RodSnapshot& rod = scene.rods[i];
    view.rods[i] = {rod.slide, rod.angle, rod.slide_rate, rod.angle_rate};
  }
  for (std::size_t team = 0; team < view.bodies.size(); ++team)
    view.bodies[team] = foosball::nearest(characters, scene.character[team]).body;
  return view;
}

// Without a person the assists stop after this time: a goalie that follows the ball would look like
// a present person, to the server too.
constexpr std::int64_t kRestsAfterUs = 10'000'000;

bool acts(const InputEvents& events) {
  constexpr float kStick = 0.25f;  // beyond the drift of a worn stick
  const cabinet::PadState& pad = events.pad;
  const auto beyond = [](float axis) { return std::fabs(axis) > kStick; };
  const bool by_pad =
      events.has_pad && (beyond(pad.left_x) || beyond(pad.left_y) || beyond(pad.right_x) ||
                         beyond(pad.right_y) || pad.previous_rod || pad.next_rod);
  return by_pad || events.mouse_right != 0.0 || events.mouse_forward != 0.0 ||
         events.choose_line >= 0 || events.wheel != 0 || events.key_slide != 0.0 ||
         events.key_spin != 0.0 || events.slide_taps != 0 || events.spin_taps != 0 ||
         events.any_key != 0 || events.push || events.pad_push;
}

}  // namespace

PlayerInput::PlayerInput(std::uint64_t session, int team, foosball::Layout layout,
                         std::uint8_t rods)
    : session_(session),
      team_(team),
      table_(foosball::table_spec(layout)),
      mine_(rods & rods_of(team, table_)),
      hand_(hand_options(team, table_, mine_)),
      assists_(team, layout, mine_, assists_on_) {}

void PlayerInput::set_assists(const foosball::AssistChoice& choice) {
  if (choice == assists_on_) return;
  assists_on_ = choice;
  assists_ = foosball::Assists(team_, table_.layout, mine_, choice);
}

void PlayerInput::update(const InputEvents& events, const wire::Snapshot* scene,
                         std::int64_t now_us) {
  requests_.clear();
  if (events.toggle_automatic) {
    foosball::AssistChoice choice = assists_on_;
    choice.automatic_rod = !choice.automatic_rod;
    set_assists(choice);
  }
  const bool known = scene != nullptr && scene->session == session_;
  begun_ = begun_ || known;
  const foosball::AssistView view = known ? seen_in(*scene, characters_) : foosball::AssistView{};
  choose_rod(view);
  hand_.choose(events.choose_line);
  if (events.wheel != 0) hand_.cycle(events.wheel);
  if (known) move(events, *scene);
  hand_.poll(now_us);
  if (known) {
    const bool in_play = scene->screen == number(wire::Screen::play) && !scene->paused;
    if (acted_us_ < 0 || now_us < acted_us_ || acts(events)) acted_us_ = now_us;
    const bool helps = in_play && now_us - acted_us_ < kRestsAfterUs;
    helps ? assist(view, now_us) : rest();
    collect_requests(events, *scene, now_us);
  }
  key_was_held_ = events.key_spin != 0 || events.key_slide != 0;
}

// Takes a rod when the assist's choice changes; a rod chosen by hand stays until then.
void PlayerInput::choose_rod(const foosball::AssistView& view) {
  if (!assists_on_.automatic_rod) {
    rod_to_take_ = -1;
    return;
  }
  const int rod = assists_.rod_to_take(view, hand_now(), rod_to_take_);
  if (rod != rod_to_take_ && rod >= 0)
    hand_.choose(static_cast<int>(table_.rods[static_cast<std::size_t>(rod)].line));
  rod_to_take_ = rod;
}

foosball::AssistHand PlayerInput::hand_now() const {
  foosball::AssistHand hand;
  for (std::size_t i = 0; i < hand.targets.size(); ++i) {
    const cabinet::RodInput& rod = hand_.rods()[i];
    if (rod.status != cabinet::RodStatus::live) continue;
    hand.targets[i] = {rod.slide, rod.angle, rod.slide_rate, rod.angle_rate, true};
  }
  hand.held = static_cast<std::uint8_t>(1u << hand_.active_rod());
  hand.strikes = hand_.strikes();
  return hand;
}

void PlayerInput::assist(const foosball::AssistView& view, std::int64_t now_us) {
  constexpr std::int64_t kTickUs = 1000, kLongestUs = 110'000;  // a stall must not fling rods
  const bool gap = assisted_us_ == 0 || now_us < assisted_us_ || now_us - assisted_us_ > kLongestUs;
  const auto ticks = gap ? 0 : static_cast<int>((now_us - assisted_us_) / kTickUs);
  assisted_us_ = gap ? now_us : assisted_us_ + ticks * kTickUs;
  targets_ = assists_.steer(view, hand_now(), ticks);
  for (int rod = 0; rod < foosball::kRods; ++rod) {
    if ((assists_.following() >> rod & 1) == 0) continue;
    const foosball::RodTarget& target = targets_[static_cast<std::size_t>(rod)];
    hand_.place(rod, target.slide, target.angle);
  }
}

// Between plays rods operate the screens: a rod turned by an assist would make a choice.
void PlayerInput::rest() {
  if (assisted_us_ != 0) assists_ = foosball::Assists(team_, table_.layout, mine_, assists_on_);
  assisted_us_ = 0;
  targets_ = hand_now().targets;
}

void PlayerInput::move(const InputEvents& events, const wire::Snapshot& scene) {
  // Rods start at their present pose until they follow this hand. Later motion of a rod by the ball
  // or by a stand-in computer is no motion of the hand.
  for (int rod = 0; rod < foosball::kRods; ++rod) {
    const wire::RodSnapshot& r = scene.rods[static_cast<std::size_t>(rod)];
    const auto bit = static_cast<std::uint8_t>(1u << rod);
    if ((drives_ & bit) == 0) hand_.adopt(rod, r.slide, r.angle);
    if (r.source == number(wire::RodSource::client)) drives_ |= bit;
  }
  hand_.mouse_moved(events.mouse_forward, events.mouse_right);
  hand_.key_axis(events.key_slide, events.key_spin);
  hand_.key_taps(events.slide_taps, events.spin_taps);
  hand_.pad(events.has_pad ? turned(events.pad) : cabinet::PadState{});
}

void PlayerInput::collect_requests(const InputEvents& events, const wire::Snapshot& scene,
                                   std::int64_t now_us) {
  const auto team = static_cast<std::uint8_t>(team_);
  const auto screen = static_cast<wire::Screen>(scene.screen);
  if ((events.push || events.pad_push) && screen != wire::Screen::play)
    requests_.push_back({number(wire::RequestKind::push), team, 0});
  if ((events.toggle_pause || events.pad_pause) && screen == wire::Screen::play) {
    requests_.push_back(
        {number(wire::RequestKind::pause), team, static_cast<std::uint8_t>(scene.paused ? 0 : 1)});
  }
  const bool time_out = events.presses[index_of(Action::time_out)] > 0 || events.pad_time_out;
  if (time_out && screen == wire::Screen::play)
    requests_.push_back({number(wire::RequestKind::time_out), team, 0});
  if (screen == wire::Screen::selection) choose_character(events, scene);
  const int presses = events.presses[index_of(Action::feed)] + (events.pad_share ? 1 : 0);
  const bool served = screen == wire::Screen::play || screen == wire::Screen::ceremony;
  if (presses > 0 && served && scene.mode == number(wire::Mode::training) && !scene.paused)
    choose_man(presses, scene, now_us);
}

// Serves the ball to a man of the active rod; each press selects the next man.
void PlayerInput::choose_man(int presses, const wire::Snapshot& scene, std::int64_t now_us) {
  constexpr std::int64_t kSeenWithinUs = 500'000;
  const bool known = fed_rod_ < 0 || now_us < fed_us_ || now_us - fed_us_ > kSeenWithinUs;
  if (known) {
    fed_rod_ = scene.feed_rod;
    fed_man_ = scene.feed_man;
  }
  const int rod = hand_.active_rod();
  const foosball::RodSpec& spec = table_.rods[static_cast<std::size_t>(rod)];
  if (rod != fed_rod_) fed_man_ = -1;
  fed_rod_ = rod;
  fed_man_ = (fed_man_ + presses) % spec.men;
  fed_us_ = now_us;
  requests_.push_back({number(wire::RequestKind::feed), static_cast<std::uint8_t>(team_),
                       foosball::feed_value(spec.line, fed_man_)});
}

// By number, by the wheel, or by a tap of an arrow. Selection by a spun rod happens at the server.
void PlayerInput::choose_character(const InputEvents& events, const wire::Snapshot& scene) {
  const int now = scene.character[static_cast<std::size_t>(team_)];
  int wanted = now;
  const int count = static_cast<int>(characters_.size());
  if (events.choose_line >= 0 && events.choose_line < count) wanted = events.choose_line;
  if (events.number >= 1 && events.number <= count) wanted = events.number - 1;
  int steps =
      -events.wheel + events.spin_taps - events.slide_taps - events.pad_up + events.pad_right;
  if (!key_was_held_) steps += static_cast<int>(std::lround(events.key_spin - events.key_slide));
  if (steps != 0) wanted = ((now + steps) % count + count) % count;
  if (wanted == now) return;
  requests_.push_back({number(wire::RequestKind::choose_character),
                       static_cast<std::uint8_t>(team_), static_cast<std::uint8_t>(wanted)});
}

std::array<wire::InputRod, 8> PlayerInput::rods() const {
  std::array<wire::InputRod, 8> rods{};
  if (!begun_) return rods;
  for (std::size_t i = 0; i < rods.size(); ++i) {
    const foosball::RodTarget& target = targets_[i];
    if (!target.live) continue;
    rods[i] = {true, static_cast<float>(target.slide), static_cast<float>(target.angle),
               static_cast<float>(target.slide_rate), static_cast<float>(target.angle_rate)};
  }
  return rods;
}

}  // namespace client
