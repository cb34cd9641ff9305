#include "render/hud_screens.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>
#include <string>
#include <vector>

#include "foosball/table.h"
#include "foosball/tuning.h"
#include "render/hud.h"
#include "render/match_text.h"
#include "render/sentences.h"
#include "render/translate.h"

namespace client {

namespace {

const Colour kVeil{0.01f, 0.015f, 0.03f, 0.42f};  // darkens the table behind a screen's text

struct KeyHelp {
  const char* keys;
  const char* meaning;
};
constexpr std::array<KeyHelp, 15> kAllKeys{
    {{N_("Mouse"), N_("forward and back slides, sideways spins")},
     {"1 2 3 4", N_("take goalie, defence, midfield, attack")},
     {N_("Wheel, Q E"), N_("next rod")},
     {"Tab", N_("automatic: rod nearest to the ball")},
     {N_("Arrows, WASD"), N_("slide and spin by keys")},
     {N_("Gamepad"), N_("sticks slide and spin, shoulders change rod")},
     {N_("Gamepad buttons"), N_("A push, Start pause, Back menu, Y time-out, X next man")},
     {N_("Space, click"), N_("push: begin, confirm")},
     {"P", N_("pause")},
     {"C", N_("camera: seat, above, follow, spectator")},
     {"F2 ... F7", N_("settings, seats, tuning, recordings, game, controllers")},
     {"T", N_("time-out")},
     {"F", N_("training: serve to the next man of the rod")},
     {"F1, H", N_("show or hide the keys")},
     {"Esc", N_("release the mouse; again: leave")}}};
constexpr std::array<KeyHelp, 4> kSelectionKeys{{{"1 - 9 0", N_("or")},
                                                 {N_("wheel, arrows"), N_("choose")},
                                                 {N_("Space, click"), N_("confirm")},
                                                 {"F1", N_("all keys")}}};
constexpr std::array<KeyHelp, 3> kLogoKeys{{{N_("Space, click"), N_("push: begin, confirm")},
                                            {"F6", N_("choose the game")},
                                            {"F1", N_("all keys")}}};
constexpr std::array<KeyHelp, 4> kPauseKeys{{{"P", N_("play on")},
                                             {"F1", N_("all keys")},
                                             {"F2", N_("settings")},
                                             {"Esc", N_("release the mouse; again: leave")}}};

constexpr TextStyle kKeyStyle{Face::bold, 14.0f, 0.0f, Align::left};
constexpr TextStyle kMeaningStyle{Face::regular, 14.0f, 0.0f, Align::left};
constexpr float kWithinKey = 7.0f, kBetweenKeys = 24.0f, kKeyLineHeight = 38.0f;

float key_line_half(const HudPen& pen, std::span<const KeyHelp> line) {
  float width = -kBetweenKeys;
  for (const KeyHelp& key : line) {
    width += pen.width(tr(key.keys), kKeyStyle) + kWithinKey +
             pen.width(tr(key.meaning), kMeaningStyle) + kBetweenKeys;
  }
  return 0.5f * width + 20.0f;
}

float key_line_height(const HudPen& whole, std::span<const KeyHelp> line) {
  return kKeyLineHeight * whole.fitting(key_line_half(whole, line), 60.0f).scale / whole.scale;
}

// One line at the bottom of the screen, above `below`; returns its height.
float draw_key_line(const HudPen& whole, std::span<const KeyHelp> line, float below = 0.0f) {
  const float half = key_line_half(whole, line);
  const HudPen pen = whole.fitting(half, 60.0f);
  const float y = pen.bottom - 24.0f - below * whole.scale / pen.scale;
  pen.panel({-half, y - 22.0f}, {half, y + 10.0f}, 10.0f, kPanel);
  float x = 20.0f - half;
  for (const KeyHelp& key : line) {
    pen.text(tr(key.keys), kKeyStyle, {x, y}, kInk);
    x += pen.width(tr(key.keys), kKeyStyle) + kWithinKey;
    pen.text(tr(key.meaning), kMeaningStyle, {x, y}, kFaint);
    x += pen.width(tr(key.meaning), kMeaningStyle) + kBetweenKeys;
  }
  return below + key_line_height(whole, line);
}

std::string capitalised(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z')
    text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

// A character's values relative to the other characters: 0 lowest .. 1 highest.
struct Traits {
  float attack, guard, agility;
};

Traits traits_of(const foosball::Characters& characters, const foosball::Character& one) {
  const auto among = [&](auto value) {
    double min = 1e9, max = -1e9;
    for (const foosball::Character& c : characters) {
      min = std::min(min, value(c.body));
      max = std::max(max, value(c.body));
    }
    const double span = max - min;
    return span > 1e-9 * max ? static_cast<float>((value(one.body) - min) / span) : 0.5f;
  };
  using Body = foosball::CharacterBody;
  static constexpr foosball::Tuning kHand;  // beyond it no limit of a character matters
  constexpr double kRod = 1.5;              // with the hand [kg]
  return {
      among([](const Body& b) {
        return (1.0 + b.restitution) * std::min(b.turn_speed, kHand.turn_rate);
      }),
      among([](const Body& b) { return b.foot_width + b.torso_width; }),
      among([](const Body& b) { return std::min(b.slide_speed, 4.0) / (kRod + 4.0 * b.mass); })};
}

void draw_trait(const HudPen& pen, const char* name, float share, const glm::vec2& at, float room,
                const Colour& colour, float text_size) {
  const float label = 5.8f * text_size, high = 0.56f * text_size;
  pen.text(name, {Face::regular, text_size, 0.0f, Align::left}, at, kFaint, 0.55f, label - 4.0f);
  const glm::vec2 low = at + glm::vec2(label, -0.64f * text_size);
  const float width = std::max(room - label, 10.0f);
  pen.panel(low, low + glm::vec2(width, high), 0.5f * high, {0.25f, 0.30f, 0.36f, 0.8f});
  pen.panel(low, low + glm::vec2(width * (0.25f + 0.75f * share), high), 0.5f * high, colour);
}

// For a row of that height, such that its lines do not touch.
float trait_text_size(float height) {
  return std::min(14.0f, 0.175f * height);
}

// The portrait, the name, and the strengths if they are legible.
void draw_character(const HudPen& pen, const foosball::Characters& characters, int character,
                    int team, const glm::vec2& low, const glm::vec2& size, bool chosen) {
  const foosball::Character& shown = foosball::nearest(characters, character);
  const auto& colour = kTeamInk[static_cast<std::size_t>(team)];
  const glm::vec2 high = low + size;
  pen.panel(low, high, 12.0f,
            chosen ? Colour{0.07f, 0.10f, 0.15f, 0.92f} : Colour{0.03f, 0.045f, 0.07f, 0.72f});
  const float tall = std::min(size.y - 8.0f, 0.34f * size.x), wide = 0.8f * tall;
  const float above = 0.5f * (size.y - tall);
  pen.picture(character, team, low + glm::vec2(4.0f, above),
              low + glm::vec2(4.0f + wide, above + tall));
  if (chosen) pen.panel(low, high, 12.0f, colour, 2.0f);
  if (character < 10)  // its number key
    pen.text(std::to_string((character + 1) % 10), {Face::bold, 14.0f, 0.0f, Align::right},
             {high.x - 9.0f, low.y + 18.0f}, chosen ? kInk : kFaint);
  const glm::vec2 text = low + glm::vec2(wide + 12.0f, 0.0f);
  const float room = size.x - wide - 20.0f, line = trait_text_size(size.y);
  const bool traits_shown = chosen || line * pen.scale >= kMinRead;
  pen.text(capitalised(tr(shown.name.c_str())),
           {Face::bold, std::min(18.0f, 0.29f * size.y), 0.0f, Align::left},
           text + glm::vec2(0.0f, traits_shown ? 0.22f * size.y + 6.5f : 0.5f * size.y + 6.5f),
           chosen ? kInk : kFaint, 0.55f, room - 12.0f);
  if (!traits_shown) return;
  const Traits traits = traits_of(characters, shown);
  const Colour bar = chosen ? colour : Colour{0.55f, 0.62f, 0.70f, 0.8f};
  const auto trait = [&](const char* name, float share, float down) {
    draw_trait(pen, name, share, text + glm::vec2(0.0f, down * size.y), room, bar, line);
  };
  trait(tr("attack"), traits.attack, 0.53f);
  trait(tr("defence"), traits.guard, 0.72f);
  trait(tr("agility"), traits.agility, 0.91f);
}

// The chosen one, large enough to recognise its face: beside the list, if there is space.
void draw_chosen(const HudPen& pen, int character, int team, const glm::vec2& low, float width) {
  const glm::vec2 size(width, 1.25f * width);
  pen.panel(low, low + size, 14.0f, {0.03f, 0.045f, 0.07f, 0.80f});
  pen.picture(character, team, low + 3.0f, low + size - 3.0f);
  pen.panel(low, low + size, 14.0f, kTeamInk[static_cast<std::size_t>(team)], 2.0f);
}

}  // namespace

namespace {

// Layout of all keys: number of columns, and size.
struct KeysLayout {
  HudPen pen;
  std::size_t columns, rows;
  float half, height;
  bool readable;  // else one line says less
  float taken() const { return height + 18.0f; }
};

constexpr float kBetweenColumns = 34.0f;

struct KeyColumn {
  float keys = 0.0f, meaning = 0.0f;
  float width() const { return keys + 14.0f + meaning; }
};

KeyColumn key_column(const HudPen& pen) {
  KeyColumn column;
  for (const KeyHelp& key : kAllKeys) {
    column.keys = std::max(column.keys, pen.width(tr(key.keys), kKeyStyle));
    column.meaning = std::max(column.meaning, pen.width(tr(key.meaning), kMeaningStyle));
  }
  return column;
}

KeysLayout keys_in(std::size_t columns, const HudPen& whole, float room) {
  const std::size_t rows = (kAllKeys.size() + columns - 1) / columns;
  const float column = key_column(whole).width();
  const float half = 0.5f * (columns == 2 ? 2.0f * column + kBetweenColumns : column) + 24.0f;
  const float height = 26.0f * static_cast<float>(rows) + 26.0f;
  const HudPen large = columns == 1 ? whole.readable(0.8f, half + 4.0f) : whole;
  const float fits = std::min(large.bottom, room * whole.scale / large.scale) / large.bottom;
  const HudPen pen =
      large.fitting(half + 4.0f, (fits < 0.999f ? height + 18.0f : height + 40.0f) / fits);
  const HudPen alone = whole.fitting(half + 4.0f, height + 40.0f);
  constexpr float kSmallest = 0.85f;  // of its unbounded size; smaller is hard to read
  return {pen, columns, rows, half, height, pen.scale >= kSmallest * alone.scale};
}

// In two columns if there is space, else in one; also in one if that is clearly larger.
KeysLayout keys_layout(const HudPen& whole, float room) {
  const KeysLayout one = keys_in(1, whole, room);
  if (whole.half_width <= key_column(whole).width() + 0.5f * kBetweenColumns + 26.0f) return one;
  const KeysLayout two = keys_in(2, whole, room);
  return one.readable && one.pen.scale > 1.15f * two.pen.scale ? one : two;
}

}  // namespace

float all_keys_height(const HudPen& whole, float room) {
  const KeysLayout layout = keys_layout(whole, room);
  if (!layout.readable) return key_line_height(whole, kLogoKeys);
  return layout.taken() * layout.pen.scale / whole.scale;
}

float draw_all_keys(const HudPen& whole, float room) {
  const KeysLayout layout = keys_layout(whole, room);
  if (!layout.readable) return draw_key_line(whole, kLogoKeys);
  const HudPen& pen = layout.pen;
  const KeyColumn column = key_column(pen);
  const float half = layout.half, top = pen.bottom - layout.taken();
  pen.panel({-half, top}, {half, top + layout.height}, 14.0f,
            {kPanel.r, kPanel.g, kPanel.b, 0.88f});
  for (std::size_t i = 0; i < kAllKeys.size(); ++i) {
    const std::size_t row = i / layout.columns;
    const float right = i % layout.columns == 0 ? 0.0f : column.width() + kBetweenColumns;
    const float x = -half + 24.0f + right, y = top + 31.0f + 26.0f * static_cast<float>(row);
    pen.text(tr(kAllKeys[i].keys), kKeyStyle, {x, y}, kInk);
    pen.text(tr(kAllKeys[i].meaning), kMeaningStyle, {x + column.keys + 14.0f, y}, kFaint);
  }
  return layout.taken() * pen.scale / whole.scale;
}

float draw_keys_of_selection(const HudPen& pen) {
  return draw_key_line(pen, kSelectionKeys);
}

float draw_keys_of_pause(const HudPen& pen, float below) {
  return draw_key_line(pen, kPauseKeys, below);
}

float logo_height(const HudPen& whole) {
  const HudPen pen = whole.fitting(400.0f, 250.0f);
  return 250.0f * pen.scale / whole.scale;
}

void draw_logo(const HudPen& whole, const wire::Snapshot& state, bool watches, bool still) {
  whole.panel({-whole.half_width, 0.0f}, {whole.half_width, whole.bottom}, 0.0f, kVeil);
  const HudPen pen = whole.fitting(400.0f, 250.0f);
  pen.text("SPACE", {Face::bold, 40.0f, 0.62f, Align::centre}, {12.0f, 92.0f},
           {0.62f, 0.84f, 1.0f, 1.0f}, 0.8f);
  pen.text("FOOSBALL", {Face::bold, 92.0f, 0.06f, Align::centre}, {0.0f, 176.0f},
           {0.97f, 0.98f, 1.0f, 1.0f}, 0.8f);
  pen.panel({-262.0f, 194.0f}, {-6.0f, 198.0f}, 2.0f, kTeamInk[pen.left_is_team_0 ? 0 : 1]);
  pen.panel({6.0f, 194.0f}, {262.0f, 198.0f}, 2.0f, kTeamInk[pen.left_is_team_0 ? 1 : 0]);
  const float pulse = still ? 1.0f : 0.70f + 0.30f * std::sin(3.0f * state.screen_seconds);
  const char* call = watches ? tr("waiting for a player to push a rod")
                             : tr("Push a rod to begin: click, Space or Enter");
  pen.text(call, {Face::regular, 21.0f, 0.01f, Align::centre}, {0.0f, 236.0f},
           {0.92f, 0.96f, 1.0f, pulse}, 0.8f);
}

namespace {

constexpr float kBetweenRows = 6.0f;

struct RowHeights {
  float chosen, other;
};

// The chosen row is taller if the rows are too low to read all text.
RowHeights row_heights(float room, int rows, float scale) {
  const float even = std::min(124.0f, room / static_cast<float>(rows));
  const float min = kMinRead / (0.175f * scale) + kBetweenRows;
  if (even >= min) return {even, even};
  const float chosen = std::min(min, 0.4f * room);
  return {chosen, (room - chosen) / static_cast<float>(rows - 1)};
}

// In at most two lines, below the list.
void draw_specialty(const HudPen& pen, const foosball::Character& one, float middle, float y,
                    float room) {
  const TextStyle style{Face::regular, 13.5f, 0.0f, Align::centre};
  std::vector<std::string> lines = pen.wrapped(capitalised(tr(one.specialty.c_str())), style, room);
  for (; lines.size() > 2; lines.pop_back()) lines[lines.size() - 2] += " " + lines.back();
  for (const std::string& line : lines) {
    y += 17.0f;
    pen.text(line, style, {middle, y}, kInk, 0.55f, room);
  }
}

HudPen selection_pen(const HudPen& whole) {
  return whole.readable(0.8f, 300.0f).fitting(300.0f, 660.0f);
}

}  // namespace

glm::vec2 selection_title_size(const HudPen& whole) {
  return glm::vec2(208.0f, 98.0f) * (selection_pen(whole).scale / whole.scale);
}

// Each team's characters on the team's side, as many as fit vertically.
void draw_selection(const HudPen& whole, const wire::Snapshot& state,
                    const foosball::Characters& characters, int viewer_team) {
  constexpr int kAtOnce = 6;
  const int count = static_cast<int>(characters.size()), shown = std::min(count, kAtOnce);
  const HudPen pen = selection_pen(whole);
  const auto mode = mode_lines(state, pen.left_is_team_0 ? 0 : 1);
  const float up = mode[0].empty() ? 0.0f : 10.0f;  // space for it
  pen.panel({-200.0f, 16.0f - up}, {200.0f, 88.0f + up}, 14.0f, kPanel);
  pen.text(tr("CHOOSE YOUR CREW"), {Face::bold, 28.0f, 0.08f, Align::centre}, {0.0f, 50.0f - up},
           kInk, 0.8f, 370.0f);
  pen.text(tr("spin a rod to choose, push it to confirm"),
           {Face::regular, 15.0f, 0.0f, Align::centre}, {0.0f, 76.0f - up}, kFaint, 0.8f, 370.0f);
  if (!mode[0].empty())
    pen.text(mode[0] + ": " + mode[1], {Face::bold, 18.0f, 0.0f, Align::centre}, {0.0f, 80.0f + up},
             kWarning, 0.8f, 370.0f);
  const float width = 262.0f, top = 114.0f, header = 46.0f, footer = 76.0f;
  const float keys = key_line_height(whole, kSelectionKeys) * whole.scale / pen.scale;
  const RowHeights rows = row_heights(pen.bottom - keys - 10.0f - top - header - footer,
                                      static_cast<int>(kAtOnce), pen.scale);
  for (int team = 0; team < 2; ++team) {
    const auto t = static_cast<std::size_t>(team);
    const bool at_left = (team == 0) == pen.left_is_team_0;
    const float x = at_left ? -pen.half_width + 24.0f : pen.half_width - 24.0f - width;
    const float end = top + header + rows.chosen + rows.other * static_cast<float>(shown - 1);
    const int chosen = std::min<int>(state.character[t], count - 1);
    const int first = std::clamp(chosen - kAtOnce / 2, 0, count - shown);
    pen.panel({x - 12.0f, top}, {x + width + 12.0f, end + footer}, 16.0f, kVeil);
    pen.text(team_with_mark(team), {Face::bold, 25.0f, 0.06f, Align::left}, {x + 2.0f, top + 34.0f},
             kTeamInk[t], 0.55f, width - 70.0f);
    if (team == viewer_team)
      pen.text(tr("you"), {Face::regular, 15.0f, 0.0f, Align::right}, {x + width, top + 34.0f},
               kInk);
    float y = top + header;
    for (int one = first; one < first + shown; ++one) {
      const float height = one == chosen ? rows.chosen : rows.other;
      draw_character(pen, characters, one, team, {x, y}, {width, height - kBetweenRows},
                     one == chosen);
      y += height;
    }
    draw_specialty(pen, foosball::nearest(characters, chosen), x + 0.5f * width, end, width);
    constexpr float kPortrait = 168.0f;
    const float inner = at_left ? x + width + 26.0f : x - 26.0f - kPortrait;
    if (pen.half_width - 62.0f - width > kPortrait) {
      draw_chosen(pen, chosen, team, {inner, top}, kPortrait);
    }
    if (count > shown) {
      const std::string place = std::to_string(chosen + 1) + " / " + std::to_string(count);
      pen.text(place, {Face::regular, 13.0f, 0.0f, Align::right}, {x + width, end + 61.0f}, kFaint);
    }
    const char* status = state.confirmed[t] ? tr("READY") : tr("choosing ...");
    pen.text(status, {Face::bold, 19.0f, 0.08f, Align::centre}, {x + 0.5f * width, end + 62.0f},
             state.confirmed[t] ? kTeamInk[t] : kFaint, 0.55f, width);
  }
}

void draw_ceremony(const HudPen& whole, const wire::Snapshot& state, const CeremonyText& text,
                   bool replay, bool still, bool at_the_bottom) {
  const HudPen pen = whole.fitting(430.0f, 180.0f);
  const float grow = still ? 0.0f : 0.25f * std::exp(-7.0f * state.screen_seconds);
  const float high = 78.0f, top = at_the_bottom ? pen.bottom - high - 74.0f : 84.0f;
  const Colour& ink = kTeamInk[state.last_scorer == 1 ? 1 : 0];
  pen.panel({-pen.half_width, top}, {pen.half_width, top + high}, 0.0f,
            {0.25f * ink.r, 0.25f * ink.g, 0.25f * ink.b, 0.80f});
  for (const float y : {top, top + high - 4.0f})
    pen.panel({-pen.half_width, y}, {pen.half_width, y + 4.0f}, 0.0f, ink);
  pen.text(text.call, {Face::bold, 52.0f * (1.0f + grow), 0.14f, Align::right},
           {-20.0f, top + 58.0f}, ink, 0.8f, 380.0f);
  pen.text(text.line, {Face::bold, 22.0f, 0.02f, Align::left}, {10.0f, top + 34.0f}, kInk, 0.8f,
           400.0f);
  pen.text(text.detail, {Face::regular, 18.0f, 0.0f, Align::left}, {10.0f, top + 62.0f}, kInk, 0.8f,
           400.0f);
  if (!replay) return;
  const float y = at_the_bottom ? top - 42.0f : top + high + 10.0f;
  pen.panel({-pen.half_width + 16.0f, y}, {-pen.half_width + 236.0f, y + 32.0f}, 8.0f, kPanel);
  pen.text(tr("SLOW MOTION - push to go on"), {Face::bold, 14.0f, 0.02f, Align::centre},
           {-pen.half_width + 126.0f, y + 21.0f}, kWarning, 0.55f, 206.0f);
}

namespace {

struct EndRow {
  const char* name;
  std::array<std::string, 2> values;  // by team
};

std::string fixed(float number, const char* unit) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f %s", static_cast<double>(number), unit);
  return text;
}

// 0: no shot, or unknown.
std::string shot_text(float speed) {
  return speed > 0.0f ? fixed(speed, "m/s") : "-";
}

// The two teams' values.
template <class Team, class Value>
std::array<std::string, 2> both(const std::array<Team, 2>& teams, Value value) {
  return {value(teams[0]), value(teams[1])};
}

std::vector<EndRow> end_rows(const std::array<TeamStatistics, 2>& s) {
  const float played = std::max(s[0].possession + s[1].possession, 1e-3f);
  return {{tr("shots"), both(s, [](const auto& t) { return std::to_string(t.shots); })},
          {tr("saves"), both(s, [](const auto& t) { return std::to_string(t.saves); })},
          {tr("fastest shot"), both(s, [](const auto& t) { return shot_text(t.fastest_shot); })},
          {tr("possession"),
           both(s,
                [&](const auto& t) {
                  return std::to_string(std::lround(100.0f * t.possession / played)) + " %";
                })},
          {tr("own goals"), both(s, [](const auto& t) { return std::to_string(t.own_goals); })}};
}

// Replaces values by the referee's count, and adds values that are not observed here.
void take_report(std::vector<EndRow>& rows, const wire::Report& report) {
  const auto& r = report.teams;
  const float played = std::max(r[0].possession + r[1].possession, 1e-3f);
  rows[0] = {tr("shots (on target)"), both(r, [](const auto& t) {
               return std::to_string(t.shots) + " (" + std::to_string(t.shots_on_target) + ")";
             })};
  rows[1].values = both(r, [](const auto& t) { return std::to_string(t.saves); });
  rows[3].values = both(r, [&](const auto& t) {
    return std::to_string(std::lround(100.0f * t.possession / played)) + " %";
  });
  rows[4].values = both(r, [](const auto& t) { return std::to_string(t.own_goals); });
  rows[2].values = both(r, [](const auto& t) { return shot_text(t.fastest_shot); });
  rows.insert(rows.begin() + 2,
              {tr("passes"), both(r, [](const auto& t) { return std::to_string(t.passes); })});
  rows.push_back({tr("rating (Elo)"), both(r, [](const auto& t) {
                    char text[40];
                    std::snprintf(text, sizeof text, "%.0f (%+.0f)", static_cast<double>(t.rating),
                                  static_cast<double>(t.rating_change));
                    return std::string(text);
                  })});
}

}  // namespace

float fame_height(std::size_t players) {
  return 74.0f + 24.0f * static_cast<float>(players);
}

void draw_fame(const HudPen& whole, std::span<const wire::Fame> fame, float y) {
  const float half = 320.0f;
  const HudPen pen = whole.fitting(half + 8.0f, whole.bottom);
  const float top = y * whole.scale / pen.scale;
  pen.panel({-half, top}, {half, top + fame_height(fame.size())}, 14.0f,
            {kPanel.r, kPanel.g, kPanel.b, 0.88f});
  pen.text(tr("HALL OF FAME"), {Face::bold, 17.0f, 0.10f, Align::centre}, {0.0f, top + 27.0f},
           {0.62f, 0.84f, 1.0f, 1.0f}, 0.55f, 2.0f * half - 30.0f);
  // Right edges of the columns, and their width.
  constexpr float kRating = 24.0f, kWon = 104.0f, kSaves = 184.0f, kFastest = 262.0f, kRoom = 72.0f;
  float line = top + 54.0f;
  const auto heading = [&](const char* name, float at, float room) {
    pen.text(name, {Face::regular, 12.0f, 0.0f, Align::right}, {half - at, line - 3.0f}, kFaint,
             0.55f, room);
  };
  heading(tr("rating (Elo)"), kRating, kRoom);
  heading(tr("won"), kWon, kRoom);
  heading(tr("saves"), kSaves, kRoom);
  heading(tr("fastest shot"), kFastest, 2.0f * kRoom);
  line += 22.0f;
  for (std::size_t i = 0; i < fame.size(); ++i) {
    const Colour& ink = i == 0 ? kWarning : kInk;
    pen.text(std::to_string(i + 1), {Face::bold, 15.0f, 0.0f, Align::right}, {-half + 34.0f, line},
             kFaint);
    pen.text(tr_player(fame[i].name), {Face::bold, 15.0f, 0.0f, Align::left}, {-half + 46.0f, line},
             ink, 0.55f, 2.0f * half - kFastest - kRoom - 52.0f);
    const std::string won = std::to_string(fame[i].wins) + " / " + std::to_string(fame[i].matches);
    const auto column = [&](const std::string& text, float at) {
      pen.text(text, {Face::regular, 14.0f, 0.0f, Align::right}, {half - at, line}, kFaint, 0.55f,
               kRoom);
    };
    column(won, kWon);
    column(shot_text(fame[i].fastest_shot), kFastest);
    // As a fraction of the shots on target that the player's teams faced.
    const float faced = static_cast<float>(fame[i].shots_faced);
    const float saved = std::min(1.0f, static_cast<float>(fame[i].saves) / std::max(faced, 1.0f));
    column(faced > 0.0f ? std::to_string(std::lround(100.0f * saved)) + " %" : "-", kSaves);
    char rating[24];
    std::snprintf(rating, sizeof rating, "%.0f", static_cast<double>(fame[i].rating));
    pen.text(rating, {Face::bold, 15.0f, 0.0f, Align::right}, {half - kRating, line}, ink);
    line += 24.0f;
  }
}

void draw_end(const HudPen& whole, const wire::Snapshot& state, const EndText& text,
              const std::array<TeamStatistics, 2>& statistics, const wire::Report* report,
              float room) {
  const auto team = static_cast<std::size_t>(state.last_scorer == 1);
  std::vector<EndRow> rows = end_rows(statistics);
  if (report != nullptr) take_report(rows, *report);
  const float details = 26.0f * static_cast<float>(text.details.size());
  constexpr float kHalf = 310.0f, kAround = 24.0f;
  const auto height_of = [&] { return 210.0f + details + 28.0f * static_cast<float>(rows.size()); };
  const auto fitted = [&] {
    return whole.fitting(kHalf + 10.0f, (height_of() + kAround) * whole.bottom / room);
  };
  while (rows.size() > 1 && 16.0f * fitted().scale < kMinRead) rows.pop_back();
  const HudPen pen = fitted();
  const float half = kHalf, height = height_of();
  const float top = 0.5f * (room * whole.scale / pen.scale - height);
  pen.panel({-half, top}, {half, top + height}, 20.0f, {0.03f, 0.045f, 0.07f, 0.86f});
  const bool drawn = state.score[0] == state.score[1];
  pen.panel({-half, top}, {half, top + height}, 20.0f, drawn ? kFaint : kTeamInk[team], 2.0f);
  pen.text(text.title, {Face::bold, 50.0f, 0.04f, Align::centre}, {0.0f, top + 62.0f},
           drawn ? kInk : kTeamInk[team], 0.8f, 2.0f * half - 40.0f);
  const std::size_t left = pen.left_is_team_0 ? 0 : 1, right = 1 - left;
  const std::string result =
      std::to_string(text.result[left]) + " : " + std::to_string(text.result[right]);
  pen.text(result, {Face::bold, 44.0f, 0.05f, Align::centre}, {0.0f, top + 116.0f}, kInk);
  for (const auto& [at, of] : {std::pair(-1.0f, left), std::pair(1.0f, right)}) {
    pen.text(team_with_mark(static_cast<int>(of)), {Face::bold, 19.0f, 0.04f, Align::centre},
             {at * 200.0f, top + 112.0f}, kTeamInk[of], 0.55f, 190.0f);
  }
  float y = top + 148.0f;
  for (const std::string& detail : text.details) {
    pen.text(detail, {Face::bold, 18.0f, 0.02f, Align::centre}, {0.0f, y}, kWarning, 0.55f,
             2.0f * half - 40.0f);
    y += 26.0f;
  }
  y += 8.0f;
  for (const EndRow& row : rows) {
    pen.text(row.name, {Face::regular, 16.0f, 0.0f, Align::centre}, {0.0f, y}, kFaint, 0.55f,
             220.0f);
    pen.text(row.values[left], {Face::bold, 17.0f, 0.0f, Align::centre}, {-200.0f, y}, kInk);
    pen.text(row.values[right], {Face::bold, 17.0f, 0.0f, Align::centre}, {200.0f, y}, kInk);
    y += 28.0f;
  }
  pen.text(text.call, {Face::regular, 17.0f, 0.0f, Align::centre}, {0.0f, top + height - 20.0f},
           kFaint, 0.55f, 2.0f * half - 40.0f);
}

void draw_paused(const HudPen& whole) {
  const HudPen pen = whole.fitting(190.0f, 200.0f);
  const float y = 0.42f * pen.bottom;
  pen.panel({-170.0f, y - 42.0f}, {170.0f, y + 32.0f}, 16.0f, {0.03f, 0.045f, 0.07f, 0.84f});
  pen.text(tr("PAUSED"), {Face::bold, 38.0f, 0.16f, Align::centre}, {4.0f, y + 9.0f}, kInk, 0.55f,
           310.0f);
}

}  // namespace client
