#include "view.h"

#include <algorithm>
#include <cmath>

#include "render/hud_screens.h"
#include "render/translate.h"
#include "text.h"

namespace calibrate {
namespace {

using client::Align;
using client::Colour;
using client::Face;
using client::HudPen;
using client::tr;

constexpr Colour kPanel{0.06f, 0.09f, 0.14f, 1.0f}, kTrack{0.16f, 0.21f, 0.29f, 1.0f},
    kBright{0.93f, 0.96f, 1.0f, 1.0f}, kDim{0.62f, 0.70f, 0.80f, 1.0f},
    kSlide{0.30f, 0.80f, 0.95f, 1.0f}, kSpin{0.98f, 0.72f, 0.30f, 1.0f},
    kGood{0.42f, 0.86f, 0.52f, 1.0f}, kBad{0.98f, 0.45f, 0.38f, 1.0f};
constexpr float kWide = 420.0f;  // half width of the text area [units]

// Draws text below the previous line, wrapped; returns its lower edge.
float paragraph(const HudPen& pen, const std::string& text, float size, float top,
                const Colour& colour, Face face = Face::regular) {
  const client::TextStyle style{face, size, 0.0f, Align::centre};
  for (const std::string& line : pen.wrapped(text, style, 2 * kWide)) {
    top += 1.3f * size;
    pen.text(line, style, {0.0f, top}, colour);
  }
  return top;
}

// Each rod of the table as a small field with its state.
void draw_rods(const HudPen& pen, const Session& session, float top) {
  const float step = 2 * kWide / static_cast<float>(cabinet::kRods);
  for (int rod = 0; rod < cabinet::kRods; ++rod) {
    const float left = -kWide + step * static_cast<float>(rod);
    const bool wanted = std::ranges::count(session.rods(), rod) > 0;
    const RodState state = session.state(rod);
    Colour colour = state == RodState::fitted    ? kGood
                    : state == RodState::refused ? kBad
                    : rod == session.rod()       ? kSlide
                                                 : kTrack;
    if (!wanted) colour.a = 0.3f;
    pen.panel({left + 4.0f, top}, {left + step - 4.0f, top + 30.0f}, 6.0f, colour);
    const Colour letters = colour == kTrack || !wanted ? kDim : kPanel;
    pen.text(std::to_string(rod + 1), {Face::bold, 18.0f, 0.0f, Align::centre},
             {left + 0.5f * step, top + 21.0f}, letters, 0.0f);
  }
}

void draw_bar(const HudPen& pen, float top, double share, const Colour& colour) {
  const auto right = static_cast<float>(-kWide + 2 * kWide * std::clamp(share, 0.0, 1.0));
  pen.panel({-kWide, top}, {kWide, top + 14.0f}, 7.0f, kTrack);
  if (right > -kWide + 14.0f) pen.panel({-kWide, top}, {right, top + 14.0f}, 7.0f, colour);
}

// The last seconds of both counts, each scaled to its range.
void draw_trace(const HudPen& pen, const Session& session, float top, float bottom) {
  pen.panel({-kWide, top}, {kWide, bottom}, 8.0f, kPanel);
  const auto& trace = session.trace();
  const auto draw = [&](double TracePoint::*value, const Colour& colour) {
    if (trace.size() < 2) return;
    const auto [low, high] = std::ranges::minmax(trace, {}, value);
    const double range = std::max(high.*value - low.*value, 20.0);
    const double end = trace.back().seconds;
    constexpr int kColumns = 280;
    std::size_t at = 0;
    float before = 0.0f;
    bool any = false;
    for (int column = 0; column < kColumns; ++column) {
      const double time = end - Session::kTraceSeconds * (1.0 - (column + 1.0) / kColumns);
      while (at + 1 < trace.size() && trace[at + 1].seconds <= time) ++at;
      if (trace[at].seconds > time) continue;
      const auto share = static_cast<float>((trace[at].*value - low.*value) / range);
      const float y = bottom - 10.0f - share * (bottom - top - 34.0f);
      const float x = -kWide + 2 * kWide * static_cast<float>(column) / kColumns;
      const float from = any ? before : y;
      pen.panel({x, std::min(from, y) - 1.0f}, {x + 3.2f, std::max(from, y) + 1.0f}, 1.0f, colour);
      before = y;
      any = true;
    }
  };
  draw(&TracePoint::slide, kSlide);
  draw(&TracePoint::spin, kSpin);
  const client::TextStyle small{Face::bold, 13.0f, 0.0f, Align::left};
  pen.text(tr(N_("counts along")), small, {-kWide + 10.0f, top + 18.0f}, kSlide);
  pen.text(tr(N_("counts around")), small, {-kWide + 150.0f, top + 18.0f}, kSpin);
}

// The residual of each mark, as a fraction of the accepted one.
void draw_residuals(const HudPen& pen, const cabinet::RodFit& fit, float top, float bottom) {
  constexpr double kMaxSlide = 1e-3, kMaxAngle = 5.0 / 180 * M_PI;
  pen.panel({-kWide, top}, {kWide, bottom}, 8.0f, kPanel);
  const float middle = 0.5f * (top + bottom) + 6.0f, half = 0.5f * (bottom - top) - 20.0f;
  pen.panel({-kWide + 8.0f, middle - 0.5f}, {kWide - 8.0f, middle + 0.5f}, 0.0f, kTrack);
  const float step = (2 * kWide - 40.0f) / static_cast<float>(fit.residuals.size());
  float x = -kWide + 20.0f;
  for (const auto& r : fit.residuals) {
    const bool slide = r.mark.kind == cabinet::CalibrationMark::Kind::slide;
    const double share = std::clamp(r.value / (slide ? kMaxSlide : kMaxAngle), -1.0, 1.0);
    const float y = middle - half * static_cast<float>(share);
    const Colour colour = r.outlier ? kBad : slide ? kSlide : kSpin;
    pen.panel({x, std::min(y, middle) - 1.0f}, {x + 0.6f * step, std::max(y, middle) + 1.0f}, 1.5f,
              colour);
    x += step;
  }
  const client::TextStyle small{Face::bold, 13.0f, 0.0f, Align::left};
  pen.text(tr(N_("error of each mark, full scale 1 mm")), small, {-kWide + 10.0f, top + 18.0f},
           kSlide);
  pen.text(tr(N_("full scale 5 degrees")), small, {-kWide + 290.0f, top + 18.0f}, kSpin);
}

}  // namespace

void draw_session(client::UiBatch& ui, const Session& session, const ViewState& state,
                  const glm::ivec2& screen) {
  const client::HudRegion region{glm::vec2(0.0f), glm::vec2(screen)};
  const HudPen pen = HudPen(ui, region, true).fitting(kWide + 20.0f, 700.0f);
  pen.text(rod_text(state.layout, session.rod()), {Face::bold, 30.0f, 0.0f, Align::centre},
           {0.0f, 48.0f}, kBright);
  draw_rods(pen, session, 66.0f);
  const bool guided = session.state(session.rod()) == RodState::guided;
  const Colour asked = session.state(session.rod()) == RodState::refused ? kBad : kBright;
  float at = paragraph(pen, request_text(session), 26.0f, 110.0f, asked, Face::bold);
  const std::string advice = advice_text(session);
  if (!advice.empty()) at = paragraph(pen, advice, 20.0f, at + 4.0f, kSpin);
  at = std::max(at + 16.0f, 250.0f);
  if (guided) {
    const bool rests = session.guide().resting() > 0.0;
    draw_bar(pen, at, rests ? session.guide().resting() : session.guide().progress(),
             rests ? kGood : kSlide);
    const std::string step = std::to_string(session.guide().step() + 1) + " / " +
                             std::to_string(cabinet::CalibrationGuide::steps());
    pen.text(step, {Face::regular, 16.0f, 0.0f, Align::centre}, {0.0f, at + 34.0f}, kDim);
    at += 48.0f;
  }
  if (const auto& fit = session.fit(); fit && !guided) {
    draw_residuals(pen, *fit, at, at + 130.0f);
    at += 152.0f;
    const std::vector<std::string> lines = fit_text(*fit);
    for (const std::string& line : lines) {
      pen.text(line, {Face::regular, 15.0f, 0.0f, Align::left}, {-kWide + 10.0f, at}, kDim);
      at += 20.0f;
    }
  } else {
    draw_trace(pen, session, at, 600.0f);
  }
  const client::TextStyle small{Face::regular, 14.0f, 0.0f, Align::centre};
  if (!state.problem.empty())
    pen.text(state.problem, small, {0.0f, 632.0f}, kBad);
  else
    pen.text(state.device + "   \u2192   " + state.path, small, {0.0f, 632.0f}, kDim);
  pen.text(
      tr(N_("Enter: mark or continue   Backspace: previous step   Tab: another rod   Esc: leave")),
      small, {0.0f, 660.0f}, kDim);
  ui.flush(screen);
}

}  // namespace calibrate
