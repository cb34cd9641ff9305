// Colours of the game, in linear light. The teams' colours differ in hue and in lightness, so that
// red-green colour-blind people distinguish them too.
#pragma once

#include <array>
#include <glm/vec3.hpp>

namespace client {

inline constexpr std::array<glm::vec3, 2> kTeamColour{
    {{0.86f, 0.23f, 0.025f}, {0.07f, 0.42f, 0.95f}}};

// Their lamps: more saturated, because the tone curve desaturates bright light.
inline constexpr std::array<glm::vec3, 2> kTeamLamp{
    {{0.82f, 0.150f, 0.008f}, {0.032f, 0.32f, 0.935f}}};

}  // namespace client
