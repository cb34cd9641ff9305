// The screens of recorded matches: the list from which one is chosen, and the bar of the one that
// is watched. What they show, as plain data; where things are, for the mouse; and how they are
// drawn.
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

// What can be clicked, in the order of the screen.
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
  double now = 0.0, read = 0.0, total = 0.0;  // [s] of the recording; read: so far one can go
  double speed = 1.0;                         // of the match's own time
  bool paused = false, kept = false, being_made = false, show_keys = false;
  std::array<int, 2> score{};
  std::vector<Goal> goals;
  std::string camera;   // name of the view, English
  std::string message;  // lines above the bar, as it is; empty: none
  bool warning = false;
};

struct ReplayBarLayout {
  float scale = 1.0f;  // pixels a unit
  ScreenBox panel;     // all of it, at the bottom of the window
  ScreenBox line;      // where a click or a drag goes to a moment
  std::array<ScreenBox, kReplayButtons> buttons;
  float text_y = 0.0f;  // base line of the words between line and buttons
};
ReplayBarLayout replay_bar_layout(const glm::ivec2& screen);
// The moment at this x, of so many seconds in all; beside the line, its beginning or end.
double moment_at(const ReplayBarLayout& layout, float x, double total);
void draw_replay_bar(UiBatch& ui, const ReplayBar& bar, const glm::ivec2& screen);

// --- the list -----------------------------------------------------------------------------------

struct ReplayList {
  struct Row {
    std::string when;                    // as it is
    std::array<std::string, 2> players;  // English
    std::array<bool, 2> computer{};
    std::array<int, 2> score{}, sets{};
    double seconds = 0.0;
    std::string state;  // English: what is special about it; empty: nothing
    std::string name;   // of the file, where nothing is known of the match
    bool bad = false, kept = false;
  };
  std::vector<Row> rows;
  int chosen = 0, first = 0;  // first: the uppermost that is seen
  bool reading = false;       // the folder, or the recording that was chosen
  bool show_keys = false;
  std::string message;  // as it is; empty: none
  bool warning = false;
};

struct ReplayListLayout {
  float scale = 1.0f;
  ScreenBox panel;
  ScreenBox rows;          // all that are seen
  bool two_lines = false;  // a row, in a narrow window
  float row_height = 1.0f;
  int shown = 1;  // rows that fit
  ScreenBox keep, share, leave;
};
ReplayListLayout replay_list_layout(const glm::ivec2& screen);
// The row at a place of the window, among all; none: beside them.
std::optional<int> row_at(const ReplayListLayout& layout, const ReplayList& list,
                          const glm::vec2& at);
void draw_replay_list(UiBatch& ui, const ReplayList& list, const glm::ivec2& screen);

}  // namespace client
