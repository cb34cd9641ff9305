#include "render/hud.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>
#include <vector>

#include "foosball/table.h"
#include "render/hud_screens.h"
#include "render/match_text.h"
#include "render/scene.h"
#include "render/sentences.h"
#include "render/table_mesh.h"
#include "render/translate.h"

namespace client {
namespace {

// In the place of a team's character, so that the board covers no more of the field.
void draw_possession(const HudPen& pen, const PossessionClock& clock, const glm::vec2& at) {
  pen.text(std::to_string(clock.seconds) + " s", {Face::bold, 23.0f, 0.0f, Align::centre}, at,
           clock.hurries ? kWarning : kInk, 0.55f, 108.0f);
}

// Height of the board at the lower edge.
constexpr float kBoardRoom = 74.0f;

// Half width of the board, and its height from its edge of the picture.
glm::vec2 board_size(const HudPen& whole) {
  return glm::vec2(204.0f, 76.0f) * (whole.fitting(204.0f, 90.0f).scale / whole.scale);
}

// The board's upper edge is at y.
void draw_score(const HudPen& whole, const HudState& hud, bool at_the_bottom) {
  const wire::Snapshot& state = *hud.state;
  const HudPen pen = whole.fitting(204.0f, 90.0f);
  const float half = 196.0f, height = 62.0f;
  const float y = at_the_bottom ? pen.bottom - height - 6.0f : 14.0f;
  const auto possession = possession_clock(state);
  pen.panel({-half, y}, {half, y + height}, 14.0f, kPanel);
  for (int team = 0; team < 2; ++team) {
    // Left on the board is left in the picture: a viewer of team 1 sees the table rotated.
    const float side = (team == 0) == pen.left_is_team_0 ? -1.0f : 1.0f;
    const auto t = static_cast<std::size_t>(team);
    const std::string score = std::to_string(state.score[t]);
    pen.text(score, {Face::bold, 44.0f, 0.0f, Align::centre}, {side * 54.0f, y + 47.0f},
             kTeamInk[t]);
    const bool counted = possession && possession->team == team;
    const TextStyle small{Face::regular, std::max(11.5f, kMinRead / pen.scale), 0.01f,
                          Align::centre};
    const bool crew = small.size <= 13.0f;  // a larger font leaves no space
    const float name_at = counted ? 23.0f : crew ? 31.0f : 37.0f;
    pen.text(team_with_mark(team), {Face::bold, counted ? 15.0f : 18.0f, 0.06f, Align::centre},
             {side * 137.0f, y + name_at}, kTeamInk[t], 0.55f, 108.0f);
    if (counted) {
      draw_possession(pen, *possession, {side * 137.0f, y + 49.0f});
      continue;
    }
    const std::string& name = foosball::nearest(*hud.characters, state.character[t]).name;
    if (crew) pen.text(tr(name.c_str()), small, {side * 137.0f, y + 49.0f}, kFaint, 0.55f, 108.0f);
  }
  // At the end of a match of one set there are no sets to count.
  const int min_sets = state.screen == number(wire::Screen::end) ? 2 : 1;
  if (state.sets[0] + state.sets[1] >= min_sets) {
    const std::size_t left = pen.left_is_team_0 ? 0 : 1;
    const std::string sets = std::string(tr("sets")) + " " + std::to_string(state.sets[left]) +
                             " : " + std::to_string(state.sets[1 - left]);
    pen.text(sets, {Face::regular, 11.5f, 0.0f, Align::centre}, {0.0f, y + 56.0f}, kFaint, 0.55f,
             70.0f);
  }
  char clock[32];
  // For a timed set the time left, otherwise the time played.
  const float shown = state.timed ? state.seconds_left : state.play_seconds;
  const int seconds = std::max(0, static_cast<int>(std::min(shown, 35999.0f)));
  std::snprintf(clock, sizeof clock, "%d:%02d", seconds / 60, seconds % 60);
  pen.text(clock, {Face::regular, 14.0f, 0.04f, Align::centre}, {0.0f, y + 38.0f}, kInk);
}

constexpr float kSmallWindow = 0.75f;  // pixels per unit: below, match messages are larger

// Beside the board.
void draw_rules_line(const HudPen& whole, const HudState& hud, bool at_the_bottom) {
  const std::string line = rules_line(hud);
  if (line.empty()) return;
  const TextStyle style{Face::bold, 16.0f, 0.0f, Align::centre};
  const float wanted = 0.5f * whole.width(line, style) + 14.0f;
  const HudPen pen = whole.readable(kSmallWindow, wanted + 4.0f);
  const float half = std::min(wanted, pen.half_width - 4.0f);
  const float board = 76.0f * whole.scale / pen.scale;
  const float y = at_the_bottom ? pen.bottom - board - 28.0f : board + 6.0f;
  pen.panel({-half, y}, {half, y + 26.0f}, 8.0f, {0.20f, 0.13f, 0.02f, 0.86f});
  pen.text(line, style, {0.0f, y + 19.0f}, kWarning, 0.55f, 2.0f * half - 12.0f);
}

bool shows_score(const HudState& hud) {
  return hud.state != nullptr && (hud.state->screen == number(wire::Screen::play) ||
                                  hud.state->screen == number(wire::Screen::ceremony) ||
                                  hud.state->screen == number(wire::Screen::end));
}

// Height of the board and the rules line at the lower edge, if they are there.
float lower_room(const HudState& hud) {
  if (!shows_score(hud) || hud.view != View::above) return 0.0f;
  const bool play = hud.state->screen == number(wire::Screen::play);
  return kBoardRoom + (play && !rules_line(hud).empty() ? 30.0f : 0.0f);
}

// Marks the handle of a rod that nobody drives; a handle outside the picture is marked at its edge.
void draw_held_rods(const HudPen& whole, const HudState& hud, const glm::ivec2& screen) {
  const HudPen pen = whole.readable(0.85f, 200.0f);
  const TextStyle style{Face::bold, 13.0f, 0.06f, Align::centre};
  const float half = 0.5f * pen.width(tr("HELD"), style) + 8.0f;
  const auto& table = foosball::table_spec(static_cast<foosball::Layout>(hud.state->layout));
  for (int rod = 0; rod < foosball::kRods; ++rod) {
    const auto r = static_cast<std::size_t>(rod);
    if (!rod_is_held(hud.state->rods[r])) continue;
    const float y = hud.state->rods[r].slide + 0.9f * handle_offset(table, rod);
    const glm::vec3 p = hud.camera.project(
        {static_cast<float>(table.rods[r].x), y, static_cast<float>(table.rod_height)}, screen);
    const float side = (half + 19.0f) * pen.scale;
    const glm::vec2 at = pen.from_pixels(
        {std::clamp(p.x, side, std::max(static_cast<float>(screen.x) - side, side)),
         std::clamp(p.y, 100.0f * pen.scale, static_cast<float>(screen.y) - 60.0f * pen.scale)});
    pen.panel(at + glm::vec2(-half, -12), at + glm::vec2(half, 11), 6.0f,
              {0.22f, 0.15f, 0.02f, 0.88f});
    pen.text(tr("HELD"), style, at + glm::vec2(0, 5), kWarning);
  }
}

// Beside the board if it is at the bottom, otherwise below the other lines in the corner.
void draw_mode(const HudPen& whole, const HudState& hud) {
  const auto lines = mode_lines(*hud.state, whole.left_is_team_0 ? 0 : 1);
  if (lines[0].empty()) return;
  const bool above = hud.view == View::above;
  const HudPen pen = above ? whole : whole.readable(kSmallWindow, 400.0f);
  const TextStyle bold{Face::bold, 15.0f, 0.0f, Align::left};
  const TextStyle regular{Face::regular, 14.0f, 0.0f, Align::left};
  const float beside = pen.half_width - 16.0f - 212.0f;
  const bool narrow = beside < 100.0f;  // above the board and the rules line
  const float x = -pen.half_width + 16.0f;
  const float y = !above ? 70.0f : pen.bottom - (narrow ? 134.0f : 36.0f);
  const float room = above && !narrow ? beside : pen.half_width;
  const float width =
      std::min(room, std::max(pen.width(lines[0], bold), pen.width(lines[1], regular)));
  pen.panel({x - 10.0f, y - 19.0f}, {x + width + 10.0f, y + 27.0f}, 8.0f, kPanel);
  pen.text(lines[0], bold, {x, y}, kInk, 0.55f, room);
  pen.text(lines[1], regular, {x, y + 19.0f}, kFaint, 0.55f, room);
}

// The keys and their actions: all of them on the logo screen and on request, one line during a
// selection. Returns the height at the bottom.
float draw_help(const HudPen& pen, const HudState& hud) {
  if (hud.recorded) return 0.0f;
  const auto screen =
      hud.state != nullptr ? static_cast<ScreenKind>(hud.state->screen) : ScreenKind::logo;
  const bool plays = hud.viewer_team >= 0;
  if (hud.show_help) return draw_all_keys(pen, pen.bottom);
  if (plays && screen == ScreenKind::logo) return draw_all_keys(pen, pen.bottom - logo_height(pen));
  if (plays && screen == ScreenKind::selection) return draw_keys_of_selection(pen);
  if (plays && screen == ScreenKind::play && hud.state->paused) {
    return draw_keys_of_pause(pen, lower_room(hud));
  }
  return 0.0f;
}

// On the logo screen, the ranking below its title; if there is no space beside the keys, both
// alternate.
float draw_logo_panels(const HudPen& pen, const HudState& hud) {
  constexpr float kBelowTitle = 262.0f, kTurn = 7.0f;  // units, [s]
  const bool logo = hud.state != nullptr && hud.state->screen == number(wire::Screen::logo);
  if (!logo || hud.fame.empty() || hud.show_help) return draw_help(pen, hud);
  const bool keys = hud.viewer_team >= 0;
  const float taken = keys ? all_keys_height(pen, pen.bottom - logo_height(pen)) : 0.0f;
  const float room = pen.bottom - taken - kBelowTitle - 10.0f;
  std::size_t players = hud.fame.size();
  while (players > 3 && fame_height(players) > room) --players;
  if (fame_height(players) <= room) {
    draw_fame(pen, std::span(hud.fame).first(players), kBelowTitle);
    return draw_help(pen, hud);
  }
  if (keys && std::fmod(hud.state->screen_seconds, 2.0f * kTurn) < kTurn)
    return draw_help(pen, hud);
  const float low = pen.bottom - 10.0f;
  while (players > 3 && fame_height(players) > low - kBelowTitle) --players;
  players = std::min(players, hud.fame.size());
  draw_fame(pen, std::span(hud.fame).first(players), low - fame_height(players));
  return fame_height(players) + 10.0f;
}

void draw_notices(const HudPen& pen, const HudState& hud, float room_below) {
  constexpr float kHighest = 22.0f;  // its panel is then at the upper edge
  float y = std::max(pen.bottom - 22.0f - room_below, kHighest);
  // In the view from above they cover the field: only the newest is shown.
  const std::size_t max = hud.view == View::above ? 1 : 3;
  const std::size_t shown = std::min(hud.notices.size(), max);
  for (std::size_t i = 0; i < shown && y >= kHighest; ++i) {
    const std::string text = tr_sentence(hud.notices[hud.notices.size() - 1 - i]);
    const TextStyle style{Face::regular, 15.0f, 0.0f, Align::centre};
    const float half = std::min(0.5f * pen.width(text, style) + 16.0f, pen.half_width - 4.0f);
    pen.panel({-half, y - 20.0f}, {half, y + 8.0f}, 9.0f, {0.20f, 0.13f, 0.02f, 0.86f});
    pen.text(text, style, {0.0f, y}, kWarning);
    y -= 34.0f;
  }
}

void draw_connection(const HudPen& whole, const HudState& hud) {
  const TextStyle style{Face::bold, 25.0f, 0.0f, Align::centre};
  const TextStyle small{Face::regular, 16.0f, 0.0f, Align::centre};
  const std::string detail = tr_sentence(hud.connection_detail);
  const float half = std::max({280.0f, 0.5f * whole.width(hud.connection_message, style) + 34.0f,
                               0.5f * whole.width(detail, small) + 24.0f});
  const HudPen pen = whole.fitting(half + 6.0f, 200.0f);
  const float y = 0.42f * pen.bottom;
  pen.panel({-half, y - 50.0f}, {half, y + 52.0f}, 16.0f, {0.03f, 0.04f, 0.07f, 0.90f});
  pen.panel({-half, y - 50.0f}, {half, y + 52.0f}, 16.0f, {0.95f, 0.65f, 0.20f, 0.75f}, 1.5f);
  pen.text(hud.connection_message, style, {0.0f, y}, kWarning);
  pen.text(detail, small, {0.0f, y + 30.0f}, kInk);
}

// A short line in a corner, or by the board that is between the corners.
struct SideLine {
  std::string text;
  Colour ink;
  Align side;
  int row;  // from the corner
};

std::vector<SideLine> side_lines(const HudState& hud) {
  std::vector<SideLine> lines;
  if (hud.fps > 0.0f) {
    char text[32];
    std::snprintf(text, sizeof text, "%.0f fps", static_cast<double>(hud.fps));
    lines.push_back({text, kFaint, Align::right, 0});
  }
  if (hud.starving && hud.connection_message.empty())
    lines.push_back({tr("no data from the physics server"), kWarning, Align::right, 1});
  // A client that has not joined yet, or is rejected, is no watcher.
  if (hud.viewer_team < 0 && hud.connection_message.empty() && !hud.recorded)
    lines.push_back({tr("watching"), kFaint, Align::left, 0});
  if (hud.automatic_rod) lines.push_back({tr("automatic rod (Tab)"), kFaint, Align::left, 0});
  if (hud.mouse_free && hud.viewer_team >= 0)
    lines.push_back({tr("mouse released: click to play, F1 for the keys, Esc to leave"), kFaint,
                     Align::left, 1});
  return lines;
}

constexpr TextStyle kSideStyle{Face::regular, 13.0f, 0.0f, Align::left};

void draw_in_corner(const HudPen& pen, const SideLine& line, float first_row) {
  const float edge = pen.half_width - 16.0f, y = first_row + 21.0f * static_cast<float>(line.row);
  const float wide = pen.width(line.text, kSideStyle);
  const float left = line.side == Align::left ? -edge : edge - wide;
  pen.panel({left - 8.0f, y - 15.0f}, {left + wide + 8.0f, y + 5.0f}, 6.0f, kPanel);
  pen.text(line.text, kSideStyle, {left, y}, line.ink);
}

// Stacks lines that are too long for the corners, downwards from y or upwards to y. Returns their
// height.
float draw_side_stack(const HudPen& whole, std::span<const SideLine> lines, float y, bool up_to) {
  if (lines.empty()) return 0.0f;
  float half = 0.0f;
  for (const SideLine& line : lines)
    half = std::max(half, 0.5f * whole.width(line.text, kSideStyle) + 10.0f);
  const HudPen pen = whole.fitting(half + 4.0f, 1.0f).readable(0.85f, half + 4.0f);
  const float units = pen.scale / whole.scale;
  const float height = 23.0f * static_cast<float>(lines.size());
  float top = y / units - (up_to ? height : 0.0f);
  for (const SideLine& line : lines) {
    const float wide = 0.5f * pen.width(line.text, kSideStyle) + 10.0f;
    pen.panel({-wide, top}, {wide, top + 20.0f}, 6.0f, kPanel);
    pen.text(line.text, kSideStyle, {10.0f - wide, top + 14.5f}, line.ink);
    top += 23.0f;
  }
  return height * units;
}

// In the view from above, the upper edge is the centre of the table: the lines go beside the board,
// or above `room_below`. Returns the total height from the lower edge.
float draw_side_lines(const HudPen& pen, const HudState& hud, float room_below) {
  const bool board = shows_score(hud), by_the_board = lower_room(hud) > 0.0f;
  const bool choosing =
      hud.state != nullptr && hud.state->screen == number(wire::Screen::selection);
  const glm::vec2 block = board ? board_size(pen) : selection_title_size(pen);
  // The logo leaves both corners free.
  const float between = board || choosing ? block.x : -0.5f * pen.half_width;
  std::vector<SideLine> stacked;
  for (SideLine& line : side_lines(hud)) {
    if (pen.width(line.text, kSideStyle) > pen.half_width - between - 32.0f)
      stacked.push_back(std::move(line));
    else
      draw_in_corner(pen, line, by_the_board ? pen.bottom - 44.0f : 26.0f);
  }
  if (by_the_board)
    return room_below + draw_side_stack(pen, stacked, pen.bottom - room_below, true);
  // The bands of a goal and of the end leave no space for them, and are short.
  const bool play = board && hud.state->screen == number(wire::Screen::play);
  const float said = play && !rules_line(hud).empty() ? 38.0f : choosing ? 2.0f : 6.0f;
  if (!board || play) draw_side_stack(pen, stacked, block.y + said, false);
  return room_below;
}

// room: the height that the questionnaire leaves.
void draw_match(const HudPen& pen, const HudState& hud, const glm::ivec2& screen, float room) {
  const wire::Snapshot& state = *hud.state;
  const bool above = hud.view == View::above;
  switch (static_cast<ScreenKind>(state.screen)) {
    case ScreenKind::logo:
      draw_logo(pen, state, hud.viewer_team < 0 || hud.recorded, hud.still);
      return;
    case ScreenKind::selection:
      draw_selection(pen, state, *hud.characters, hud.recorded ? -1 : hud.viewer_team);
      return;
    case ScreenKind::play:
      break;
    case ScreenKind::ceremony:
      draw_ceremony(pen, state, ceremony_text(hud), hud.replay, hud.still, above);
      break;
    case ScreenKind::end:
      draw_end(pen, state, end_text(hud, pen.left_is_team_0 ? 0 : 1), hud.statistics, hud.report,
               room);
      break;
  }
  // A menu would cover half of the board; at the end the panel shows the score.
  const bool board = static_cast<ScreenKind>(state.screen) != ScreenKind::end;
  if (board && hud.menu.rows.empty()) draw_score(pen, hud, above);
  if (static_cast<ScreenKind>(state.screen) == ScreenKind::play) {
    draw_rules_line(pen, hud, above);
    draw_mode(pen, hud);
  }
  if (!above) draw_held_rods(pen, hud, screen);
  if (state.paused) draw_paused(pen);
}

// Everything that one side of the table reads.
void draw_for_reader(const HudPen& pen, const HudState& hud, const glm::ivec2& screen) {
  // In the view from above each side reads a separate copy.
  const int reader = hud.view != View::above ? -1 : pen.left_is_team_0 ? 0 : 1;
  const float asked = survey_height(pen, hud.survey, reader);
  if (hud.state != nullptr) draw_match(pen, hud, screen, pen.bottom - asked);
  draw_survey(pen, hud.survey, reader);
  const float help_height = asked > 0.0f ? asked : draw_logo_panels(pen, hud);
  const float room_below = std::max(help_height, lower_room(hud));
  draw_notices(pen, hud, draw_side_lines(pen, hud, room_below));
  if (!hud.connection_message.empty()) draw_connection(pen, hud);
  if (!hud.menu.rows.empty()) draw_menu(pen, hud.menu);
}

}  // namespace

void set_story(HudState& hud, const MatchStory& story) {
  hud.goal = story.last_goal();
  hud.since_foul = story.since_foul();
  hud.since_serve = story.since_serve();
  hud.set_over = story.set_over();
  hud.sets = story.sets();
  hud.statistics = story.statistics();
}

void draw_hud(UiBatch& ui, const HudState& hud, const glm::ivec2& screen) {
  const bool left = hud.viewer_team != 1;
  const glm::vec2 size(screen);
  const HudPen whole(ui, {{0.0f, 0.0f}, size}, left, hud.text_scale);
  if (hud.state != nullptr && hud.state->screen == number(wire::Screen::play))
    draw_active_rods(whole, hud, screen);
  if (hud.state != nullptr) draw_rod_names(whole, hud, screen);
  if (hud.view != View::above) {
    draw_for_reader(whole, hud, screen);
  } else {
    // The lower half for this side, the upper half for the opposite side, which has left and right
    // exchanged.
    const HudRegion lower{{0.0f, 0.5f * size.y}, {size.x, 0.5f * size.y}};
    draw_for_reader(HudPen(ui, lower, left, 1.35f * hud.text_scale), hud, screen);
    ui.turn(size);
    draw_for_reader(HudPen(ui, lower, !left, 1.35f * hud.text_scale), hud, screen);
    ui.turn(glm::vec2(0.0f));
  }
  draw_phone_code(whole, hud, screen);
  ui.flush(screen);
}

}  // namespace client
