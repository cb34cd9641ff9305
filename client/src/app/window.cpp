#include "app/window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <cmath>
#include <utility>

namespace client {

struct Window::Impl {
  explicit Impl(draw::Window opened) : window(std::move(opened)), handle(window.handle()) {}

  draw::Window window;
  GLFWwindow* handle;
  InputEvents events;
  bool captured = false;
  double last_x = 0, last_y = 0, wheel = 0;
  bool have_last = false, close_asked = false;
  bool pad_push_held = false, pad_pause_held = false;

  void capture(bool on) {
    captured = on;
    have_last = false;
    glfwSetInputMode(handle, GLFW_CURSOR, on ? GLFW_CURSOR_DISABLED : GLFW_CURSOR_NORMAL);
    if (glfwRawMouseMotionSupported()) glfwSetInputMode(handle, GLFW_RAW_MOUSE_MOTION, on);
  }
  void pressed(int key);
  void moved(double x, double y);
  void read_held_keys();
  void read_pad();
};

namespace {

Window::Impl& impl_of(GLFWwindow* handle);

}  // namespace

void Window::Impl::pressed(int key) {
  switch (key) {
    case GLFW_KEY_1:
    case GLFW_KEY_2:
    case GLFW_KEY_3:
    case GLFW_KEY_4:
      events.choose_line = key - GLFW_KEY_1;
      break;
    case GLFW_KEY_TAB:
      events.toggle_automatic = !events.toggle_automatic;
      break;
    case GLFW_KEY_P:
      events.toggle_pause = !events.toggle_pause;
      break;
    case GLFW_KEY_F1:
    case GLFW_KEY_H:
      events.toggle_help = !events.toggle_help;
      break;
    case GLFW_KEY_SPACE:
    case GLFW_KEY_ENTER:
    case GLFW_KEY_KP_ENTER:
      events.push = true;
      break;
    case GLFW_KEY_ESCAPE:
      if (captured) {
        capture(false);
      } else {
        close_asked = true;
      }
      break;
    default:
      break;
  }
}

void Window::Impl::moved(double x, double y) {
  if (captured && have_last) {
    events.mouse_right += x - last_x;
    events.mouse_forward += last_y - y;
  }
  last_x = x;
  last_y = y;
  have_last = true;
}

void Window::Impl::read_held_keys() {
  const auto held = [&](int a, int b) {
    return glfwGetKey(handle, a) == GLFW_PRESS || glfwGetKey(handle, b) == GLFW_PRESS ? 1.0 : 0.0;
  };
  events.key_slide = held(GLFW_KEY_UP, GLFW_KEY_W) - held(GLFW_KEY_DOWN, GLFW_KEY_S);
  events.key_spin = held(GLFW_KEY_RIGHT, GLFW_KEY_D) - held(GLFW_KEY_LEFT, GLFW_KEY_A);
}

void Window::Impl::read_pad() {
  for (int id = GLFW_JOYSTICK_1; id <= GLFW_JOYSTICK_LAST; ++id) {
    GLFWgamepadstate state;
    if (!glfwJoystickIsGamepad(id) || !glfwGetGamepadState(id, &state)) continue;
    events.has_pad = true;
    events.pad.left_x = state.axes[GLFW_GAMEPAD_AXIS_LEFT_X];
    events.pad.left_y = -state.axes[GLFW_GAMEPAD_AXIS_LEFT_Y];  // GLFW: down positive
    events.pad.right_x = state.axes[GLFW_GAMEPAD_AXIS_RIGHT_X];
    events.pad.right_y = -state.axes[GLFW_GAMEPAD_AXIS_RIGHT_Y];
    events.pad.previous_rod = state.buttons[GLFW_GAMEPAD_BUTTON_LEFT_BUMPER] == GLFW_PRESS;
    events.pad.next_rod = state.buttons[GLFW_GAMEPAD_BUTTON_RIGHT_BUMPER] == GLFW_PRESS;
    const bool push = state.buttons[GLFW_GAMEPAD_BUTTON_A] == GLFW_PRESS;
    const bool pause = state.buttons[GLFW_GAMEPAD_BUTTON_START] == GLFW_PRESS;
    events.pad_push = push && !std::exchange(pad_push_held, push);
    events.pad_pause = pause && !std::exchange(pad_pause_held, pause);
    return;
  }
}

tl::expected<Window, draw::WindowError> Window::open(const draw::WindowOptions& options) {
  auto opened = draw::Window::open(options);
  if (!opened) return tl::unexpected(opened.error());
  auto impl = std::make_unique<Impl>(std::move(*opened));
  GLFWwindow* handle = impl->handle;
  glfwSetWindowUserPointer(handle, impl.get());
  glfwSetKeyCallback(handle, [](GLFWwindow* w, int key, int, int action, int) {
    if (action == GLFW_PRESS) impl_of(w).pressed(key);
  });
  glfwSetCursorPosCallback(handle,
                           [](GLFWwindow* w, double x, double y) { impl_of(w).moved(x, y); });
  glfwSetScrollCallback(handle,
                        [](GLFWwindow* w, double, double steps) { impl_of(w).wheel += steps; });
  glfwSetMouseButtonCallback(handle, [](GLFWwindow* w, int, int action, int) {
    if (action != GLFW_PRESS) return;
    if (impl_of(w).captured) {
      impl_of(w).events.push = true;
    } else {
      impl_of(w).capture(true);  // the click that takes the pointer does nothing else
    }
  });
  glfwSetWindowFocusCallback(handle, [](GLFWwindow* w, int focused) {
    if (!focused) impl_of(w).capture(false);
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

InputEvents Window::poll() {
  impl_->events = {};
  impl_->window.poll();
  impl_->read_held_keys();
  impl_->read_pad();
  const double whole = std::trunc(impl_->wheel);  // touch pads scroll in fractions of a step
  impl_->wheel -= whole;
  impl_->events.wheel = static_cast<int>(whole);
  return impl_->events;
}

std::string Window::renderer() const {
  return impl_->window.renderer();
}
bool Window::draws_in_software() const {
  return impl_->window.draws_in_software();
}

}  // namespace client
