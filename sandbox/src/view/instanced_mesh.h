// A mesh of shape_mesh.h on the GPU, and its bodies as instances: one draw call for all.
#pragma once

#include <glm/vec4.hpp>
#include <span>

#include "draw/gl_handle.h"
#include "view/shape_mesh.h"

namespace sandbox {

// 80 bytes, as body.vert reads it.
struct Instance {
  glm::vec4 row[3];   // of the pose, relative to the camera's target
  glm::vec4 stretch;  // of the core; w: rounding radius
  glm::vec4 colour;   // linear rgb; a: gloss
};
static_assert(sizeof(Instance) == 80);

class InstancedMesh {
 public:
  InstancedMesh() = default;
  explicit InstancedMesh(const ShapeMesh& mesh);

  void set_instances(std::span<const Instance> instances);
  void draw() const;

 private:
  draw::GlVertexArray array_;
  draw::GlBuffer vertices_, indices_, instances_;
  GLsizei index_count_ = 0, instance_count_ = 0;
};

}  // namespace sandbox
