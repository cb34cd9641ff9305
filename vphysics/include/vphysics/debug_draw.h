// What a world is made of, as lines and points for a picture of one's own: derive from DebugDraw
// and hand it to World::debug_draw.
#pragma once

#include <cstdint>

#include "vphysics/ids.h"
#include "vphysics/lie.h"
#include "vphysics/shapes.h"

namespace vp {

// What a line or a point stands for: the picture chooses its colour, its width, or to leave it out.
enum class DebugCategory : std::uint8_t {
  fixed_shape,
  kinematic_shape,
  dynamic_shape,  // links too
  sensor,
  bounds,    // of a collider, along the world's axes
  contact,   // a point that the solver holds
  normal,    // from the point, out of a towards b
  impulse,   // from the point, on b, in the last step: along the normal ...
  friction,  // ... and across it
  axis_x,    // of a body's frame
  axis_y,
  axis_z,
  centre,      // of mass
  joint,       // from a body or a link's parent over the joint to the other body or the link
  joint_axis,  // that it turns about or slides along
};
inline constexpr int kDebugCategories = 15;

// A colour that tells it from the others on dark and light ground: 0xRRGGBB.
std::uint32_t usual_colour(DebugCategory category);

// Is called from within World::debug_draw, in the same order for the same world. Nothing in it may
// change that world. World frame [m].
class DebugDraw {
 public:
  virtual ~DebugDraw() = default;
  virtual void line(const Vec3& from, const Vec3& to, DebugCategory category) = 0;
  virtual void point(const Vec3& at, DebugCategory category) = 0;
  // A collider. True: it is drawn; false: its wire follows, as lines. The shape is there for the
  // call alone.
  virtual bool shape(ColliderId collider, const Shape& shape, const SE3& T_world_shape,
                     DebugCategory category);
};

struct DebugDrawOptions {
  bool shapes = true;
  bool bounds = false;
  bool contacts = false;
  bool normals = false;
  // Where the sub-stepped solver's are those of a step; none are known before the first step or
  // after restore().
  bool impulses = false;
  bool frames = false;
  bool centres = false;
  bool joints = false;

  double frame_size = 0.25;    // of a body's and of a joint's axis [m]
  double normal_length = 0.1;  // [m]
  double impulse_scale = 0.1;  // length of an impulse's line for each N s [m/(N s)]
  // Half the side of the square that stands for a half-space, about the shape's own origin [m].
  double half_space_size = 10.0;
};

}  // namespace vp
