// The models of the comparison, described once: every engine is built from the same list of links.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "vphysics/multibody/model.h"

namespace vp::bench {

// All joints are revolute, except that the first one may be free. Links have no damping and no
// armature. Depth-first order with parents first, as MuJoCo numbers its bodies.
struct BenchModel {
  std::string name;
  std::vector<LinkSpec> links;
  bool free_base = false;

  int velocities() const { return static_cast<int>(links.size()) + (free_base ? 5 : 0); }
};

// In the order of the reports.
const std::vector<std::string>& model_names();
// Precondition: a name of model_names().
BenchModel make_model(std::string_view name);

inline const Vec3& axis_of(const LinkSpec& link) {
  return std::get<RevoluteJoint>(link.joint).axis;
}

// A link's inertia in the form that several engines require: about the centre of mass, along
// principal axes.
struct PrincipalInertia {
  double mass;
  Vec3 centre;   // in the link's frame
  Mat3 axes;     // of inertia, in the link's frame; a rotation
  Vec3 moments;  // about them
};
PrincipalInertia principal_inertia(const Inertia& J);

}  // namespace vp::bench
