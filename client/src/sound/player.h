// Plays the sounds where they happen, through OpenAL.
#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <string>
#include <tl/expected.hpp>

#include "sound/synth.h"

namespace client {

class SoundPlayer {
 public:
  // The error says why there is no sound; the game goes on without.
  static tl::expected<std::unique_ptr<SoundPlayer>, std::string> open();
  ~SoundPlayer();

  void set_listener(const glm::vec3& eye, const glm::vec3& at);
  // volume 0..1; at: world [m].
  void play(Sound sound, float volume, const glm::vec3& at);

 private:
  struct Impl;
  explicit SoundPlayer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// Loudness of a hit from its impulse [N s]: a tap is heard, a shot is not painful.
float volume_of_impulse(float impulse);

}  // namespace client
