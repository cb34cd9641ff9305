// The real window with a scene and the HUD, for tests that examine the pixels. Needs a display.
#pragma once

#include <GLES3/gl3.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>

#include "app/window.h"
#include "draw/image.h"
#include "render/hud.h"
#include "render/scene.h"
#include "scripted_scene.h"

namespace client {

inline constexpr glm::ivec2 kSize{960, 540};

// Shared by all tests, and opened once for all suites: a display server restarts when its last
// window closes, and rejects connections for a moment.
class Display : public ::testing::Environment {
 public:
  void SetUp() override {
    draw::WindowOptions options;
    options.size = kSize;
    auto opened = Window::open(options);
    ASSERT_TRUE(opened) << opened.error().sentence;
    window = std::make_unique<Window>(std::move(*opened));
  }
  void TearDown() override {
    scenes = {};
    ui.reset();
    window.reset();
  }

  static inline std::unique_ptr<Window> window;
  static inline std::array<std::unique_ptr<Scene>, 2> scenes;  // by quality
  static inline std::unique_ptr<UiBatch> ui;
};
inline ::testing::Environment* const display = ::testing::AddGlobalTestEnvironment(new Display);

class RenderTest : public ::testing::TestWithParam<draw::Quality> {
 protected:
  // Created once for all tests of a quality: setup takes longer than drawing.
  void SetUp() override {
    ASSERT_TRUE(Display::window);
    std::unique_ptr<Scene>& shared = Display::scenes[static_cast<std::size_t>(GetParam())];
    if (!shared) {
      auto made = Scene::create(GetParam());
      ASSERT_TRUE(made) << made.error();
      shared = std::move(*made);
    }
    scene = shared.get();
    if (!ui) {
      auto font = Font::load();
      ASSERT_TRUE(font) << font.error();
      auto batch = UiBatch::create(std::move(*font));
      ASSERT_TRUE(batch) << batch.error();
      ui = std::make_unique<UiBatch>(std::move(*batch));
    }
    camera = player_camera({}, kSize);
  }

  draw::Image draw(const wire::Snapshot& state, std::optional<HudState> hud = {}) {
    SceneView view;
    view.camera = camera;
    Particles none;
    scene->draw(state, view, none, kSize);
    if (hud) {
      hud->state = &state;
      hud->camera = camera;
      draw_hud(*ui, *hud, kSize);
    }
    const draw::Image image = draw::read_pixels(kSize);
    // For a person to examine after a failure.
    if (const char* directory = std::getenv("CLIENT_TEST_PICTURES")) {
      static int count = 0;
      (void)draw::write_png(image,
                            std::string(directory) + "/render-" + std::to_string(count++) + ".png");
    }
    Display::window->swap();
    return image;
  }

  // The HUD alone, over a uniform grey.
  draw::Image written(const wire::Snapshot& state, const HudState& hud) {
    return written(*ui, state, hud, kSize);
  }
  // In a part of the window that is as large as another window.
  draw::Image written(UiBatch& words, const wire::Snapshot& state, HudState hud,
                      const glm::ivec2& size) {
    hud.state = &state;
    hud.camera = camera;
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glViewport(0, 0, size.x, size.y);
    glClearColor(0.5f, 0.5f, 0.5f, 1.0f);
    glClear(GL_COLOR_BUFFER_BIT);
    draw_hud(words, hud, size);
    return draw::read_pixels(size);
  }

  glm::ivec2 pixel_of(const std::array<float, 3>& p) const {
    const glm::vec3 at = camera.project({p[0], p[1], p[2]}, kSize);
    return {static_cast<int>(at.x), static_cast<int>(at.y)};
  }

  static glm::vec3 mean(const draw::Image& image, glm::ivec2 low, glm::ivec2 high) {
    glm::vec3 sum(0.0f);
    for (int y = low.y; y < high.y; ++y) {
      for (int x = low.x; x < high.x; ++x) sum += glm::vec3(image.at(x, y));
    }
    return sum / static_cast<float>((high.x - low.x) * (high.y - low.y));
  }

  // Number of pixels around the centre that differ clearly between two pictures.
  static int changed(const draw::Image& a, const draw::Image& b, glm::ivec2 centre, int radius) {
    int count = 0;
    for (int y = std::max(0, centre.y - radius); y < std::min(kSize.y, centre.y + radius); ++y) {
      for (int x = std::max(0, centre.x - radius); x < std::min(kSize.x, centre.x + radius); ++x) {
        const glm::ivec3 d = glm::abs(a.at(x, y) - b.at(x, y));
        count += d.r + d.g + d.b > 60;
      }
    }
    return count;
  }

  static inline std::unique_ptr<UiBatch>& ui = Display::ui;
  Scene* scene = nullptr;
  Camera camera;
};

}  // namespace client
