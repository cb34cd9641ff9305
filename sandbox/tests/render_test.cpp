// Opens the real window, draws scenes and examines the pixels. Needs a display.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <memory>
#include <set>
#include <string>
#include <tuple>

#include "clocks.h"
#include "draw/image.h"
#include "draw/window.h"
#include "view/palette.h"
#include "view/scene_view.h"

namespace sandbox {
namespace {

constexpr glm::ivec2 kSize{640, 360};

Simulation opened(const std::string& scene) {
  return Simulation::open(scene, 1000, kStopped).value();
}
void run(Simulation& simulation, int steps) {
  for (int i = 0; i < steps; ++i) ASSERT_TRUE(simulation.step());
}

class SandboxRender : public ::testing::TestWithParam<draw::Quality> {
 protected:
  static void SetUpTestSuite() {
    draw::WindowOptions options;
    options.size = kSize;
    auto opened = draw::Window::open(options);
    ASSERT_TRUE(opened) << opened.error().sentence;
    window = std::make_unique<draw::Window>(std::move(*opened));
  }
  static void TearDownTestSuite() { window.reset(); }

  void SetUp() override {
    auto made = SceneView::create(GetParam());
    ASSERT_TRUE(made) << made.error();
    view = std::move(*made);
  }

  void look_at_all(const Simulation& simulation) {
    vp::Vec3 low, high;
    simulation.bounds(low, high);
    camera.fit(low, high, kSize);
  }
  draw::Image drawn(const Simulation& simulation, const ViewOptions& options = {}) {
    view->draw(simulation, camera, options, kSize);
    const draw::Image image = draw::read_pixels(kSize);
    // For a person to examine after a failure.
    if (const char* directory = std::getenv("SANDBOX_TEST_PICTURES")) {
      static int count = 0;
      (void)draw::write_png(image, std::string(directory) + "/" + std::to_string(count++) + ".png");
    }
    return image;
  }
  glm::ivec2 pixel_of(const vp::Vec3& p) const {
    const vp::Vec3 q = p - camera.target();
    const glm::vec4 clip =
        camera.projection(kSize) * camera.view() *
        glm::vec4(static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z), 1.0f);
    return {static_cast<int>((0.5f + 0.5f * clip.x / clip.w) * static_cast<float>(kSize.x)),
            static_cast<int>((0.5f - 0.5f * clip.y / clip.w) * static_cast<float>(kSize.y))};
  }
  // Number of pixels around the centre that differ clearly between two pictures.
  static int changed(const draw::Image& a, const draw::Image& b, glm::ivec2 centre, int radius) {
    int count = 0;
    const glm::ivec2 low = glm::max(centre - radius, 0), high = glm::min(centre + radius, kSize);
    for (int y = low.y; y < high.y; ++y) {
      for (int x = low.x; x < high.x; ++x) {
        const glm::ivec3 d = glm::abs(a.at(x, y) - b.at(x, y));
        count += d.r + d.g + d.b > 40 ? 1 : 0;
      }
    }
    return count;
  }
  static int changed(const draw::Image& a, const draw::Image& b) {
    return changed(a, b, kSize / 2, kSize.x);
  }
  // Number of coloured pixels: more than 40 between their smallest and their largest channel.
  static int coloured(const draw::Image& image) {
    int count = 0;
    for (int y = 0; y < kSize.y; ++y) {
      for (int x = 0; x < kSize.x; ++x) {
        const glm::ivec3 c = image.at(x, y);
        count += std::max({c.r, c.g, c.b}) - std::min({c.r, c.g, c.b}) > 40 ? 1 : 0;
      }
    }
    return count;
  }

