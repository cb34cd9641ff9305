// The present state of a controller: below its row of the menu.
#include <algorithm>
#include <cstdio>

#include "client/devices_menu.h"
#include "render/hud.h"
#include "render/hud_screens.h"
#include "render/translate.h"
#include "wire/enums.h"

namespace client {
namespace {

constexpr float kHalf = 308.0f, kRow = 25.0f, kHead = 62.0f;  // in units
const Colour kSlideInk{0.30f, 0.80f, 0.95f, 1.0f}, kSpinInk{0.98f, 0.72f, 0.30f, 1.0f},
    kTrack{0.10f, 0.14f, 0.20f, 0.9f};
// The columns' right edges.
constexpr float kSlideCounts = -152.0f, kSpinCounts = -62.0f, kSlide = 10.0f, kAngle = 66.0f,
                kTrace = 78.0f;

std::string fixed(double value, int digits) {
  char text[48];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

std::string line(const char* words, const std::string& value) {
  std::string text = tr(words);
  if (const auto at = text.find("%1"); at != std::string::npos) text.replace(at, 2, value);
  return text;
}

bool shown(const wire::DeviceRod& rod) {
  return rod.status != number(wire::RodStatus::absent);
}

// The last seconds of a count, scaled to its range.
void draw_trace(const HudPen& pen, const std::deque<DeviceView::Point>& trace,
                double DeviceView::Point::*value, const glm::vec2& low, const glm::vec2& high,
                const Colour& ink) {
  if (trace.size() < 2) return;
  constexpr double kMinRange = 40.0;  // [counts]
  const auto [min, max] = std::ranges::minmax(trace, {}, value);
  const double middle = 0.5 * (min.*value + max.*value);
  const double range = std::max(max.*value - min.*value, kMinRange);
  const double end = trace.back().seconds;
  const auto place = [&](const DeviceView::Point& p) {
    const double x = 1.0 - (end - p.seconds) / DeviceView::kTraceSeconds;
    const double y = 0.5 - (p.*value - middle) / range;
    return low + (high - low) * glm::vec2(static_cast<float>(x), static_cast<float>(y));
  };
  glm::vec2 before = place(trace.front());
  for (const DeviceView::Point& point : trace) {
    const glm::vec2 here = place(point);
    pen.panel({before.x - 0.7f, std::min(before.y, here.y) - 0.7f},
              {here.x + 0.7f, std::max(before.y, here.y) + 0.7f}, 0.7f, ink);
    before = here;
  }
}

void draw_rod(const HudPen& pen, const DeviceView& view, std::size_t rod, float y) {
  const wire::DeviceRod& now = view.now.rods[rod];
  const bool live = now.status == number(wire::RodStatus::live);
  const Colour& ink = live ? kInk : kFaint;
  const TextStyle right{Face::regular, 13.5f, 0.0f, Align::right};
  pen.text(line(N_("Rod %1"), std::to_string(rod + 1)), {Face::bold, 13.5f, 0.0f, Align::left},
           {-kHalf, y}, live ? kInk : kWarning, 0.55f, 84.0f);
  pen.text(std::to_string(now.slide_counts), right, {kSlideCounts, y}, ink, 0.55f, 72.0f);
  pen.text(std::to_string(now.spin_counts), right, {kSpinCounts, y}, ink, 0.55f, 72.0f);
  pen.text(fixed(1e3 * static_cast<double>(now.slide), 1) + " mm", right, {kSlide, y}, ink, 0.55f,
           64.0f);
  pen.text(fixed(57.29578 * static_cast<double>(now.angle), 0) + "\u00B0", right, {kAngle, y}, ink,
           0.55f, 64.0f);
  const glm::vec2 low(kTrace, y - 17.0f), high(kHalf, y + 5.0f);
  pen.panel(low, high, 4.0f, kTrack);
  const glm::vec2 inset(4.0f, 3.0f);
  draw_trace(pen, view.traces[rod], &DeviceView::Point::slide, low + inset, high - inset,
             kSlideInk);
  draw_trace(pen, view.traces[rod], &DeviceView::Point::spin, low + inset, high - inset, kSpinInk);
}

// Rates, and errors since the server's start.
std::array<std::string, 2> totals(const DeviceView& view) {
  const wire::DeviceReport& now = view.now;
  std::string rates = line(N_("%1 frames a second"), fixed(view.frames_per_second, 0));
  if (view.latency_ms >= 0.0) {
    rates += " \u00B7 " + line(N_("%1 ms old when the tick uses them"), fixed(view.latency_ms, 2));
    rates += " \u00B7 " +
             line(N_("at most %1 ms"), fixed(1e-3 * static_cast<double>(now.latency_max_us), 1));
  }
  std::string faults;
  const auto add = [&](const char* words, std::uint64_t count) {
    if (count == 0) return;
    if (!faults.empty()) faults += " \u00B7 ";
    faults += line(words, std::to_string(count));
  };
  add(N_("%1 lost"), now.lost);
  add(N_("%1 bad"), now.bad);
  add(N_("%1 stale"), now.stale);
  add(N_("%1 errors between sensor and controller"), now.line_errors);
  add(N_("%1 times too fast for a sensor"), now.overflows);
  add(N_("%1 impossible motions"), now.impossible);
  add(N_("%1 times plugged in again"), now.reopened);
  if (faults.empty()) faults = tr(N_("nothing lost, no errors"));
  return {rates, faults};
}

}  // namespace

float device_height(const DeviceView& view) {
  return kHead + kRow * static_cast<float>(std::ranges::count_if(view.now.rods, shown));
}

void draw_device(const HudPen& pen, const DeviceView& view, float top) {
  const TextStyle small{Face::regular, 13.0f, 0.0f, Align::left};
  const auto [rates, faults] = totals(view);
  pen.text(rates, small, {-kHalf, top + 14.0f}, kInk, 0.55f, 2.0f * kHalf);
  const bool well = view.now.lost + view.now.bad + view.now.line_errors + view.now.overflows +
                        view.now.impossible ==
                    0;
  pen.text(faults, small, {-kHalf, top + 31.0f}, well ? kFaint : kWarning, 0.55f, 2.0f * kHalf);
  float y = top + kHead - 10.0f;
  const TextStyle head{Face::bold, 11.5f, 0.0f, Align::right};
  if (std::ranges::any_of(view.now.rods, shown)) {
    pen.text(tr(N_("counts along")), head, {kSlideCounts, y}, kSlideInk, 0.55f, 84.0f);
    pen.text(tr(N_("counts around")), head, {kSpinCounts, y}, kSpinInk, 0.55f, 86.0f);
    pen.text(tr(N_("slide")), head, {kSlide, y}, kFaint, 0.55f, 60.0f);
    pen.text(tr(N_("angle")), head, {kAngle, y}, kFaint, 0.55f, 60.0f);
    pen.text(tr(N_("last ten seconds")), {Face::bold, 11.5f, 0.0f, Align::left}, {kTrace, y},
             kFaint, 0.55f, kHalf - kTrace);
  }
  for (std::size_t rod = 0; rod < view.now.rods.size(); ++rod) {
    if (!shown(view.now.rods[rod])) continue;
    y += kRow;
    draw_rod(pen, view, rod, y - 3.0f);
  }
}

}  // namespace client
