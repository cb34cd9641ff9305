#include "render/gpu_mesh.h"

#include <cstddef>

namespace client {
namespace {

const void* at(std::size_t offset) {
  return reinterpret_cast<const void*>(offset);
}

GLsizeiptr bytes_of(std::size_t count, std::size_t size) {
  return static_cast<GLsizeiptr>(count * size);
}

}  // namespace

Instance make_instance(const glm::mat4& m, const glm::vec3& tint, float glow) {
  Instance instance;
  for (int r = 0; r < 3; ++r) instance.row[r] = {m[0][r], m[1][r], m[2][r], m[3][r]};
  instance.tint = glm::vec4(tint, glow);
  return instance;
}

GpuMesh::GpuMesh(const MeshData& mesh)
    : array_(draw::GlVertexArray::make()),
      vertices_(draw::GlBuffer::make()),
      indices_(draw::GlBuffer::make()) {
  index_count_ = static_cast<GLsizei>(mesh.indices.size());
  glBindVertexArray(array_.get());
  glBindBuffer(GL_ARRAY_BUFFER, vertices_.get());
  glBufferData(GL_ARRAY_BUFFER, bytes_of(mesh.vertices.size(), sizeof(MeshVertex)),
               mesh.vertices.data(), GL_STATIC_DRAW);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.get());
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, bytes_of(mesh.indices.size(), sizeof(std::uint32_t)),
               mesh.indices.data(), GL_STATIC_DRAW);
  constexpr GLsizei kStride = sizeof(MeshVertex);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, kStride, at(offsetof(MeshVertex, position)));
  glVertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, kStride, at(offsetof(MeshVertex, normal)));
  glVertexAttribPointer(2, 4, GL_UNSIGNED_BYTE, GL_TRUE, kStride, at(offsetof(MeshVertex, albedo)));
  glVertexAttribPointer(3, 4, GL_UNSIGNED_BYTE, GL_TRUE, kStride,
                        at(offsetof(MeshVertex, material)));
  for (GLuint i = 0; i < 4; ++i) glEnableVertexAttribArray(i);
  glBindVertexArray(0);
}

void GpuMesh::set_instances(std::span<const Instance> instances) {
  instance_count_ = static_cast<GLsizei>(instances.size());
  if (!instanced_) {
    instanced_ = true;
    instances_ = draw::GlBuffer::make();
    glBindVertexArray(array_.get());
    glBindBuffer(GL_ARRAY_BUFFER, instances_.get());
    for (GLuint i = 0; i < 4; ++i) {
      glVertexAttribPointer(4 + i, 4, GL_FLOAT, GL_FALSE, sizeof(Instance),
                            at(i * sizeof(glm::vec4)));
      glVertexAttribDivisor(4 + i, 1);
      glEnableVertexAttribArray(4 + i);
    }
    glBindVertexArray(0);
  }
  glBindBuffer(GL_ARRAY_BUFFER, instances_.get());
  glBufferData(GL_ARRAY_BUFFER, bytes_of(instances.size(), sizeof(Instance)), instances.data(),
               GL_STREAM_DRAW);
}

void GpuMesh::draw() const {
  if (instanced_ && instance_count_ == 0) return;
  glBindVertexArray(array_.get());
  if (instanced_) {
    glDrawElementsInstanced(GL_TRIANGLES, index_count_, GL_UNSIGNED_INT, nullptr, instance_count_);
  } else {
    glDrawElements(GL_TRIANGLES, index_count_, GL_UNSIGNED_INT, nullptr);
  }
}

}  // namespace client
