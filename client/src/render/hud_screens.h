// The screens of the match between plays, and the pen they are written with.
#pragma once

#include <array>
#include <string_view>

#include "render/ui_batch.h"
#include "wire/snapshot.h"

namespace client {

inline const Colour kInk{0.90f, 0.94f, 0.98f, 1.0f};
inline const Colour kFaint{0.66f, 0.73f, 0.80f, 0.95f};
inline const Colour kWarning{1.0f, 0.80f, 0.36f, 1.0f};
inline const Colour kPanel{0.030f, 0.045f, 0.070f, 0.74f};
inline const std::array<Colour, 2> kTeamInk{Colour{1.0f, 0.60f, 0.22f, 1.0f},
                                            Colour{0.42f, 0.74f, 1.0f, 1.0f}};

// Writes in units of a 720-line screen, x from its middle, y from its top.
class HudPen {
 public:
  HudPen(UiBatch& ui, const glm::ivec2& screen, bool team_0_on_the_left);

  void text(std::string_view utf8, TextStyle style, const glm::vec2& at, const Colour& colour,
            float glow = 0.55f) const;
  void panel(const glm::vec2& low, const glm::vec2& high, float corner, const Colour& colour,
             float outline = 0.0f) const;
  float width(std::string_view utf8, const TextStyle& style) const {
    return ui_.font().width(utf8, style);
  }
  glm::vec2 from_pixels(const glm::vec2& pixel) const;

  float scale;       // pixels a unit
  float half_width;  // of the screen, in units
  float bottom;
  bool left_is_team_0;

 private:
  glm::vec2 to_pixels(const glm::vec2& at) const;
  UiBatch& ui_;
  float middle_;
};

void draw_logo(const HudPen& pen, const wire::Snapshot& state, bool watches);
void draw_selection(const HudPen& pen, const wire::Snapshot& state, int viewer_team);
void draw_ceremony(const HudPen& pen, const wire::Snapshot& state);
void draw_end(const HudPen& pen, const wire::Snapshot& state);
void draw_paused(const HudPen& pen);

// What the keys do, at the bottom of the screen; how high it stands.
float draw_all_keys(const HudPen& pen);
float draw_keys_of_selection(const HudPen& pen);
float draw_keys_of_pause(const HudPen& pen);

}  // namespace client
