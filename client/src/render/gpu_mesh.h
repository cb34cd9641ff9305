// A mesh on the GPU, drawn once or instanced.
#pragma once

#include <glm/mat4x4.hpp>
#include <span>

#include "draw/gl_handle.h"
#include "render/mesh_data.h"

namespace client {

// 64 bytes, as solid.vert reads it.
struct Instance {
  glm::vec4 row[3];  // of the pose, world from mesh
  glm::vec4 tint;    // linear rgb; a: glow
};
static_assert(sizeof(Instance) == 64);

Instance make_instance(const glm::mat4& T_world_mesh, const glm::vec3& tint, float glow);

class GpuMesh {
 public:
  GpuMesh() = default;
  explicit GpuMesh(const MeshData& mesh);

  void set_instances(std::span<const Instance> instances);
  void draw() const;  // all instances; if never set, once without instance attributes

 private:
  draw::GlVertexArray array_;
  draw::GlBuffer vertices_, indices_, instances_;
  GLsizei index_count_ = 0, instance_count_ = 0;
  bool instanced_ = false;
};

}  // namespace client
