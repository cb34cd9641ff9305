#include <algorithm>
#include <sstream>

#include "render/hud_screens.h"

namespace client {

// 720 units tall and at least 900 wide, so that narrow windows have smaller text, with a minimum
// scale for legibility.
HudPen::HudPen(UiBatch& ui, const HudRegion& region, bool team_0_on_the_left, float text_scale)
    : left_is_team_0(team_0_on_the_left), ui_(ui), region_(region) {
  rescale(text_scale * std::max(0.30f, std::min(region.size.y / 720.0f, region.size.x / 900.0f)));
}

void HudPen::rescale(float pixels_a_unit) {
  scale = pixels_a_unit;
  half_width = 0.5f * region_.size.x / scale;
  bottom = region_.size.y / scale;
}

HudPen HudPen::fitting(float wanted_half_width, float height) const {
  HudPen smaller = *this;
  const float share = std::min({1.0f, half_width / wanted_half_width, bottom / height});
  smaller.rescale(share * scale);
  return smaller;
}

HudPen HudPen::readable(float pixels_a_unit, float wanted_half_width) const {
  HudPen larger = *this;
  const float widest = 0.5f * region_.size.x / wanted_half_width;
  larger.rescale(std::max(scale, std::min(pixels_a_unit, widest)));
  return larger;
}

glm::vec2 HudPen::to_pixels(const glm::vec2& at) const {
  return {region_.low.x + 0.5f * region_.size.x + at.x * scale, region_.low.y + at.y * scale};
}

glm::vec2 HudPen::from_pixels(const glm::vec2& pixel) const {
  return {(pixel.x - region_.low.x - 0.5f * region_.size.x) / scale,
          (pixel.y - region_.low.y) / scale};
}

void HudPen::text(std::string_view utf8, TextStyle style, const glm::vec2& at, const Colour& colour,
                  float glow, float max_width) const {
  const float room = max_width > 0.0f ? max_width : 2.0f * half_width - 16.0f;
  const float wide = width(utf8, style);
  if (wide > room) style.size *= room / wide;
  style.size *= scale;
  ui_.text(utf8, style, to_pixels(at), colour, glow);
}

std::vector<std::string> HudPen::wrapped(const std::string& text, const TextStyle& style,
                                         float room) const {
  std::vector<std::string> lines;
  std::string line;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    std::string longer = line;
    if (!line.empty()) longer += ' ';
    longer += word;
    if (!line.empty() && width(longer, style) > room) {
      lines.push_back(line);
      line = word;
    } else {
      line = longer;
    }
  }
  if (!line.empty()) lines.push_back(line);
  return lines;
}

void HudPen::panel(const glm::vec2& low, const glm::vec2& high, float corner, const Colour& colour,
                   float outline) const {
  ui_.panel(to_pixels(low), to_pixels(high), corner * scale, colour, outline * scale);
}

void HudPen::picture(int column, int row, const glm::vec2& low, const glm::vec2& high) const {
  ui_.picture(column, row, to_pixels(low), to_pixels(high));
}

}  // namespace client
