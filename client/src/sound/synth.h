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
  voice,  // a character's shout; its pitch is the character's
  // Loops: without a beginning and an end, of constant loudness.
  roll,
  slide,
  crowd,
};
inline constexpr int kSounds = 14;
constexpr bool is_loop(Sound sound) {
  return sound >= Sound::roll;
}
inline constexpr int kSampleRate = 44100;  // [Hz]

// Mono, full scale; those that are no loops end in silence. The same for every call.
std::vector<std::int16_t> synthesise(Sound sound);

}  // namespace client
