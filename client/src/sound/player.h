// Positional sound through OpenAL.
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
  // The error says why there is no sound; the game continues without it.
  static tl::expected<std::unique_ptr<SoundPlayer>, std::string> open();
  // Opens without an audio device: render() returns the samples, as fast as it is called.
  static tl::expected<std::unique_ptr<SoundPlayer>, std::string> open_offline();
  ~SoundPlayer();

  // The next samples, kSampleRate per second, interleaved left and right. Precondition: created by
  // open_offline().
  std::vector<std::int16_t> render(int moments);

  void set_listener(const glm::vec3& eye, const glm::vec3& at);
  void set_volume(float volume);  // 0..1, master volume
  // volume 0..1; at: world [m]. pitch: 1 as synthesised.
  void play(Sound sound, float volume, const glm::vec3& at, float pitch = 1.0f);
  // A loop keeps this volume (0: silent) and pitch until the next call.
  void set_loop(Sound loop, float volume, const glm::vec3& at, float pitch = 1.0f);

 private:
  struct Impl;
  explicit SoundPlayer(std::unique_ptr<Impl> impl);
  static tl::expected<std::unique_ptr<SoundPlayer>, std::string> prepare(std::unique_ptr<Impl> impl,
                                                                         const int* attributes);
  std::unique_ptr<Impl> impl_;
};

// Volume of a hit from its impulse [N s], 0..1: linear in decibels, from the softest audible touch
// to the hardest shot of a table, so that each tenfold impulse adds the same loudness.
inline constexpr float kSoftestImpulse = 0.004f;
inline constexpr float kHardestImpulse = 0.60f;  // the ball's 26 g at 23 m/s
float volume_of_impulse(float impulse);

// Sound of the rolling ball, from its speed along the field [m/s].
struct RollingSound {
  float volume, pitch;
};
RollingSound rolling_sound(float speed);

}  // namespace client
