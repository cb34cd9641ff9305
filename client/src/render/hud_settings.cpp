// The menu, and the marks of the active rods.
#include <algorithm>

#include "foosball/table.h"
#include "render/hud.h"
#include "render/hud_screens.h"
#include "render/sentences.h"
#include "render/table_mesh.h"
#include "render/translate.h"

namespace client {

namespace {

constexpr float kHalf = 330.0f, kLine = 27.0f;  // of the menu, in units
constexpr TextStyle kNoteStyle{Face::regular, 13.5f, 0.0f, Align::left};

// A bar from the minimum to the maximum value, with a tick at the default.
void draw_range(const HudPen& pen, const MenuRow& row, float y, const Colour& ink) {
  constexpr float kLeft = 20.0f, kWide = 120.0f;
  pen.panel({kLeft, y - 7.0f}, {kLeft + kWide, y - 3.0f}, 2.0f, {0.30f, 0.36f, 0.44f, 0.9f});
  pen.panel({kLeft, y - 7.0f}, {kLeft + kWide * std::clamp(row.share, 0.0f, 1.0f), y - 3.0f}, 2.0f,
            ink);
  const float usual = kLeft + kWide * std::clamp(row.usual, 0.0f, 1.0f);
  pen.panel({usual - 1.0f, y - 11.0f}, {usual + 1.0f, y + 1.0f}, 1.0f, kFaint);
}

void draw_menu_row(const HudPen& pen, const MenuRow& row, float y, bool here) {
  if (here)
    pen.panel({-kHalf + 10.0f, y - 19.0f}, {kHalf - 10.0f, y + 7.0f}, 6.0f,
              {0.16f, 0.26f, 0.38f, 0.95f});
  std::string label = row.prefix;
  if (!label.empty()) label += " ";
  label += row.translate_label ? tr(row.label.c_str()) : row.label.c_str();
  if (row.number > 0) label.append(" ").append(std::to_string(row.number));
  const bool bar = row.share >= 0.0f;
  pen.text(label, {here ? Face::bold : Face::regular, 15.0f, 0.0f, Align::left},
           {-kHalf + 22.0f, y}, here ? kInk : kFaint, 0.55f, bar ? 320.0f : 380.0f);
  std::string value =
      row.translate_value && !row.value.empty() ? tr(row.value.c_str()) : row.value.c_str();
  if (row.value_number > 0) value.append(" ").append(std::to_string(row.value_number));
  const bool changes = here && !row.fixed;
  const Colour& ink = row.fixed ? kFaint : here ? kWarning : kInk;
  if (bar) draw_range(pen, row, y, ink);
  if (value.empty() && !row.fixed)
    value = here ? "\u21B5" : "";
  else if (changes)
    value = row.typed ? value + " \u21B5" : "\u2190 " + value + " \u2192";
  pen.text(value, {Face::bold, 15.0f, 0.0f, Align::right}, {kHalf - 22.0f, y}, ink, 0.55f,
           bar ? 165.0f : 230.0f);
}

}  // namespace

void draw_menu(const HudPen& whole, const MenuPage& page) {
  const float min = page.device != nullptr ? device_height(*page.device) + 220.0f : 420.0f;
  const HudPen pen =
      whole.fitting(kHalf + 10.0f, std::max(min, 420.0f)).readable(0.62f, kHalf + 10.0f);
  std::vector<std::string> notes;
  if (!page.note.empty())
    notes = pen.wrapped(tr(page.note.c_str()), kNoteStyle, 2.0f * kHalf - 50.0f);
  if (!page.detail.empty()) {
    for (std::string& line :
         pen.wrapped(tr_sentence(page.detail), kNoteStyle, 2.0f * kHalf - 50.0f))
      notes.push_back(std::move(line));
  }
  const std::size_t problem_from = notes.size();
  if (!page.problem.empty()) {
    for (std::string& line : pen.wrapped(page.problem, kNoteStyle, 2.0f * kHalf - 50.0f))
      notes.push_back(std::move(line));
  }
  // Reserves three lines, so that the rows do not move while one goes through them.
  const std::size_t kept =
      page.note.empty() && page.problem.empty() && page.detail.empty() &&
              std::ranges::none_of(page.rows, [](const MenuRow& row) { return row.share >= 0.0f; })
          ? 0
          : std::max<std::size_t>(3, notes.size());
  const float device = page.device != nullptr ? device_height(*page.device) : 0.0f;
  const float below = 44.0f + 18.0f * static_cast<float>(kept) + device;
  const auto count = static_cast<int>(page.rows.size());
  const float room = pen.bottom - 72.0f - below;
  const int shown = std::clamp(static_cast<int>(room / kLine), 3, std::max(count, 3));
  const int drawn = std::min(shown, count);
  const float height = 54.0f + below + kLine * static_cast<float>(drawn);
  const float top = std::max(8.0f, 0.5f * (pen.bottom - height));
  pen.panel({-kHalf, top}, {kHalf, top + height}, 16.0f, {0.03f, 0.045f, 0.07f, 0.93f});
  pen.panel({-kHalf, top}, {kHalf, top + height}, 16.0f, {0.62f, 0.84f, 1.0f, 0.6f}, 1.5f);
  pen.text(tr(page.title.c_str()), {Face::bold, 26.0f, 0.10f, Align::centre}, {0.0f, top + 38.0f},
           kInk);
  const int first = std::clamp(page.chosen - drawn / 2, 0, count - drawn);
  for (int i = 0; i < drawn; ++i) {
    draw_menu_row(pen, page.rows[static_cast<std::size_t>(first + i)],
                  top + 72.0f + kLine * static_cast<float>(i), first + i == page.chosen);
  }
  // The scroll bar.
  const auto all = static_cast<float>(count);
  const float bar = kLine * static_cast<float>(drawn), at = top + 54.0f;
  pen.panel({kHalf - 7.0f, at + bar * static_cast<float>(first) / all},
            {kHalf - 4.0f, at + bar * static_cast<float>(first + drawn) / all}, 1.5f, kFaint);
  for (std::size_t i = 0; i < notes.size(); ++i) {
    pen.text(notes[i], kNoteStyle,
             {-kHalf + 22.0f, at + bar + 20.0f + 18.0f * static_cast<float>(i)},
             i >= problem_from ? kWarning : kInk, 0.55f, 2.0f * kHalf - 44.0f);
  }
  if (page.device != nullptr) draw_device(pen, *page.device, top + height - device - 32.0f);
  pen.text(tr("up and down choose, left and right change; spin and slide a rod; Esc closes"),
           {Face::regular, 13.0f, 0.0f, Align::centre}, {0.0f, top + height - 16.0f}, kFaint, 0.55f,
           2.0f * kHalf - 30.0f);
}

namespace {

// A sign above each man and at both ends of the rod: visible without colours.
void draw_active_rod(const HudPen& pen, const HudState& hud, int active, const glm::ivec2& screen) {
  const wire::Snapshot& state = *hud.state;
  const auto& table = foosball::table_spec(static_cast<foosball::Layout>(state.layout));
  const auto rod = static_cast<std::size_t>(active);
  const foosball::RodSpec& spec = table.rods[rod];
  const Colour kSignal{1.0f, 0.93f, 0.45f, 1.0f};
  const bool above = hud.view == View::above;
  const auto mark = [&](const char* sign, const glm::vec3& at, float size, const Colour& colour) {
    const glm::vec3 p = hud.camera.project(at, screen);
    if (p.z <= 0.0f) return;
    const float edge = 0.6f * size * pen.scale;
    const glm::vec2 inside = glm::clamp(glm::vec2(p), glm::vec2(edge),
                                        glm::max(glm::vec2(screen) - edge, glm::vec2(edge)));
    const glm::vec2 place = pen.from_pixels(inside);
    // Dark around light: visible before any background and any team's colour.
    const float wider = 1.45f * size;
    pen.text(sign, {Face::bold, wider, 0.0f, Align::centre}, place + glm::vec2(0, 0.365f * wider),
             {0.0f, 0.0f, 0.0f, 0.9f}, 0.0f);
    pen.text(sign, {Face::bold, size, 0.0f, Align::centre}, place + glm::vec2(0, 0.365f * size),
             colour, 0.0f);
  };
  constexpr float kBeside = 0.036f;  // [m]
  for (const wire::ManState& man : state.men) {
    if (man.rod != active) continue;
    const auto& at = man.body.position;
    // From above beside him, on the rod: his head stays visible.
    const glm::vec3 place =
        above ? glm::vec3(at[0], at[1] + kBeside, at[2]) : glm::vec3(at[0], at[1], at[2] + 0.085f);
    mark("\u25BC", place, above ? 17.0f : 19.0f, kSignal);
  }
  if (!rods_are_drawn(hud.rods, table.layout)) return;  // there is no handle
  const float x = static_cast<float>(spec.x) + hud.rod_shift[rod],
              z = static_cast<float>(table.rod_height);
  const float end =
      above ? static_cast<float>(0.42 * table.width) : std::abs(handle_offset(table, active));
  const float own = handle_offset(table, active) > 0.0f ? 1.0f : -1.0f;
  mark("\u25C6", {x, own * end + (above ? 0.0f : state.rods[rod].slide), z}, 26.0f, kSignal);
  if (above) mark("\u25C6", {x, -own * end, z}, 26.0f, kSignal);
}

}  // namespace

void draw_active_rods(const HudPen& pen, const HudState& hud, const glm::ivec2& screen) {
  for (int rod = 0; rod < foosball::kRods; ++rod) {
    if ((hud.active_rods >> rod & 1) != 0) draw_active_rod(pen, hud, rod, screen);
  }
}

// At the handles; scaled down where several are close, so that none covers another.
void draw_rod_names(const HudPen& pen, const HudState& hud, const glm::ivec2& screen) {
  const auto& table = foosball::table_spec(static_cast<foosball::Layout>(hud.state->layout));
  const TextStyle style{Face::bold, 13.0f, 0.0f, Align::centre};
  for (int rod = 0; rod < foosball::kRods; ++rod) {
    const auto r = static_cast<std::size_t>(rod);
    if (hud.rod_names[r].empty()) continue;
    const foosball::RodSpec& spec = table.rods[r];
    const float own = handle_offset(table, rod) > 0.0f ? 1.0f : -1.0f;
    const auto height = static_cast<float>(table.rod_height);
    const float end = static_cast<float>(0.5 * table.width) + 0.03f;
    const auto x = static_cast<float>(spec.x) + hud.rod_shift[r];
    const glm::vec3 at = hud.camera.project({x, own * end, height}, screen);
    const glm::vec3 next = hud.camera.project({x + 0.15f, own * end, height}, screen);
    if (at.z <= 0.0f) continue;
    const float room = std::max(40.0f, 0.96f * std::abs(next.x - at.x) / pen.scale);
    const float half = std::min(0.5f * pen.width(hud.rod_names[r], style) + 7.0f, 0.5f * room);
    const float edge = half * pen.scale;
    const glm::vec2 p = pen.from_pixels(
        {std::clamp(at.x, edge, std::max(static_cast<float>(screen.x) - edge, edge)),
         std::clamp(at.y, 14.0f * pen.scale, static_cast<float>(screen.y) - 14.0f * pen.scale)});
    pen.panel(p + glm::vec2(-half, -11), p + glm::vec2(half, 9), 6.0f,
              {0.03f, 0.045f, 0.07f, 0.82f});
    pen.text(hud.rod_names[r], style, p + glm::vec2(0, 4), kTeamInk[spec.team == 1 ? 1 : 0], 0.55f,
             2.0f * half - 8.0f);
  }
}

}  // namespace client
