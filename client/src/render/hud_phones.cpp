// The QR code with which phones join.
#include <cmath>

#include "render/hud.h"
#include "render/hud_screens.h"
#include "render/translate.h"

namespace client {

void draw_phone_code(const HudPen& pen, const HudState& hud, const glm::ivec2& screen) {
  constexpr float kSide = 176.0f, kFromRight = 22.0f, kTop = 250.0f;  // units: below the title
  constexpr float kMenuHalf = 340.0f;
  constexpr int kQuiet = 4;  // width of the quiet zone in modules, as the standard requires
  if (hud.phones == nullptr || hud.phones->size == 0) return;
  const QrCode& code = *hud.phones;
  const int modules = code.size + 2 * kQuiet;
  // Integer pixels: a camera needs sharp edges.
  const float module = std::floor(kSide * pen.scale / static_cast<float>(modules));
  const bool beside_menu = hud.menu.rows.empty() || pen.half_width - kSide - kFromRight > kMenuHalf;
  if (module < 2.0f || !beside_menu) return;
  const float side = module * static_cast<float>(modules);
  const glm::vec2 low = glm::floor(
      glm::vec2(static_cast<float>(screen.x) - kFromRight * pen.scale - side, kTop * pen.scale));
  const auto box = [&](const glm::vec2& from, const glm::vec2& to, const Colour& colour) {
    pen.panel(pen.from_pixels(low + from), pen.from_pixels(low + to), 0.0f, colour);
  };
  box(glm::vec2(0.0f), glm::vec2(side), {1.0f, 1.0f, 1.0f, 1.0f});
  for (int y = 0; y < code.size; ++y) {
    for (int x = 0; x < code.size; ++x) {
      if (!code(x, y)) continue;
      const int from = x;
      while (x + 1 < code.size && code(x + 1, y)) ++x;
      const glm::vec2 at(static_cast<float>(kQuiet + from), static_cast<float>(kQuiet + y));
      const glm::vec2 to(static_cast<float>(kQuiet + x + 1), static_cast<float>(kQuiet + y + 1));
      box(module * at, module * to, {0.0f, 0.0f, 0.0f, 1.0f});
    }
  }
  const glm::vec2 under = pen.from_pixels(low + glm::vec2(0.5f * side, side));
  pen.text(tr("Play with a phone: scan this"), {Face::bold, 15.0f, 0.0f, Align::centre},
           under + glm::vec2(0.0f, 20.0f), kInk, 0.8f, side / pen.scale + 30.0f);
}

}  // namespace client
