#include "render/hud_replay.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "render/hud_screens.h"
#include "render/translate.h"

namespace client {
namespace {

constexpr float kBarRoom = 22.0f;    // left and right of the bar, in units
constexpr float kBarHeight = 78.0f;  // of the panel below

HudPen pen_of(UiBatch& ui, const glm::ivec2& screen) {
  return {ui, {{0.0f, 0.0f}, glm::vec2(screen)}, true};
}

std::string clock_text(double seconds) {
  const auto whole = static_cast<long>(std::max(0.0, seconds));
  char text[40];
  if (whole >= 3600) {
    std::snprintf(text, sizeof text, "%ld:%02ld:%02ld", whole / 3600, whole / 60 % 60, whole % 60);
  } else {
    std::snprintf(text, sizeof text, "%ld:%02ld", whole / 60, whole % 60);
  }
  return text;
}

std::string speed_text(double speed) {
  char text[24];
  if (speed < 1.0) {
    std::snprintf(text, sizeof text, "1/%.0fx", 1.0 / speed);
  } else {
    std::snprintf(text, sizeof text, "%.0fx", speed);
  }
  return text;
}

struct KeyLine {
  const char* keys;
  const char* meaning;
};
constexpr std::array<KeyLine, 10> kReplayKeys{
    {{N_("Space"), N_("pause, play on")},
     {N_("Left, Right"), N_("5 s back, on; with Shift 30 s")},
     {", .", N_("one frame back, on")},
     {N_("Up, Down"), N_("faster, slower: 1/8 to 8 times")},
     {"B N", N_("goal before, next goal")},
     {N_("Home, End"), N_("beginning, end")},
     {"C V", N_("camera, other side")},
     {"S", N_("share: a copy with a telling name")},
     {N_("Mouse"), N_("click or draw along the bar")},
     {"Esc", N_("back to the list, leave")}}};

void draw_replay_keys(const HudPen& whole, float bottom_room) {
  const float line = 25.0f, half = 300.0f;
  const float height = line * static_cast<float>(kReplayKeys.size()) + 30.0f;
  const HudPen pen = whole.fitting(half + 6.0f, height + 60.0f + bottom_room);
  const float top = std::max(90.0f, pen.bottom - bottom_room - height - 40.0f);
  pen.panel({-half, top}, {half, top + height}, 14.0f, {kPanel.r, kPanel.g, kPanel.b, 0.92f});
  float y = top + 32.0f;
  for (const KeyLine& key : kReplayKeys) {
    pen.text(tr(key.keys), {Face::bold, 15.0f, 0.0f, Align::right}, {-half + 180.0f, y}, kInk,
             0.55f, 160.0f);
    pen.text(tr(key.meaning), {Face::regular, 15.0f, 0.0f, Align::left}, {-half + 200.0f, y},
             kFaint, 0.55f, 2.0f * half - 215.0f);
    y += line;
  }
}

void draw_goals(const HudPen& pen, const ReplayBar& bar, float y, float half) {
  for (const ReplayBar::Goal& goal : bar.goals) {
    const float x = half * (2.0f * static_cast<float>(goal.at / bar.total) - 1.0f);
    const auto team = static_cast<std::size_t>(goal.team == 1);
    pen.panel({x - 1.5f, y - 9.0f}, {x + 1.5f, y + 9.0f}, 1.0f, kTeamInk[team]);
    pen.text(kTeamMark[team], {Face::bold, 11.0f, 0.0f, Align::centre}, {x, y - 10.0f},
             kTeamInk[team]);
  }
}

}  // namespace

std::optional<double> bar_moment(const UiBatch&, const ReplayBar& bar, const glm::vec2& at,
                                 const glm::ivec2& screen) {
  const float scale = std::max(0.30f, std::min(static_cast<float>(screen.y) / 720.0f,
                                               static_cast<float>(screen.x) / 900.0f));
  const float room = kBarRoom * scale;
  if (at.y < static_cast<float>(screen.y) - kBarHeight * scale) return std::nullopt;
  const float along = (at.x - room) / std::max(1.0f, static_cast<float>(screen.x) - 2.0f * room);
  return bar.total * static_cast<double>(std::clamp(along, 0.0f, 1.0f));
}

void draw_replay_bar(UiBatch& ui, const ReplayBar& bar, const glm::ivec2& screen) {
  const HudPen pen = pen_of(ui, screen);
  const float top = pen.bottom - kBarHeight, y = top + 24.0f, half = pen.half_width - kBarRoom;
  pen.panel({-pen.half_width, top}, {pen.half_width, pen.bottom}, 0.0f,
            {kPanel.r, kPanel.g, kPanel.b, 0.86f});
  const auto along = [&](double moment) {
    return half * (2.0f * static_cast<float>(moment / std::max(bar.total, 1e-3)) - 1.0f);
  };
  pen.panel({-half, y - 3.0f}, {half, y + 3.0f}, 3.0f, {0.22f, 0.27f, 0.33f, 0.9f});
  pen.panel({-half, y - 3.0f}, {along(bar.read), y + 3.0f}, 3.0f, {0.42f, 0.50f, 0.58f, 0.9f});
  pen.panel({-half, y - 3.0f}, {along(bar.now), y + 3.0f}, 3.0f, kInk);
  if (bar.total > 0.0) draw_goals(pen, bar, y, half);
  pen.panel({along(bar.now) - 5.0f, y - 8.0f}, {along(bar.now) + 5.0f, y + 8.0f}, 5.0f, kInk);

  const float line = top + 58.0f;
  pen.text((bar.paused ? std::string(tr("PAUSED")) + "  " : std::string()) + clock_text(bar.now) +
               " / " + clock_text(bar.total) + "   " + speed_text(bar.speed),
           {Face::bold, 16.0f, 0.0f, Align::left}, {-half, line}, kInk, 0.55f, half - 60.0f);
  const std::string score = std::string(kTeamMark[0]) + " " + std::to_string(bar.score[0]) + " : " +
                            std::to_string(bar.score[1]) + " " + kTeamMark[1];
  pen.text(score, {Face::bold, 18.0f, 0.0f, Align::centre}, {0.0f, line}, kInk);
  pen.text(std::string(tr(bar.camera.c_str())) + "   F1 " + tr("keys"),
           {Face::regular, 15.0f, 0.0f, Align::right}, {half, line}, kFaint, 0.55f, half - 60.0f);
  if (!bar.message.empty()) {
    const TextStyle style{Face::regular, 15.0f, 0.0f, Align::centre};
    const float wide =
        std::min(0.5f * pen.width(bar.message, style) + 16.0f, pen.half_width - 4.0f);
    pen.panel({-wide, top - 36.0f}, {wide, top - 6.0f}, 8.0f, {0.20f, 0.13f, 0.02f, 0.86f});
    pen.text(bar.message, style, {0.0f, top - 16.0f}, kWarning, 0.55f, 2.0f * wide - 12.0f);
  }
  if (bar.show_keys) draw_replay_keys(pen, kBarHeight);
  ui.flush(screen);
}

void draw_replay_list(UiBatch& ui, const ReplayList& list, const glm::ivec2& screen) {
  const HudPen pen = pen_of(ui, screen).fitting(450.0f, 480.0f);
  const float half = 440.0f, line = 30.0f;
  pen.panel({-half, 14.0f}, {half, pen.bottom - 14.0f}, 16.0f, {0.03f, 0.045f, 0.07f, 0.95f});
  pen.text(tr("RECORDINGS"), {Face::bold, 26.0f, 0.08f, Align::left}, {-half + 24.0f, 56.0f}, kInk,
           0.55f, 470.0f);
  pen.text(tr("HALL OF FAME"), {Face::bold, 20.0f, 0.06f, Align::left}, {half - 290.0f, 56.0f},
           kInk, 0.55f, 270.0f);
  const int all = static_cast<int>(list.rows.size());
  const int shown = std::clamp(static_cast<int>((pen.bottom - 150.0f) / line), 1, std::max(all, 1));
  const int first = std::clamp(list.chosen - shown / 2, 0, std::max(0, all - shown));
  const float width = 2.0f * half - 330.0f;
  for (int i = first; i < std::min(all, first + shown); ++i) {
    const auto& row = list.rows[static_cast<std::size_t>(i)];
    const float y = 92.0f + line * static_cast<float>(i - first);
    const bool here = i == list.chosen;
    if (here)
      pen.panel({-half + 12.0f, y - 20.0f}, {-half + 18.0f + width, y + 8.0f}, 6.0f,
                {0.16f, 0.26f, 0.38f, 0.95f});
    const Colour& ink = here ? kInk : kFaint;
    pen.text(row.when, {Face::regular, 14.0f, 0.0f, Align::left}, {-half + 24.0f, y}, ink, 0.55f,
             150.0f);
    pen.text(row.what, {here ? Face::bold : Face::regular, 15.0f, 0.0f, Align::left},
             {-half + 184.0f, y}, ink, 0.55f, width - 200.0f);
    pen.text(row.playable ? "●" : "-", {Face::bold, 14.0f, 0.0f, Align::right},
             {-half + 8.0f + width, y}, ink);
  }
  if (all == 0)
    pen.text(tr("no match is recorded yet: play one"), {Face::regular, 16.0f, 0.0f, Align::left},
             {-half + 24.0f, 92.0f}, kFaint, 0.55f, width);
  float y = 92.0f;
  int place = 1;
  for (const ReplayList::Player& player : list.hall_of_fame) {
    if (y > pen.bottom - 70.0f) break;
    pen.text(std::to_string(place++) + "  " + player.name,
             {Face::regular, 15.0f, 0.0f, Align::left}, {half - 290.0f, y}, kInk, 0.55f, 150.0f);
    pen.text(player.rating, {Face::bold, 15.0f, 0.0f, Align::right}, {half - 84.0f, y}, kInk);
    pen.text(player.record, {Face::regular, 13.0f, 0.0f, Align::right}, {half - 22.0f, y}, kFaint);
    y += 26.0f;
  }
  if (list.hall_of_fame.empty())
    pen.text(tr("nobody has won a match yet"), {Face::regular, 14.0f, 0.0f, Align::left},
             {half - 290.0f, 92.0f}, kFaint, 0.55f, 270.0f);
  const bool news = !list.message.empty();
  pen.text(
      news ? list.message.c_str() : tr("up and down choose, Enter or click watches, Esc leaves"),
      {Face::regular, 14.0f, 0.0f, Align::centre}, {0.0f, pen.bottom - 30.0f},
      news ? kWarning : kFaint, 0.55f, 2.0f * half - 40.0f);
  ui.flush(screen);
}

}  // namespace client
