// space-foosball-calibrate: guides through the calibration of a cabinet's rods, in a window or on
// the terminal.
#define GLFW_INCLUDE_NONE
#include <GLES3/gl3.h>
#include <GLFW/glfw3.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <mutex>
#include <thread>

#include "cabinet/controller.h"
#include "cabinet/device_source.h"
#include "draw/command_line.h"
#include "draw/image.h"
#include "draw/window.h"
#include "os/clock.h"
#include "os/time_of_day.h"
#include "render/translate.h"
#include "session.h"
#include "text.h"
#include "view.h"

namespace {

using namespace calibrate;

constexpr int kOk = 0, kFailed = 1, kUsage = 2, kNoDisplay = 4;

struct Options {
  std::string device, out, language, screenshot, layout = "tournament";
  std::vector<int> rods;
  bool text = false;
  double screenshot_at = 1.0;
  glm::ivec2 size{1280, 720};
};

volatile std::sig_atomic_t asked_to_leave = 0;

int fail(int code, const std::string& sentence) {
  std::fprintf(stderr, "space-foosball-calibrate: %s\n", sentence.c_str());
  return code;
}

// Reads the device each millisecond, independent of the frame rate.
class Listener {
 public:
  explicit Listener(std::unique_ptr<cabinet::DeviceSource> device) : device_(std::move(device)) {
    device_->observe([this](const wire::DeviceFrame& frame) {
      const std::lock_guard lock(mutex_);
      frames_.push_back(frame);
    });
    thread_ = std::thread([this] {
      while (!stops_) {
        device_->poll(os::monotonic_us());
        state_ = device_->state();
        error_ = device_->open_error();
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    });
  }
  ~Listener() {
    stops_ = true;
    thread_.join();
  }
  std::vector<wire::DeviceFrame> take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(frames_, {});
  }
  cabinet::DeviceState state() const { return state_; }
  int error() const { return error_; }

 private:
  std::unique_ptr<cabinet::DeviceSource> device_;
  std::mutex mutex_;
  std::vector<wire::DeviceFrame> frames_;
  std::atomic<cabinet::DeviceState> state_ = cabinet::DeviceState::missing;
  std::atomic<int> error_ = 0;
  std::atomic<bool> stops_ = false;
  std::thread thread_;
};

// The session with its device and its file.
class Run {
 public:
  Run(const Options& options, std::unique_ptr<cabinet::DeviceSource> device, std::string path,
      cabinet::Calibration start)
      : session_({.layout = layout_of(options), .rods = options.rods, .start = std::move(start)}),
        listener_(std::move(device)) {
    view_.layout = layout_of(options);
    view_.device = options.device;
    view_.path = std::move(path);
  }
  static foosball::Layout layout_of(const Options& options) {
    return options.layout == "paper" ? foosball::Layout::paper : foosball::Layout::tournament;
  }
  void step() {
    session_.line_is(listener_.state(), listener_.error());
    for (const wire::DeviceFrame& frame : listener_.take()) session_.update(frame);
    keep();
  }
  // Stores each rod as soon as it is fitted, so that an aborted calibration keeps the finished
  // rods.
  void keep() {
    if (session_.kept() == kept_) return;
    kept_ = session_.kept();
    cabinet::Calibration calibration = session_.calibration();
    calibration.made = os::utc_now();
    const auto saved = cabinet::save_calibration(calibration, view_.path);
    view_.problem = saved ? "" : saved.error();
  }
  Session& session() { return session_; }
  const ViewState& view() const { return view_; }

 private:
  Session session_;
  ViewState view_;
  int kept_ = 0;
  Listener listener_;
};

// --- the terminal --------------------------------------------------------------------------------

class Terminal {
 public:
  explicit Terminal(Run& run) : run_(run) {}
  int loop() {
    std::printf(
        "Enter: mark or continue; b and Enter: previous step; n and Enter: another rod; q and "
        "Enter: leave.\n");
    while (asked_to_leave == 0 && !done_) {
      run_.step();
      print_state();
      read_keys();
    }
    if (run_.session().all_fitted()) return run_.view().problem.empty() ? kOk : kFailed;
    if (!closed_) return kFailed;
    return fail(kFailed, "its input has ended before all rods fit: run it on a terminal.");
  }

