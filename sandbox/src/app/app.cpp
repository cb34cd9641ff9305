#include "app/app.h"

#include <backends/imgui_impl_glfw.h>
#include <imgui.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <memory>
#include <optional>

#include "app/meter.h"
#include "app/panel.h"
#include "app/statistics.h"
#include "app/thrown.h"
#include "draw/image.h"
#include "draw/window.h"
#include "os/clock.h"
#include "view/ui_renderer.h"

namespace sandbox {
namespace {

constexpr double kLongestFrame = 0.1;  // [s]; a longer delay of a frame is dropped
// A frame may step for as long as its picture takes to draw, but at least for this time [s].
constexpr double kMinStepping = 1.0 / 30.0;

constexpr Simulation::Clocks kClocks{os::monotonic_ns, os::thread_ns, os::monotonic_ns};

volatile std::sig_atomic_t asked_to_leave = 0;

int fail(const std::string& sentence, int code) {
  std::fprintf(stderr, "%s\n", sentence.c_str());
  return code;
}

std::string write_stats(const Statistics& statistics, const std::string& path) {
  if (path.empty()) return {};
  std::ofstream file(path);
  file << json(statistics);
  if (file.flush()) return {};
  return "Cannot write the statistics to " + path + ": choose a directory that can be written to.";
}

int sum_up(const Statistics& statistics, const Options& options) {
  std::printf("%s\n", sentence(statistics).c_str());
  const std::string error = write_stats(statistics, options.stats_file);
  return error.empty() ? 0 : fail(error, 1);
}

int run_without_window(const Options& options, Simulation simulation) {
  const double end = options.seconds.value_or(simulation.scene().seconds);
  while (simulation.time() < end - 0.5 * simulation.dt() && asked_to_leave == 0) {
    if (const auto stepped = simulation.step(); !stepped) return fail(stepped.error().message, 1);
  }
  return sum_up(statistics_of(simulation), options);
}

// Dear ImGui's state, for as long as there is a window.
struct UiContext {
  explicit UiContext(const draw::Window& window) {
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    ImGui_ImplGlfw_InitForOther(window.handle(), true);
  }
  ~UiContext() {
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
  }
  UiContext(const UiContext&) = delete;
  UiContext& operator=(const UiContext&) = delete;
};

class App {
 public:
  App(const Options& options, Simulation simulation)
      : options_(options), simulation_(std::move(simulation)) {
    controls_ = {options.paused, options.rate, options.speed, options.view, 0, !options.no_panel};
  }
  // Returns an empty string, or the error to print; exit_code is then set.
  std::string start(int& exit_code);
  int loop();

 private:
  glm::ivec2 pointer_screen() const;
  void show_all();
  void point();
  void fulfil(const Requests& requests);
  void throw_one();
  void skip();
  void advance(double frame);
  // The next scene time with an action to perform; none: no more actions.
  std::optional<double> next_stop() const;
  bool has_come_to(double time) const;
  void begin_frame(bool first);
  void draw_frame(Requests& requests);
  std::string take_picture();
  bool leaving() const;
  void fail_softly(const vp::Expected<void>& result);

