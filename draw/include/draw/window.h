// The window: GLFW with an OpenGL ES 3.0 context. Its owner handles keys and mouse.
#pragma once

#include <glm/vec2.hpp>
#include <memory>
#include <string>
#include <tl/expected.hpp>

struct GLFWwindow;

namespace draw {

struct WindowOptions {
  glm::ivec2 size{1280, 720};
  bool fullscreen = false;
  std::string title = "Virtual Physics";
  std::string otherwise = "ask for no window";  // advice for a machine without a display
  bool visible = true;                          // false: for pictures that are read back
};

struct WindowError {
  std::string sentence;
};

class Window {
 public:
  static tl::expected<Window, WindowError> open(const WindowOptions& options);
  Window(Window&&) noexcept = default;
  Window& operator=(Window&&) = delete;  // the old window would outlive GLFW
  ~Window() = default;

  // The owner may set callbacks and the user pointer.
  GLFWwindow* handle() const { return handle_.get(); }
  bool should_close() const;
  glm::ivec2 size() const;         // of the framebuffer [px]
  void swap();                     // shows the frame; waits for the display's refresh
  void poll();                     // calls the callbacks of pending events
  void wait(double seconds);       // until the window has events, at most for this time
  std::string renderer() const;    // name of the driver
  bool draws_in_software() const;  // judged by that name

 private:
  // Initialises GLFW, for as long as there is a window.
  struct Library {
    Library();
    ~Library();
    Library(const Library&) = delete;
    Library& operator=(const Library&) = delete;
    bool good = false;
  };
  struct Destroy {
    void operator()(GLFWwindow* handle) const;
  };
  Window(std::unique_ptr<Library> library, GLFWwindow* handle);

  std::unique_ptr<Library> library_;
  std::unique_ptr<GLFWwindow, Destroy> handle_;
};

}  // namespace draw
