#include "sound/synth.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace client {
namespace {

struct Mode {
  double frequency;  // [Hz]
  double decay;      // to 1 / e [s]
  double level;
  double start = 0.0;  // [s]
};

struct Recipe {
  double length;  // [s]
  std::span<const Mode> modes;
  double noise, noise_decay;  // level, to 1 / e [s]
  double noise_smoothing;     // 0 white .. 1 dull
};

// A hollow plastic man, a wooden board, a felted field, a chord of bells, a soft ping, a referee.
constexpr Mode kKick[] = {
    {310, 0.030, 1.0}, {742, 0.020, 0.6}, {1480, 0.012, 0.35}, {2610, 0.006, 0.2}};
constexpr Mode kWall[] = {
    {196, 0.045, 1.0}, {523, 0.030, 0.7}, {1130, 0.018, 0.5}, {1870, 0.010, 0.3}};
constexpr Mode kField[] = {{128, 0.035, 1.0}, {262, 0.022, 0.4}};
constexpr Mode kGoal[] = {{392.0, 0.55, 0.8},         {493.9, 0.55, 0.7, 0.09},
                          {587.3, 0.60, 0.7, 0.18},   {784.0, 0.70, 0.8, 0.27},
                          {1568.0, 0.40, 0.25, 0.27}, {98.0, 0.30, 0.9}};
constexpr Mode kServe[] = {{880, 0.07, 0.8}, {1320, 0.05, 0.4, 0.03}};
constexpr Mode kWhistle[] = {
    {2350, 0.20, 0.6}, {2420, 0.20, 0.6}, {2350, 0.35, 0.6, 0.28}, {2420, 0.35, 0.6, 0.28}};

Recipe recipe_of(Sound sound) {
  switch (sound) {
    case Sound::kick:
      return {0.16, kKick, 0.55, 0.006, 0.3};
    case Sound::wall:
      return {0.22, kWall, 0.45, 0.008, 0.5};
    case Sound::field:
      return {0.16, kField, 0.30, 0.015, 0.8};
    case Sound::goal:
      return {2.2, kGoal, 0.25, 0.25, 0.7};
    case Sound::serve:
      return {0.30, kServe, 0.08, 0.02, 0.2};
    case Sound::whistle:
      return {1.4, kWhistle, 0.05, 0.3, 0.1};
  }
  return {};
}

}  // namespace

std::vector<std::int16_t> synthesise(Sound sound) {
  const Recipe recipe = recipe_of(sound);
  const auto count = static_cast<std::size_t>(recipe.length * kSampleRate);
  std::vector<double> wave(count, 0.0);
  std::uint32_t random = 1;
  double smooth = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / kSampleRate;
    for (const Mode& mode : recipe.modes) {
      const double since = t - mode.start;
      if (since < 0) continue;
      const double attack = std::min(since / 0.0008, 1.0);  // a click would be louder than the tone
      wave[i] += attack * mode.level * std::exp(-since / mode.decay) *
                 std::sin(2 * std::numbers::pi * mode.frequency * since);
    }
    random = random * 1664525u + 1013904223u;
    const double white = static_cast<double>(random >> 8) / 8388608.0 - 1.0;
    smooth += (1.0 - recipe.noise_smoothing) * (white - smooth);
    wave[i] += recipe.noise * std::exp(-t / recipe.noise_decay) * smooth;
  }
  double peak = 1e-9;
  for (const double v : wave) peak = std::max(peak, std::abs(v));
  std::vector<std::int16_t> samples(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double left = static_cast<double>(count - i) / kSampleRate;
    const double fade = std::min(left / 0.02, 1.0);
    samples[i] = static_cast<std::int16_t>(std::lround(32000.0 * fade * wave[i] / peak));
  }
  return samples;
}

}  // namespace client
