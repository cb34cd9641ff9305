// The window: GLFW with an OpenGL ES 3.0 context, and what a person does in it as plain events.
#pragma once

#include <functional>
#include <glm/vec2.hpp>
#include <memory>
#include <string>
#include <tl/expected.hpp>

#include "client/input_events.h"

struct GLFWwindow;

namespace client {

struct WindowOptions {
  glm::ivec2 size{1280, 720};
  bool fullscreen = false;
  std::string title = "Space Foosball";
};

struct WindowError {
  std::string sentence;
};

class Window {
 public:
  static tl::expected<Window, WindowError> open(const WindowOptions& options);
  Window(Window&&) noexcept;
  Window& operator=(Window&&) noexcept;
  ~Window();

  bool should_close() const;
  void close();
  glm::ivec2 size() const;  // of the framebuffer [px]
  void swap();              // shows the frame; waits for the display's refresh
  // What happened since the last call, mouse motion summed up.
  InputEvents poll();
  void wait(double seconds);  // until the window has news, at most so long
  bool captured() const;
  // Name of the driver's renderer, for the log and the choice of quality.
  std::string renderer() const;

  struct Impl;

 private:
  explicit Window(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace client
