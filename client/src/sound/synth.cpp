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
  double noise, noise_decay;  // level, decay time to 1 / e [s]
  double noise_smoothing;     // 0 white .. 1 dull
  double swell = 0.0;         // rise time of the noise [s]
  double murmur = 0.0;        // depth of the noise's random amplitude modulation, as of many voices
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
constexpr Mode kShot[] = {{255, 0.055, 1.0},  {610, 0.040, 0.8},   {1240, 0.030, 0.6},
                          {2450, 0.016, 0.5}, {3900, 0.010, 0.35}, {82, 0.060, 0.9}};
// Vowels of a crowd: frequency bands of a voice, many of them, slightly detuned.
constexpr Mode kCheer[] = {{392, 0.9, 0.22, 0.02}, {440, 0.8, 0.22, 0.05}, {523, 0.9, 0.2, 0.09},
                           {587, 0.8, 0.18, 0.04}, {659, 0.7, 0.16, 0.12}, {784, 0.6, 0.12, 0.15}};
constexpr Mode kGroan[] = {
    {196, 0.7, 0.3}, {185, 0.8, 0.3, 0.06}, {165, 0.9, 0.3, 0.14}, {147, 0.9, 0.25, 0.22}};
constexpr Mode kGasp[] = {{330, 0.12, 0.2}, {349, 0.12, 0.2, 0.02}, {415, 0.10, 0.15, 0.03}};
// One vowel: nearly a pure tone (flute), and one with all its overtones (reed).
constexpr Mode kFlute[] = {{220, 0.18, 1.0}, {440, 0.10, 0.22}, {660, 0.07, 0.06}};
constexpr Mode kReed[] = {{220, 0.15, 0.8},  {440, 0.14, 0.8},  {660, 0.12, 1.0},
                          {880, 0.10, 0.7},  {1100, 0.10, 0.7}, {1540, 0.08, 0.5},
                          {1980, 0.07, 0.4}, {2420, 0.05, 0.3}};
constexpr Mode kServe[] = {{880, 0.07, 0.8}, {1320, 0.05, 0.4, 0.03}};
constexpr Mode kWhistle[] = {
    {2350, 0.20, 0.6}, {2420, 0.20, 0.6}, {2350, 0.35, 0.6, 0.28}, {2420, 0.35, 0.6, 0.28}};

Recipe recipe_of(Sound sound) {
  switch (sound) {
    case Sound::kick:
      return {0.16, kKick, 0.55, 0.006, 0.3};
    case Sound::shot:
      return {0.32, kShot, 0.85, 0.016, 0.15};
    case Sound::wall:
      return {0.22, kWall, 0.45, 0.008, 0.5};
    case Sound::field:
      return {0.16, kField, 0.30, 0.015, 0.8};
    case Sound::goal:
      return {2.2, kGoal, 0.25, 0.25, 0.7};
    case Sound::cheer:
      return {2.6, kCheer, 1.0, 0.85, 0.80, 0.25, 0.5};
    case Sound::groan:
      return {1.8, kGroan, 0.8, 0.6, 0.93, 0.12, 0.4};
    case Sound::gasp:
      return {0.7, kGasp, 0.9, 0.18, 0.85, 0.06, 0.3};
    case Sound::flute:
      return {0.42, kFlute, 0.12, 0.10, 0.6};
    case Sound::reed:
      return {0.42, kReed, 0.06, 0.06, 0.4};
    case Sound::roll:
      return {2.0, {}, 1.0, 0.0, 0.95, 0.0, 0.25};
    case Sound::slide:
      return {2.0, {}, 1.0, 0.0, 0.45, 0.0, 0.15};
    case Sound::crowd:
      return {6.0, {}, 1.0, 0.0, 0.93, 0.0, 0.6};
    case Sound::serve:
      return {0.30, kServe, 0.08, 0.02, 0.2};
    case Sound::whistle:
      return {1.4, kWhistle, 0.05, 0.3, 0.1};
  }
  return {};
}

// Noise between low and high frequencies, with random amplitude as of many voices. close_loop()
// fades the end of a loop into its beginning.
class Noise {
 public:
  explicit Noise(const Recipe& recipe) : recipe_(recipe) {}
  double next(double t) {
    random_ = random_ * 1664525u + 1013904223u;
    const double white = static_cast<double>(random_ >> 8) / 8388608.0 - 1.0;
    smooth_ += (1.0 - recipe_.noise_smoothing) * (white - smooth_);
    rumble_ += 0.004 * (smooth_ - rumble_);  // removes frequencies below a loudspeaker's range
    uneven_ += 0.0006 * (white - uneven_);
    const double swell = recipe_.swell > 0 ? std::min(t / recipe_.swell, 1.0) : 1.0;
    const double decay = recipe_.noise_decay > 0
                             ? std::exp(-std::max(t - recipe_.swell, 0.0) / recipe_.noise_decay)
                             : 1.0;
    return recipe_.noise * swell * decay * (1.0 + 40.0 * recipe_.murmur * uneven_) *
           (smooth_ - rumble_);
  }

 private:
  const Recipe& recipe_;
  std::uint32_t random_ = 1;
  double smooth_ = 0, rumble_ = 0, uneven_ = 0;
};

std::vector<double> wave_of(const Recipe& recipe, std::size_t count) {
  std::vector<double> wave(count, 0.0);
  Noise noise(recipe);
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / kSampleRate;
    for (const Mode& mode : recipe.modes) {
      const double since = t - mode.start;
      if (since < 0) continue;
      const double attack = std::min(since / 0.0008, 1.0);  // a click would be louder than the tone
      wave[i] += attack * mode.level * std::exp(-since / mode.decay) *
                 std::sin(2 * std::numbers::pi * mode.frequency * since);
    }
    wave[i] += noise.next(t);
  }
  return wave;
}

// Crossfades the last quarter of a second with the beginning.
void close_loop(std::vector<double>& wave) {
  const auto overlap = static_cast<std::size_t>(0.25 * kSampleRate);
  const std::size_t count = wave.size() - overlap;
  for (std::size_t i = 0; i < overlap; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(overlap);
    wave[i] = std::sqrt(share) * wave[i] + std::sqrt(1.0 - share) * wave[count + i];
  }
  wave.resize(count);
}

}  // namespace

std::vector<std::int16_t> synthesise(Sound sound) {
  const Recipe recipe = recipe_of(sound);
  std::vector<double> wave = wave_of(recipe, static_cast<std::size_t>(recipe.length * kSampleRate));
  if (is_loop(sound)) close_loop(wave);
  double peak = 1e-9;
  for (const double v : wave) peak = std::max(peak, std::abs(v));
  std::vector<std::int16_t> samples(wave.size());
  for (std::size_t i = 0; i < wave.size(); ++i) {
    const double left = static_cast<double>(wave.size() - i) / kSampleRate;
    const double fade = is_loop(sound) ? 1.0 : std::min(left / 0.02, 1.0);
    samples[i] = static_cast<std::int16_t>(std::lround(32000.0 * fade * wave[i] / peak));
  }
  return samples;
}

}  // namespace client
