// Plays the sounds where they happen, through OpenAL.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "sound/synth.h"

namespace client {

class SoundPlayer {
 public:
  // The error says why there is no sound; the game goes on without.
  static tl::expected<std::unique_ptr<SoundPlayer>, std::string> open();
  // Heard by nobody: what would be is handed out by render(), as fast as it is asked for.
  static tl::expected<std::unique_ptr<SoundPlayer>, std::string> open_offline();
  ~SoundPlayer();

  // The next so many moments of the sound, kSampleRate a second, left and right in turn.
  // Precondition: made by open_offline().
  std::vector<std::int16_t> render(int moments);

  void set_listener(const glm::vec3& eye, const glm::vec3& at);
  void set_volume(float volume);  // 0..1, of everything
  // volume 0..1; at: world [m]. pitch: 1 as made.
  void play(Sound sound, float volume, const glm::vec3& at, float pitch = 1.0f);
  // A loop goes on with this volume (0: silent) and pitch until it is told otherwise.
  void set_loop(Sound loop, float volume, const glm::vec3& at, float pitch = 1.0f);

 private:
  struct Impl;
  explicit SoundPlayer(std::unique_ptr<Impl> impl);
  static tl::expected<std::unique_ptr<SoundPlayer>, std::string> prepare(std::unique_ptr<Impl> impl,
                                                                         const int* attributes);
  std::unique_ptr<Impl> impl_;
};

// Volume of a hit from its impulse [N s], 0..1: by decibels, from the softest touch that is heard
// to the hardest shot of a table, so that each tenfold impulse is as much louder as the last.
inline constexpr float kSoftestImpulse = 0.004f;
inline constexpr float kHardestImpulse = 0.60f;  // the ball's 26 g at 23 m/s
float volume_of_impulse(float impulse);

// Of the rolling ball, from its speed along the field [m/s].
struct RollingSound {
  float volume, pitch;
};
RollingSound rolling_sound(float speed);

}  // namespace client
