// Draws several moments of the calibration in a real window: no text is cut.
#include <GLES3/gl3.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "draw/image.h"
#include "draw/window.h"
#include "render/translate.h"
#include "session.h"
#include "simulated_device.h"
#include "simulated_person.h"
#include "view.h"

namespace calibrate {
namespace {

using namespace cabinet_test;

// Each step of one rod's calibration, with the counts so far, then its fit.
class Moments {
 public:
  explicit Moments(std::function<void(const Session&)> look) : look_(std::move(look)) {
    look_(session_);
    const auto& spec = foosball::table_spec(foosball::Layout::tournament).rods[0];
    const cabinet::GuideOptions options{.reach = spec.slide_limit,
                                        .push_side = foosball::push_sign(spec.team),
                                        .forward_sign = -foosball::attack_sign(spec.team)};
    cabinet::CalibrationGuide guide(options);
    Mount mount{.counts_per_mm = 39.4, .tilt = 0.05, .eccentricity = 1e-4};
    mount.mark = {.angle = 0.6, .width = 0.4, .slide = -options.push_side * options.reach};
    SimulatedRod rod(mount, 5);
    Person person(guide, rod, options);
    SimulatedDevice device;
    session_.line_is(cabinet::DeviceState::live, 0);
    session_.update(device.frame(5'000));
    int step = -1;
    person.on_counts = [&](const cabinet::CountIncrement& c) {
      device.slide[0] += c.slide;
      device.spin[0] += c.spin;
      wire::DeviceFrame frame = device.frame(5'000);
      frame.index = c.mark ? 1 : 0;
      session_.update(frame);
      const bool half_way = guide.step() != step && !guide.finished() && guide.progress() > 0.5;
      if (!half_way) return;
      step = guide.step();
      look_(session_);
    };
    person.on_start = [&] { session_.confirm(); };
    person.follow();
    look_(session_);
    session_.back();
    for (int i = 0; i < 40; ++i) {
      device.slide[6] += 7;
      session_.update(device.frame(5'000));
    }
    look_(session_);  // another rod moves
  }

 private:
  std::function<void(const Session&)> look_;
  Session session_{SessionOptions{}};
};

TEST(CalibrationView, NothingWrittenIsCutInAnyWindowAndLanguage) {
  draw::WindowOptions wanted;
  wanted.size = {1280, 720};
  auto window = draw::Window::open(wanted);
  ASSERT_TRUE(window) << window.error().sentence;
  const char* pictures = std::getenv("CLIENT_TEST_PICTURES");
  int count = 0;
  for (const char* language : {"en", "de", "ko"}) {
    client::use_language(language, CLIENT_CATALOGUES);
    auto font = client::Font::load({}, client::catalogue_file());
    ASSERT_TRUE(font) << font.error();
    auto ui = client::UiBatch::create(std::move(*font));
    ASSERT_TRUE(ui) << ui.error();
    for (const glm::ivec2 size :
         {glm::ivec2(1280, 720), glm::ivec2(480, 640), glm::ivec2(640, 360)}) {
      ViewState state{
          .device = "hid:/dev/hidraw0",
          .path = "/home/somebody/.local/share/space-foosball/calibrations/SF-0042.json"};
      const Moments moments([&](const Session& session) {
        glViewport(0, 0, size.x, size.y);
        glClearColor(0.03f, 0.05f, 0.09f, 1.0f);
        glClear(GL_COLOR_BUFFER_BIT);
        draw_session(*ui, session, state, size);
        const client::UiBatch::Bounds& b = ui->bounds();
        EXPECT_GE(b.low.x, -1.0f) << language << size.x;
        EXPECT_GE(b.low.y, -1.0f) << language << size.x;
        EXPECT_LE(b.high.x, static_cast<float>(size.x) + 1.0f) << language << size.x;
        EXPECT_LE(b.high.y, static_cast<float>(size.y) + 1.0f) << language << size.x;
        if (pictures != nullptr)
          (void)draw::write_png(draw::read_pixels(size), std::string(pictures) + "/calibrate-" +
                                                             std::to_string(count++) + ".png");
      });
    }
  }
  EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
}

}  // namespace
}  // namespace calibrate
