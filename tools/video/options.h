// The command line of space-foosball-video.
#pragma once

#include <optional>
#include <string>
#include <tl/expected.hpp>

#include "client/settings.h"
#include "draw/command_line.h"
#include "draw/quality.h"
#include "encoder.h"

namespace video {

struct Options {
  std::string recording;
  EncoderOptions encoder;
  draw::Quality quality = draw::Quality::high;
  int team = 0;  // side of the camera
  client::View view = client::View::seat;
  double from = 0.0;         // [s] of the recording
  std::optional<double> to;  // [s]; none: to its end
  bool mute = false;
};

tl::expected<Options, draw::Leave> parse_options(int argc, const char* const* argv);

}  // namespace video
