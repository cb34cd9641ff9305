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
  std::optional<draw::Quality> quality;  // none: by what the machine can do
  glm::ivec2 size{1280, 720};
  std::string language;    // "" as the settings say, else en, ko or de
  std::string screenshot;  // of the first picture, then leave
};

// Exit code; sentences go to stderr.
int run(const Options& options);

}  // namespace watch
