// Keys and the panel, with Dear ImGui but no window.
#include "app/panel.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <gtest/gtest.h>
#include <imgui.h>

#include "clocks.h"

namespace sandbox {
namespace {

class SandboxPanel : public ::testing::Test {
 protected:
  void SetUp() override {
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;
    io.DisplaySize = {1280, 720};
    const auto styled = style_panel("");
    ASSERT_TRUE(styled) << styled.error();
    unsigned char* pixels = nullptr;
    int width = 0, height = 0;
    io.Fonts->GetTexDataAsAlpha8(&pixels, &width, &height);
  }
  void TearDown() override { ImGui::DestroyContext(); }

  // The requests of a frame in which these keys are newly pressed.
  Requests frame(std::initializer_list<int> keys) {
    ImGuiIO& io = ImGui::GetIO();
    for (const bool down : {false, true}) {
      for (const int key : keys) io.KeysDown[key] = down;
      io.DeltaTime = 0.01f;
      ImGui::NewFrame();
      requests = {};
      read_keys(simulation, controls, requests);
      draw_panel(simulation, meter, 0.003, "", controls, requests);
      ImGui::Render();
    }
    return requests;
  }

  Simulation simulation = Simulation::open("tower10", 1000, kStopped).value();
  Meter meter;
  Controls controls;
  Requests requests;
};

TEST_F(SandboxPanel, SpacePausesAndGoesOn) {
  frame({GLFW_KEY_SPACE});
  EXPECT_TRUE(controls.paused);
  frame({});
  EXPECT_TRUE(controls.paused);
  frame({GLFW_KEY_SPACE});
  EXPECT_FALSE(controls.paused);
}

TEST_F(SandboxPanel, EachKeyRequestsItsOwn) {
  EXPECT_TRUE(frame({GLFW_KEY_S}).step);
  EXPECT_TRUE(frame({GLFW_KEY_R}).reset);
  EXPECT_TRUE(frame({GLFW_KEY_T}).throw_one);
  EXPECT_TRUE(frame({GLFW_KEY_HOME}).show_all);
  EXPECT_TRUE(frame({GLFW_KEY_ESCAPE}).leave);
  EXPECT_EQ(frame({GLFW_KEY_N}).scene, "pyramid10");
  EXPECT_EQ(frame({GLFW_KEY_B}).scene, "bridge");
  const Requests none = frame({});
  EXPECT_FALSE(none.step || none.reset || none.throw_one || none.show_all || none.leave);
  EXPECT_FALSE(none.scene);
}

TEST_F(SandboxPanel, RatesAndSpeedsAreWithinTheirBounds) {
  frame({GLFW_KEY_1});
  EXPECT_EQ(controls.rate, 60);
  frame({GLFW_KEY_2});
  EXPECT_EQ(controls.rate, 240);
  frame({GLFW_KEY_3});
  EXPECT_EQ(controls.rate, 1000);
  for (int i = 0; i < 20; ++i) frame({GLFW_KEY_MINUS});
  EXPECT_EQ(controls.speed, 0.01);
  for (int i = 0; i < 40; ++i) frame({GLFW_KEY_EQUAL});
  EXPECT_EQ(controls.speed, 10.0);
}

TEST_F(SandboxPanel, MarksAreSwitchedOnAndOffAgain) {
  vp::DebugDrawOptions& marks = controls.view.marks;
  const std::pair<int, bool*> switches[] = {
      {GLFW_KEY_C, &marks.contacts}, {GLFW_KEY_I, &marks.impulses}, {GLFW_KEY_F, &marks.frames},
      {GLFW_KEY_M, &marks.centres},  {GLFW_KEY_J, &marks.joints},   {GLFW_KEY_X, &marks.bounds},
      {GLFW_KEY_W, &marks.shapes}};
  for (const auto& [key, on] : switches) {
    EXPECT_FALSE(*on);
    frame({key});
    EXPECT_TRUE(*on);
    frame({key});
    EXPECT_FALSE(*on);
  }
  frame({GLFW_KEY_V});
  EXPECT_EQ(controls.view.colouring, Colouring::speed);
}

TEST_F(SandboxPanel, IsHiddenByTab) {
  frame({});
  EXPECT_GT(ImGui::GetDrawData()->TotalVtxCount, 500);
  frame({GLFW_KEY_TAB});
  frame({});
  EXPECT_EQ(ImGui::GetDrawData()->TotalVtxCount, 0);
}

}  // namespace
}  // namespace sandbox
