// The window, and what a person does in it as plain events.
#pragma once

#include <glm/vec2.hpp>
#include <memory>
#include <string>
#include <tl/expected.hpp>

#include "client/input_events.h"
#include "client/settings.h"
#include "draw/window.h"

namespace client {

class Window {
 public:
  static tl::expected<Window, draw::WindowError> open(const draw::WindowOptions& options);
  Window(Window&&) noexcept;
  Window& operator=(Window&&) noexcept;
  ~Window();

  bool should_close() const;
  void close();
  glm::ivec2 size() const;  // of the framebuffer [px]
  void swap();              // shows the frame; waits for the display's refresh
  void set_keys(const KeyBindings& keys);
  // What happened since the last call, mouse motion summed up.
  InputEvents poll();
  // Looks at the gamepad in between. It has no events, so a button is noticed if it is down at one
  // of these looks or at a poll; call it where a frame has taken a while.
  void look_at_pad();
  void wait(double seconds);  // until the window has news, at most so long
  bool captured() const;
  std::string renderer() const;  // name of the driver's, for the log
  bool draws_in_software() const;

  struct Impl;

 private:
  explicit Window(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace client
