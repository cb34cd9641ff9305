#include "viewer.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <GLES3/gl3.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <filesystem>
#include <memory>
#include <optional>

#include "app/pads.h"
#include "core/input_collector.h"
#include "draw/image.h"
#include "draw/window.h"
#include "film.h"
#include "os/clock.h"
#include "render/hud.h"
#include "render/hud_replay.h"
#include "render/translate.h"
#include "server/exit_code.h"

namespace watch {
namespace {

constexpr int kNoDisplay = 4;

volatile std::sig_atomic_t asked_to_leave = 0;

// Beside the program, both in the build tree and installed.
std::string catalogue_directory() {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  return (program.parent_path().parent_path() / "share" / "locale").string();
}

// The window's events since the last frame.
struct Events {
  struct Key {
    int key;
    bool shift;
  };
  std::deque<Key> keys;
  std::deque<PointerEvent> pointer;
  glm::vec2 at{-1.0f};  // the pointer's position at these events; the present one may differ
};

Events& events_of(GLFWwindow* window) {
  return *static_cast<Events*>(glfwGetWindowUserPointer(window));
}

glm::vec2 pointer_at(GLFWwindow* window, double x, double y) {
  int wide = 1, high = 1, pixels_wide = 1, pixels_high = 1;
  glfwGetWindowSize(window, &wide, &high);
  glfwGetFramebufferSize(window, &pixels_wide, &pixels_high);
  return {x * pixels_wide / std::max(wide, 1), y * pixels_high / std::max(high, 1)};
}

void listen_to(GLFWwindow* window, Events& input) {
  glfwSetWindowUserPointer(window, &input);
  glfwSetKeyCallback(window, [](GLFWwindow* of, int key, int, int action, int mods) {
    if (action != GLFW_RELEASE) events_of(of).keys.push_back({key, (mods & GLFW_MOD_SHIFT) != 0});
  });
  glfwSetMouseButtonCallback(window, [](GLFWwindow* of, int button, int action, int) {
    if (button != GLFW_MOUSE_BUTTON_LEFT) return;
    Events& events = events_of(of);
    const bool press = action == GLFW_PRESS;
    events.pointer.push_back(
        {press ? PointerEvent::Kind::press : PointerEvent::Kind::release, events.at});
  });
  glfwSetCursorPosCallback(window, [](GLFWwindow* of, double x, double y) {
    Events& events = events_of(of);
    events.at = pointer_at(of, x, y);
    events.pointer.push_back({PointerEvent::Kind::move, events.at});
  });
  glfwSetScrollCallback(window, [](GLFWwindow* of, double, double y) {
    events_of(of).pointer.push_back({PointerEvent::Kind::wheel, {}, static_cast<float>(y)});
  });
}

class Viewer {
 public:
  explicit Viewer(const Options& options) : options_(options), session_(options.session) {}
  int start();
  int loop();
  bool reading() const { return session_.reading(); }

 private:
  std::string use_texts();
  void take_events();
  void advance(float dt);
  void follow_recording();
  int picture_height() const;
  void draw();
  void draw_match();
  void take_picture();
  int take_screenshot();
  void say_state();

