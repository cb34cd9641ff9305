// The overlay: score, clock, screens of the match, notices, the state of the connection.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "client/menu_page.h"
#include "client/qr_code.h"
#include "client/settings.h"
#include "client/survey.h"
#include "core/match_story.h"
#include "foosball/character.h"
#include "render/camera.h"
#include "render/ui_batch.h"
#include "wire/control.h"
#include "wire/enums.h"
#include "wire/snapshot.h"

namespace client {

inline constexpr std::array<const char*, 2> kTeamNames{"ORION", "VEGA"};

using ScreenKind = wire::Screen;

struct HudState {
  const wire::Snapshot* state = nullptr;  // null: nothing was received yet
  Camera camera;
  const foosball::Characters* characters = &foosball::built_in_characters();
  int viewer_team = -1;            // -1: watches
  std::string connection_message;  // covers all else while the server is away; empty: connected
  std::string connection_detail;
  std::vector<std::string> notices;  // newest last
  bool starving = false;             // joined, but the server's snapshots are late
  bool mouse_free = false;           // the pointer is released: show how to capture it again
  bool show_help = false;            // all keys, on top of any screen
  bool automatic_rod = false;
  float fps = 0.0f;              // 0: not shown
  std::uint8_t active_rods = 0;  // driven by a person here, by bit
  View view = View::seat;
  RodsShown rods = RodsShown::as_on_the_table;
  float text_scale = 1.0f;
  bool still = false;     // nothing pulses or grows
  bool replay = false;    // the goal's replay is shown
  bool recorded = false;  // a recording: no waiting for players, no calls to play
  std::array<float, 8> rod_shift{};
  GoalStory goal;
  float since_foul = 1e3f, since_serve = 1e3f;  // [s]
  bool set_over = false;                        // at a ceremony
  std::vector<std::array<int, 2>> sets;         // goals of the finished sets, as far as observed
  std::array<TeamStatistics, 2> statistics;
  const wire::Report* report = nullptr;  // of the match that has just ended; null: none is stored
  std::vector<wire::Fame> fame;          // the ranking; none: not known
  MenuPage menu;                         // no rows: closed
  std::vector<SurveyPanel> survey;       // the questionnaire, by person; none: not asked
  const QrCode* phones = nullptr;        // where phones join; null: not shown
  std::array<std::string, 8> rod_names;  // the player of each rod, shown at its handle
};

// Copies what the match's events have shown.
void set_story(HudState& hud, const MatchStory& story);

class HudPen;
void draw_menu(const HudPen& pen, const MenuPage& page);
// Below the rows of the menu's page.
float device_height(const DeviceView& view);
void draw_device(const HudPen& pen, const DeviceView& view, float top);
// For this team's people, at the lower edge; -1: for both teams.
void draw_survey(const HudPen& pen, std::span<const SurveyPanel> panels, int team);
float survey_height(const HudPen& pen, std::span<const SurveyPanel> panels, int team);
// At the right edge, below the title and above the keys. Omitted if its modules would be smaller
// than two pixels, or if there is no space beside the menu.
void draw_phone_code(const HudPen& pen, const HudState& hud, const glm::ivec2& screen);
void draw_rod_names(const HudPen& pen, const HudState& hud, const glm::ivec2& screen);
void draw_active_rods(const HudPen& pen, const HudState& hud, const glm::ivec2& screen);

// In the view from above it is drawn twice, for both long sides, the upper one rotated by 180
// degrees.
void draw_hud(UiBatch& ui, const HudState& hud, const glm::ivec2& screen);

}  // namespace client
