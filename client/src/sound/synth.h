// Synthesises the game's sounds from decaying modes and filtered noise. No audio device here.
#pragma once

#include <cstdint>
#include <vector>

namespace client {

enum class Sound : std::uint8_t {
  kick,  // a man of hollow plastic
  shot,  // the same, hit hard: brighter and longer
  wall,
  field,
  goal,
  serve,
  whistle,
  cheer,  // many voices, rising
  groan,  // many voices, falling: an own goal
  gasp,   // a shot, a save
  // A character's shout mixes both, at the character's pitch.
  flute,
  reed,
  // Loops: seamless, of constant loudness.
  roll,
  slide,
  crowd,
};
inline constexpr int kSounds = 15;
constexpr bool is_loop(Sound sound) {
  return sound >= Sound::roll;
}
// Pitch of flute and reed as synthesised [Hz].
inline constexpr float kVoicePitch = 220.0f;
inline constexpr int kSampleRate = 44100;  // [Hz]

// Mono, full scale; sounds that are no loops end in silence. Deterministic: equal for every call.
std::vector<std::int16_t> synthesise(Sound sound);

}  // namespace client
