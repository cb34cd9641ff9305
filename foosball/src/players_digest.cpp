// Digest of all numbers of all computer players. The structured bindings name every member: a new
// member does not compile until the digest includes it.
#include <bit>
#include <cstdint>
#include <initializer_list>

#include "classic_tactics.h"
#include "computer_level.h"
#include "foosball/computer_player.h"

namespace foosball {
namespace {

struct NumbersDigest {
  std::uint64_t value = 14695981039346656037u;  // FNV-1a over the numbers' bits
  void add(double number) {
    const auto bits = std::bit_cast<std::uint64_t>(number);
    for (int byte = 0; byte < 8; ++byte) {
      value = (value ^ (bits >> (8 * byte) & 0xff)) * 1099511628211u;
    }
  }
  void add(std::initializer_list<double> numbers) {
    for (const double number : numbers) add(number);
  }
  void add(const AxisLimits& limits) {
    const auto& [rate, acceleration] = limits;
    add({rate, acceleration});
  }
};

}  // namespace

std::uint64_t digest(const Temperament& t) {
  const auto& [delay, hand_travel, aim_error, slide, swing, strike, pause_low, pause_high,
               forecast_ticks, stays_home, judgment] = t;
  NumbersDigest digest;
  digest.add({delay, hand_travel, aim_error, pause_low, pause_high,
              static_cast<double>(forecast_ticks), stays_home ? 1.0 : 0.0});
  for (const AxisLimits* limits : {&slide, &swing, &strike}) digest.add(*limits);
  for (const JudgmentField& field : kJudgmentFields) digest.add(judgment.*field.value);
  return digest.value;
}

std::uint64_t players_digest() {
  NumbersDigest all;
  for (int level = 1; level <= kLevels; ++level) {
    for (int style = 0; style < kPlayStyles; ++style) {
      all.add(std::bit_cast<double>(digest(temperament_of(level, static_cast<PlayStyle>(style)))));
    }
    all.add(static_cast<double>(style_of_level(level)));
  }
  for (const double skill : {0.0, 0.5, 1.0}) {
    const auto& [delay, aim_error, pause_low, pause_high, slide, swing, strike] = temper_of(skill);
    all.add({delay, aim_error, pause_low, pause_high});
    for (const AxisLimits* limits : {&slide, &swing, &strike}) all.add(*limits);
  }
  return all.value;
}

}  // namespace foosball
