#include "commands.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace watch {
namespace {

Command choosing_by(int key) {
  switch (key) {
    case GLFW_KEY_UP:
      return Command::up;
    case GLFW_KEY_DOWN:
      return Command::down;
    case GLFW_KEY_PAGE_UP:
      return Command::page_up;
    case GLFW_KEY_PAGE_DOWN:
      return Command::page_down;
    case GLFW_KEY_ENTER:
    case GLFW_KEY_KP_ENTER:
    case GLFW_KEY_SPACE:
      return Command::confirm;
    default:
      return Command::none;
  }
}

Command watching_by(int key, bool shift) {
  switch (key) {
    case GLFW_KEY_SPACE:
    case GLFW_KEY_ENTER:
    case GLFW_KEY_KP_ENTER:
    case GLFW_KEY_P:
      return Command::play;
    case GLFW_KEY_LEFT:
      return shift ? Command::far_back : Command::back;
    case GLFW_KEY_RIGHT:
      return shift ? Command::far_on : Command::on;
    case GLFW_KEY_COMMA:
      return Command::tick_back;
    case GLFW_KEY_PERIOD:
      return Command::tick_on;
    case GLFW_KEY_UP:
      return Command::faster;
    case GLFW_KEY_DOWN:
      return Command::slower;
    case GLFW_KEY_B:
      return Command::previous_goal;
    case GLFW_KEY_N:
      return Command::next_goal;
    case GLFW_KEY_C:
      return Command::camera;
    case GLFW_KEY_V:
      return Command::side;
    case GLFW_KEY_U:
      return Command::hide;
    default:
      return Command::none;
  }
}

}  // namespace

Command command_of_key(int key, bool shift, bool choosing) {
  switch (key) {
    case GLFW_KEY_HOME:
      return Command::begin;
    case GLFW_KEY_END:
      return Command::end;
    case GLFW_KEY_K:
      return Command::keep;
    case GLFW_KEY_S:
      return Command::share;
    case GLFW_KEY_F12:
      return Command::picture;
    case GLFW_KEY_F1:
    case GLFW_KEY_H:
      return Command::keys;
    case GLFW_KEY_ESCAPE:
      return Command::leave;
    default:
      return choosing ? choosing_by(key) : watching_by(key, shift);
  }
}

Command command_of_button(client::ReplayButton button) {
  using client::ReplayButton;
  switch (button) {
    case ReplayButton::previous_goal:
      return Command::previous_goal;
    case ReplayButton::back:
      return Command::back;
    case ReplayButton::play:
      return Command::play;
    case ReplayButton::on:
      return Command::on;
    case ReplayButton::next_goal:
      return Command::next_goal;
    case ReplayButton::slower:
      return Command::slower;
    case ReplayButton::faster:
      return Command::faster;
    case ReplayButton::camera:
      return Command::camera;
    case ReplayButton::side:
      return Command::side;
    case ReplayButton::keep:
      return Command::keep;
    case ReplayButton::share:
      return Command::share;
    case ReplayButton::hide:
      return Command::hide;
    case ReplayButton::keys:
      return Command::keys;
    case ReplayButton::leave:
      return Command::leave;
  }
  return Command::none;
}

}  // namespace watch