  const Options& options_;
  client::Settings settings_;
  std::optional<draw::Window> window_;
  Events events_;
  std::optional<client::Pads> pads_;
  client::InputCollector input_;
  std::unique_ptr<client::Scene> scene_;
  std::optional<client::UiBatch> ui_;
  std::unique_ptr<client::SoundPlayer> sounds_;
  Session session_;
  std::optional<video::Staging> staging_;
  int staged_team_ = 0;
  glm::ivec2 size_{1, 1};
  double seconds_ = 0.0;
  std::string said_;
};

// Loads the language's catalogue, and the letters that it needs.
std::string Viewer::use_texts() {
  constexpr std::array<const char*, client::kLanguages> kCodes{"", "en", "ko", "de"};
  client::use_language(options_.language.empty()
                           ? kCodes[static_cast<std::size_t>(settings_.language)]
                           : options_.language,
                       catalogue_directory());
  auto font = client::Font::load({}, client::catalogue_file());
  if (!font) return font.error();
  auto ui = client::UiBatch::create(std::move(*font));
  if (!ui) return ui.error();
  ui_.emplace(std::move(*ui));
  return {};
}

int Viewer::start() {
  const auto fail = [](int code, const std::string& sentence) {
    std::fprintf(stderr, "space-foosball-watch: %s\n", sentence.c_str());
    return code;
  };
  auto window = draw::Window::open({.size = options_.size,
                                    .fullscreen = options_.fullscreen,
                                    .title = "Space Foosball: recordings",
                                    .otherwise = "make a video with space-foosball-video"});
  if (!window) return fail(kNoDisplay, window.error().sentence);
  window_.emplace(std::move(*window));
  listen_to(window_->handle(), events_);
  pads_.emplace();
  settings_ = client::load_settings(client::settings_path()).settings;
  draw::Quality quality = window_->draws_in_software() ? draw::Quality::low : draw::Quality::high;
  if (settings_.quality != client::QualityChoice::automatic)
    quality =
        settings_.quality == client::QualityChoice::high ? draw::Quality::high : draw::Quality::low;
  if (options_.quality) quality = *options_.quality;
  auto scene = client::Scene::create(quality);
  if (!scene) return fail(server::kExitFailed, scene.error());
  scene_ = std::move(*scene);
  if (const std::string error = use_texts(); !error.empty())
    return fail(server::kExitFailed, error);
  if (!options_.mute && options_.screenshot.empty()) {
    if (auto sounds = client::SoundPlayer::open()) {
      sounds_ = std::move(*sounds);
      sounds_->set_volume(settings_.volume);
    }
  }
  if (options_.keys) session_.act(Command::keys);
  return server::kExitOk;
}

void Viewer::take_events() {
  window_->poll();
  session_.resize(glm::max(window_->size(), 1));
  for (const Events::Key& key : std::exchange(events_.keys, {})) session_.key(key.key, key.shift);
  for (const PointerEvent& event : std::exchange(events_.pointer, {})) session_.pointer(event);
  pads_->poll(input_);
  session_.pad(input_.take(client::kAllDevices));
  input_.clear();
  for (const std::string& message : pads_->take_messages()) session_.show_message(message, true);
}

// Handles a change of the recording, the side, or the moment.
void Viewer::follow_recording() {
  Player& player = *session_.player();
  const foosball::Characters& characters = player.timeline().scene().characters();
  if (session_.take_opened()) {
    scene_->set_characters(characters);
    ui_->set_pictures(scene_->portraits(), scene_->portrait_cells());
    staging_.reset();
    if (options_.paused) player.act(Command::play);
  }
  const bool turned = staging_ && staged_team_ != session_.team();
  const client::MatchStory story = turned ? staging_->story() : player.timeline().story();
  if (!staging_ || turned) {
    staged_team_ = session_.team();
    staging_.emplace(staged_team_, characters);
    staging_->jump(story);
  }
  if (player.take_jump()) staging_->jump(player.timeline().story());
}

void Viewer::advance(float dt) {
  session_.step(static_cast<double>(dt));
  if (session_.player() == nullptr) return;
  follow_recording();
  Player& player = *session_.player();
  const auto passed = player.stands() ? 0.0f : dt * static_cast<float>(player.speed());
  // Sound only at the match's own speed.
  client::SoundPlayer* const sounds =
      !player.stands() && player.speed() == 1.0 ? sounds_.get() : nullptr;
  staging_->advance(player.timeline().scene().snapshot(), player.timeline().scene().take_events(),
                    passed, sounds);
}

// The picture ends above the bar, so that the bar covers nothing of the match.
int Viewer::picture_height() const {
  if (session_.hidden()) return size_.y;
  const float top = client::replay_bar_layout(size_).panel.low.y;
  return std::clamp(static_cast<int>(top), 1, size_.y);
}

void Viewer::draw_match() {
  const Player& player = *session_.player();
  const wire::Snapshot& state = player.timeline().scene().snapshot();
  const glm::ivec2 picture(size_.x, picture_height());
  client::SceneView view;
  view.time = static_cast<float>(1e-3 * player.tick());
  view.camera = staging_->camera(session_.view(), picture);
  view.rods = settings_.rods;
  view.distinct_teams = settings_.distinct_teams;
  view.reduced_flashes = settings_.reduced_flashes;
  view.room_below = size_.y - picture.y;
  if (sounds_) sounds_->set_listener(view.camera.eye, glm::vec3(0));
  scene_->draw(state, view, staging_->particles(), picture);
  if (session_.hidden()) return;
  client::HudState hud;
  hud.state = &state;
  hud.camera = view.camera;
  hud.characters = &player.timeline().scene().characters();
  hud.view = session_.view();
  // Left on the board is left in the picture; a spectator sees the table from one side only.
  const bool turned = session_.team() == 1 && session_.view() != client::View::spectator;
  hud.viewer_team = turned ? 1 : -1;
  hud.text_scale = settings_.text_scale;
  hud.still = settings_.reduced_flashes;
  client::set_story(hud, staging_->story());
  hud.recorded = true;
  client::draw_hud(*ui_, hud, picture);
  glViewport(0, 0, size_.x, size_.y);
  client::draw_replay_bar(*ui_, session_.bar(), size_);
}

void Viewer::draw() {
  size_ = glm::max(window_->size(), 1);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, size_.x, size_.y);
  glClearColor(0.01f, 0.015f, 0.03f, 1.0f);
  glClear(GL_COLOR_BUFFER_BIT);
  if (session_.player() != nullptr) {
    draw_match();
  } else {
    client::draw_replay_list(*ui_, session_.list(), size_);
  }
}

// Saves the screen's picture to the folder of shared recordings.
void Viewer::take_picture() {
  std::error_code error;
  std::filesystem::create_directories(session_.shared_to(), error);
  const draw::Image image = draw::read_pixels(size_);
  for (int i = 1; i < 10'000; ++i) {
    const std::string path =
        session_.shared_to() + "/Space Foosball picture " + std::to_string(i) + ".png";
    if (std::filesystem::exists(path, error)) continue;
    const auto written = draw::write_png(image, path);
    return session_.show_message(
        written ? client::tr("picture written to") + std::string(" ") + path : written.error(),
        !written);
  }
}

int Viewer::take_screenshot() {
  const auto written = draw::write_png(draw::read_pixels(size_), options_.screenshot);
  if (!written) std::fprintf(stderr, "space-foosball-watch: %s\n", written.error().c_str());
  return written ? server::kExitOk : server::kExitFailed;
}

// The tick of a playing recording alone is not printed.
void Viewer::say_state() {
  if (!options_.say_state) return;
  std::string state = session_.state();
  const Player* player = session_.player();
  if (player != nullptr && player->stands())
    state += ", tick " + std::to_string(player->timeline().scene().ticks());
  if (state == said_) return;
  said_ = std::move(state);
  std::printf("%s\n", said_.c_str());
  std::fflush(stdout);
}

int Viewer::loop() {
  if (!options_.screenshot.empty()) session_.wait();
  std::int64_t before = os::monotonic_us();
  for (int frame = 0; !window_->should_close() && !session_.over() && asked_to_leave == 0;
       ++frame) {
    const std::int64_t now = os::monotonic_us();
    const double dt = std::clamp(1e-6 * static_cast<double>(now - before), 0.0, 0.1);
    before = now;
    seconds_ += dt;
    take_events();
    advance(static_cast<float>(options_.screenshot.empty() ? dt : 0.02));
    if (!session_.first_problem().empty() && options_.session.folder.empty()) {
      std::fprintf(stderr, "space-foosball-watch: %s\n", session_.first_problem().c_str());
      return server::kExitUsage;
    }
    draw();
    say_state();
    if (session_.take_picture()) take_picture();
    if (frame >= 2 && !options_.screenshot.empty()) return take_screenshot();
    window_->swap();
  }
  return server::kExitOk;
}

}  // namespace

int run(const Options& options) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP})
    std::signal(signal, [](int) { asked_to_leave = 1; });
  int code = 0;
  bool reading = false;
  {
    Viewer viewer(options);
    code = viewer.start();
    if (code == server::kExitOk) code = viewer.loop();
    reading = viewer.reading();
  }
  // Does not wait for a disk read in the background.
  if (reading) std::_Exit(code);
  return code;
}

}  // namespace watch
