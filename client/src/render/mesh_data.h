// Triangles in memory, before upload to the GPU.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace client {

// 32 bytes, as solid.vert reads it.
struct MeshVertex {
  glm::vec3 position;        // [m]
  glm::vec3 normal;          // unit, outward
  std::uint8_t albedo[4];    // square root of linear rgb; a: fraction of the instance's tint
  std::uint8_t material[4];  // roughness, metal, emission / 4, occlusion
};
static_assert(sizeof(MeshVertex) == 32);

struct MeshData {
  std::vector<MeshVertex> vertices;
  std::vector<std::uint32_t> indices;  // triangles, counter-clockwise from outside
};

struct Paint {
  glm::vec3 albedo{0.8f};  // linear rgb
  float tint = 0.0f;       // 0: as given; 1: times the instance's tint
  float roughness = 0.5f;
  float metal = 0.0f;
  float emission = 0.0f;  // times albedo, up to 4
};

}  // namespace client
