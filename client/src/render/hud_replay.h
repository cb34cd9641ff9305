// The screens of recorded matches: the list to choose from, and the bar of the recording that is
// watched. Their data, their layout for the mouse, and their drawing.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "render/ui_batch.h"

namespace client {

// A rectangle of the window [px], from the top left.
struct ScreenBox {
  glm::vec2 low{0.0f}, high{0.0f};
  bool holds(const glm::vec2& at) const {
    return at.x >= low.x && at.x < high.x && at.y >= low.y && at.y < high.y;
  }
};

// The clickable buttons, in screen order.
enum class ReplayButton : std::uint8_t {
  previous_goal,
  back,
  play,
  on,
  next_goal,
  slower,
  faster,
  camera,
  side,
  keep,
  share,
  hide,
  keys,
  leave,
};
inline constexpr int kReplayButtons = 14;

// --- the bar ------------------------------------------------------------------------------------

struct ReplayBar {
  struct Goal {
    double at;  // [s]
    int team;
  };
  double now = 0.0, read = 0.0, total = 0.0;  // [s] of the recording; read: playable so far
  double speed = 1.0;                         // relative to the match's time
  bool paused = false, kept = false, being_made = false, show_keys = false;
  std::array<int, 2> score{};
  std::vector<Goal> goals;
  std::string camera;   // name of the view, English
  std::string message;  // lines above the bar, not translated; empty: none
  bool warning = false;
};

struct ReplayBarLayout {
  float scale = 1.0f;  // pixels per unit
  ScreenBox panel;     // the whole bar, at the bottom of the window
  ScreenBox line;      // where a click or a drag seeks
  std::array<ScreenBox, kReplayButtons> buttons;
  float text_y = 0.0f;  // baseline of the text between line and buttons
};
ReplayBarLayout replay_bar_layout(const glm::ivec2& screen);
// The moment at this x, out of `total` [s]; beyond the line, its beginning or end.
double moment_at(const ReplayBarLayout& layout, float x, double total);
void draw_replay_bar(UiBatch& ui, const ReplayBar& bar, const glm::ivec2& screen);

// --- the list -----------------------------------------------------------------------------------

struct ReplayList {
  struct Row {
    std::string when;                    // not translated
    std::array<std::string, 2> players;  // English
    std::array<bool, 2> computer{};
    std::array<int, 2> score{}, sets{};
    double seconds = 0.0;
    std::string state;  // English: a special state; empty: none
    std::string name;   // of the file, if nothing is known of the match
    bool bad = false, kept = false;
  };
  std::vector<Row> rows;
  int chosen = 0, first = 0;  // first: index of the uppermost visible row
  bool reading = false;       // the folder, or the chosen recording
  bool show_keys = false;
  std::string message;  // not translated; empty: none
  bool warning = false;
};

struct ReplayListLayout {
  float scale = 1.0f;
  ScreenBox panel;
  ScreenBox rows;          // all visible rows
  bool two_lines = false;  // per row, in a narrow window
  float row_height = 1.0f;
  int shown = 1;  // rows that fit
  ScreenBox keep, share, leave;
};
ReplayListLayout replay_list_layout(const glm::ivec2& screen);
// The index of the row at a point of the window; none: no row there.
std::optional<int> row_at(const ReplayListLayout& layout, const ReplayList& list,
                          const glm::vec2& at);
void draw_replay_list(UiBatch& ui, const ReplayList& list, const glm::ivec2& screen);

}  // namespace client
