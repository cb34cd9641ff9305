// Draws a simulation: lit and shadowed bodies, the ground, the sky, marks.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "core/simulation.h"
#include "draw/program.h"
#include "draw/target.h"
#include "view/instanced_mesh.h"
#include "view/marks.h"

namespace sandbox {

enum class Colouring : std::uint8_t {
  body,   // by index
  speed,  // from blue, at rest, to red
};

struct ViewOptions {
  vp::DebugDrawOptions marks{.shapes = false};
  bool shadows = true;
  Colouring colouring = Colouring::body;
};

class SceneView {
 public:
  // Needs a current OpenGL ES 3.0 context. The error is a sentence.
  static tl::expected<std::unique_ptr<SceneView>, std::string> create(draw::Quality quality);

  // Draws to the window's framebuffer of that size, and leaves it bound.
  void draw(const Simulation& simulation, const OrbitCamera& camera, const ViewOptions& options,
            const glm::ivec2& screen);
  // Of the last picture: one for each kind of shape present, in the picture and in the shadow map.
  int draw_calls() const { return draw_calls_; }

 private:
  // A shape with a separate mesh: a hull, a mesh or a height field.
  struct Built {
    vp::Shape shape;
    InstancedMesh mesh;
    std::vector<Instance> instances;
  };

  explicit SceneView(draw::Quality quality) : quality_(quality) {}
  std::string build_programs();
  void gather(const Simulation& simulation, const OrbitCamera& camera, const ViewOptions& options);
  void add(const vp::Shape& shape, const vp::SE3& T_world_shape, const glm::vec4& colour);
  template <class T>
  std::vector<Instance>* instances_of(const vp::Shape& shape, ShapeMesh (*mesh)(const T&));
  void upload();
  void draw_bodies(int& calls) const;
  void draw_shadow(const OrbitCamera& camera, bool wanted);
  void light(const draw::Program& program, const OrbitCamera& camera) const;
  void draw_grounds(const OrbitCamera& camera);
  void draw_ghosts(const OrbitCamera& camera);
  void draw_sky(const OrbitCamera& camera) const;
  void draw_marks(const Simulation& simulation, const OrbitCamera& camera,
                  const vp::DebugDrawOptions& options);
  glm::vec3 seen(const vp::Vec3& world) const;  // relative to the camera's target

  draw::Quality quality_;
  draw::Program body_, depth_, ground_, ghost_, sky_;
  draw::ShadowTarget shadow_;
  draw::Target target_;
  glm::ivec2 screen_{0, 0};
  draw::GlVertexArray empty_, square_;
  draw::GlBuffer square_corners_;
  std::array<InstancedMesh, kShapeKinds> meshes_;
  std::array<std::vector<Instance>, kShapeKinds> instances_;
  std::vector<Built> built_;
  InstancedMesh ghost_mesh_;
  std::vector<Instance> ghosts_;
  std::vector<vp::SE3> grounds_;  // half-spaces
  Marks marks_;
  vp::Vec3 origin_;                  // of the drawing: the camera's target
  glm::mat4 view_projection_{1.0f};  // for positions relative to it
  glm::mat4 shadow_matrix_{1.0f};
  float shadow_texel_ = 0.0f;  // [m]
  int draw_calls_ = 0;
};

}  // namespace sandbox
