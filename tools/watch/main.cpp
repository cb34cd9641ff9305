// space-foosball-watch: recorded matches in a window: watch, seek, slow motion, goals, any camera.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>

#include "draw/command_line.h"
#include "viewer.h"

namespace {

// Where ./play keeps what it writes.
std::string data_folder() {
  const char* data = std::getenv("XDG_DATA_HOME");
  if (data != nullptr && *data != '\0') return std::string(data) + "/space-foosball";
  const char* home = std::getenv("HOME");
  return home != nullptr && *home != '\0' ? std::string(home) + "/.local/share/space-foosball" : "";
}

}  // namespace

int main(int argc, char** argv) {
  watch::Options options;
  const std::string data = data_folder();
  if (!data.empty()) {
    options.folder = data + "/recordings";
    options.results = data + "/results.sqlite";
  }
  std::string view = "seat", size = "1280x720";
  CLI::App cli{
      "Shows recorded matches: the list of those that were played with the hall of fame, or one\n"
      "file. F1 names the keys.\n\nExit codes: 0 left; 1 failed; 2 a bad option or file; 4 no "
      "display.",
      "space-foosball-watch"};
  cli.add_option("FILE", options.file, "a recording, as --record writes it");
  cli.add_option("--folder", options.folder, "recordings of the list")->capture_default_str();
  cli.add_option("--results", options.results, "file of results")->capture_default_str();
  cli.add_option("--share-to", options.share_to, "folder that copies go to (key S)")
      ->capture_default_str();
  cli.add_flag("--share", options.share, "copy FILE there, print the copy's name, and leave");
  cli.add_option("--from", options.from, "begin after so many seconds")
      ->check(draw::within(0.0, 1e6));
  cli.add_option("--view", view, "seat, above, follow or spectator")
      ->check(CLI::IsMember({"seat", "above", "follow", "spectator"}));
  cli.add_option("--size", size, "of the window, WxH")->capture_default_str();
  cli.add_flag("--fullscreen", options.fullscreen, "take the whole screen");
  cli.add_flag("--mute", options.mute, "no sound");
  cli.add_flag("--keys", options.keys, "show the keys at once");
  cli.add_option("--screenshot", options.screenshot, "write a picture of the beginning, and leave");
  const auto parsed = draw::parse(cli, argc, argv);
  const auto pixels = draw::parse_size(size);
  tl::expected<void, draw::Leave> good = parsed;
  if (good && !pixels) good = tl::unexpected(draw::refuse(pixels.error()));
  if (good && options.share && options.file.empty())
    good = tl::unexpected(draw::refuse("--share wants the recording to copy: FILE."));
  if (!good) {
    const draw::Leave& leave = good.error();
    std::fprintf(leave.exit_code == 0 ? stdout : stderr, "%s%s%s",
                 leave.exit_code == 0 ? "" : "space-foosball-watch: ", leave.text.c_str(),
                 leave.exit_code == 0 ? "" : "\n");
    return leave.exit_code;
  }
  options.size = *pixels;
  for (int i = 0; const char* name : {"seat", "above", "follow", "spectator"}) {
    if (view == name) options.view = static_cast<client::View>(i);
    ++i;
  }
  return watch::run(options);
}
