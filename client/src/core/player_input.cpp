#include "client/player_input.h"

#include <cmath>

#include "wire/enums.h"

namespace client {
namespace {

cabinet::HandOptions hand_options(int team, const foosball::TableSpec& table) {
  cabinet::HandOptions options;
  options.rods = foosball::rods_of_team(table, team);
  for (std::size_t i = 0; i < options.rods.size(); ++i) {
    options.slide_limit[i] = table.rods[static_cast<std::size_t>(options.rods[i])].slide_limit;
  }
  // Away from the person is the team's push; feet towards the other goal is a turn against the
  // right-handed one about +y for team 0 (foosball/table.h).
  options.slide_sign = foosball::push_sign(team);
  options.angle_sign = -foosball::attack_sign(team);
  return options;
}

// The hand knows one axis that slides and one that spins; here the rods run away from the person.
cabinet::PadState turned(const cabinet::PadState& pad) {
  cabinet::PadState state = pad;
  state.left_x = 0;
  state.right_y = pad.right_x;
  state.right_x = 0;
  return state;
}

}  // namespace

PlayerInput::PlayerInput(std::uint64_t session, int team, foosball::Layout layout)
    : session_(session),
      team_(team),
      table_(foosball::table_spec(layout)),
      hand_(hand_options(team, table_)) {
  for (std::size_t i = 0; i < rod_x_.size(); ++i) rod_x_[i] = table_.rods[i].x;
}

void PlayerInput::update(const InputEvents& events, const wire::Snapshot* scene,
                         std::int64_t now_us) {
  wishes_.clear();
  if (events.toggle_automatic) automatic_ = !automatic_;
  hand_.set_automatic(automatic_);
  const bool known = scene != nullptr && scene->session == session_;
  begun_ = begun_ || known;
  if (known && scene->ball_in_play) hand_.ball_at(scene->ball.position[0], rod_x_);
  hand_.choose(events.choose_line);
  if (events.wheel != 0) hand_.cycle(events.wheel);
  if (known) move(events, *scene);
  hand_.poll(now_us);
  if (known) collect_wishes(events, *scene);
  key_was_held_ = events.key_spin != 0 || events.key_slide != 0;
}

void PlayerInput::move(const InputEvents& events, const wire::Snapshot& scene) {
  for (int rod = 0; rod < foosball::kRods; ++rod) {
    const wire::RodSnapshot& r = scene.rods[static_cast<std::size_t>(rod)];
    hand_.adopt(rod, r.slide, r.angle);
  }
  hand_.mouse_moved(events.mouse_forward, events.mouse_right);
  hand_.key_axis(events.key_slide, events.key_spin);
  hand_.key_taps(events.slide_taps, events.spin_taps);
  hand_.pad(events.has_pad ? turned(events.pad) : cabinet::PadState{});
}

void PlayerInput::collect_wishes(const InputEvents& events, const wire::Snapshot& scene) {
  const auto team = static_cast<std::uint8_t>(team_);
  const auto screen = static_cast<wire::Screen>(scene.screen);
  if ((events.push || events.pad_push) && screen != wire::Screen::play)
    wishes_.push_back({number(wire::WishKind::push), team, 0});
  if ((events.toggle_pause || events.pad_pause) && screen == wire::Screen::play) {
    wishes_.push_back(
        {number(wire::WishKind::pause), team, static_cast<std::uint8_t>(scene.paused ? 0 : 1)});
  }
  if (screen == wire::Screen::selection) choose_character(events, scene);
}

// By number, by the wheel, or by a tap of an arrow; a spun rod chooses by itself, at the server.
void PlayerInput::choose_character(const InputEvents& events, const wire::Snapshot& scene) {
  const int now = scene.character[static_cast<std::size_t>(team_)];
  int wanted = now;
  if (events.choose_line >= 0 && events.choose_line < foosball::kCharacters)
    wanted = events.choose_line;
  int steps = -events.wheel + events.spin_taps - events.slide_taps;
  if (!key_was_held_) steps += static_cast<int>(std::lround(events.key_spin - events.key_slide));
  if (steps != 0)
    wanted =
        ((now + steps) % foosball::kCharacters + foosball::kCharacters) % foosball::kCharacters;
  if (wanted == now) return;
  wishes_.push_back({number(wire::WishKind::choose_character), static_cast<std::uint8_t>(team_),
                     static_cast<std::uint8_t>(wanted)});
}

std::array<wire::InputRod, 8> PlayerInput::rods() const {
  std::array<wire::InputRod, 8> rods{};
  if (!begun_) return rods;
  for (std::size_t i = 0; i < rods.size(); ++i) {
    const cabinet::RodInput& input = hand_.rods()[i];
    if (input.status != cabinet::RodStatus::live) continue;
    rods[i] = {true, static_cast<float>(input.slide), static_cast<float>(input.angle),
               static_cast<float>(input.slide_rate), static_cast<float>(input.angle_rate)};
  }
  return rods;
}

}  // namespace client
