// space-foosball-visibility: measures how well the ball is visible in a recorded match, in every
// view for play.
//
//   space-foosball-visibility RECORDING
//
// Each 50 ms it draws the picture with everything between eye and ball, and counts the ball's
// pixels (Scene::ball_visibility). A ball of which less than half is visible is hidden; it may be
// hidden for kLongestHidden at a time. Exit codes: 0 it never is for longer, 1 it is, 2 a bad
// recording, 4 no display.
#include <algorithm>
#include <array>
#include <cstdio>

#include "app/view_motion.h"
#include "draw/window.h"
#include "render/scene.h"
#include "server/recorded_scene.h"

namespace {

constexpr double kLongestHidden = 0.3;    // [s]
constexpr std::uint64_t kStepTicks = 50;  // 1 ms each
constexpr glm::ivec2 kPicture{480, 270};

struct WatchedView {
  const char* name;
  int team;
  client::View view;
  client::ViewMotion motion;
  double hidden = 0.0, longest = 0.0, min = 1.0, sum = 0.0;  // [s], [s], fraction, fractions
  int looks = 0, times_hidden = 0;
};

void look(WatchedView& watched, client::Scene& scene, const wire::Snapshot& state) {
  const double step = 1e-3 * kStepTicks;
  watched.motion.step(&state, watched.team, static_cast<float>(step));
  if (!state.ball_in_play) {
    watched.hidden = 0.0;
    return;
  }
  client::SceneView view;
  view.camera = watched.motion.camera(watched.view, kPicture);
  const double seen = scene.ball_visibility(state, view, kPicture);
  ++watched.looks;
  watched.sum += seen;
  watched.min = std::min(watched.min, seen);
  watched.times_hidden += seen < 0.5;
  watched.hidden = seen < 0.5 ? watched.hidden + step : 0.0;
  watched.longest = std::max(watched.longest, watched.hidden);
}

int run(const char* recording) {
  auto match = server::RecordedScene::open(recording);
  if (!match) {
    std::fprintf(stderr, "space-foosball-visibility: %s\n", match.error().c_str());
    return 2;
  }
  auto window =
      draw::Window::open({.size = kPicture, .otherwise = "use a display", .visible = false});
  if (!window) {
    std::fprintf(stderr, "space-foosball-visibility: %s\n", window.error().sentence.c_str());
    return 4;
  }
  auto scene = client::Scene::create(draw::Quality::low);
  if (!scene) {
    std::fprintf(stderr, "space-foosball-visibility: %s\n", scene.error().c_str());
    return 4;
  }
  std::array<WatchedView, 6> views{{{"seat, team 0", 0, client::View::seat, {}},
                                    {"seat, team 1", 1, client::View::seat, {}},
                                    {"above, team 0", 0, client::View::above, {}},
                                    {"above, team 1", 1, client::View::above, {}},
                                    {"follow, team 0", 0, client::View::follow, {}},
                                    {"follow, team 1", 1, client::View::follow, {}}}};
  for (std::uint64_t tick = kStepTicks; match->advance_to(tick); tick += kStepTicks) {
    for (WatchedView& watched : views) look(watched, **scene, match->snapshot());
    match->take_events();
  }
  std::printf("view            looks  seen, mean  least  hidden  longest [s], goal %.1f\n",
              kLongestHidden);
  bool good = true;
  for (const WatchedView& v : views) {
    const double looks = std::max(v.looks, 1);
    std::printf("%-14s %6d %9.1f %% %4.0f %% %5.2f %%  %.2f\n", v.name, v.looks,
                100.0 * v.sum / looks, 100.0 * v.min, 100.0 * v.times_hidden / looks, v.longest);
    good = good && v.looks > 0 && v.longest <= kLongestHidden;
  }
  return good ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2 || argv[1][0] == '-') {
    std::printf(
        "space-foosball-visibility RECORDING: how well the ball is seen in a recorded match\n");
    return argc == 2 ? 0 : 2;
  }
  return run(argv[1]);
}