  const Options& options_;
  Simulation simulation_;
  Controls controls_;
  std::optional<draw::Window> window_;
  std::unique_ptr<UiContext> ui_;
  std::optional<UiRenderer> ui_renderer_;
  draw::Quality quality_ = draw::Quality::high;
  std::unique_ptr<SceneView> view_;
  OrbitCamera camera_;
  Meter meter_;
  std::string message_;
  double drawing_ = 0.0;  // duration of the last picture [s]
  glm::ivec2 size_{1, 1};
  bool shot_ = false, leave_ = false;
};

std::string App::start(int& exit_code) {
  exit_code = 4;
  auto window = draw::Window::open({.size = options_.size,
                                    .fullscreen = options_.fullscreen,
                                    .title = "Virtual Physics: sandbox",
                                    .otherwise = "run without a window with --no-window"});
  if (!window) return window.error().sentence;
  window_.emplace(std::move(*window));
  exit_code = 1;
  ui_ = std::make_unique<UiContext>(*window_);
  if (const auto styled = style_panel(options_.font_directory); !styled) return styled.error();
  const draw::Quality guess =
      window_->draws_in_software() ? draw::Quality::low : draw::Quality::high;
  quality_ = options_.quality.value_or(guess);
  auto view = SceneView::create(quality_);
  if (!view) return view.error();
  view_ = std::move(*view);
  auto renderer = UiRenderer::create(quality_);
  if (!renderer) return renderer.error();
  ui_renderer_ = std::move(*renderer);
  size_ = glm::max(window_->size(), 1);
  exit_code = 0;
  return {};
}

// The screen size in GLFW's pointer units: on some displays not the framebuffer's pixels.
glm::ivec2 App::pointer_screen() const {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  return {static_cast<int>(size.x), static_cast<int>(size.y)};
}

void App::show_all() {
  vp::Vec3 low, high;
  simulation_.bounds(low, high);
  double closer = 1.0;
  if (options_.look) {
    camera_.look_from(options_.look->x, options_.look->y);
    closer = options_.look->z;
  }
  camera_.fit(low, high, size_);
  camera_.scale_distance(closer);
}

void App::point() {
  const ImGuiIO& io = ImGui::GetIO();
  const glm::ivec2 screen = pointer_screen();
  const Ray ray = camera_.ray({io.MousePos.x, io.MousePos.y}, screen);
  if (!ImGui::IsMouseDown(ImGuiMouseButton_Left)) simulation_.let_go();
  if (simulation_.grip()) {
    simulation_.drag(ray, camera_.forward());
    return;
  }
  if (io.WantCaptureMouse) return;
  const glm::dvec2 moved{io.MouseDelta.x, io.MouseDelta.y};
  if (ImGui::IsMouseClicked(ImGuiMouseButton_Left) && simulation_.grab(ray)) return;
  if (ImGui::IsMouseDown(ImGuiMouseButton_Left)) camera_.orbit(moved);
  if (ImGui::IsMouseDown(ImGuiMouseButton_Right) || ImGui::IsMouseDown(ImGuiMouseButton_Middle))
    camera_.pan(moved, screen);
  camera_.zoom(io.MouseWheel);
}

void App::fail_softly(const vp::Expected<void>& result) {
  if (!result) message_ = result.error().message;
}

// Throws from the eye towards the pointer; after a key press beside the picture, towards its
// centre. Fast enough to fly nearly straight.
void App::throw_one() {
  const double radius = 0.02 * camera_.distance(), speed = 1.5 * camera_.distance();
  const ImGuiIO& io = ImGui::GetIO();
  const glm::ivec2 screen = pointer_screen();
  const glm::dvec2 at = io.WantCaptureMouse || !ImGui::IsMousePosValid()
                            ? 0.5 * glm::dvec2(screen)
                            : glm::dvec2(io.MousePos.x, io.MousePos.y);
  const Ray ray = camera_.ray(at, screen);
  fail_softly(simulation_.throw_body(thrown_shape(controls_.thrown, radius),
                                     ray.origin + 0.2 * camera_.distance() * ray.direction,
                                     speed * ray.direction));
}

void App::fulfil(const Requests& requests) {
  simulation_.set_rate(controls_.rate);
  if (requests.scene) {
    auto opened = Simulation::open(*requests.scene, controls_.rate, kClocks);
    message_ = opened ? std::string() : opened.error().message;
    if (opened) simulation_ = std::move(*opened);
  }
  if (requests.reset) fail_softly(simulation_.reset());
  if (requests.scene || requests.show_all) show_all();
  if (requests.throw_one) throw_one();
  if (requests.step) {
    controls_.paused = true;
    fail_softly(simulation_.step());
  }
  leave_ = leave_ || requests.leave;
}

// Steps as fast as possible, without drawing.
void App::skip() {
  while (!has_come_to(options_.skip_to) && !leaving() && message_.empty()) {
    fail_softly(simulation_.step());
    if (simulation_.steps() % 100 == 0) window_->poll();
  }
}

bool App::has_come_to(double time) const {
  return simulation_.time() >= time - 0.5 * simulation_.dt();
}

std::optional<double> App::next_stop() const {
  if (options_.screenshot_at && !shot_) return options_.screenshot_at;
  return options_.seconds;
}

// Stops at the time of a requested picture.
void App::advance(double frame) {
  if (controls_.paused) return;
  if (const auto stop = next_stop())
    frame = std::clamp((*stop - simulation_.time()) / controls_.speed, 0.0, frame);
  const double budget = std::clamp(drawing_, kMinStepping, kLongestFrame);
  const auto stepped = simulation_.advance(frame, controls_.speed, budget);
  if (stepped) return;
  message_ = stepped.error().message;
  controls_.paused = true;
}

void App::draw_frame(Requests& requests) {
  const std::int64_t began = os::monotonic_ns();
  view_->draw(simulation_, camera_, controls_.view, size_);
  draw_panel(simulation_, meter_, drawing_, message_, controls_, requests);
  ImGui::Render();
  ui_renderer_->draw(*ImGui::GetDrawData());
  window_->swap();
  drawing_ = 1e-9 * static_cast<double>(os::monotonic_ns() - began);
}

// Of the frame just drawn. A picture is worth a slow frame: it is drawn in high quality, unless
// another was requested.
std::string App::take_picture() {
  if (!options_.quality && quality_ != draw::Quality::high) {
    const auto view = SceneView::create(draw::Quality::high);
    if (!view) return view.error();
    (*view)->draw(simulation_, camera_, controls_.view, size_);
  } else {
    view_->draw(simulation_, camera_, controls_.view, size_);
  }
  ui_renderer_->draw(*ImGui::GetDrawData());
  const auto wrote = draw::write_png(draw::read_pixels(size_), options_.screenshot);
  return wrote ? std::string() : wrote.error();
}

bool App::leaving() const {
  return leave_ || window_->should_close() || asked_to_leave != 0 ||
         (options_.seconds && has_come_to(*options_.seconds));
}

void App::begin_frame(bool first) {
  window_->poll();
  size_ = glm::max(window_->size(), 1);
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
  const auto width = static_cast<double>(std::max(pointer_screen().x, 1));
  camera_.leave_free(controls_.panel ? kPanelReach / width : 0.0);
  if (first) show_all();
}

int App::loop() {
  skip();
  const std::int64_t began = os::monotonic_ns();
  std::int64_t before = began;
  shot_ = options_.screenshot.empty();
  std::string failure;
  for (bool last = false; !last;) {
    const std::int64_t now = os::monotonic_ns();
    const double frame = std::min(1e-9 * static_cast<double>(now - before), kLongestFrame);
    begin_frame(before == began);
    before = now;
    Requests requests;
    point();
    read_keys(simulation_, controls_, requests);
    advance(frame);
    draw_frame(requests);
    last = leaving();
    if (!shot_ && (last || (options_.screenshot_at && has_come_to(*options_.screenshot_at)))) {
      shot_ = true;
      failure = take_picture();
    }
    meter_.frame(os::monotonic_ns(), simulation_.time());
    fulfil(requests);
  }
  if (!failure.empty()) return fail(failure, 1);
  Statistics statistics = statistics_of(simulation_);
  statistics.frames = meter_.frames();
  statistics.frames_per_second = 1e9 * meter_.frames() / static_cast<double>(before - began + 1);
  return sum_up(statistics, options_);
}

}  // namespace

int run(const Options& options) {
  auto simulation = Simulation::open(options.scene, options.rate, kClocks);
  if (!simulation) return fail(simulation.error().message + ".", 2);
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { asked_to_leave = 1; });
  if (options.no_window) return run_without_window(options, std::move(*simulation));
  App app(options, std::move(*simulation));
  int exit_code = 0;
  if (const std::string error = app.start(exit_code); !error.empty()) return fail(error, exit_code);
  return app.loop();
}

}  // namespace sandbox