 private:
  void print_state() {
    Session& s = run_.session();
    std::string now = rod_text(run_.view().layout, s.rod()) + "  ";
    if (s.state(s.rod()) == RodState::guided)
      now += std::to_string(s.guide().step() + 1) + "/" +
             std::to_string(cabinet::CalibrationGuide::steps()) + "  ";
    now += request_text(s);
    if (const std::string advice = advice_text(s); !advice.empty()) now += "  " + advice;
    if (now != printed_) std::printf("%s\n", now.c_str());
    const bool fits = s.state(s.rod()) == RodState::fitted;
    if (now != printed_ && fits)
      for (const std::string& line : fit_text(*s.fit())) std::printf("    %s\n", line.c_str());
    if (now != printed_ && fits && !run_.view().problem.empty())
      std::printf("%s\n", run_.view().problem.c_str());
    std::fflush(stdout);
    printed_ = now;
    done_ = done_ || s.all_fitted();
  }
  void read_keys() {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    if (::poll(&input, 1, 20) <= 0) return;
    char bytes[64];
    const ssize_t got = ::read(STDIN_FILENO, bytes, sizeof bytes);
    closed_ = got <= 0;  // end of input: nobody can continue
    done_ = done_ || closed_;
    for (ssize_t i = 0; i < got; ++i) {
      if (bytes[i] != '\n') {
        line_ += bytes[i];
        continue;
      }
      if (line_.empty()) run_.session().confirm();
      if (line_ == "b") run_.session().back();
      if (line_ == "n") run_.session().next_rod(1);
      if (line_ == "q") done_ = true;
      line_.clear();
    }
  }

  Run& run_;
  std::string printed_, line_;
  bool done_ = false, closed_ = false;
};

// --- the window ----------------------------------------------------------------------------------

std::string catalogue_directory() {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  return (program.parent_path().parent_path() / "share" / "locale").string();
}

int show(const Options& options, Run& run) {
  auto window = draw::Window::open({.size = options.size,
                                    .title = "Space Foosball: calibration",
                                    .otherwise = "calibrate on the terminal with --text"});
  if (!window) return fail(kNoDisplay, window.error().sentence);
  auto font = client::Font::load({}, client::catalogue_file());
  if (!font) return fail(kFailed, font.error());
  auto ui = client::UiBatch::create(std::move(*font));
  if (!ui) return fail(kFailed, ui.error());
  glfwSetWindowUserPointer(window->handle(), &run.session());
  glfwSetKeyCallback(window->handle(), [](GLFWwindow* of, int key, int, int action, int mods) {
    if (action != GLFW_PRESS) return;
    auto& session = *static_cast<Session*>(glfwGetWindowUserPointer(of));
    if (key == GLFW_KEY_SPACE || key == GLFW_KEY_ENTER) session.confirm();
    if (key == GLFW_KEY_BACKSPACE) session.back();
    if (key == GLFW_KEY_TAB) session.next_rod((mods & GLFW_MOD_SHIFT) != 0 ? -1 : 1);
    if (key == GLFW_KEY_ESCAPE) glfwSetWindowShouldClose(of, GLFW_TRUE);
  });
  const std::int64_t began_us = os::monotonic_us();
  while (asked_to_leave == 0 && !window->should_close()) {
    window->poll();
    run.step();
    const glm::ivec2 size = window->size();
    glViewport(0, 0, size.x, size.y);
    glClearColor(0.03f, 0.05f, 0.09f, 1.0f);
    glClear(GL_COLOR_BUFFER_BIT);
    draw_session(*ui, run.session(), run.view(), size);
    const double seconds = 1e-6 * static_cast<double>(os::monotonic_us() - began_us);
    if (!options.screenshot.empty() && seconds >= options.screenshot_at) {
      const auto written = draw::write_png(draw::read_pixels(size), options.screenshot);
      return written ? kOk : fail(kFailed, written.error());
    }
    window->swap();
  }
  return kOk;
}

}  // namespace

