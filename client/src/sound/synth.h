// The game's short sounds, made from a few decaying modes and a puff of noise. No device here.
#pragma once

#include <cstdint>
#include <vector>

namespace client {

enum class Sound : std::uint8_t { kick, wall, field, goal, serve, whistle };
inline constexpr int kSounds = 6;
inline constexpr int kSampleRate = 44100;  // [Hz]

// Mono, full scale, ending in silence. The same for every call.
std::vector<std::int16_t> synthesise(Sound sound);

}  // namespace client
