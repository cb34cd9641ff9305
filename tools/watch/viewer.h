// The window in which recordings are chosen and watched.
#pragma once

#include <optional>
#include <string>

#include "client/settings.h"
#include "draw/quality.h"

#include <glm/vec2.hpp>

namespace watch {

struct Options {
  std::string file;             // watched at once; empty: the list first
  std::string folder, results;  // of the list; may be empty
  std::string share_to = ".";   // folder that copies go to
  double from = 0.0;            // [s] of the recording
  client::View view = client::View::seat;
  bool fullscreen = false, mute = false, share = false, keys = false;
  glm::ivec2 size{1280, 720};
  std::string screenshot;  // of the first picture at `from`, then leave
};

// Exit code; sentences go to stderr.
int run(const Options& options);

}  // namespace watch
