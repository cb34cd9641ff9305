#include "app/window.h"

#include "app/pads.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace client {

struct Window::Impl {
  Impl(draw::Window opened, bool cabinet_gamepads)
      : window(std::move(opened)), handle(window.handle()), pads(cabinet_gamepads) {}

  draw::Window window;
  GLFWwindow* handle;
  InputCollector input;
  Pads pads;
  bool captured = false;
  double last_x = 0, last_y = 0;
  bool have_last = false, close_asked = false;

  void capture(bool on) {
    captured = on;
    have_last = false;
    glfwSetInputMode(handle, GLFW_CURSOR, on ? GLFW_CURSOR_DISABLED : GLFW_CURSOR_NORMAL);
    if (glfwRawMouseMotionSupported()) glfwSetInputMode(handle, GLFW_RAW_MOUSE_MOTION, on);
  }
  void pressed(int key);
  void moved(double x, double y);
};

namespace {

Window::Impl& impl_of(GLFWwindow* handle);

}  // namespace

void Window::Impl::pressed(int key) {
  if (key == GLFW_KEY_ESCAPE) {
    if (!captured) input.back();
    if (captured) capture(false);
    return;
  }
  input.key(key, true);
}

void Window::Impl::moved(double x, double y) {
  if (captured && have_last) input.mouse_moved(x - last_x, last_y - y);
  last_x = x;
  last_y = y;
  have_last = true;
}

tl::expected<Window, draw::WindowError> Window::open(const draw::WindowOptions& options,
                                                     bool cabinet_gamepads) {
  auto opened = draw::Window::open(options);
  if (!opened) return tl::unexpected(opened.error());
  auto impl = std::make_unique<Impl>(std::move(*opened), cabinet_gamepads);
  GLFWwindow* handle = impl->handle;
  glfwSetWindowUserPointer(handle, impl.get());
  glfwSetKeyCallback(handle, [](GLFWwindow* w, int key, int, int action, int) {
    if (action == GLFW_PRESS) impl_of(w).pressed(key);
    if (action == GLFW_RELEASE) impl_of(w).input.key(key, false);
  });
  glfwSetCharCallback(handle,
                      [](GLFWwindow* w, unsigned letter) { impl_of(w).input.letter(letter); });
  glfwSetCursorPosCallback(handle,
                           [](GLFWwindow* w, double x, double y) { impl_of(w).moved(x, y); });
  glfwSetScrollCallback(handle,
                        [](GLFWwindow* w, double, double steps) { impl_of(w).input.wheel(steps); });
  glfwSetMouseButtonCallback(handle, [](GLFWwindow* w, int, int action, int) {
    if (action != GLFW_PRESS) return;
    if (impl_of(w).captured) {
      impl_of(w).input.click();
    } else {
      impl_of(w).capture(true);  // the click that captures the pointer does nothing else
    }
  });
  glfwSetWindowFocusCallback(handle, [](GLFWwindow* w, int focused) {
    if (focused) return;
    impl_of(w).capture(false);
    impl_of(w).input.release_keys();
  });
  return Window(std::move(impl));
}

namespace {
Window::Impl& impl_of(GLFWwindow* handle) {
  return *static_cast<Window::Impl*>(glfwGetWindowUserPointer(handle));
}
}  // namespace

Window::Window(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Window::Window(Window&&) noexcept = default;
Window& Window::operator=(Window&&) noexcept = default;
Window::~Window() = default;

bool Window::should_close() const {
  return impl_->close_asked || impl_->window.should_close();
}
void Window::close() {
  impl_->close_asked = true;
}
void Window::set_visible(bool visible) {
  const bool fullscreen = glfwGetWindowMonitor(impl_->handle) != nullptr;
  if (!visible) impl_->capture(false);
  if (!visible) impl_->input.release_keys();
  if (fullscreen) {
    visible ? glfwRestoreWindow(impl_->handle) : glfwIconifyWindow(impl_->handle);
  } else {
    visible ? glfwShowWindow(impl_->handle) : glfwHideWindow(impl_->handle);
  }
  if (visible) glfwFocusWindow(impl_->handle);
}
bool Window::captured() const {
  return impl_->captured;
}

glm::ivec2 Window::size() const {
  return impl_->window.size();
}

void Window::wait(double seconds) {
  impl_->window.wait(seconds);
}

void Window::swap() {
  impl_->window.swap();
}

void Window::set_keys(const KeyBindings& keys) {
  impl_->input.set_keys(keys);
}

void Window::poll() {
  impl_->window.poll();
  impl_->pads.poll(impl_->input);
}

void Window::forget_input() {
  impl_->input.clear();
}

const InputCollector& Window::input() const {
  return impl_->input;
}
void Window::rumble(int pad, float strength, std::uint16_t ms) {
  impl_->pads.rumble(pad, strength, ms);
}

std::vector<std::string> Window::take_messages() {
  return impl_->pads.take_messages();
}

std::string Window::renderer() const {
  return impl_->window.renderer();
}
bool Window::draws_in_software() const {
  return impl_->window.draws_in_software();
}

}  // namespace client
