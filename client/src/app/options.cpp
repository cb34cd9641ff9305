#include "app/options.h"

#include <CLI/CLI.hpp>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace client {
namespace {

bool read_number(std::string_view text, int low, int high, int& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && value >= low && value <= high;
}

Leave refuse(const std::string& sentence) {
  return {2, sentence + " See --help."};
}

// A number within the range; unlike CLI::Range it does not take "nan" for one.
CLI::Validator within(double low, double high) {
  return CLI::Validator(
      [low, high](const std::string& text) {
        double value = std::nan("");
        const bool number = CLI::detail::lexical_cast(text, value);
        if (number && value >= low && value <= high) return std::string();
        std::ostringstream sentence;
        sentence << "\"" << text << "\" is no number from " << low << " to " << high;
        return sentence.str();
      },
      "NUMBER");
}

// What is written at the end is refused at the start where it cannot be. Only trying tells: of a
// file system that is full of promises (/proc) or read-only, the permissions say nothing.
tl::expected<void, std::string> can_be_written(const char* option, const std::string& path) {
  std::error_code none;
  const auto status = std::filesystem::status(path, none);
  const bool there = std::filesystem::exists(status);
  if (path.empty() || (there && !std::filesystem::is_regular_file(status) &&
                       !std::filesystem::is_directory(status)))
    return {};  // a device or a pipe: to open it may do something
  errno = 0;
  const bool good = std::ofstream(path, std::ios::app).is_open();
  const std::string why = std::strerror(errno);
  if (good && !there) std::filesystem::remove(path, none);
  if (good) return {};
  return tl::unexpected(std::string(option) + " cannot write to \"" + path + "\" (" + why +
                        "): name a file in a folder that can be written to.");
}

}  // namespace

tl::expected<void, std::string> parse_server(const std::string& text, ConnectionOptions& into) {
  const auto colon = text.rfind(':');
  const std::string host = text.substr(0, colon);
  int port = kDefaultPort;
  const bool good = colon == std::string::npos ||
                    read_number(std::string_view(text).substr(colon + 1), 1, 65535, port);
  if (text.empty() || !good || host.find(':') != std::string::npos) {
    return tl::unexpected("--server wants HOST:PORT with a port from 1 to 65535, not \"" + text +
                          "\".");
  }
  if (!host.empty()) into.host = host;
  into.port = static_cast<std::uint16_t>(port);
  return {};
}

tl::expected<glm::ivec2, std::string> parse_size(const std::string& text) {
  const auto x = text.find('x');
  glm::ivec2 size{0, 0};
  if (x == std::string::npos ||
      !read_number(std::string_view(text).substr(0, x), 160, 16384, size.x) ||
      !read_number(std::string_view(text).substr(x + 1), 120, 16384, size.y)) {
    return tl::unexpected("--size wants WxH in pixels, at least 160x120, not \"" + text + "\".");
  }
  return size;
}

tl::expected<Options, Leave> parse_options(int argc, const char* const* argv) {
  Options options;
  std::string server = "127.0.0.1:" + std::to_string(kDefaultPort), team = "0", size = "1280x720",
              quality = "auto";
  CLI::App cli(
      "Space Foosball: the renderer. Draws what the physics server simulates, and sends it your "
      "hands.",
      "space-foosball");
  cli.add_option("--server", server, "the physics server, HOST:PORT")->capture_default_str();
  cli.add_option("--team", team, "0 or 1 to play, watch to look on")
      ->capture_default_str()
      ->check(CLI::IsMember({"0", "1", "watch"}));
  cli.add_option("--name", options.connection.name, "your name, for the server's log")
      ->capture_default_str();
  cli.add_option("--seconds", options.seconds, "leave after so many seconds")
      ->check(within(0.1, 1e6));
  cli.add_flag("--until-server-ends", options.until_server_ends,
               "leave when the physics server ends, instead of waiting for it");
  cli.add_option("--screenshot", options.screenshot, "write a picture to FILE.png, at the end");
  cli.add_option("--screenshot-at", options.screenshot_at, "... or after so many seconds")
      ->check(within(0.0, 1e6));
  cli.add_option("--size", size, "of the window, WxH")->capture_default_str();
  cli.add_flag("--fullscreen", options.fullscreen, "take the whole screen");
  cli.add_option("--quality", quality, "low, high or auto (by the frame rate reached)")
      ->capture_default_str()
      ->check(CLI::IsMember({"low", "high", "auto"}));
  cli.add_flag("--mute", options.mute, "no sound");
  cli.add_flag("--fps", options.show_fps, "show the frame rate");
  cli.add_option("--stats-file", options.stats_file, "write figures as JSON to FILE at the end");
  cli.add_option("--font-dir", options.font_directory,
                 "where DejaVuSans.ttf and DejaVuSans-Bold.ttf are")
      ->check(CLI::ExistingDirectory);
  cli.footer(
      "Exit codes: 0 done, 1 failed, 2 bad option, 4 no display.\n"
      "Keys: 1-4 choose a rod, wheel next rod, Tab nearest rod, arrows or WASD slide and spin,\n"
      "Space pushes (starts, confirms), P pauses, F1 or H shows the keys, Esc releases the mouse,\n"
      "again Esc leaves.");
  try {
    cli.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() != 0) return tl::unexpected(refuse(std::string(e.what()) + "."));
    std::ostringstream out, err;
    cli.exit(e, out, err);
    return tl::unexpected(Leave{0, out.str()});
  }
  if (const auto good = parse_server(server, options.connection); !good)
    return tl::unexpected(refuse(good.error()));
  const auto pixels = parse_size(size);
  if (!pixels) return tl::unexpected(refuse(pixels.error()));
  options.size = *pixels;
  if (options.connection.name.size() > 64)
    return tl::unexpected(refuse("--name may have at most 64 bytes."));
  if (options.screenshot_at && options.screenshot.empty())
    return tl::unexpected(refuse("--screenshot-at wants --screenshot FILE.png too."));
  for (const auto& written : {can_be_written("--stats-file", options.stats_file),
                              can_be_written("--screenshot", options.screenshot)}) {
    if (!written) return tl::unexpected(refuse(written.error()));
  }
  options.connection.team =
      team == "watch" ? wire::kWatchOnly : static_cast<std::uint8_t>(team == "1");
  if (quality != "auto") options.quality = quality == "high" ? Quality::high : Quality::low;
  return options;
}

}  // namespace client
