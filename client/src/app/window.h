// The window, and a person's input in it as plain events.
#pragma once

#include <glm/vec2.hpp>
#include <memory>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "client/settings.h"
#include "core/input_collector.h"
#include "draw/window.h"

namespace client {

class Window {
 public:
  // cabinet_gamepads: as in Pads.
  static tl::expected<Window, draw::WindowError> open(const draw::WindowOptions& options,
                                                      bool cabinet_gamepads = false);
  Window(Window&&) noexcept;
  Window& operator=(Window&&) noexcept;
  ~Window();

  bool should_close() const;
  void close();
  void set_visible(bool visible);  // hidden: another program has the screen
  glm::ivec2 size() const;         // of the framebuffer [px]
  void swap();                     // shows the frame; waits for the display's refresh
  void set_keys(const KeyBindings& keys);
  // Processes the pending events, in order, so that no short press is lost.
  void poll();
  const InputCollector& input() const;                     // since the last forget_input()
  void forget_input();                                     // a frame has consumed it
  void rumble(int pad, float strength, std::uint16_t ms);  // as in Pads
  std::vector<std::string> take_messages();                // for a person: a pad was unplugged
  void wait(double seconds);  // until the window has events, at most for this time
  bool captured() const;
  std::string renderer() const;  // name of the driver, for the log
  bool draws_in_software() const;

  struct Impl;

 private:
  explicit Window(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace client
