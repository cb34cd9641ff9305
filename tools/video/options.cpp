#include "options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>

namespace video {

tl::expected<Options, draw::Leave> parse_options(int argc, const char* const* argv) {
  Options options;
  std::string size = "1280x720", quality = "high", view = "seat";
  CLI::App cli(
      "Draws a recorded match into a video, frame by frame, however long that takes: the picture "
      "is\n"
      "that of the game, and no frame is left out. Exit codes: 0 done; 1 failed; 2 a bad option "
      "or\n"
      "file; 4 no display.",
      "space-foosball-video");
  cli.add_option("RECORDING", options.recording, "a match, as --record writes it")->required();
  cli.add_option("VIDEO", options.encoder.path, "the file to write: *.mp4, *.mkv or *.webm")
      ->required();
  cli.add_option("--from", options.from, "start at this time of the recording, in seconds")
      ->check(draw::within(0.0, 1e6));
  cli.add_option("--to", options.to, "end at this time of the recording, in seconds")
      ->check(draw::within(0.001, 1e6));
  cli.add_option("--fps", options.encoder.frames_per_second, "frames a second")
      ->capture_default_str()
      ->check(CLI::Range(1, 240));
  cli.add_option("--size", size, "of the picture, WxH, both even")->capture_default_str();
  cli.add_option("--quality", quality, "low or high")
      ->capture_default_str()
      ->check(CLI::IsMember({"low", "high"}));
  cli.add_option("--team", options.team, "the side that the camera stands on")
      ->capture_default_str()
      ->check(CLI::IsMember({0, 1}));
  cli.add_option("--view", view, "seat, above, follow or spectator")
      ->capture_default_str()
      ->check(CLI::IsMember({"seat", "above", "follow", "spectator"}));
  cli.add_flag("--mute", options.mute, "no sound");
  if (auto parsed = draw::parse(cli, argc, argv); !parsed) return tl::unexpected(parsed.error());
  const auto pixels = draw::parse_size(size);
  if (!pixels) return tl::unexpected(draw::refuse(pixels.error()));
  // The codecs store one colour for each four pixels.
  if (pixels->x % 2 != 0 || pixels->y % 2 != 0)
    return tl::unexpected(draw::refuse("--size needs an even width and height, not " + size + "."));
  options.encoder.size = *pixels;
  constexpr std::array<const char*, client::kViews> kNames{"seat", "above", "follow", "spectator"};
  options.view =
      static_cast<client::View>(std::ranges::find(kNames, view) - std::ranges::begin(kNames));
  options.quality = quality == "high" ? draw::Quality::high : draw::Quality::low;
  if (options.to && *options.to <= options.from)
    return tl::unexpected(draw::refuse("--to must come after --from."));
  if (const auto codec = codec_for(options.encoder.path); !codec)
    return tl::unexpected(draw::refuse(codec.error()));
  if (const auto good = draw::can_be_written("VIDEO", options.encoder.path); !good)
    return tl::unexpected(draw::refuse(good.error()));
  return options;
}

}  // namespace video
