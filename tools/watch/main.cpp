// space-foosball-watch: recorded matches in a window: watch, seek, slow motion, goals, any camera.
#include <CLI/CLI.hpp>
#include <cstdio>

#include "draw/command_line.h"
#include "server/exit_code.h"
#include "server/recordings.h"
#include "share.h"
#include "viewer.h"

namespace {

int leave(const draw::Leave& leave) {
  const bool good = leave.exit_code == 0;
  std::fprintf(good ? stdout : stderr, "%s%s%s",
               good ? "" : "space-foosball-watch: ", leave.text.c_str(), good ? "" : "\n");
  return leave.exit_code;
}

int share(const std::string& file, const std::string& folder) {
  const auto copied = watch::share(file, folder);
  if (copied) {
    std::printf("%s\n", copied->c_str());
    return server::kExitOk;
  }
  std::fprintf(stderr, "space-foosball-watch: %s\n", copied.error().c_str());
  return server::kExitFailed;
}

int list(const std::string& folder) {
  const auto recordings = server::list_recordings(folder);
  if (!recordings) {
    std::fprintf(stderr, "space-foosball-watch: %s\n", recordings.error().c_str());
    return server::kExitFailed;
  }
  for (const server::RecordingSummary& one : *recordings) {
    if (one.state == server::RecordingSummary::State::bad) {
      std::printf("%s\n", one.problem.c_str());
      continue;
    }
    std::printf("%s  %s %d : %d %s, %.1f s%s\n", one.path.c_str(), one.characters[0].c_str(),
                one.standing.score[0], one.standing.score[1], one.characters[1].c_str(),
                1e-3 * static_cast<double>(one.ticks), one.kept ? ", kept" : "");
  }
  return server::kExitOk;
}

}  // namespace

int main(int argc, char** argv) {
  watch::Options options;
  options.session.folder = server::recordings_folder();
  options.session.share_to = watch::shared_folder();
  std::string view = "seat", size = "1280x720", quality;
  bool share_file = false, list_folder = false;
  CLI::App cli{
      "Shows recorded matches: the list of them, or one file. F1 shows the keys.\n\n"
      "Exit codes: 0 left; 1 failed; 2 a bad option or file; 4 no display.",
      "space-foosball-watch"};
  cli.add_option("FILE", options.session.file, "a recording, as --record writes it");
  auto* folder = cli.add_option("--folder", options.session.folder, "recordings of the list");
  cli.add_option("--share-to", options.session.share_to, "folder that copies go to (key S)")
      ->capture_default_str();
  cli.add_flag("--share", share_file, "copy FILE there, print the copy's name, and exit");
  cli.add_flag("--list", list_folder, "print the list, and exit");
  cli.add_option("--from", options.session.from, "start at this time, in seconds")
      ->check(draw::within(0.0, 1e6));
  cli.add_flag("--paused", options.paused, "start paused");
  cli.add_option("--view", view, "seat, above, follow or spectator")
      ->check(CLI::IsMember({"seat", "above", "follow", "spectator"}));
  cli.add_option("--size", size, "of the window, WxH")->capture_default_str();
  cli.add_option("--quality", quality, "low or high")->check(CLI::IsMember({"low", "high"}));
  cli.add_option("--language", options.language, "instead of the one in the settings")
      ->check(CLI::IsMember({"en", "ko", "de"}));
  cli.add_flag("--fullscreen", options.fullscreen, "use the whole screen");
  cli.add_flag("--mute", options.mute, "no sound");
  cli.add_flag("--keys", options.keys, "show the keys at once");
  cli.add_flag("--say-state", options.say_state, "print the displayed state whenever it changes");
  cli.add_option("--screenshot", options.screenshot, "write a picture of the beginning, and exit");
  if (const auto parsed = draw::parse(cli, argc, argv); !parsed) return leave(parsed.error());
  const auto pixels = draw::parse_size(size);
  if (!pixels) return leave(draw::refuse(pixels.error()));
  if (const auto good = draw::can_be_written("--screenshot", options.screenshot); !good)
    return leave(draw::refuse(good.error()));
  if (share_file && options.session.file.empty())
    return leave(draw::refuse("--share needs the recording to copy: FILE."));
  if (share_file) return share(options.session.file, options.session.share_to);
  if (list_folder) return list(options.session.folder);
  if (options.session.folder.empty() && options.session.file.empty())
    return leave(
        draw::refuse("There is no home folder with recordings: give a folder with --folder."));
  // A single file: closing it ends the program.
  if (!options.session.file.empty() && folder->count() == 0) options.session.folder.clear();
  options.size = *pixels;
  if (!quality.empty())
    options.quality = quality == "high" ? draw::Quality::high : draw::Quality::low;
  for (int i = 0; const char* name : {"seat", "above", "follow", "spectator"}) {
    if (view == name) options.session.view = static_cast<client::View>(i);
    ++i;
  }
  return watch::run(options);
}
