// The command line of space-foosball.
#pragma once

#include <glm/vec2.hpp>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "client/connection.h"
#include "client/settings.h"
#include "draw/command_line.h"
#include "draw/quality.h"

namespace client {

struct Options {
  ConnectionOptions connection;
  glm::ivec2 size{1280, 720};
  bool fullscreen = false;
  std::optional<View> view;  // none: as the settings say
  bool mute = false;
  bool show_fps = false;
  bool cabinet_gamepads = false;         // a cabinet's, whose server has its rods otherwise
  bool until_server_ends = false;        // leave when the server says good-bye, else wait for it
  std::optional<draw::Quality> quality;  // none: picked by what the machine can do
  std::optional<double> seconds;         // play so long, then leave
  std::optional<double> screenshot_at;   // none: at the end
  std::string screenshot, stats_file, font_directory;
  // Of the people at this window; those that are not given are as the settings say.
  std::vector<std::string> names;
};

tl::expected<Options, draw::Leave> parse_options(int argc, const char* const* argv);

// "HOST:PORT", "HOST" or ":PORT"; the error is a sentence.
tl::expected<void, std::string> parse_server(const std::string& text, ConnectionOptions& into);

}  // namespace client
