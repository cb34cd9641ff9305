#include "viewer.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <GLES3/gl3.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <memory>

#include "draw/image.h"
#include "draw/window.h"
#include "film.h"
#include "library.h"
#include "os/clock.h"
#include "render/hud.h"
#include "render/hud_replay.h"
#include "render/translate.h"
#include "server/exit_code.h"
#include "timeline.h"

namespace watch {
namespace {

constexpr int kNoDisplay = 4;
constexpr std::array<double, 7> kSpeeds{0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0};
constexpr int kNormal = 3;                 // of kSpeeds
constexpr std::uint64_t kFrameTicks = 16;  // of one step: a picture of 60 a second
constexpr double kMessageSeconds = 8.0;
constexpr double kLookAgainSeconds = 2.0;  // at a file that may grow
constexpr std::array<const char*, client::kViews> kViewNames{"seat", "from above (cabinet)",
                                                             "follow the ball", "spectator"};

struct Key {
  int key, mods;
};

// What a gamepad's buttons mean here.
constexpr std::array<std::array<int, 2>, 12> kPadKeys{
    {{GLFW_GAMEPAD_BUTTON_A, GLFW_KEY_SPACE},
     {GLFW_GAMEPAD_BUTTON_B, GLFW_KEY_ESCAPE},
     {GLFW_GAMEPAD_BUTTON_X, GLFW_KEY_S},
     {GLFW_GAMEPAD_BUTTON_Y, GLFW_KEY_C},
     {GLFW_GAMEPAD_BUTTON_LEFT_BUMPER, GLFW_KEY_B},
     {GLFW_GAMEPAD_BUTTON_RIGHT_BUMPER, GLFW_KEY_N},
     {GLFW_GAMEPAD_BUTTON_DPAD_LEFT, GLFW_KEY_LEFT},
     {GLFW_GAMEPAD_BUTTON_DPAD_RIGHT, GLFW_KEY_RIGHT},
     {GLFW_GAMEPAD_BUTTON_DPAD_UP, GLFW_KEY_UP},
     {GLFW_GAMEPAD_BUTTON_DPAD_DOWN, GLFW_KEY_DOWN},
     {GLFW_GAMEPAD_BUTTON_BACK, GLFW_KEY_F1},
     {GLFW_GAMEPAD_BUTTON_START, GLFW_KEY_ENTER}}};

std::string catalogue_directory() {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  return (program.parent_path().parent_path() / "share" / "locale").string();
}

class Viewer {
 public:
  explicit Viewer(const Options& options) : options_(options), view_(options.view) {}
  int start();
  int loop();

 private:
  bool open(const std::string& path);
  void reopen_if_grown();
  void take_keys();
  void take_pad();
  void take_mouse();
  void press(const Key& key);
  void press_in_list(int key);
  void go_to(double tick);
  void go_to_goal(int direction);
  void advance(double dt);
  void copy();
  void tell(const std::string& text);
  client::ReplayBar bar() const;
  void draw(float dt);