int main(int argc, char** argv) {
  // so that no file opened later becomes descriptor 0
  if (::fcntl(STDIN_FILENO, F_GETFD) < 0) (void)::open("/dev/null", O_RDONLY);
  Options options;
  std::string size = "1280x720";
  CLI::App cli{
      "Guides through the calibration of a cabinet's rods: strokes and turns of each, then its "
      "numbers are fitted, shown and stored. No server may use the controller meanwhile.\n\n"
      "Exit codes: 0 left, on the terminal with all rods calibrated; 1 failed, or left before; 2 a "
      "bad option; 4 no display.",
      "space-foosball-calibrate"};
  cli.add_option("--device", options.device,
                 "the cabinet's controller: serial:/dev/ttyACM0, hid:/dev/hidraw0 or "
                 "file:RECORDING")
      ->required();
  cli.add_option("--rods", options.rods, "1 to 8, from team 0's goal, as in 2,3 (all)")
      ->delimiter(',')
      ->check([](const std::string& text) {
        const bool rod = text.size() == 1 && text[0] >= '1' && text[0] <= '8';
        return rod ? ""
                   : "\"" + text +
                         "\" is not a list of rods: write rods from 1 to 8, separated by commas, "
                         "such as 2,3";
      });
  cli.add_option("--layout", options.layout, "of the table: tournament (1-2-5-3) or paper")
      ->check(CLI::IsMember({"tournament", "paper"}))
      ->capture_default_str();
  cli.add_option("--out", options.out,
                 "the calibration's file; default: the one that the server loads, by the "
                 "controller's serial number; other rods keep its values");
  cli.add_flag("--text", options.text, "on the terminal, without a window");
  cli.add_option("--size", size, "of the window, WxH")->capture_default_str();
  cli.add_option("--language", options.language, "instead of the one of the system")
      ->check(CLI::IsMember({"en", "ko", "de"}));
  cli.add_option("--screenshot", options.screenshot, "write a picture of the window, and exit");
  cli.add_option("--screenshot-at", options.screenshot_at, "... after so many seconds")
      ->check(draw::within(0.0, 1e6))
      ->capture_default_str();
  if (const auto parsed = draw::parse(cli, argc, argv); !parsed) {
    const draw::Leave& leave = parsed.error();
    if (leave.exit_code != 0) return fail(leave.exit_code, leave.text);
    std::printf("%s", leave.text.c_str());
    return kOk;
  }
  const auto pixels = draw::parse_size(size);
  if (!pixels) return fail(kUsage, pixels.error());
  options.size = *pixels;
  if (const auto good = draw::can_be_written("--screenshot", options.screenshot); !good)
    return fail(kUsage, good.error());
  if (options.rods.empty()) options.rods = {1, 2, 3, 4, 5, 6, 7, 8};
  std::ranges::sort(options.rods);
  options.rods.erase(std::unique(options.rods.begin(), options.rods.end()), options.rods.end());
  for (int& rod : options.rods) --rod;

  if (const std::string why = cabinet::why_no_device(options.device); !why.empty())
    return fail(kUsage, why);
  const std::string serial = cabinet::controller_serial(options.device);
  std::string path = options.out, before = path;
  if (path.empty() && options.device.rfind("file:", 0) == 0)
    return fail(
        kUsage,
        "A recording has no controller whose calibration could be stored: give a file with --out.");
  if (path.empty()) {
    const std::string folder = cabinet::calibrations_folder();
    if (folder.empty())
      return fail(kUsage,
                  "There is no home folder to store the calibration in: give a file with --out.");
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    path = cabinet::calibration_file(folder, serial);
    before = cabinet::kept_calibration(folder, serial);
  }
  cabinet::Calibration start = cabinet::nominal_calibration();
  std::error_code unknown;
  if (!before.empty() && std::filesystem::exists(before, unknown)) {
    auto loaded = cabinet::load_calibration(before);
    if (!loaded) return fail(kUsage, loaded.error());
    start = std::move(*loaded);
  }
  if (!serial.empty()) start.serial = serial;
  // Checked before an hour of work, not after.
  if (const auto good = draw::can_be_written("--out", path); !good)
    return fail(kUsage, good.error());
  auto device = cabinet::open_device(options.device, cabinet::nominal_calibration());
  if (!device) return fail(kUsage, device.error());
  client::use_language(options.language, catalogue_directory());
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { asked_to_leave = 1; });
  Run run(options, std::move(*device), std::move(path), std::move(start));
  return options.text ? Terminal(run).loop() : show(options, run);
}
