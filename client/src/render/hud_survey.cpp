// The questionnaire: one panel per person who is asked, at the lower edge.
#include <algorithm>

#include "render/hud.h"
#include "render/hud_screens.h"
#include "render/translate.h"
#include "wire/limits.h"

namespace client {
namespace {

constexpr float kPanelHalf = 300.0f, kPanelHeight = 142.0f,
                kBetween = 10.0f;  // of a panel, in units

std::string named(const SurveyPanel& panel) {
  const auto team = static_cast<std::size_t>(panel.team == 1);
  std::string text = std::string(kTeamMark[team]).append(" ").append(kTeamNames[team]);
  if (!panel.name.empty()) text.append("  ").append(tr(panel.name.c_str()));
  if (panel.number > 0) text.append(" ").append(std::to_string(panel.number));
  return text;
}

void draw_choice(const HudPen& pen, const char* text, const glm::vec2& at, float half, bool chosen,
                 const Colour& ink) {
  const glm::vec2 low = at + glm::vec2(-half, -20.0f), high = at + glm::vec2(half, 8.0f);
  pen.panel(low, high, 7.0f,
            chosen ? Colour{0.16f, 0.26f, 0.38f, 0.98f} : Colour{0.09f, 0.12f, 0.17f, 0.9f});
  if (chosen) pen.panel(low, high, 7.0f, ink, 1.5f);
  pen.text(text, {Face::bold, 16.0f, 0.0f, Align::centre}, at, chosen ? kInk : kFaint, 0.55f,
           2.0f * half - 8.0f);
}

void draw_consent(const HudPen& pen, const SurveyPanel& panel, float x, float y,
                  const Colour& ink) {
  pen.text(tr("They stay on this machine, without your name. Stop whenever you like."),
           {Face::regular, 13.5f, 0.0f, Align::centre}, {x, y + 62.0f}, kFaint, 0.55f,
           2.0f * kPanelHalf - 40.0f);
  const std::array<const char*, 3> choices{tr("No"), tr("Yes"), tr("Never ask")};
  for (int i = 0; i < 3; ++i) {
    draw_choice(pen, choices[static_cast<std::size_t>(i)],
                {x + 150.0f * static_cast<float>(i - 1), y + 96.0f}, 66.0f, panel.chosen == i, ink);
  }
}

// The choice "no answer" is set apart from the scale.
void draw_scale(const HudPen& pen, const SurveyPanel& panel, float x, float y, const Colour& ink) {
  constexpr float kStep = 58.0f, kBox = 24.0f, kApart = 62.0f;
  const auto middle = [&](int score) {
    return x + kStep * (static_cast<float>(score) - 2.5f) - (score == 0 ? kApart : 0.0f) +
           0.5f * kApart;
  };
  for (int score = 0; score <= wire::kMaxScore; ++score) {
    const std::string text = score == 0 ? "-" : std::to_string(score);
    draw_choice(pen, text.c_str(), {middle(score), y + 78.0f}, kBox, panel.chosen == score, ink);
  }
  const float below = y + 104.0f;
  pen.text(tr("no answer"), {Face::regular, 12.5f, 0.0f, Align::centre}, {middle(0), below}, kFaint,
           0.55f, kStep + kApart - 12.0f);
  pen.text(tr("strongly disagree"), {Face::regular, 12.5f, 0.0f, Align::left},
           {middle(1) - kBox, below}, kFaint, 0.55f, 2.4f * kStep);
  pen.text(tr("strongly agree"), {Face::regular, 12.5f, 0.0f, Align::right},
           {middle(wire::kMaxScore) + kBox, below}, kFaint, 0.55f, 2.4f * kStep);
}

// x: its centre; y: its upper edge.
void draw_panel(const HudPen& pen, const SurveyPanel& panel, float x, float y) {
  const Colour& ink = kTeamInk[panel.team == 1 ? 1 : 0];
  const glm::vec2 low{x - kPanelHalf, y}, high{x + kPanelHalf, y + kPanelHeight};
  pen.panel(low, high, 14.0f, {0.03f, 0.045f, 0.07f, 0.96f});
  pen.panel(low, high, 14.0f, ink, 1.5f);
  const bool statement = panel.kind == SurveyPanel::Kind::statement;
  pen.text(named(panel), {Face::bold, 13.0f, 0.02f, Align::left}, low + glm::vec2(16.0f, 20.0f),
           ink, 0.55f, 260.0f);
  if (statement) {
    const std::string place =
        std::to_string(panel.question + 1) + " / " + std::to_string(wire::kQuestionCount);
    pen.text(place, {Face::regular, 13.0f, 0.0f, Align::right}, {x + kPanelHalf - 16.0f, y + 20.0f},
             kFaint);
  }
  const bool thanks = panel.kind == SurveyPanel::Kind::thanks;
  pen.text(tr(panel.text), {Face::bold, 19.0f, 0.0f, Align::centre},
           {x, y + (thanks ? 80.0f : 43.0f)}, kInk, 0.55f, 2.0f * kPanelHalf - 40.0f);
  if (thanks) return;
  statement ? draw_scale(pen, panel, x, y, ink) : draw_consent(pen, panel, x, y, ink);
  const char* how = panel.cabinet
                        ? tr("spin a rod to choose, hold it still to confirm; push it to "
                             "play on")
                        : tr("left and right choose, push confirms, up goes back, Esc ends");
  pen.text(how, {Face::regular, 12.5f, 0.0f, Align::centre}, {x, y + kPanelHeight - 12.0f}, kFaint,
           0.55f, 2.0f * kPanelHalf - 40.0f);
  if (panel.standing > 0.0f) {
    pen.panel(
        {x - kPanelHalf + 16.0f, high.y - 5.0f},
        {x - kPanelHalf + 16.0f + panel.standing * (2.0f * kPanelHalf - 32.0f), high.y - 2.0f},
        1.5f, ink);
  }
}

struct SurveyLayout {
  HudPen pen;
  std::vector<const SurveyPanel*> shown;
  std::size_t columns = 1;
  float high = 0.0f;
  float taken() const { return high + 4.0f; }
};

// Two in a row if there is space; scaled down if there is not.
SurveyLayout layout_of(const HudPen& whole, std::span<const SurveyPanel> panels, int team) {
  std::vector<const SurveyPanel*> shown;
  for (const SurveyPanel& panel : panels) {
    if (team < 0 || panel.team == team) shown.push_back(&panel);
  }
  if (shown.empty()) return {whole, shown};
  // In one column if two columns would be too small to read.
  const bool narrow = whole.half_width < 1.6f * kPanelHalf;
  const std::size_t columns = narrow ? 1 : std::min<std::size_t>(shown.size(), 2);
  const std::size_t rows = (shown.size() + columns - 1) / columns;
  const float wide = static_cast<float>(columns) * (2.0f * kPanelHalf + kBetween);
  const float high = static_cast<float>(rows) * (kPanelHeight + kBetween);
  const float half = 0.5f * wide + 4.0f;
  const HudPen pen =
      whole.fitting(half, std::max(high + 10.0f, 1.25f * high)).readable(0.75f, half);
  return {pen, shown, columns, high};
}

}  // namespace

float survey_height(const HudPen& whole, std::span<const SurveyPanel> panels, int team) {
  const SurveyLayout layout = layout_of(whole, panels, team);
  return layout.shown.empty() ? 0.0f : layout.taken() * layout.pen.scale / whole.scale;
}

void draw_survey(const HudPen& whole, std::span<const SurveyPanel> panels, int team) {
  const SurveyLayout layout = layout_of(whole, panels, team);
  const HudPen& pen = layout.pen;
  const float top = pen.bottom - layout.taken();
  for (std::size_t i = 0; i < layout.shown.size(); ++i) {
    const std::size_t column = i % layout.columns, row = i / layout.columns;
    const float beside = static_cast<float>(column) - 0.5f * static_cast<float>(layout.columns - 1);
    const float below = static_cast<float>(row) * (kPanelHeight + kBetween);
    draw_panel(pen, *layout.shown[i], beside * (2.0f * kPanelHalf + kBetween), top + below);
  }
}

}  // namespace client
