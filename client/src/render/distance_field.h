// Signed distance fields of glyphs: exact Euclidean distances (Felzenszwalb and Huttenlocher,
// Distance Transforms of Sampled Functions, 2012) of a glyph at a larger size, then downsampled.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace client {

// coverage: width x height, 0..255, with a margin of at least `reach` pixels on every side. Returns
// the field at 1 / step of the size: 128 at the outline, 255 at `reach` pixels inside, 0 at `reach`
// pixels outside. Preconditions: step divides width and height; step >= 1; reach > 0.
std::vector<std::uint8_t> distance_field(std::span<const std::uint8_t> coverage, int width,
                                         int height, int step, float reach);

}  // namespace client
