#include "app/window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <cmath>

namespace client {

struct Window::Impl {
  explicit Impl(draw::Window opened) : window(std::move(opened)), handle(window.handle()) {}

  draw::Window window;
  GLFWwindow* handle;
  InputEvents events;
  bool captured = false;
  double last_x = 0, last_y = 0, wheel = 0;
  bool have_last = false, close_asked = false;
  ActionState actions;
  KeyBindings keys = default_keys();
  // Of the pad's buttons: down at the last look; pressed since the last poll.
  struct PadButtons {
    bool push = false, pause = false, previous_rod = false, next_rod = false;
  };
  PadButtons pad_down, pad_pressed;

  void capture(bool on) {
    captured = on;
    have_last = false;
    glfwSetInputMode(handle, GLFW_CURSOR, on ? GLFW_CURSOR_DISABLED : GLFW_CURSOR_NORMAL);
    if (glfwRawMouseMotionSupported()) glfwSetInputMode(handle, GLFW_RAW_MOUSE_MOTION, on);
  }
  void pressed(int key);
  void released(int key);
  void moved(double x, double y);
  void read_keys();
  void read_pad();
  void take_pad_presses();
};

namespace {

Window::Impl& impl_of(GLFWwindow* handle);

template <class Do>
void for_actions_of(const KeyBindings& keys, int key, Do&& act) {
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (keys[i][0] == key || keys[i][1] == key) act(static_cast<Action>(i));
  }
}

}  // namespace

void Window::Impl::pressed(int key) {
  if (key == GLFW_KEY_ESCAPE) {
    events.back = events.back || !captured;
    if (captured) capture(false);
    return;
  }
  events.any_key = key;
  for_actions_of(keys, key, [&](Action action) { actions.press(action); });
}

void Window::Impl::released(int key) {
  for_actions_of(keys, key, [&](Action action) { actions.release(action); });
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

void Window::Impl::read_keys() {
  const auto presses = [&](Action action) { return actions.presses(action); };
  const auto odd = [&](Action action) { return presses(action) % 2 != 0; };
  for (int i = 0; i < kActions; ++i)
    events.presses[static_cast<std::size_t>(i)] = presses(static_cast<Action>(i));
  events.key_slide = actions.axis(Action::slide_away, Action::slide_near);
  events.key_spin = actions.axis(Action::spin_right, Action::spin_left);
  events.slide_taps = actions.tapped(Action::slide_away, Action::slide_near);
  events.spin_taps = actions.tapped(Action::spin_right, Action::spin_left);
  for (int line = 0; line < 4; ++line) {
    if (presses(static_cast<Action>(static_cast<int>(Action::rod_1) + line)) > 0)
      events.choose_line = line;
  }
  wheel += presses(Action::next_rod) - presses(Action::previous_rod);
  events.push = events.push || presses(Action::push) > 0;
  events.toggle_automatic = odd(Action::automatic);
  events.toggle_pause = odd(Action::pause);
  events.toggle_help = odd(Action::help);
  actions.clear();
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
    const auto look = [&](int button, bool& down, bool& pressed) {
      const bool now = state.buttons[button] == GLFW_PRESS;
      pressed = pressed || (now && !down);
      down = now;
    };
    look(GLFW_GAMEPAD_BUTTON_A, pad_down.push, pad_pressed.push);
    look(GLFW_GAMEPAD_BUTTON_START, pad_down.pause, pad_pressed.pause);
    look(GLFW_GAMEPAD_BUTTON_LEFT_BUMPER, pad_down.previous_rod, pad_pressed.previous_rod);
    look(GLFW_GAMEPAD_BUTTON_RIGHT_BUMPER, pad_down.next_rod, pad_pressed.next_rod);
    return;
  }
}

// Bumpers change the rod as the wheel does, once a press.
void Window::Impl::take_pad_presses() {
  events.pad_push = pad_pressed.push;
  events.pad_pause = pad_pressed.pause;
  wheel += (pad_pressed.next_rod ? 1 : 0) - (pad_pressed.previous_rod ? 1 : 0);
  pad_pressed = {};
}

tl::expected<Window, draw::WindowError> Window::open(const draw::WindowOptions& options) {
  auto opened = draw::Window::open(options);
  if (!opened) return tl::unexpected(opened.error());
  auto impl = std::make_unique<Impl>(std::move(*opened));
  GLFWwindow* handle = impl->handle;
  glfwSetWindowUserPointer(handle, impl.get());
  glfwSetKeyCallback(handle, [](GLFWwindow* w, int key, int, int action, int) {
    if (action == GLFW_PRESS) impl_of(w).pressed(key);
    if (action == GLFW_RELEASE) impl_of(w).released(key);
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
    if (focused) return;
    impl_of(w).capture(false);
    impl_of(w).actions.release_all();
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

void Window::set_keys(const KeyBindings& keys) {
  impl_->keys = keys;
  impl_->actions.release_all();
}

void Window::look_at_pad() {
  impl_->read_pad();
}

InputEvents Window::poll() {
  impl_->events = {};
  impl_->window.poll();
  impl_->read_keys();
  impl_->read_pad();
  impl_->take_pad_presses();
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