  Options options_;
  std::optional<draw::Window> window_;
  std::unique_ptr<client::Scene> scene_;
  std::optional<client::UiBatch> ui_;
  std::unique_ptr<client::SoundPlayer> sounds_;
  std::deque<Key> keys_;
  GLFWgamepadstate pad_{};
  Library library_;
  std::unique_ptr<Timeline> timeline_;  // none: the list is shown
  std::optional<video::Staging> staging_;
  client::View view_;
  int team_ = 0, speed_ = kNormal;
  bool paused_ = false, dragging_ = false, pressed_ = false, show_keys_ = false,
       verdict_told_ = false;
  double tick_ = 0.0;
  double seconds_ = 0.0, message_until_ = 0.0, look_again_at_ = 0.0;
  std::string message_;
};

int Viewer::start() {
  auto window = draw::Window::open({.size = options_.size,
                                    .fullscreen = options_.fullscreen,
                                    .title = "Space Foosball: recordings",
                                    .otherwise = "make a video with space-foosball-video"});
  if (!window) {
    std::fprintf(stderr, "space-foosball-watch: %s\n", window.error().sentence.c_str());
    return kNoDisplay;
  }
  window_.emplace(std::move(*window));
  glfwSetWindowUserPointer(window_->handle(), &keys_);
  glfwSetKeyCallback(window_->handle(), [](GLFWwindow* of, int key, int, int action, int mods) {
    if (action != GLFW_RELEASE)
      static_cast<std::deque<Key>*>(glfwGetWindowUserPointer(of))->push_back({key, mods});
  });
  glfwSetScrollCallback(window_->handle(), [](GLFWwindow* of, double, double y) {
    static_cast<std::deque<Key>*>(glfwGetWindowUserPointer(of))
        ->push_back({y > 0 ? GLFW_KEY_UP : GLFW_KEY_DOWN, 0});
  });
  const client::Settings settings = client::load_settings(client::settings_path()).settings;
  constexpr std::array<const char*, client::kLanguages> kCodes{"", "en", "ko", "de"};
  client::use_language(kCodes[static_cast<std::size_t>(settings.language)], catalogue_directory());
  const auto quality = window_->draws_in_software() ? draw::Quality::low : draw::Quality::high;
  auto scene = client::Scene::create(quality);
  auto font = client::Font::load({}, client::catalogue_file());
  auto ui = font ? client::UiBatch::create(std::move(*font)) : tl::unexpected(font.error());
  if (!scene || !ui) {
    std::fprintf(stderr, "space-foosball-watch: %s\n",
                 (!scene ? scene.error() : ui.error()).c_str());
    return server::kExitFailed;
  }
  scene_ = std::move(*scene);
  ui_.emplace(std::move(*ui));
  if (!options_.mute && options_.screenshot.empty()) {
    if (auto sounds = client::SoundPlayer::open()) {
      sounds_ = std::move(*sounds);
      sounds_->set_volume(settings.volume);
    }
  }
  show_keys_ = options_.keys;
  library_ = read_library(options_.folder, options_.results);
  return server::kExitOk;
}

bool Viewer::open(const std::string& path) {
  auto timeline = Timeline::open(path);
  if (!timeline) {
    library_.list.message = timeline.error();
    return false;
  }
  timeline_ = std::move(*timeline);
  staging_.emplace(team_, timeline_->scene().characters());
  scene_->set_characters(timeline_->scene().characters());
  ui_->set_pictures(scene_->portraits(), scene_->portrait_cells());
  tick_ = 0.0;
  paused_ = verdict_told_ = false;
  speed_ = kNormal;
  library_.list.message.clear();
  return true;
}

// A match that is still being played: what has come since is read too.
void Viewer::reopen_if_grown() {
  const Findings findings = timeline_->findings();
  if (!findings.done) return;
  if (!verdict_told_ && findings.verdict != server::Playback::Verdict::same)
    tell(findings.sentence);
  verdict_told_ = true;
  if (seconds_ < look_again_at_ || findings.verdict != server::Playback::Verdict::cut_short) return;
  look_again_at_ = seconds_ + kLookAgainSeconds;
  if (!timeline_->has_grown()) return;
  auto longer = Timeline::open(timeline_->path());
  if (!longer) return;
  const auto here = static_cast<std::uint64_t>(tick_);
  (*longer)->wait_until_read();
  timeline_ = std::move(*longer);
  go_to(static_cast<double>(here));
}

void Viewer::tell(const std::string& text) {
  message_ = text;
  message_until_ = seconds_ + kMessageSeconds;
}

void Viewer::go_to(double tick) {
  tick = std::max(0.0, tick);
  if (!timeline_->seek(static_cast<std::uint64_t>(tick))) {
    tell(client::tr("this moment cannot be restored: the file was written by another release"));
    return;
  }
  tick_ = static_cast<double>(timeline_->scene().ticks());
  staging_->jump(timeline_->story());
}

// The second before a goal; backwards from just after one to the one before it.
void Viewer::go_to_goal(int direction) {
  constexpr double kBefore = 2'000.0, kNear = 500.0;  // ticks
  const Findings findings = timeline_->findings();
  std::optional<double> found;
  for (const Goal& goal : findings.goals) {
    const double at = std::max(0.0, static_cast<double>(goal.tick) - kBefore);
    if (direction > 0 && at > tick_ + kNear) {
      found = at;
      break;
    }
    if (direction < 0 && at < tick_ - kNear) found = at;
  }
  if (found) {
    go_to(*found);
  } else {
    tell(client::tr(findings.goals.empty() ? "no goal was scored" : "no goal there"));
  }
}

void Viewer::copy() {
  const auto copied = share(*timeline_, options_.share_to);
  tell(copied ? *copied : copied.error());
}

void Viewer::press_in_list(int key) {
  const int all = static_cast<int>(library_.list.rows.size());
  if (key == GLFW_KEY_ESCAPE) glfwSetWindowShouldClose(window_->handle(), GLFW_TRUE);
  if (all == 0) return;
  int& chosen = library_.list.chosen;
  if (key == GLFW_KEY_UP) chosen = std::max(0, chosen - 1);
  if (key == GLFW_KEY_DOWN) chosen = std::min(all - 1, chosen + 1);
  if (key == GLFW_KEY_HOME) chosen = 0;
  if (key == GLFW_KEY_END) chosen = all - 1;
  if (key != GLFW_KEY_ENTER && key != GLFW_KEY_SPACE) return;
  const std::string path = library_.paths[static_cast<std::size_t>(chosen)];
  if (path.empty()) {
    library_.list.message = client::tr("of this match there is no recording");
  } else {
    open(path);
  }
}

void Viewer::press(const Key& key) {
  if (!timeline_) return press_in_list(key.key);
  const double far = (key.mods & GLFW_MOD_SHIFT) != 0 ? 30'000.0 : 5'000.0;
  switch (key.key) {
    case GLFW_KEY_SPACE:
    case GLFW_KEY_ENTER:
    case GLFW_KEY_P:
      paused_ = !paused_;
      break;
    case GLFW_KEY_LEFT:
      go_to(tick_ - far);
      break;
    case GLFW_KEY_RIGHT:
      go_to(tick_ + far);
      break;
    case GLFW_KEY_COMMA:
      paused_ = true;
      go_to(tick_ - kFrameTicks);
      break;
    case GLFW_KEY_PERIOD:
      paused_ = true;
      go_to(tick_ + kFrameTicks);
      break;
    case GLFW_KEY_UP:
      speed_ = std::min<int>(speed_ + 1, kSpeeds.size() - 1);
      break;
    case GLFW_KEY_DOWN:
      speed_ = std::max(speed_ - 1, 0);
      break;
    case GLFW_KEY_B:
      go_to_goal(-1);
      break;
    case GLFW_KEY_N:
      go_to_goal(1);
      break;
    case GLFW_KEY_HOME:
      go_to(0.0);
      break;
    case GLFW_KEY_END:
      go_to(static_cast<double>(timeline_->findings().total));
      break;
    case GLFW_KEY_C:
      view_ = static_cast<client::View>((static_cast<int>(view_) + 1) % client::kViews);
      break;
    case GLFW_KEY_V: {
      team_ = 1 - team_;
      const client::MatchStory story = staging_->story();
      staging_.emplace(team_, timeline_->scene().characters());
      staging_->jump(story);
      break;
    }
    case GLFW_KEY_S:
      copy();
      break;
    case GLFW_KEY_F1:
    case GLFW_KEY_H:
      show_keys_ = !show_keys_;
      break;
    case GLFW_KEY_ESCAPE:
      if (library_.list.rows.empty()) {
        glfwSetWindowShouldClose(window_->handle(), GLFW_TRUE);
      } else {
        timeline_.reset();
      }
      break;
    default:
      break;
  }
}

void Viewer::take_keys() {
  take_pad();
  while (!keys_.empty()) {
    const Key key = keys_.front();
    keys_.pop_front();
    press(key);
  }
}

void Viewer::take_pad() {
  GLFWgamepadstate now{};
  for (int id = GLFW_JOYSTICK_1; id <= GLFW_JOYSTICK_LAST; ++id) {
    if (glfwJoystickIsGamepad(id) == GLFW_TRUE && glfwGetGamepadState(id, &now) == GLFW_TRUE) break;
  }
  for (const auto& [button, key] : kPadKeys) {
    if (now.buttons[button] != 0 && pad_.buttons[button] == 0) keys_.push_back({key, 0});
  }
  pad_ = now;
}

void Viewer::take_mouse() {
  GLFWwindow* const handle = window_->handle();
  const bool down = glfwGetMouseButton(handle, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS;
  const bool click = down && !pressed_;
  pressed_ = down;
  if (!down) dragging_ = false;
  if (!timeline_) {
    if (click) press_in_list(GLFW_KEY_ENTER);
    return;
  }
  if (!click && !dragging_) return;
  double x = 0.0, y = 0.0;
  int wide = 1, high = 1;
  glfwGetCursorPos(handle, &x, &y);
  glfwGetWindowSize(handle, &wide, &high);
  const glm::ivec2 screen = window_->size();
  const glm::vec2 at(x * screen.x / std::max(wide, 1), y * screen.y / std::max(high, 1));
  const auto moment =
      client::bar_moment(*ui_, bar(), dragging_ ? glm::vec2(at.x, screen.y) : at, screen);
  if (moment) {
    dragging_ = true;
    if (std::abs(1e3 * *moment - tick_) > 1.0) go_to(1e3 * *moment);
  } else if (click) {
    paused_ = !paused_;
  }
}

void Viewer::advance(double dt) {
  const double speed = kSpeeds[static_cast<std::size_t>(speed_)];
  if (!paused_ && !dragging_) {
    tick_ = std::min(tick_ + 1e3 * speed * dt, static_cast<double>(timeline_->findings().total));
    timeline_->play_to(static_cast<std::uint64_t>(tick_));
  }
  const auto passed = static_cast<float>(paused_ || dragging_ ? 0.0 : speed * dt);
  // Sounds are of the speed of the match.
  staging_->advance(timeline_->scene().snapshot(), timeline_->scene().take_events(), passed,
                    speed_ == kNormal ? sounds_.get() : nullptr);
}

client::ReplayBar Viewer::bar() const {
  const Findings findings = timeline_->findings();
  client::ReplayBar bar;
  bar.now = 1e-3 * static_cast<double>(timeline_->scene().ticks());
  bar.read = 1e-3 * static_cast<double>(findings.read);
  bar.total = 1e-3 * static_cast<double>(findings.total);
  bar.speed = kSpeeds[static_cast<std::size_t>(speed_)];
  bar.paused = paused_;
  bar.show_keys = show_keys_;
  const auto& score = timeline_->scene().snapshot().score;
  bar.score = {score[0], score[1]};
  for (const Goal& goal : findings.goals)
    bar.goals.push_back({1e-3 * static_cast<double>(goal.tick), goal.team, goal.score});
  bar.camera = kViewNames[static_cast<std::size_t>(view_)];
  if (seconds_ < message_until_) bar.message = message_;
  return bar;
}

void Viewer::draw(float dt) {
  const glm::ivec2 size = window_->size();
  if (size.x <= 0 || size.y <= 0) return;
  if (!timeline_) {
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glViewport(0, 0, size.x, size.y);
    glClearColor(0.01f, 0.015f, 0.03f, 1.0f);
    glClear(GL_COLOR_BUFFER_BIT);
    client::draw_replay_list(*ui_, library_.list, size);
    return;
  }
  advance(dt);
  const wire::Snapshot& state = timeline_->scene().snapshot();
  client::SceneView view;
  view.time = static_cast<float>(seconds_);
  view.camera = staging_->camera(view_, size);
  scene_->draw(state, view, staging_->particles(), size);
  client::HudState hud;
  hud.state = &state;
  hud.camera = view.camera;
  hud.characters = &timeline_->scene().characters();
  hud.view = view_;
  hud.goal = staging_->story().last_goal();
  hud.since_foul = staging_->story().since_foul();
  hud.statistics = staging_->story().statistics();
  client::draw_hud(*ui_, hud, size);
  client::draw_replay_bar(*ui_, bar(), size);
}

int Viewer::loop() {
  std::int64_t before = os::monotonic_us();
  if (!options_.file.empty() && !open(options_.file)) {
    std::fprintf(stderr, "space-foosball-watch: %s\n", library_.list.message.c_str());
    return server::kExitUsage;
  }
  if (timeline_ && options_.from > 0.0) {
    timeline_->wait_until_read();
    go_to(1e3 * options_.from);
  }
  for (int frame = 0; !window_->should_close(); ++frame) {
    const std::int64_t now = os::monotonic_us();
    const double dt = std::clamp(1e-6 * static_cast<double>(now - before), 0.0, 0.1);
    before = now;
    seconds_ += dt;
    window_->poll();
    take_keys();
    take_mouse();
    if (timeline_) reopen_if_grown();
    draw(static_cast<float>(dt));
    if (frame >= 2 && !options_.screenshot.empty()) {
      const auto written = draw::write_png(draw::read_pixels(window_->size()), options_.screenshot);
      if (!written) std::fprintf(stderr, "space-foosball-watch: %s\n", written.error().c_str());
      return written ? server::kExitOk : server::kExitFailed;
    }
    window_->swap();
  }
  return server::kExitOk;
}

}  // namespace

int run(const Options& options) {
  if (options.share) {
    const auto timeline = Timeline::open(options.file);
    const auto copied =
        timeline ? share(**timeline, options.share_to) : tl::unexpected(timeline.error());
    if (!copied) {
      std::fprintf(stderr, "space-foosball-watch: %s\n", copied.error().c_str());
      return timeline ? server::kExitFailed : server::kExitUsage;
    }
    std::printf("%s\n", copied->c_str());
    return server::kExitOk;
  }
  Viewer viewer(options);
  const int code = viewer.start();
  return code == server::kExitOk ? viewer.loop() : code;
}

}  // namespace watch
