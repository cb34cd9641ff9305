#include "render/hud_screens.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "foosball/table.h"
#include "render/hud.h"

namespace client {

HudPen::HudPen(UiBatch& ui, const glm::ivec2& screen, bool team_0_on_the_left)
    : scale(std::max(0.35f, std::min(static_cast<float>(screen.y) / 720.0f,
                                     static_cast<float>(screen.x) / 900.0f))),
      half_width(0.5f * static_cast<float>(screen.x) / scale),
      bottom(static_cast<float>(screen.y) / scale),
      left_is_team_0(team_0_on_the_left),
      ui_(ui),
      middle_(0.5f * static_cast<float>(screen.x)) {}

glm::vec2 HudPen::to_pixels(const glm::vec2& at) const {
  return {middle_ + at.x * scale, at.y * scale};
}

glm::vec2 HudPen::from_pixels(const glm::vec2& pixel) const {
  return {(pixel.x - middle_) / scale, pixel.y / scale};
}

void HudPen::text(std::string_view utf8, TextStyle style, const glm::vec2& at, const Colour& colour,
                  float glow) const {
  style.size *= scale;
  ui_.text(utf8, style, to_pixels(at), colour, glow);
}

void HudPen::panel(const glm::vec2& low, const glm::vec2& high, float corner, const Colour& colour,
                   float outline) const {
  ui_.panel(to_pixels(low), to_pixels(high), corner * scale, colour, outline * scale);
}

namespace {

const Colour kVeil{0.01f, 0.015f, 0.03f, 0.42f};  // lets a screen's words stand out from the table

struct KeyHelp {
  const char* keys;
  const char* meaning;
};
constexpr std::array<KeyHelp, 10> kAllKeys{
    {{"Mouse", "forward and back slides, sideways spins"},
     {"1 2 3 4", "take goalie, defence, midfield, attack"},
     {"Wheel", "next rod"},
     {"Tab", "rod nearest to the ball by itself"},
     {"Arrows, WASD", "slide and spin by keys"},
     {"Gamepad", "sticks slide and spin, shoulders change rod"},
     {"Space, click", "push: begin, confirm"},
     {"P", "pause"},
     {"F1, H", "show or hide the keys"},
     {"Esc", "release the mouse; again: leave"}}};
constexpr std::array<KeyHelp, 4> kSelectionKeys{{{"1 2 3", "or"},
                                                 {"wheel, arrows", "choose"},
                                                 {"Space, click", "confirm"},
                                                 {"F1", "all keys"}}};
constexpr std::array<KeyHelp, 3> kPauseKeys{
    {{"P", "play on"}, {"F1", "all keys"}, {"Esc", "release the mouse; again: leave"}}};

// One line at the bottom of the screen; how high it stands.
float draw_key_line(const HudPen& pen, std::span<const KeyHelp> line) {
  const TextStyle bold{Face::bold, 14.0f, 0.0f, Align::left};
  const TextStyle regular{Face::regular, 14.0f, 0.0f, Align::left};
  const float within = 7.0f, between = 24.0f;
  float width = -between;
  for (const KeyHelp& key : line)
    width += pen.width(key.keys, bold) + within + pen.width(key.meaning, regular) + between;
  const float half = 0.5f * width + 20.0f, y = pen.bottom - 24.0f;
  pen.panel({-half, y - 22.0f}, {half, y + 10.0f}, 10.0f, kPanel);
  float x = -0.5f * width;
  for (const KeyHelp& key : line) {
    pen.text(key.keys, bold, {x, y}, kInk);
    x += pen.width(key.keys, bold) + within;
    pen.text(key.meaning, regular, {x, y}, kFaint);
    x += pen.width(key.meaning, regular) + between;
  }
  return 38.0f;
}

std::string capitalised(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z')
    text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

// How a character's figures compare with the others': 0 least .. 1 most.
struct Traits {
  float reach, guard, agility;
};

Traits traits_of(int character) {
  const auto among = [&](auto value) {
    double least = 1e9, most = -1e9;
    for (int c = 0; c < foosball::kCharacters; ++c) {
      const double v = value(foosball::character_spec(c));
      least = std::min(least, v);
      most = std::max(most, v);
    }
    const double here = value(foosball::character_spec(character));
    return most > least ? static_cast<float>((here - least) / (most - least)) : 0.5f;
  };
  using Spec = foosball::CharacterSpec;
  return {among([](const Spec& s) { return s.foot_restitution * s.foot_reach; }),
          among([](const Spec& s) { return s.foot_width + s.torso_width; }),
          among([](const Spec& s) { return -s.mass; })};
}

void draw_trait(const HudPen& pen, const char* name, float share, const glm::vec2& at,
                const Colour& colour) {
  pen.text(name, {Face::regular, 12.5f, 0.0f, Align::left}, at, kFaint);
  const glm::vec2 low = at + glm::vec2(58.0f, -8.0f);
  pen.panel(low, low + glm::vec2(84.0f, 7.0f), 3.5f, {0.25f, 0.30f, 0.36f, 0.8f});
  pen.panel(low, low + glm::vec2(84.0f * (0.25f + 0.75f * share), 7.0f), 3.5f, colour);
}

void draw_character(const HudPen& pen, int character, const glm::vec2& at, float width, bool chosen,
                    const Colour& colour) {
  const glm::vec2 high = at + glm::vec2(width, 104.0f);
  pen.panel(at, high, 12.0f,
            chosen ? Colour{0.07f, 0.10f, 0.15f, 0.92f} : Colour{0.03f, 0.045f, 0.07f, 0.72f});
  if (chosen) pen.panel(at, high, 12.0f, colour, 2.0f);
  pen.text(capitalised(foosball::character_spec(character).name),
           {Face::bold, 18.0f, 0.0f, Align::left}, at + glm::vec2(18, 28), chosen ? kInk : kFaint);
  const Traits traits = traits_of(character);
  const Colour bar = chosen ? colour : Colour{0.55f, 0.62f, 0.70f, 0.8f};
  draw_trait(pen, "attack", traits.reach, at + glm::vec2(18, 52), bar);
  draw_trait(pen, "defence", traits.guard, at + glm::vec2(18, 71), bar);
  draw_trait(pen, "agility", traits.agility, at + glm::vec2(18, 90), bar);
}

}  // namespace

float draw_all_keys(const HudPen& pen) {
  constexpr std::size_t kRows = kAllKeys.size() / 2;
  const float height = 28.0f * static_cast<float>(kRows) + 28.0f, half = 478.0f;
  const float top = pen.bottom - 22.0f - height;
  pen.panel({-half, top}, {half, top + height}, 14.0f, {kPanel.r, kPanel.g, kPanel.b, 0.88f});
  for (std::size_t i = 0; i < kAllKeys.size(); ++i) {
    const float x = i % 2 == 0 ? -half + 26.0f : 30.0f;
    const std::size_t row = i / 2;
    const float y = top + 33.0f + 28.0f * static_cast<float>(row);
    pen.text(kAllKeys[i].keys, {Face::bold, 14.0f, 0.0f, Align::left}, {x, y}, kInk);
    pen.text(kAllKeys[i].meaning, {Face::regular, 14.0f, 0.0f, Align::left}, {x + 128.0f, y},
             kFaint);
  }
  return height + 20.0f;
}

float draw_keys_of_selection(const HudPen& pen) {
  return draw_key_line(pen, kSelectionKeys);
}

float draw_keys_of_pause(const HudPen& pen) {
  return draw_key_line(pen, kPauseKeys);
}

void draw_logo(const HudPen& pen, const wire::Snapshot& state, bool watches) {
  pen.panel({-pen.half_width, 0.0f}, {pen.half_width, pen.bottom}, 0.0f, kVeil);
  pen.text("SPACE", {Face::bold, 40.0f, 0.62f, Align::centre}, {12.0f, 92.0f},
           {0.62f, 0.84f, 1.0f, 1.0f}, 0.8f);
  pen.text("FOOSBALL", {Face::bold, 92.0f, 0.06f, Align::centre}, {0.0f, 176.0f},
           {0.97f, 0.98f, 1.0f, 1.0f}, 0.8f);
  pen.panel({-262.0f, 194.0f}, {-6.0f, 198.0f}, 2.0f, kTeamInk[pen.left_is_team_0 ? 0 : 1]);
  pen.panel({6.0f, 194.0f}, {262.0f, 198.0f}, 2.0f, kTeamInk[pen.left_is_team_0 ? 1 : 0]);
  const float pulse = 0.70f + 0.30f * std::sin(3.0f * state.screen_seconds);
  const char* call =
      watches ? "waiting for a player to push a rod" : "Push a rod to begin: click, Space or Enter";
  pen.text(call, {Face::regular, 21.0f, 0.01f, Align::centre}, {0.0f, 236.0f},
           {0.92f, 0.96f, 1.0f, pulse}, 0.8f);
}

void draw_selection(const HudPen& pen, const wire::Snapshot& state, int viewer_team) {
  pen.panel({-236.0f, 22.0f}, {236.0f, 104.0f}, 14.0f, kPanel);
  pen.text("CHOOSE YOUR CREW", {Face::bold, 32.0f, 0.10f, Align::centre}, {0.0f, 62.0f}, kInk,
           0.8f);
  pen.text("spin a rod to choose, push it to confirm", {Face::regular, 16.0f, 0.0f, Align::centre},
           {0.0f, 90.0f}, kFaint, 0.8f);
  for (int team = 0; team < 2; ++team) {
    const auto t = static_cast<std::size_t>(team);
    const float width = 184.0f;
    const float x = (team == 0) == pen.left_is_team_0 ? -pen.half_width + 36.0f
                                                      : pen.half_width - 36.0f - width;
    pen.panel({x - 14.0f, 108.0f}, {x + width + 14.0f, 546.0f}, 16.0f, kVeil);
    pen.text(kTeamNames[t], {Face::bold, 26.0f, 0.08f, Align::left}, {x + 2.0f, 142.0f},
             kTeamInk[t]);
    if (team == viewer_team)
      pen.text("you", {Face::regular, 15.0f, 0.0f, Align::right}, {x + width, 142.0f}, kInk);
    for (int c = 0; c < foosball::kCharacters; ++c) {
      draw_character(pen, c, {x, 158.0f + 116.0f * static_cast<float>(c)}, width,
                     state.character[t] == c, kTeamInk[t]);
    }
    const float y = 158.0f + 116.0f * foosball::kCharacters + 22.0f;
    const char* status = state.confirmed[t] ? "READY" : "choosing ...";
    pen.text(status, {Face::bold, 19.0f, 0.08f, Align::centre}, {x + 0.5f * width, y},
             state.confirmed[t] ? kTeamInk[t] : kFaint);
  }
}

void draw_ceremony(const HudPen& pen, const wire::Snapshot& state) {
  const auto team = static_cast<std::size_t>(state.last_scorer == 1);
  const float t = state.screen_seconds;
  const float grow = 1.0f + 0.35f * std::exp(-7.0f * t);
  const float y = 0.40f * pen.bottom;
  pen.panel({-pen.half_width, y - 92.0f}, {pen.half_width, y + 66.0f}, 0.0f,
            {0.02f, 0.03f, 0.05f, 0.55f});
  pen.text("GOAL", {Face::bold, 120.0f * grow, 0.16f, Align::centre}, {8.0f, y + 14.0f},
           kTeamInk[team], 0.8f);
  const std::string line = std::string(kTeamNames[team]) + " scores";
  pen.text(line, {Face::regular, 24.0f, 0.02f, Align::centre}, {0.0f, y + 50.0f}, kInk, 0.8f);
}

void draw_end(const HudPen& pen, const wire::Snapshot& state) {
  const auto team = static_cast<std::size_t>(state.last_scorer == 1);
  const float y = 0.38f * pen.bottom;
  pen.panel({-300.0f, y - 84.0f}, {300.0f, y + 96.0f}, 20.0f, {0.03f, 0.045f, 0.07f, 0.84f});
  pen.panel({-300.0f, y - 84.0f}, {300.0f, y + 96.0f}, 20.0f, kTeamInk[team], 2.0f);
  pen.text(std::string(kTeamNames[team]) + " WINS", {Face::bold, 58.0f, 0.05f, Align::centre},
           {0.0f, y - 14.0f}, kTeamInk[team], 0.8f);
  const std::size_t left = pen.left_is_team_0 ? 0 : 1;
  const std::string score =
      std::to_string(state.score[left]) + " : " + std::to_string(state.score[1 - left]);
  pen.text(score, {Face::bold, 40.0f, 0.05f, Align::centre}, {0.0f, y + 38.0f}, kInk);
  pen.text("push a rod to play again", {Face::regular, 17.0f, 0.0f, Align::centre},
           {0.0f, y + 74.0f}, kFaint);
}

void draw_paused(const HudPen& pen) {
  const float y = 0.42f * pen.bottom;
  pen.panel({-170.0f, y - 42.0f}, {170.0f, y + 32.0f}, 16.0f, {0.03f, 0.045f, 0.07f, 0.84f});
  pen.text("PAUSED", {Face::bold, 38.0f, 0.16f, Align::centre}, {4.0f, y + 9.0f}, kInk);
}

}  // namespace client
