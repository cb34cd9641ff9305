// The bar of a recording that is watched, and the list from which one is chosen: what they show, as
// plain data, and how they are drawn.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "render/ui_batch.h"

namespace client {

struct ReplayBar {
  struct Goal {
    double at;  // [s]
    int team;
    std::array<int, 2> score;
  };
  double now = 0.0, read = 0.0, total = 0.0;  // [s] of the recording; read: so far one can go
  double speed = 1.0;                         // of the match's own time
  bool paused = false, show_keys = false;
  std::array<int, 2> score{};
  std::vector<Goal> goals;
  std::string camera;   // name of the view, English
  std::string message;  // a line above the bar, as it is; empty: none
};

// Where on the bar a point of the screen is [s]; none: beside it.
std::optional<double> bar_moment(const UiBatch& ui, const ReplayBar& bar, const glm::vec2& at,
                                 const glm::ivec2& screen);
void draw_replay_bar(UiBatch& ui, const ReplayBar& bar, const glm::ivec2& screen);

// Results and recordings to choose from, and the hall of fame beside them.
struct ReplayList {
  struct Row {
    std::string when, what;
    bool playable = false;
  };
  struct Player {
    std::string name, rating, record;
  };
  std::vector<Row> rows;
  int chosen = 0;
  std::vector<Player> hall_of_fame;  // best first
  std::string message;               // as it is; empty: none
};
void draw_replay_list(UiBatch& ui, const ReplayList& list, const glm::ivec2& screen);

}  // namespace client
