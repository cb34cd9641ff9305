// What is written over the picture: score, clock, screens of the match, notices, the state of the
// connection.
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
  const wire::Snapshot* state = nullptr;  // none yet: nothing was received
  Camera camera;
  const foosball::Characters* characters = &foosball::built_in_characters();
  int viewer_team = -1;            // -1: watches
  std::string connection_message;  // over all else, while the server is away; empty: it is there
  std::string connection_detail;
  std::vector<std::string> notices;  // newest last
  bool starving = false;             // the server is joined, but its news are late
  bool mouse_free = false;           // the pointer is released: say how to take it back
  bool show_help = false;            // all keys, over whatever is shown
  bool automatic_rod = false;
  float fps = 0.0f;              // 0: not shown
  std::uint8_t active_rods = 0;  // in a hand here, by bit
  View view = View::seat;
  RodsShown rods = RodsShown::as_on_the_table;
  float text_scale = 1.0f;
  bool still = false;     // nothing pulses or grows
  bool replay = false;    // what is seen is the goal again
  bool recorded = false;  // a recording: nobody is waited for, nor called to play
  std::array<float, 8> rod_shift{};
  GoalStory goal;
  float since_foul = 1e3f, since_serve = 1e3f;  // [s]
  bool set_over = false;                        // at a ceremony
  std::vector<std::array<int, 2>> sets;         // goals of those that are over, as far as seen
  std::array<TeamStatistics, 2> statistics;
  const wire::Report* report = nullptr;  // of the match that has just ended; null: none is kept
  std::vector<wire::Fame> fame;          // who plays best; none: not known
  MenuPage menu;                         // no rows: closed
  std::vector<SurveyPanel> survey;       // the questionnaire, by person; none: not asked
  const QrCode* phones = nullptr;        // where they join; null: not shown
  std::array<std::string, 8> rod_names;  // who plays each, to be shown at its handle
};

// What the events of the match have told.
void tell_story(HudState& hud, const MatchStory& story);

class HudPen;
void draw_menu(const HudPen& pen, const MenuPage& page);
// Below the rows of the menu's page.
float device_height(const DeviceView& view);
void draw_device(const HudPen& pen, const DeviceView& view, float top);
// Of this team's people, at the lower edge; -1: of both.
void draw_survey(const HudPen& pen, std::span<const SurveyPanel> panels, int team);
float survey_height(const HudPen& pen, std::span<const SurveyPanel> panels, int team);
// At the right edge, below the title and above the keys; left out where its modules would be
// smaller than two pixels, or where there is no room beside the menu.
void draw_phone_code(const HudPen& pen, const HudState& hud, const glm::ivec2& screen);
void draw_rod_names(const HudPen& pen, const HudState& hud, const glm::ivec2& screen);
void draw_active_rods(const HudPen& pen, const HudState& hud, const glm::ivec2& screen);

// From above it is written twice, for both long sides, the upper turned round.
void draw_hud(UiBatch& ui, const HudState& hud, const glm::ivec2& screen);

}  // namespace client
