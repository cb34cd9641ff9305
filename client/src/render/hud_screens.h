// The screens of the match between plays, and the pen that draws them.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/match_story.h"
#include "foosball/character.h"
#include "render/ui_batch.h"
#include "wire/control.h"
#include "wire/snapshot.h"

namespace client {

struct CeremonyText;  // render/match_text.h
struct EndText;

inline const Colour kInk{0.90f, 0.94f, 0.98f, 1.0f};
inline const Colour kFaint{0.66f, 0.73f, 0.80f, 0.95f};
inline const Colour kWarning{1.0f, 0.80f, 0.36f, 1.0f};
inline const Colour kPanel{0.030f, 0.045f, 0.070f, 0.74f};
inline const std::array<Colour, 2> kTeamInk{Colour{1.0f, 0.60f, 0.22f, 1.0f},
                                            Colour{0.42f, 0.74f, 1.0f, 1.0f}};
inline constexpr float kMinRead = 8.0f;  // [px] of a letter's size: smaller ones are illegible
// Beside a team's name: distinguishes the teams without colours.
inline constexpr std::array<const char*, 2> kTeamMark{"●", "▲"};

// The part of the screen that a pen draws in [px], from the top left.
struct HudRegion {
  glm::vec2 low{0.0f}, size{1.0f};
};

// Draws in units of a 720-line screen, x from the region's centre, y from its top. Content that is
// too wide for the region is scaled down, never cut.
class HudPen {
 public:
  HudPen(UiBatch& ui, const HudRegion& region, bool team_0_on_the_left, float text_scale = 1.0f);

  // In units; a line wider than max_width (the region's, if 0) is scaled down.
  void text(std::string_view utf8, TextStyle style, const glm::vec2& at, const Colour& colour,
            float glow = 0.55f, float max_width = 0.0f) const;
  // Breaks text at spaces into lines that fit.
  std::vector<std::string> wrapped(const std::string& text, const TextStyle& style,
                                   float room) const;
  void panel(const glm::vec2& low, const glm::vec2& high, float corner, const Colour& colour,
             float outline = 0.0f) const;
  void picture(int column, int row, const glm::vec2& low, const glm::vec2& high) const;
  float width(std::string_view utf8, const TextStyle& style) const {
    return ui_.font().width(utf8, style);
  }
  glm::vec2 from_pixels(const glm::vec2& pixel) const;
  // The same pen, scaled down so that a block of this half width and height fits into the region.
  HudPen fitting(float half_width, float height) const;

  // The same pen, scaled up to `pixels_a_unit` if its scale is smaller, as far as this half width
  // fits.
  HudPen readable(float pixels_a_unit, float wanted_half_width) const;

  float scale;       // pixels per unit
  float half_width;  // of the region, in units
  float bottom;
  bool left_is_team_0;

 private:
  void rescale(float pixels_a_unit);
  glm::vec2 to_pixels(const glm::vec2& at) const;
  UiBatch& ui_;
  HudRegion region_;
};

float logo_height(const HudPen& pen);
void draw_logo(const HudPen& pen, const wire::Snapshot& state, bool watches, bool still);
// Six at a time of each team's characters, around the chosen one.
void draw_selection(const HudPen& pen, const wire::Snapshot& state,
                    const foosball::Characters& characters, int viewer_team);
// Half width of its title, and its bottom.
glm::vec2 selection_title_size(const HudPen& pen);
// A band at the upper or the lower edge: the field stays visible.
void draw_ceremony(const HudPen& pen, const wire::Snapshot& state, const CeremonyText& text,
                   bool replay, bool still, bool at_the_bottom);
// report: as stored, or null: use what was observed here. room: height from the top down; if it is
// small, fewer statistics are shown.
void draw_end(const HudPen& pen, const wire::Snapshot& state, const EndText& text,
              const std::array<TeamStatistics, 2>& statistics, const wire::Report* report,
              float room);
// y: its upper edge. fame_height(): its height for this number of players.
void draw_fame(const HudPen& pen, std::span<const wire::Fame> fame, float y);
float fame_height(std::size_t players);
void draw_paused(const HudPen& pen);

// The keys and their actions, at the bottom of the screen; returns the height. room: height from
// the bottom up; if it is too small for legible text, one line says so instead.
float draw_all_keys(const HudPen& pen, float room);
float all_keys_height(const HudPen& pen, float room);
float draw_keys_of_selection(const HudPen& pen);
// below: height of what is drawn under it.
float draw_keys_of_pause(const HudPen& pen, float below);

}  // namespace client