  static std::unique_ptr<draw::Window> window;
  std::unique_ptr<SceneView> view;
  OrbitCamera camera;
};
std::unique_ptr<draw::Window> SandboxRender::window;

TEST_P(SandboxRender, EveryKindOfSceneIsNotBlank) {
  for (const char* name : {"towers1120", "pile1120", "ragdolls", "bridge", "cards", "conveyor",
                           "convex_pile", "junkyard"}) {
    Simulation simulation = opened(name);
    look_at_all(simulation);
    const draw::Image image = drawn(simulation);
    std::set<std::tuple<int, int, int>> colours;
    for (int y = 0; y < kSize.y; y += 3) {
      for (int x = 0; x < kSize.x; x += 3) {
        const glm::ivec3 c = image.at(x, y);
        colours.insert({c.r / 16, c.g / 16, c.b / 16});
      }
    }
    EXPECT_GT(colours.size(), 12u) << name;
    EXPECT_GT(coloured(image), 300) << name;
    EXPECT_LE(view->draw_calls(), 12) << name << ": a call for each kind of shape, not each body";
  }
}

TEST_P(SandboxRender, BodiesAreWhereTheyAreAndMoveInThePicture) {
  Simulation simulation = opened("bounce");
  look_at_all(simulation);
  const draw::Image before = drawn(simulation);
  std::vector<glm::ivec2> were;
  for (const Piece& piece : simulation.pieces())
    were.push_back(pixel_of(simulation.world().pose(piece.body).position()));
  run(simulation, 300);
  const draw::Image after = drawn(simulation);
  for (std::size_t i = 0; i < were.size(); ++i) {
    if (simulation.pieces()[i].motion != scenes::Motion::dynamic) continue;
    EXPECT_GT(changed(before, after, were[i], 4), 10) << "body " << i << " has left its place";
    const glm::ivec2 at = pixel_of(simulation.world().pose(simulation.pieces()[i].body).position());
    EXPECT_GT(changed(before, after, at, 4), 10) << "body " << i << " has come to its place";
  }
}

TEST_P(SandboxRender, MarksAreOnWhatTheyMark) {
  Simulation simulation = opened("tower10");
  run(simulation, 200);
  look_at_all(simulation);
  const draw::Image plain = drawn(simulation);
  ViewOptions options;
  options.marks.contacts = true;
  const draw::Image contacts = drawn(simulation, options);
  // The corners of the sixth box's base, on the sides that face the eye.
  const vp::Vec3 box = simulation.world().pose(simulation.pieces()[6].body).position();
  const vp::Vec3 side = camera.forward();
  const vp::Vec3 corner = box + vp::Vec3{side.x > 0 ? -0.5 : 0.5, side.y > 0 ? -0.5 : 0.5, -0.5};
  const glm::ivec2 at = pixel_of(corner);
  EXPECT_GT(changed(plain, contacts, at, 4), 5);
  int yellow = 0;
  for (int y = at.y - 4; y < at.y + 4; ++y) {
    for (int x = at.x - 4; x < at.x + 4; ++x) {
      const glm::ivec3 c = contacts.at(x, y);
      yellow += c.r > 180 && c.g > 140 && c.b < 110 ? 1 : 0;
    }
  }
  EXPECT_GE(yellow, 3);
  for (bool vp::DebugDrawOptions::*mark :
       {&vp::DebugDrawOptions::impulses, &vp::DebugDrawOptions::frames,
        &vp::DebugDrawOptions::centres, &vp::DebugDrawOptions::shapes}) {
    ViewOptions one;
    one.marks.*mark = true;
    EXPECT_GT(changed(plain, drawn(simulation, one)), 60);
  }
  ViewOptions bounds;
  bounds.marks.bounds = true;
  EXPECT_GT(changed(plain, drawn(simulation, bounds)), 30);
}

TEST_P(SandboxRender, WhatIsHeldIsAnotherColourAndTiedToTheHand) {
  Simulation simulation = opened("tower10");
  look_at_all(simulation);
  const draw::Image plain = drawn(simulation);
  const vp::Vec3 box = simulation.world().pose(simulation.pieces()[5].body).position();
  const glm::ivec2 at = pixel_of(box);
  ASSERT_TRUE(simulation.grab(camera.ray(at, kSize)));
  ASSERT_EQ(simulation.grip()->body, simulation.pieces()[5].body);
  const glm::ivec2 hand{at.x + 120, at.y - 20};
  simulation.drag(camera.ray(hand, kSize), camera.forward());
  const draw::Image held = drawn(simulation);
  EXPECT_GT(changed(plain, held, at, 6), 40);
  EXPECT_GT(changed(plain, held, hand, 6), 8);
  EXPECT_GT(changed(plain, held, (at + hand) / 2, 4), 3);
}

TEST_P(SandboxRender, AWallBetweenTheEyeAndTheBodiesIsSeenThrough) {
  Simulation simulation = opened("pile1120");
  run(simulation, 50);
  for (const double yaw : {-1.1, 0.4, 2.0, 3.6}) {
    camera.look_from(yaw, 0.15);  // level: not over a wall
    look_at_all(simulation);
    EXPECT_GT(coloured(drawn(simulation)), kSize.x * kSize.y / 30) << yaw;
  }
}

TEST_P(SandboxRender, SpeedsColourWhatMoves) {
  Simulation simulation = opened("tower10");
  look_at_all(simulation);
  const glm::ivec2 top =
      pixel_of(simulation.world().pose(simulation.pieces().back().body).position());
  ViewOptions options;
  options.colouring = Colouring::speed;
  const glm::ivec3 still = drawn(simulation, options).at(top.x, top.y);
  EXPECT_GT(still.b, still.r);
}

INSTANTIATE_TEST_SUITE_P(BothQualities, SandboxRender,
                         ::testing::Values(draw::Quality::low, draw::Quality::high),
                         [](const auto& which) {
                           return which.param == draw::Quality::low ? "low" : "high";
                         });

}  // namespace
}  // namespace sandbox
