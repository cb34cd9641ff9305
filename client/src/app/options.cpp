#include "app/options.h"

#include <CLI/CLI.hpp>
#include <fstream>
#include <sstream>

#include "draw/command_line.h"
#include "os/socket_address.h"
#include "wire/text.h"

namespace client {
namespace {

// Rods of the whole table, counted from 1 at -x: "1,2,4".
tl::expected<std::uint8_t, std::string> parse_rods(const std::string& text) {
  unsigned rods = 0;
  std::istringstream list(text.empty() ? "," : text);
  for (std::string rod; std::getline(list, rod, ',');) {
    if (rod.size() != 1 || rod[0] < '1' || rod[0] > '8') {
      return tl::unexpected(
          "--rods needs rods from 1 to 8, separated by commas, such as 1,2, not \"" + text + "\".");
    }
    rods |= 1u << (rod[0] - '1');
  }
  return static_cast<std::uint8_t>(rods);
}

}  // namespace

tl::expected<void, std::string> parse_server(const std::string& text, ConnectionOptions& into) {
  const auto parsed = os::parse_host_port(text);
  if (!parsed) {
    return tl::unexpected("--server needs HOST:PORT with a port from 1 to 65535, not \"" + text +
                          "\".");
  }
  if (!parsed->host.empty()) into.host = parsed->host;
  into.port = parsed->port.value_or(kDefaultPort);
  return {};
}

tl::expected<Options, draw::Leave> parse_options(int argc, const char* const* argv) {
  Options options;
  std::string server = "127.0.0.1:" + std::to_string(kDefaultPort), team = "0", size = "1280x720",
              quality = "auto", view;
  CLI::App cli(
      "Space Foosball: the renderer. Draws what the physics server simulates, and sends it the "
      "motions of your hands.\n"
      "\"space-foosball doctor\" lists the connected devices that can move rods.",
      "space-foosball");
  cli.add_option("--server", server, "the physics server, HOST:PORT")->capture_default_str();
  cli.add_option("--team", team, "0 or 1 to play, watch to watch only")
      ->capture_default_str()
      ->check(CLI::IsMember({"0", "1", "watch"}));
  std::string rods, password_file;
  cli.add_option("--rods", rods, "rods to play, of 1 to 8 from the left: 1,2 (all that are free)");
  cli.add_option("--password-file", password_file,
                 "its first line is the password of a server on another machine")
      ->check(CLI::ExistingFile);
  cli.add_option("--password", options.connection.password,
                 "the same; other users of this machine can see it here, unless it is given as "
                 "SPACE_FOOSBALL_PASSWORD")
      ->envname("SPACE_FOOSBALL_PASSWORD");
  cli.add_flag("--host", options.connection.as_host, "the password is the host's");
  cli.add_option("--name", options.names,
                 "your name in results and ratings, instead of the one in the settings; for "
                 "several people at this window: Ann,Ben")
      ->delimiter(',')
      ->expected(1)
      ->take_all();
  cli.add_flag(
      "--cabinet-gamepads", options.cabinet_gamepads,
      "also use the gamepads of a cabinet's controller, with a server that does not read its rods");
  cli.add_option("--seconds", options.seconds, "exit after this time, in seconds")
      ->check(draw::within(0.1, 1e6));
  cli.add_flag("--until-server-ends", options.until_server_ends,
               "exit when the physics server ends, instead of waiting for it");
  cli.add_option("--screenshot", options.screenshot, "write a picture to FILE.png, at the end");
  cli.add_option("--screenshot-at", options.screenshot_at, "... or after this time, in seconds")
      ->check(draw::within(0.0, 1e6));
  cli.add_option("--size", size, "of the window, WxH")->capture_default_str();
  cli.add_flag("--fullscreen", options.fullscreen, "use the whole screen");
  cli.add_option("--quality", quality, "low, high or auto (by the frame rate reached)")
      ->capture_default_str()
      ->check(CLI::IsMember({"low", "high", "auto"}));
  cli.add_option("--view", view,
                 "seat, above (a cabinet's screen), follow or spectator, instead of the one in the "
                 "settings")
      ->check(CLI::IsMember({"seat", "above", "follow", "spectator"}));
  cli.add_flag("--mute", options.mute, "no sound");
  cli.add_flag("--fps", options.show_fps, "show the frame rate");
  cli.add_option("--stats-file", options.stats_file, "write statistics as JSON to FILE at the end");
  cli.add_option("--font-dir", options.font_directory,
                 "folder of DejaVuSans.ttf and DejaVuSans-Bold.ttf")
      ->check(CLI::ExistingDirectory);
  cli.footer(
      "Exit codes: 0 done, 1 failed, 2 bad option, 4 no display.\n"
      "Keys: 1-4 choose a rod, wheel next rod, Tab nearest rod, arrows or WASD slide and spin,\n"
      "Space pushes (starts, confirms), P pauses, C changes the camera, in training F serves\n"
      "the ball to the next man of the controlled rod, F2 or O opens the settings,\n"
      "F1 or H shows the keys, Esc releases the mouse, again Esc leaves. Settings are stored in\n"
      "$XDG_CONFIG_HOME/space-foosball/client.conf, or ~/.config/space-foosball/client.conf.");
  if (auto parsed = draw::parse(cli, argc, argv); !parsed) return tl::unexpected(parsed.error());
  if (const auto good = parse_server(server, options.connection); !good)
    return tl::unexpected(draw::refuse(good.error()));
  if (cli.get_option("--rods")->count() > 0) {
    const auto wanted_rods = parse_rods(rods);
    if (!wanted_rods) return tl::unexpected(draw::refuse(wanted_rods.error()));
    options.connection.rods = *wanted_rods;
  }
  if (!password_file.empty()) {
    std::ifstream file(password_file);
    std::getline(file, options.connection.password);
  }
  const auto pixels = draw::parse_size(size);
  if (!pixels) return tl::unexpected(draw::refuse(pixels.error()));
  options.size = *pixels;
  if (options.names.size() > kNamedPeople)
    return tl::unexpected(draw::refuse("--name: at most " + std::to_string(kNamedPeople) +
                                       " people have names at one window."));
  for (std::string& name : options.names) {
    if (name.find_first_not_of(" \t") == name.npos || name.size() > wire::kMaxName)
      return tl::unexpected(draw::refuse("--name needs names of 1 to 64 bytes each."));
    name = wire::clean_name(name);
  }
  if (options.screenshot_at && options.screenshot.empty())
    return tl::unexpected(draw::refuse("--screenshot-at needs --screenshot FILE.png too."));
  for (const auto& written : {draw::can_be_written("--stats-file", options.stats_file),
                              draw::can_be_written("--screenshot", options.screenshot)}) {
    if (!written) return tl::unexpected(draw::refuse(written.error()));
  }
  options.connection.team =
      team == "watch" ? wire::kWatchOnly : static_cast<std::uint8_t>(team == "1");
  if (!view.empty()) {
    for (int i = 0; i < kViews; ++i) {
      constexpr std::array<const char*, kViews> kNames{"seat", "above", "follow", "spectator"};
      if (view == kNames[static_cast<std::size_t>(i)]) options.view = static_cast<View>(i);
    }
  }
  if (quality != "auto")
    options.quality = quality == "high" ? draw::Quality::high : draw::Quality::low;
  return options;
}

}  // namespace client
