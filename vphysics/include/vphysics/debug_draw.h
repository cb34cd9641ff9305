// Debug drawing: the contents of a world as lines and points. Derive from DebugDraw and pass it to
// World::debug_draw.
#pragma once

#include <cstdint>

#include "vphysics/ids.h"
#include "vphysics/lie.h"
#include "vphysics/shapes.h"

namespace vp {

// What a line or a point represents. The renderer chooses its colour and width, or omits it.
enum class DebugCategory : std::uint8_t {
  fixed_shape,
  kinematic_shape,
  dynamic_shape,  // links included
  sensor,
  bounds,    // AABB of a collider
  contact,   // a contact point of the solver
  normal,    // at the contact point, from a towards b
  impulse,   // on b in the last step, at the contact point: along the normal ...
  friction,  // ... and tangential to it
  axis_x,    // of a body's frame
  axis_y,
  axis_z,
  centre,      // of mass
  joint,       // from a body, or a link's parent, through the joint to the other body or the link
  joint_axis,  // axis of rotation or translation
};
inline constexpr int kDebugCategories = 15;

// A colour that is distinct from the others on dark and light backgrounds: 0xRRGGBB.
std::uint32_t default_colour(DebugCategory category);

// World::debug_draw calls these functions, in the same order for the same world. They must not
// change that world. World frame [m].
class DebugDraw {
 public:
  virtual ~DebugDraw() = default;
  virtual void line(const Vec3& from, const Vec3& to, DebugCategory category) = 0;
  virtual void point(const Vec3& at, DebugCategory category) = 0;
  // A collider. Return true if it is drawn; false makes World::debug_draw draw its wireframe as
  // lines. The shape is valid only during the call.
  virtual bool shape(ColliderId collider, const Shape& shape, const SE3& T_world_shape,
                     DebugCategory category);
};

struct DebugDrawOptions {
  bool shapes = true;
  bool bounds = false;
  bool contacts = false;
  bool normals = false;
  // Contacts of the sub-stepped solver show the impulses of a whole step. No impulses are known
  // before the first step or after restore().
  bool impulses = false;
  bool frames = false;
  bool centres = false;
  bool joints = false;

  double frame_size = 0.25;    // of a body's and of a joint's axis [m]
  double normal_length = 0.1;  // [m]
  double impulse_scale = 0.1;  // length of the line for each N s [m/(N s)]
  // Half the side of the square that represents a half-space, about the shape's origin [m].
  double half_space_size = 10.0;
};

}  // namespace vp
