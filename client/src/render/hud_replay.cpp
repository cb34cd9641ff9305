#include "render/hud_replay.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>
#include <sstream>

#include "render/hud_screens.h"
#include "render/sentences.h"
#include "render/translate.h"

namespace client {
namespace {

const Colour kFace{0.10f, 0.14f, 0.20f, 0.95f}, kChosen{0.16f, 0.26f, 0.38f, 0.95f};

// Draws text at pixels of the window, with a separate scale.
struct Pen {
  UiBatch& ui;
  float scale;

  TextStyle style(float size, Align align, Face face = Face::regular) const {
    return {face, size * scale, 0.0f, align};
  }
  float width(const std::string& text, float size, Face face = Face::regular) const {
    return ui.font().width(text, style(size, Align::left, face));
  }
  // Scales the line down if it is wider than room [px].
  void text(const std::string& text, float size, Align align, const glm::vec2& at,
            const Colour& colour, float room, Face face = Face::regular) const {
    TextStyle written = style(size, align, face);
    const float wide = ui.font().width(text, written);
    if (wide > room) written.size *= std::max(room, 1.0f) / wide;
    ui.text(text, written, at, colour);
  }
  // A name: scaled down to the smallest legible size, then cut.
  void name(std::string text, float size, Align align, const glm::vec2& at, const Colour& colour,
            float room, Face face = Face::regular) const {
    constexpr float kMinName = 11.0f;  // [px] of a letter's size
    const float wide = width(text, size, face);
    if (wide > room) size = std::min(size, std::max(size * room / wide, kMinName / scale));
    if (width(text, size, face) > 1.01f * room) {  // tolerance for rounding
      const auto shortened = [&] { return text + "\u2026"; };
      while (!text.empty() && width(shortened(), size, face) > room) {
        while (text.size() > 1 && (text.back() & 0xC0) == 0x80) text.pop_back();  // UTF-8
        text.pop_back();
      }
      text = shortened();
    }
    this->text(text, size, align, at, colour, room, face);
  }
  void box(const ScreenBox& box, float corner, const Colour& colour, float outline = 0.0f) const {
    ui.panel(box.low, box.high, corner * scale, colour, outline * scale);
  }
  void button(const ScreenBox& box, const std::string& label, const Colour& ink) const {
    this->box(box, 6.0f, kFace);
    this->box(box, 6.0f, {0.35f, 0.45f, 0.55f, 0.6f}, 1.0f);
    const glm::vec2 middle = 0.5f * (box.low + box.high) + glm::vec2(0.0f, 5.0f * scale);
    text(label, 14.0f, Align::centre, middle, ink, box.high.x - box.low.x - 8.0f * scale);
  }
};

std::string clock_text(double seconds, bool tenths = false) {
  const long tenth = std::lround(std::floor(10.0 * std::max(0.0, seconds) + 1e-6));
  const long whole = tenth / 10;
  char text[48];
  int length = 0;
  if (whole >= 3600) {
    length = std::snprintf(text, sizeof text, "%ld:%02ld:%02ld", whole / 3600, whole / 60 % 60,
                           whole % 60);
  } else {
    length = std::snprintf(text, sizeof text, "%ld:%02ld", whole / 60, whole % 60);
  }
  if (tenths)
    std::snprintf(text + length, sizeof text - static_cast<std::size_t>(length), ".%ld",
                  tenth % 10);
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

// Breaks text into lines that fit; a word that is too long, such as a path, is split.
std::vector<std::string> wrapped(const Pen& pen, const std::string& text, float size, float room) {
  std::vector<std::string> lines;
  std::string line;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    std::string longer = line.empty() ? word : line + ' ';
    if (!line.empty()) longer += word;
    if (pen.width(longer, size) <= room) {
      line = longer;
      continue;
    }
    if (!line.empty()) lines.push_back(line);
    while (pen.width(word, size) > room && word.size() > 4) {
      std::size_t fits = word.size();
      while (fits > 1 && pen.width(word.substr(0, fits), size) > room) --fits;
      while (fits > 1 && fits < word.size() && (word[fits] & 0xC0) == 0x80) --fits;  // UTF-8
      lines.push_back(word.substr(0, fits));
      word.erase(0, fits);
    }
    line = word;
  }
  if (!line.empty()) lines.push_back(line);
  return lines;
}

// Lines of which the last is at `bottom`.
void draw_message(const Pen& pen, const std::string& message, bool warning, float bottom,
                  const glm::ivec2& screen) {
  if (message.empty()) return;
  const float room = static_cast<float>(screen.x) - 40.0f * pen.scale, line = 21.0f * pen.scale;
  const auto lines = wrapped(pen, tr_sentence(message), 15.0f, room);
  float wide = 0.0f;
  for (const std::string& text : lines) wide = std::max(wide, pen.width(text, 15.0f));
  const float middle = 0.5f * static_cast<float>(screen.x);
  const float half = 0.5f * wide + 14.0f * pen.scale;
  const float top = bottom - line * static_cast<float>(lines.size()) - 12.0f * pen.scale;
  pen.box({{middle - half, top}, {middle + half, bottom}}, 9.0f,
          warning ? Colour{0.20f, 0.13f, 0.02f, 0.92f} : Colour{0.03f, 0.06f, 0.09f, 0.92f});
  float y = top + line;
  for (const std::string& text : lines) {
    pen.text(text, 15.0f, Align::centre, {middle, y}, warning ? kWarning : kInk, room);
    y += line;
  }
}

struct KeyLine {
  const char* keys;
  const char* meaning;
};
constexpr std::array<KeyLine, 14> kReplayKeys{
    {{N_("Space, Enter"), N_("pause, play on")},
     {N_("Left, Right"), N_("1 s back, forward; with Shift 10 s")},
     {", .", N_("one tick (1 ms) back, forward")},
     {N_("Up, Down"), N_("faster, slower: 1/8 to 4 times")},
     {"B N", N_("previous, next goal")},
     {N_("Home, End"), N_("beginning, end")},
     {"C V", N_("camera, other side")},
     {"U", N_("hide or show all text")},
     {"K", N_("keep: is never deleted")},
     {"S", N_("share: a copy with a descriptive name")},
     {"F12", N_("picture into the folder of shared recordings")},
     {N_("Mouse"), N_("click or draw along the line; wheel: 1 s")},
     {N_("Gamepad"), N_("A pause, B back, X share, Y camera, cross, shoulders: goals")},
     {"Esc", N_("back to the list, leave")}}};
constexpr std::array<KeyLine, 6> kListKeys{
    {{N_("Up, Down, wheel"), N_("choose")},
     {N_("Enter, click"), N_("watch")},
     {"K", N_("keep: is never deleted")},
     {"S", N_("share: a copy with a descriptive name")},
     {N_("Gamepad"), N_("cross chooses, A watches, B leaves, X shares, Y keeps")},
     {"Esc", N_("leave")}}};

// Centred above `bottom`, as large as fits.
void draw_keys(const Pen& usual, std::span<const KeyLine> keys, float bottom,
               const glm::ivec2& screen) {
  float left = 0.0f, right = 0.0f;
  for (const KeyLine& key : keys) {
    left = std::max(left, usual.width(tr(key.keys), 15.0f, Face::bold));
    right = std::max(right, usual.width(tr(key.meaning), 15.0f));
  }
  const float wide = left + right + 56.0f * usual.scale;
  const float high = (25.0f * static_cast<float>(keys.size()) + 24.0f) * usual.scale;
  const float share = std::min(
      {1.0f, (static_cast<float>(screen.x) - 8.0f) / wide, std::max(bottom - 8.0f, 8.0f) / high});
  const Pen pen{usual.ui, share * usual.scale};
  const glm::vec2 size = share * glm::vec2(wide, high);
  const glm::vec2 low{0.5f * (static_cast<float>(screen.x) - size.x),
                      std::max(4.0f, 0.5f * (bottom - size.y))};
  pen.box({low, low + size}, 14.0f, {kPanel.r, kPanel.g, kPanel.b, 0.95f});
  pen.box({low, low + size}, 14.0f, {0.62f, 0.84f, 1.0f, 0.6f}, 1.5f);
  const float column = low.x + share * left + 20.0f * pen.scale;
  float y = low.y + 31.0f * pen.scale;
  for (const KeyLine& key : keys) {
    pen.text(tr(key.keys), 15.0f, Align::right, {column, y}, kInk, size.x, Face::bold);
    pen.text(tr(key.meaning), 15.0f, Align::left, {column + 16.0f * pen.scale, y}, kFaint, size.x);
    y += 25.0f * pen.scale;
  }
}

std::string label_of(ReplayButton button, const ReplayBar& bar) {
  switch (button) {
    case ReplayButton::previous_goal:
      return std::string("\u25C0 ") + tr("goal");
    case ReplayButton::back:
      return "-1 s";
    case ReplayButton::play:
      return bar.paused ? std::string("\u25B6 ") + tr("play") : std::string(tr("pause"));
    case ReplayButton::on:
      return "+1 s";
    case ReplayButton::next_goal:
      return std::string(tr("goal")) + " \u25B6";
    case ReplayButton::slower:
      return tr("slower");
    case ReplayButton::faster:
      return tr("faster");
    case ReplayButton::camera:
      return tr("camera");
    case ReplayButton::side:
      return tr("side");
    case ReplayButton::keep:
      return bar.kept ? std::string("\u25CF ") + tr("kept") : std::string(tr("keep"));
    case ReplayButton::share:
      return tr("share");
    case ReplayButton::hide:
      return tr("hide");
    case ReplayButton::keys:
      return tr("keys");
    case ReplayButton::leave:
      return tr("back");
  }
  return {};
}

float scale_of(const glm::ivec2& screen, float min) {
  return std::max(
      min, std::min(static_cast<float>(screen.y) / 720.0f, static_cast<float>(screen.x) / 960.0f));
}

}  // namespace

// --- the bar ------------------------------------------------------------------------------------

ReplayBarLayout replay_bar_layout(const glm::ivec2& screen) {
  constexpr float kEdge = 18.0f, kButton = 62.0f, kHigh = 28.0f, kGap = 4.0f;
  ReplayBarLayout layout;
  const float s = layout.scale = scale_of(screen, 0.72f);
  const auto width = static_cast<float>(screen.x), height = static_cast<float>(screen.y);
  const float room = width - 2.0f * kEdge * s;
  const int rows = room / kReplayButtons < kButton * s ? 2 : 1;
  const int columns = (kReplayButtons + rows - 1) / rows;
  const float high = 64.0f + static_cast<float>(rows) * (kHigh + kGap) + 6.0f;
  layout.panel = {{0.0f, height - high * s}, {width, height}};
  const float top = layout.panel.low.y;
  layout.line = {{kEdge * s, top + 4.0f * s}, {width - kEdge * s, top + 34.0f * s}};
  layout.text_y = top + 52.0f * s;
  const float step = room / static_cast<float>(columns);
  for (int i = 0; i < kReplayButtons; ++i) {
    const int column = i % columns, row = i / columns;
    const glm::vec2 low{kEdge * s + step * static_cast<float>(column),
                        top + (62.0f + static_cast<float>(row) * (kHigh + kGap)) * s};
    layout.buttons[static_cast<std::size_t>(i)] = {low,
                                                   low + glm::vec2(step - kGap * s, kHigh * s)};
  }
  return layout;
}

double moment_at(const ReplayBarLayout& layout, float x, double total) {
  const float along =
      (x - layout.line.low.x) / std::max(layout.line.high.x - layout.line.low.x, 1.0f);
  return total * static_cast<double>(std::clamp(along, 0.0f, 1.0f));
}

void draw_replay_bar(UiBatch& ui, const ReplayBar& bar, const glm::ivec2& screen) {
  const ReplayBarLayout layout = replay_bar_layout(screen);
  const Pen pen{ui, layout.scale};
  const float s = layout.scale;
  pen.box(layout.panel, 0.0f, {0.02f, 0.03f, 0.05f, 1.0f});
  const float left = layout.line.low.x, right = layout.line.high.x;
  const float y = 0.5f * (layout.line.low.y + layout.line.high.y) + 4.0f * s;
  const auto along = [&](double moment) {
    const double share = bar.total > 0.0 ? std::clamp(moment / bar.total, 0.0, 1.0) : 0.0;
    return left + (right - left) * static_cast<float>(share);
  };
  const auto stripe = [&](float to, const Colour& colour) {
    pen.box({{left, y - 3.0f * s}, {to, y + 3.0f * s}}, 3.0f, colour);
  };
  stripe(right, {0.22f, 0.27f, 0.33f, 1.0f});
  stripe(along(bar.read), {0.42f, 0.50f, 0.58f, 1.0f});
  stripe(along(bar.now), kInk);
  for (const ReplayBar::Goal& goal : bar.goals) {
    const auto team = static_cast<std::size_t>(goal.team == 1);
    const float x = along(goal.at);
    pen.box({{x - 1.5f * s, y - 8.0f * s}, {x + 1.5f * s, y + 8.0f * s}}, 1.0f, kTeamInk[team]);
    pen.text(kTeamMark[team], 11.0f, Align::centre, {x, y - 9.0f * s}, kTeamInk[team], 40.0f * s,
             Face::bold);
  }
  const float now = along(bar.now);
  pen.box({{now - 6.0f * s, y - 9.0f * s}, {now + 6.0f * s, y + 9.0f * s}}, 6.0f, kInk);

  const float third = 0.36f * (right - left);
  std::string time = clock_text(bar.now, bar.paused || bar.speed < 1.0) + " / " +
                     clock_text(bar.total) + "   " + speed_text(bar.speed);
  if (bar.paused) time.append("   ").append(tr("PAUSED"));
  pen.text(time, 16.0f, Align::left, {left, layout.text_y}, kInk, third, Face::bold);
  const float middle = 0.5f * (left + right);
  const std::string score = std::to_string(bar.score[0]) + " : " + std::to_string(bar.score[1]);
  const float half = 0.5f * pen.width(score, 18.0f, Face::bold) + 10.0f * s;
  pen.text(score, 18.0f, Align::centre, {middle, layout.text_y}, kInk, third, Face::bold);
  pen.text(kTeamMark[0], 15.0f, Align::right, {middle - half, layout.text_y}, kTeamInk[0], third);
  pen.text(kTeamMark[1], 15.0f, Align::left, {middle + half, layout.text_y}, kTeamInk[1], third);
  std::string camera = tr(bar.camera.c_str());
  if (bar.being_made) camera = std::string(tr("is being played")) + "   " + camera;
  pen.text(camera, 15.0f, Align::right, {right, layout.text_y}, kFaint, third);
  for (int i = 0; i < kReplayButtons; ++i) {
    pen.button(layout.buttons[static_cast<std::size_t>(i)],
               label_of(static_cast<ReplayButton>(i), bar), kInk);
  }
  draw_message(pen, bar.message, bar.warning, layout.panel.low.y - 8.0f * s, screen);
  if (bar.show_keys) draw_keys(pen, kReplayKeys, layout.panel.low.y, screen);
  ui.flush(screen);
}

// --- the list -----------------------------------------------------------------------------------

ReplayListLayout replay_list_layout(const glm::ivec2& screen) {
  ReplayListLayout layout;
  const float min = std::clamp(static_cast<float>(screen.x) / 630.0f, 0.66f, 0.76f);
  const float s = layout.scale = scale_of(screen, min);
  const auto width = static_cast<float>(screen.x), height = static_cast<float>(screen.y);
  const float half = std::min(0.5f * width - 6.0f, 460.0f * s);
  layout.panel = {{0.5f * width - half, 10.0f * s}, {0.5f * width + half, height - 10.0f * s}};
  const glm::vec2 low = layout.panel.low, high = layout.panel.high;
  layout.two_lines = width < 900.0f * s;
  layout.row_height = (layout.two_lines ? 56.0f : 32.0f) * s;
  const float top = low.y + 70.0f * s, bottom = high.y - 62.0f * s;
  layout.shown = std::max(1, static_cast<int>((bottom - top) / layout.row_height));
  layout.rows = {{low.x + 12.0f * s, top},
                 {high.x - 12.0f * s, top + layout.row_height * static_cast<float>(layout.shown)}};
  const glm::vec2 size(112.0f * s, 28.0f * s);
  const float y = low.y + 18.0f * s;
  float x = high.x - 18.0f * s;
  for (ScreenBox* box : {&layout.leave, &layout.share, &layout.keep}) {
    *box = {{x - size.x, y}, {x, y + size.y}};
    x -= size.x + 8.0f * s;
  }
  return layout;
}

std::optional<int> row_at(const ReplayListLayout& layout, const ReplayList& list,
                          const glm::vec2& at) {
  if (!layout.rows.holds(at)) return std::nullopt;
  const int row = list.first + static_cast<int>((at.y - layout.rows.low.y) / layout.row_height);
  if (row >= static_cast<int>(list.rows.size()) || row >= list.first + layout.shown)
    return std::nullopt;
  return row;
}

namespace {

std::string player_text(const ReplayList::Row& row, std::size_t team) {
  std::string text = row.players[team].empty() ? "?" : tr(row.players[team].c_str());
  if (row.computer[team]) text.append(" (").append(tr("computer")).append(")");
  return text;
}

// Positions of a row's fields, as fractions of its width.
struct RowPlaces {
  float when, kept, middle, beside_score, side, seconds, state;
};
constexpr RowPlaces kInOneLine{0.164f, 0.187f, 0.43f, 0.045f, 0.175f, 0.745f, 0.225f};
constexpr RowPlaces kInTwoLines{0.36f, 0.41f, 0.50f, 0.065f, 0.42f, 0.60f, 0.36f};

void draw_row(const Pen& pen, const ReplayList::Row& row, const ScreenBox& box, bool chosen,
              bool two_lines) {
  const RowPlaces& at = two_lines ? kInTwoLines : kInOneLine;
  const float s = pen.scale, wide = box.high.x - box.low.x;
  if (chosen) pen.box(box, 6.0f, kChosen);
  const float y = two_lines ? box.low.y + 21.0f * s : box.high.y - 10.0f * s;
  const float below = box.high.y - 10.0f * s;
  const Colour& ink = chosen ? kInk : kFaint;
  const auto x = [&](float share) { return box.low.x + share * wide; };
  pen.name(row.when, 15.0f, Align::left, {x(0.012f), below}, ink, at.when * wide);
  pen.text(row.kept ? "\u25CF" : "", 13.0f, Align::centre, {x(at.kept), below}, kWarning,
           0.03f * wide);
  if (row.bad) {
    const float left = two_lines ? 0.012f : 0.21f;
    pen.name(row.name, 15.0f, Align::left, {x(left), y}, kFaint,
             (two_lines ? 0.95f : 0.45f) * wide);
  } else {
    char score[48];
    std::snprintf(score, sizeof score, "%d : %d", row.score[0], row.score[1]);
    pen.text(score, 16.0f, Align::centre, {x(at.middle), y}, kInk, 2.0f * at.beside_score * wide,
             Face::bold);
    const Face face = chosen ? Face::bold : Face::regular;
    pen.name(player_text(row, 0), 15.0f, Align::right, {x(at.middle - at.beside_score), y},
             kTeamInk[0], at.side * wide, face);
    pen.name(player_text(row, 1), 15.0f, Align::left, {x(at.middle + at.beside_score), y},
             kTeamInk[1], at.side * wide, face);
    pen.text(clock_text(row.seconds), 15.0f, Align::right, {x(at.seconds), below}, ink,
             0.12f * wide);
  }
  if (!row.state.empty())
    pen.text(tr(row.state.c_str()), 14.0f, Align::right, {x(0.985f), below},
             row.bad ? kWarning : kFaint, at.state * wide);
}

void draw_rows(const Pen& pen, const ReplayList& list, const ReplayListLayout& layout) {
  const int all = static_cast<int>(list.rows.size());
  for (int i = list.first; i < std::min(all, list.first + layout.shown); ++i) {
    const float top = layout.rows.low.y + layout.row_height * static_cast<float>(i - list.first);
    draw_row(pen, list.rows[static_cast<std::size_t>(i)],
             {{layout.rows.low.x, top}, {layout.rows.high.x, top + layout.row_height}},
             i == list.chosen, layout.two_lines);
  }
  if (all <= layout.shown) return;
  // The scroll bar.
  const float high = layout.rows.high.y - layout.rows.low.y, count = static_cast<float>(all);
  const float x = layout.rows.high.x + 2.0f * pen.scale;
  const auto at = [&](int row) {
    return layout.rows.low.y + high * static_cast<float>(row) / count;
  };
  pen.box({{x, at(list.first)},
           {x + 4.0f * pen.scale, std::min(at(list.first + layout.shown), layout.rows.high.y)}},
          2.0f, kFaint);
}

}  // namespace

void draw_replay_list(UiBatch& ui, const ReplayList& list, const glm::ivec2& screen) {
  const ReplayListLayout layout = replay_list_layout(screen);
  const Pen pen{ui, layout.scale};
  const float s = layout.scale;
  const glm::vec2 low = layout.panel.low, high = layout.panel.high;
  pen.box(layout.panel, 16.0f, {0.03f, 0.045f, 0.07f, 0.97f});
  pen.box(layout.panel, 16.0f, {0.62f, 0.84f, 1.0f, 0.4f}, 1.5f);
  pen.text(tr("RECORDINGS"), 26.0f, Align::left, {low.x + 22.0f * s, low.y + 42.0f * s}, kInk,
           layout.keep.low.x - low.x - 34.0f * s, Face::bold);
  const bool any = !list.rows.empty();
  const bool kept = any && list.rows[static_cast<std::size_t>(list.chosen)].kept;
  if (any) {
    pen.button(layout.keep, tr(kept ? N_("do not keep") : N_("keep")), kInk);
    pen.button(layout.share, tr("share"), kInk);
  }
  pen.button(layout.leave, tr("back"), kInk);
  draw_rows(pen, list, layout);
  if (!any)
    pen.text(tr(list.reading ? N_("reading ...") : N_("no match has been recorded yet: play one")),
             17.0f, Align::left, {low.x + 24.0f * s, layout.rows.low.y + 24.0f * s}, kFaint,
             high.x - low.x - 48.0f * s);
  const float middle = 0.5f * (low.x + high.x);
  if (!list.message.empty()) {
    draw_message(pen, list.message, list.warning, high.y - 12.0f * s, screen);
  } else {
    const char* hint =
        list.reading && any
            ? tr("reading ...")
            : tr("up and down choose, Enter or click watches, K keeps, S shares, F1 all keys, Esc "
                 "leaves");
    pen.text(hint, 14.0f, Align::centre, {middle, high.y - 22.0f * s}, kFaint,
             high.x - low.x - 36.0f * s);
  }
  if (list.show_keys) draw_keys(pen, kListKeys, high.y - 60.0f * s, screen);
  ui.flush(screen);
}

}  // namespace client
