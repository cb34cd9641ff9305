// The settings screen, and the marks of the rod in hand.
#include <algorithm>

#include "foosball/table.h"
#include "render/hud.h"
#include "render/hud_screens.h"
#include "render/table_mesh.h"
#include "render/translate.h"

namespace client {

void draw_settings(const HudPen& whole, const std::vector<MenuRow>& rows, int chosen) {
  const float half = 330.0f, line = 27.0f;
  const HudPen pen = whole.fitting(half + 10.0f, 420.0f).readable(0.62f, half + 10.0f);
  const float room = pen.bottom - 112.0f;
  const int shown = std::clamp(static_cast<int>(room / line), 3, static_cast<int>(rows.size()));
  const float height = 96.0f + line * static_cast<float>(shown);
  const float top = std::max(8.0f, 0.5f * (pen.bottom - height));
  pen.panel({-half, top}, {half, top + height}, 16.0f, {0.03f, 0.045f, 0.07f, 0.93f});
  pen.panel({-half, top}, {half, top + height}, 16.0f, {0.62f, 0.84f, 1.0f, 0.6f}, 1.5f);
  pen.text(tr("SETTINGS"), {Face::bold, 26.0f, 0.10f, Align::centre}, {0.0f, top + 38.0f}, kInk);
  const int first = std::clamp(chosen - shown / 2, 0, static_cast<int>(rows.size()) - shown);
  for (int i = 0; i < shown; ++i) {
    const MenuRow& row = rows[static_cast<std::size_t>(first + i)];
    const float y = top + 72.0f + line * static_cast<float>(i);
    const bool here = first + i == chosen;
    if (here)
      pen.panel({-half + 10.0f, y - 19.0f}, {half - 10.0f, y + 7.0f}, 6.0f,
                {0.16f, 0.26f, 0.38f, 0.95f});
    std::string label = tr(row.label.c_str());
    if (row.number > 0) label.append(" ").append(std::to_string(row.number));
    pen.text(label, {here ? Face::bold : Face::regular, 15.0f, 0.0f, Align::left},
             {-half + 22.0f, y}, here ? kInk : kFaint, 0.55f, 370.0f);
    const std::string value = row.translate_value ? tr(row.value.c_str()) : row.value.c_str();
    pen.text(here ? "\u2190 " + value + " \u2192" : value, {Face::bold, 15.0f, 0.0f, Align::right},
             {half - 22.0f, y}, here ? kWarning : kInk, 0.55f, 230.0f);
  }
  // How far down the list this is.
  const auto all = static_cast<float>(rows.size());
  const float bar = line * static_cast<float>(shown), at = top + 54.0f;
  pen.panel({half - 7.0f, at + bar * static_cast<float>(first) / all},
            {half - 4.0f, at + bar * static_cast<float>(first + shown) / all}, 1.5f, kFaint);
  pen.text(tr("up and down choose, left and right change; spin and slide a rod; Esc closes"),
           {Face::regular, 13.0f, 0.0f, Align::centre}, {0.0f, top + height - 16.0f}, kFaint, 0.55f,
           2.0f * half - 30.0f);
}

namespace {

// A sign above each man and at both ends of the rod: plain to see without colours.
void draw_active_rod(const HudPen& pen, const HudState& hud, int active, const glm::ivec2& screen) {
  const wire::Snapshot& state = *hud.state;
  const auto& table = foosball::table_spec(static_cast<foosball::Layout>(state.layout));
  const auto rod = static_cast<std::size_t>(active);
  const foosball::RodSpec& spec = table.rods[rod];
  const Colour& ink = kTeamInk[spec.team == 1 ? 1 : 0];
  const bool above = hud.view == View::above;
  const auto mark = [&](const char* sign, const glm::vec3& at, float size, const Colour& colour) {
    const glm::vec3 p = hud.camera.project(at, screen);
    if (p.z <= 0.0f) return;
    const float edge = 0.6f * size * pen.scale;
    const glm::vec2 inside = glm::clamp(glm::vec2(p), glm::vec2(edge),
                                        glm::max(glm::vec2(screen) - edge, glm::vec2(edge)));
    pen.text(sign, {Face::bold, size, 0.0f, Align::centre},
             pen.from_pixels(inside) + glm::vec2(0, 0.35f * size), colour, 1.0f);
  };
  for (const wire::ManState& man : state.men) {
    if (man.rod != active) continue;
    const auto& at = man.body.position;
    mark("\u25BC", {at[0], at[1], at[2] + (above ? 0.0f : 0.085f)}, above ? 14.0f : 17.0f, ink);
  }
  const float x = static_cast<float>(spec.x) + hud.rod_shift[rod],
              z = static_cast<float>(table.rod_height);
  const float end =
      above ? static_cast<float>(0.42 * table.width) : std::abs(handle_offset(table, active));
  const float own = handle_offset(table, active) > 0.0f ? 1.0f : -1.0f;
  mark("\u25C6", {x, own * end + (above ? 0.0f : state.rods[rod].slide), z}, 26.0f, kInk);
  if (above) mark("\u25C6", {x, -own * end, z}, 26.0f, kInk);
}

}  // namespace

void draw_active_rods(const HudPen& pen, const HudState& hud, const glm::ivec2& screen) {
  for (int rod = 0; rod < foosball::kRods; ++rod) {
    if ((hud.active_rods >> rod & 1) != 0) draw_active_rod(pen, hud, rod, screen);
  }
}

}  // namespace client
