#include "view/palette.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>

namespace sandbox {
namespace {

constexpr float kGloss = 0.7f;

constexpr std::array<glm::vec3, 6> kBodyColours{{{0.024f, 0.250f, 0.260f},
                                                 {0.050f, 0.160f, 0.340f},
                                                 {0.720f, 0.440f, 0.110f},
                                                 {0.680f, 0.240f, 0.090f},
                                                 {0.560f, 0.110f, 0.070f},
                                                 {0.640f, 0.600f, 0.500f}}};
// From slow to fast.
constexpr std::array<glm::vec3, 4> kSpeedColours{{{0.030f, 0.080f, 0.300f},
                                                  {0.030f, 0.350f, 0.330f},
                                                  {0.800f, 0.560f, 0.060f},
                                                  {0.750f, 0.060f, 0.040f}}};

// Gives bodies with adjacent indices different colours: a hash (the finaliser of MurmurHash3).
std::uint32_t mixed(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x85EBCA6Bu;
  x ^= x >> 13;
  x *= 0xC2B2AE35u;
  return x ^ x >> 16;
}

}  // namespace

glm::vec4 body_colour(std::size_t index) {
  const std::uint32_t hash = mixed(static_cast<std::uint32_t>(index) + 1u);
  const float shade = 0.85f + 0.3f * static_cast<float>(hash >> 16 & 0xFF) / 255.0f;
  return {shade * kBodyColours[hash % kBodyColours.size()], kGloss};
}

glm::vec4 speed_colour(double speed) {
  constexpr double kFast = 10.0;  // [m/s]
  const double x = 3.0 * std::sqrt(std::min(speed / kFast, 1.0));
  const auto i = std::min<std::size_t>(static_cast<std::size_t>(x), 2);
  const auto share = static_cast<float>(x - static_cast<double>(i));
  return {glm::mix(kSpeedColours[i], kSpeedColours[i + 1], share), kGloss};
}

glm::vec4 mark_colour(vp::DebugCategory mark) {
  const std::uint32_t rgb = vp::default_colour(mark);
  const auto share = [rgb](int shift) { return static_cast<float>(rgb >> shift & 0xFF) / 255.0f; };
  return {share(16), share(8), share(0), 1.0f};
}

}  // namespace sandbox
