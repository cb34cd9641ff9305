#include "view/instanced_mesh.h"

#include <cstddef>

namespace sandbox {
namespace {

const void* offset_pointer(std::size_t offset) {
  return reinterpret_cast<const void*>(offset);
}

}  // namespace

InstancedMesh::InstancedMesh(const ShapeMesh& mesh)
    : array_(draw::GlVertexArray::make()),
      vertices_(draw::GlBuffer::make()),
      indices_(draw::GlBuffer::make()),
      instances_(draw::GlBuffer::make()),
      index_count_(static_cast<GLsizei>(mesh.indices.size())) {
  glBindVertexArray(array_.get());
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.get());
  glBufferData(GL_ELEMENT_ARRAY_BUFFER,
               static_cast<GLsizeiptr>(mesh.indices.size() * sizeof(std::uint32_t)),
               mesh.indices.data(), GL_STATIC_DRAW);
  glBindBuffer(GL_ARRAY_BUFFER, vertices_.get());
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(mesh.vertices.size() * sizeof(ShapeVertex)),
               mesh.vertices.data(), GL_STATIC_DRAW);
  for (GLuint i = 0; i < 2; ++i) {
    glVertexAttribPointer(i, 3, GL_FLOAT, GL_FALSE, sizeof(ShapeVertex),
                          offset_pointer(i * sizeof(glm::vec3)));
    glEnableVertexAttribArray(i);
  }
  glBindBuffer(GL_ARRAY_BUFFER, instances_.get());
  for (GLuint i = 0; i < 5; ++i) {
    glVertexAttribPointer(2 + i, 4, GL_FLOAT, GL_FALSE, sizeof(Instance),
                          offset_pointer(i * sizeof(glm::vec4)));
    glVertexAttribDivisor(2 + i, 1);
    glEnableVertexAttribArray(2 + i);
  }
  glBindVertexArray(0);
}

void InstancedMesh::set_instances(std::span<const Instance> instances) {
  instance_count_ = static_cast<GLsizei>(instances.size());
  if (instances.empty()) return;
  glBindBuffer(GL_ARRAY_BUFFER, instances_.get());
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(instances.size_bytes()), instances.data(),
               GL_STREAM_DRAW);
}

void InstancedMesh::draw() const {
  if (instance_count_ == 0) return;
  glBindVertexArray(array_.get());
  glDrawElementsInstanced(GL_TRIANGLES, index_count_, GL_UNSIGNED_INT, nullptr, instance_count_);
}

}  // namespace sandbox
