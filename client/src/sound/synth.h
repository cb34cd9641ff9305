// The game's sounds, made from decaying modes and shaped noise. No device here.
#pragma once

#include <cstdint>
#include <vector>

namespace client {

enum class Sound : std::uint8_t {
  kick,  // a man of hollow plastic
  shot,  // the same, struck hard: brighter and longer
  wall,
  field,
  goal,
  serve,
  whistle,
  cheer,  // many voices, rising
  groan,  // many voices, falling: an own goal
  gasp,   // a shot, a save
  // A character's shout is a mixture of both, at its own pitch.
  flute,
  reed,
  // Loops: without a beginning and an end, of constant loudness.
  roll,
  slide,
  crowd,
};
inline constexpr int kSounds = 15;
constexpr bool is_loop(Sound sound) {
  return sound >= Sound::roll;
}
// Of flute and reed as they are made [Hz].
inline constexpr float kVoicePitch = 220.0f;
inline constexpr int kSampleRate = 44100;  // [Hz]

// Mono, full scale; those that are no loops end in silence. The same for every call.
std::vector<std::int16_t> synthesise(Sound sound);

}  // namespace client
