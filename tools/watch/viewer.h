// The window in which recordings are chosen and watched.
#pragma once

#include <optional>
#include <string>

#include "draw/quality.h"
#include "session.h"

namespace watch {

struct Options {
  SessionOptions session;
  bool fullscreen = false, mute = false, keys = false, paused = false, say_state = false;
  std::optional<draw::Quality> quality;  // none: chosen by what the machine can draw
  glm::ivec2 size{1280, 720};
  std::string language;    // "" as in the settings, else en, ko or de
  std::string screenshot;  // of the first picture, then exit
};

// Returns the exit code; prints errors to stderr.
int run(const Options& options);

}  // namespace watch
