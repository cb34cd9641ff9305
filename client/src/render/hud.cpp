#include "render/hud.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "foosball/table.h"
#include "render/hud_screens.h"
#include "render/match_words.h"
#include "render/sentences.h"
#include "render/table_mesh.h"
#include "render/translate.h"

namespace client {
namespace {

// In place of a team's character, so that the field stays as free as without it.
void draw_possession(const HudPen& pen, const PossessionClock& clock, const glm::vec2& at) {
  pen.text(std::to_string(clock.seconds) + " s", {Face::bold, 23.0f, 0.0f, Align::centre}, at,
           clock.hurries ? kWarning : kInk, 0.55f, 108.0f);
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
    // The left of the board is the left of the picture: a viewer of team 1 sees the table turned.
    const float side = (team == 0) == pen.left_is_team_0 ? -1.0f : 1.0f;
    const auto t = static_cast<std::size_t>(team);
    const std::string score = std::to_string(state.score[t]);
    pen.text(score, {Face::bold, 44.0f, 0.0f, Align::centre}, {side * 54.0f, y + 47.0f},
             kTeamInk[t]);
    const bool counted = possession && possession->team == team;
    pen.text(team_with_mark(team), {Face::bold, counted ? 15.0f : 18.0f, 0.06f, Align::centre},
             {side * 137.0f, y + (counted ? 23.0f : 31.0f)}, kTeamInk[t], 0.55f, 108.0f);
    if (counted) {
      draw_possession(pen, *possession, {side * 137.0f, y + 49.0f});
      continue;
    }
    const std::string& name = foosball::nearest(*hud.characters, state.character[t]).name;
    pen.text(tr(name.c_str()), {Face::regular, 11.5f, 0.01f, Align::centre},
             {side * 137.0f, y + 49.0f}, kFaint, 0.55f, 108.0f);
  }
  // At the end of a match of one set there is nothing to count.
  const int least_sets = state.screen == number(wire::Screen::end) ? 2 : 1;
  if (state.sets[0] + state.sets[1] >= least_sets) {
    const std::size_t left = pen.left_is_team_0 ? 0 : 1;
    const std::string sets = std::string(tr("sets")) + " " + std::to_string(state.sets[left]) +
                             " : " + std::to_string(state.sets[1 - left]);
    pen.text(sets, {Face::regular, 11.5f, 0.0f, Align::centre}, {0.0f, y + 56.0f}, kFaint, 0.55f,
             70.0f);
  }
  char clock[32];
  // Of a timed set what is left, else what was played.
  const float shown = state.timed ? state.seconds_left : state.play_seconds;
  const int seconds = std::max(0, static_cast<int>(std::min(shown, 35999.0f)));
  std::snprintf(clock, sizeof clock, "%d:%02d", seconds / 60, seconds % 60);
  pen.text(clock, {Face::regular, 14.0f, 0.04f, Align::centre}, {0.0f, y + 38.0f}, kInk);
}

constexpr float kSmallWindow = 0.75f;  // pixels a unit: below, news of the match are written larger

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

// Where a held rod's handle is on the screen; a handle outside the picture is marked at its edge.
void draw_held_rods(const HudPen& pen, const HudState& hud, const glm::ivec2& screen) {
  const auto& table = foosball::table_spec(static_cast<foosball::Layout>(hud.state->layout));
  for (int rod = 0; rod < foosball::kRods; ++rod) {
    const auto r = static_cast<std::size_t>(rod);
    const auto& driven = hud.state->rods[r];
    if (driven.status != number(wire::RodStatus::held)) continue;
    const float y = hud.state->rods[r].slide + 0.9f * handle_offset(table, rod);
    const glm::vec3 p = hud.camera.project(
        {static_cast<float>(table.rods[r].x), y, static_cast<float>(table.rod_height)}, screen);
    const glm::vec2 at = pen.from_pixels(
        {std::clamp(p.x, 50.0f * pen.scale, static_cast<float>(screen.x) - 50.0f * pen.scale),
         std::clamp(p.y, 100.0f * pen.scale, static_cast<float>(screen.y) - 60.0f * pen.scale)});
    pen.panel(at + glm::vec2(-31, -12), at + glm::vec2(31, 11), 6.0f, {0.22f, 0.15f, 0.02f, 0.88f});
    pen.text(tr("HELD"), {Face::bold, 13.0f, 0.06f, Align::centre}, at + glm::vec2(0, 5), kWarning,
             0.55f, 58.0f);
  }
}

// Beside the board, where there is one below, else below what else is told in the corner.
void draw_mode(const HudPen& whole, const HudState& hud) {
  const auto lines = mode_lines(*hud.state, whole.left_is_team_0 ? 0 : 1);
  if (lines[0].empty()) return;
  const bool above = hud.view == View::above;
  const HudPen pen = above ? whole : whole.readable(kSmallWindow, 400.0f);
  const TextStyle bold{Face::bold, 15.0f, 0.0f, Align::left};
  const TextStyle regular{Face::regular, 14.0f, 0.0f, Align::left};
  const float beside = pen.half_width - 16.0f - 212.0f;
  const bool narrow = beside < 100.0f;  // above the board and the line of the rules
  const float x = -pen.half_width + 16.0f;
  const float y = !above ? 70.0f : pen.bottom - (narrow ? 134.0f : 36.0f);
  const float room = above && !narrow ? beside : pen.half_width;
  const float width =
      std::min(room, std::max(pen.width(lines[0], bold), pen.width(lines[1], regular)));
  pen.panel({x - 10.0f, y - 19.0f}, {x + width + 10.0f, y + 27.0f}, 8.0f, kPanel);
  pen.text(lines[0], bold, {x, y}, kInk, 0.55f, room);
  pen.text(lines[1], regular, {x, y + 19.0f}, kFaint, 0.55f, room);
}

// What the keys do: all of it on the logo and when asked for, a line where a choice is to be made.
// How much room it takes at the bottom.
float draw_help(const HudPen& pen, const HudState& hud) {
  if (hud.recorded) return 0.0f;
  const auto screen =
      hud.state != nullptr ? static_cast<ScreenKind>(hud.state->screen) : ScreenKind::logo;
  const bool plays = hud.viewer_team >= 0;
  if (hud.show_help) return draw_all_keys(pen, pen.bottom);
  if (plays && screen == ScreenKind::logo) return draw_all_keys(pen, pen.bottom - logo_height(pen));
  if (plays && screen == ScreenKind::selection) return draw_keys_of_selection(pen);
  if (plays && screen == ScreenKind::play && hud.state->paused) return draw_keys_of_pause(pen);
  return 0.0f;
}

// On the logo who plays best, below its title; where there is no room beside the keys, by turns.
float draw_logo_panels(const HudPen& pen, const HudState& hud) {
  constexpr float kBelowTitle = 262.0f, kKeysAtMost = 240.0f, kTurn = 7.0f;  // units, [s]
  const bool logo = hud.state != nullptr && hud.state->screen == number(wire::Screen::logo);
  if (!logo || hud.fame.empty() || hud.show_help) return draw_help(pen, hud);
  const bool keys = hud.viewer_team >= 0;
  const float room = pen.bottom - (keys ? kKeysAtMost : 0.0f) - kBelowTitle - 10.0f;
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
  float y = pen.bottom - 22.0f - room_below;
  const std::size_t shown = std::min<std::size_t>(hud.notices.size(), 3);
  for (std::size_t i = 0; i < shown; ++i) {
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

void draw_corner_texts(const HudPen& pen, const HudState& hud) {
  const TextStyle small{Face::regular, 13.0f, 0.0f, Align::left};
  const float x = -pen.half_width + 16.0f;
  if (hud.fps > 0.0f) {
    char text[32];
    std::snprintf(text, sizeof text, "%.0f fps", static_cast<double>(hud.fps));
    pen.text(text, {Face::regular, 13.0f, 0.0f, Align::right}, {pen.half_width - 16.0f, 26.0f},
             kFaint);
  }
  if (hud.starving && hud.connection_message.empty()) {
    pen.text(tr("no news from the physics server"), {Face::regular, 13.0f, 0.0f, Align::right},
             {pen.half_width - 16.0f, 46.0f}, kWarning);
  }
  // Who has not joined yet, or is refused, is no watcher.
  if (hud.viewer_team < 0 && hud.connection_message.empty() && !hud.recorded)
    pen.text(tr("watching"), small, {x, 26.0f}, kFaint);
  if (hud.automatic_rod) pen.text(tr("automatic rod (Tab)"), small, {x, 26.0f}, kFaint);
  if (hud.mouse_free && hud.viewer_team >= 0)
    pen.text(tr("mouse released: click to play, F1 for the keys, Esc to leave"), small, {x, 46.0f},
             kFaint);
}

void draw_match(const HudPen& pen, const HudState& hud, const glm::ivec2& screen) {
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
      draw_ceremony(pen, state, ceremony_words(hud), hud.replay, hud.still, above);
      break;
    case ScreenKind::end:
      draw_end(pen, state, end_words(hud, pen.left_is_team_0 ? 0 : 1), hud.statistics, hud.report);
      break;
  }
  draw_score(pen, hud, above);
  if (static_cast<ScreenKind>(state.screen) == ScreenKind::play) {
    draw_rules_line(pen, hud, above);
    draw_mode(pen, hud);
  }
  if (!above) draw_held_rods(pen, hud, screen);
  if (state.paused) draw_paused(pen);
}

// All that one side of the table reads.
void draw_for_reader(const HudPen& pen, const HudState& hud, const glm::ivec2& screen) {
  if (hud.state != nullptr) draw_match(pen, hud, screen);
  draw_corner_texts(pen, hud);
  // From above each side reads its own.
  const int reader = hud.view != View::above ? -1 : pen.left_is_team_0 ? 0 : 1;
  const float survey_height = draw_survey(pen, hud.survey, reader);
  const float help_height = survey_height > 0.0f ? survey_height : draw_logo_panels(pen, hud);
  draw_notices(pen, hud, hud.view == View::above ? std::max(help_height, 74.0f) : help_height);
  if (!hud.connection_message.empty()) draw_connection(pen, hud);
  if (!hud.menu.rows.empty()) draw_menu(pen, hud.menu);
}

}  // namespace

void tell_story(HudState& hud, const MatchStory& story) {
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
    // The lower half for this side, the upper for the other, whose left is our right.
    const HudRegion lower{{0.0f, 0.5f * size.y}, {size.x, 0.5f * size.y}};
    draw_for_reader(HudPen(ui, lower, left, 1.35f * hud.text_scale), hud, screen);
    ui.turn(size);
    draw_for_reader(HudPen(ui, lower, !left, 1.35f * hud.text_scale), hud, screen);
    ui.turn(glm::vec2(0.0f));
  }
  ui.flush(screen);
}

}  // namespace client
