#include "app/options.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <glm/trigonometric.hpp>
#include <sstream>

#include "scenes/catalogue.h"

namespace sandbox {
namespace {

constexpr double kLongest = 1e6;  // [s]

// "YAW,PITCH" in degrees, or with ",DISTANCE" as a fraction of the distance that shows all.
tl::expected<glm::dvec3, std::string> parse_look(const std::string& text) {
  std::istringstream in(text);
  glm::dvec3 look{0.0, 0.0, 1.0};
  char comma = ',', second = ',';
  in >> look.x >> comma >> look.y;
  if (in && !in.eof()) in >> second >> look.z;
  const bool good = !in.fail() && (in.eof() || in.peek() == std::char_traits<char>::eof()) &&
                    comma == ',' && second == ',' && std::abs(look.x) <= 360.0 &&
                    std::abs(look.y) < 90.0 && look.z >= 0.01 && look.z <= 100.0;
  if (good) return glm::dvec3(glm::radians(look.x), glm::radians(look.y), look.z);
  return tl::unexpected(
      "--look needs YAW,PITCH or YAW,PITCH,DISTANCE: degrees, the pitch between -90 and 90, and a "
      "factor from 0.01 to 100, not \"" +
      text + "\".");
}

tl::expected<void, std::string> fit_together(const Options& options) {
  if (options.screenshot_at && options.screenshot.empty())
    return tl::make_unexpected(std::string("--screenshot-at needs --screenshot FILE.png too."));
  if (options.no_window && !options.screenshot.empty())
    return tl::make_unexpected(std::string("--screenshot needs a window: omit --no-window."));
  if (options.no_window && options.skip_to > 0.0)
    return tl::make_unexpected(std::string("--skip-to needs a window: omit --no-window."));
  if (options.seconds && options.skip_to > *options.seconds)
    return tl::make_unexpected(
        std::string("--skip-to is later than --seconds: nothing would be shown."));
  if (options.no_window && options.paused)
    return tl::make_unexpected(
        std::string("--paused needs a window, to continue from: omit --no-window."));
  for (const auto& written : {draw::can_be_written("--stats-file", options.stats_file),
                              draw::can_be_written("--screenshot", options.screenshot)}) {
    if (!written) return written;
  }
  return {};
}

}  // namespace

std::string scene_list() {
  std::size_t widest = 0;
  for (const scenes::Entry& entry : scenes::catalogue())
    widest = std::max(widest, entry.name.size());
  std::string out;
  const auto line = [&](std::string_view name, std::string_view what) {
    out.append(name).append(widest + 2 - name.size(), ' ').append(what).append("\n");
  };
  for (const scenes::Entry& entry : scenes::catalogue()) line(entry.name, entry.what);
  line("heapN", "N boxes poured into a pit, 1 to 1000000");
  out.pop_back();
  return out;
}

tl::expected<Options, draw::Leave> parse_options(int argc, const char* const* argv) {
  Options options;
  bool list = false, contacts = false;
  std::string size = "1280x720", quality = "auto", look;
  CLI::App cli("Virtual Physics: shows a scene and lets you drag its bodies.", "vphysics-sandbox");
  cli.add_option("SCENE,--scene", options.scene, "one of --list")->capture_default_str();
  cli.add_flag("--list", list, "print the scenes");
  cli.add_option("--rate", options.rate, "steps a second, 10 to 10000")
      ->capture_default_str()
      ->check(draw::within(Simulation::kMinRate, Simulation::kMaxRate));
  cli.add_option("--speed", options.speed, "factor of real time, 0.01 to 10")
      ->capture_default_str()
      ->check(draw::within(0.01, 10.0));
  cli.add_flag("--paused", options.paused, "start paused");
  cli.add_option("--skip-to", options.skip_to,
                 "start showing at this time of the scene, in seconds")
      ->check(draw::within(0.0, kLongest));
  cli.add_option("--seconds", options.seconds, "exit at this time of the scene, in seconds")
      ->check(draw::within(0.001, kLongest));
  cli.add_flag("--no-window", options.no_window,
               "no window: run to the end at full speed, and print the statistics");
  cli.add_option("--screenshot", options.screenshot, "write a picture to FILE.png, at the end");
  cli.add_option("--screenshot-at", options.screenshot_at,
                 "... or at this time of the scene, in seconds")
      ->check(draw::within(0.0, kLongest));
  cli.add_option("--look", look, "camera direction YAW,PITCH[,DISTANCE], e.g. -60,25,0.8");
  vp::DebugDrawOptions& marks = options.view.marks;
  cli.add_flag("--contacts", contacts, "draw contact points and normals");
  cli.add_flag("--impulses", marks.impulses, "draw the contact impulses of the last step");
  cli.add_flag("--frames", marks.frames, "draw the bodies' axes");
  cli.add_flag("--centres", marks.centres, "draw the centres of mass");
  cli.add_flag("--joints", marks.joints, "draw the joints and their axes");
  cli.add_flag("--bounds", marks.bounds, "draw the bounds of the shapes");
  cli.add_flag("--wires", marks.shapes, "draw the edges of the shapes");
  cli.add_flag("--no-panel", options.no_panel, "no panel");
  cli.add_option("--size", size, "of the window, WxH")->capture_default_str();
  cli.add_flag("--fullscreen", options.fullscreen, "use the whole screen");
  cli.add_option("--quality", quality, "low, high or auto (low where there is no GPU)")
      ->capture_default_str()
      ->check(CLI::IsMember({"low", "high", "auto"}));
  cli.add_option("--stats-file", options.stats_file, "write statistics as JSON to FILE at the end");
  cli.add_option("--font-dir", options.font_directory, "folder of DejaVuSans.ttf")
      ->check(CLI::ExistingDirectory);
  cli.footer(
      "Exit codes: 0 done, 1 failed, 2 bad option or scene, 4 no display.\n"
      "Mouse: left drags a body, or rotates the view on the background; right pans, the wheel "
      "zooms.\n"
      "Keys: Space pauses, S steps once, R restarts, 1 2 3 step at 60, 240, 1000 Hz, - and +\n"
      "slow down and speed up, N and B show the next and the previous scene, C contacts, I "
      "impulses,\n"
      "F frames, M centres of mass, J joints, X bounds, W wires, V colours by speed, T throws a\n"
      "body, Home shows all, Tab hides the panel, Esc leaves.");
  if (auto parsed = draw::parse(cli, argc, argv); !parsed) return tl::unexpected(parsed.error());
  if (list) return tl::unexpected(draw::Leave{0, scene_list()});
  marks.contacts = marks.normals = contacts;
  const auto pixels = draw::parse_size(size);
  if (!pixels) return tl::unexpected(draw::refuse(pixels.error()));
  options.size = *pixels;
  if (!look.empty()) {
    const auto parsed = parse_look(look);
    if (!parsed) return tl::unexpected(draw::refuse(parsed.error()));
    options.look = *parsed;
  }
  if (const auto good = fit_together(options); !good)
    return tl::unexpected(draw::refuse(good.error()));
  if (quality != "auto")
    options.quality = quality == "high" ? draw::Quality::high : draw::Quality::low;
  return options;
}

}  // namespace sandbox
