#include "urdf/mend.h"

#include <algorithm>
#include <cmath>

#include "multibody/principal.h"

namespace vp::detail {
namespace {

double size_of(const Sym3& a) {
  return std::fabs(a.xx) + std::fabs(a.yy) + std::fabs(a.zz);
}

// The motion subspace of a URDF joint, in its link's frame, which is the joint's frame.
std::vector<se3> columns_of(const Joint& joint) {
  if (const auto* revolute = std::get_if<RevoluteJoint>(&joint)) {
    return {{(1.0 / norm(revolute->axis)) * revolute->axis, {}}};
  }
  if (const auto* prismatic = std::get_if<PrismaticJoint>(&joint)) {
    return {{{}, (1.0 / norm(prismatic->axis)) * prismatic->axis}};
  }
  const Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  if (std::holds_alternative<PlanarJoint>(joint)) return {{{}, x}, {{}, y}, {z, {}}};
  if (std::holds_alternative<FreeJoint>(joint)) {
    return {{x, {}}, {y, {}}, {z, {}}, {{}, x}, {{}, y}, {{}, z}};
  }
  return {};
}

// Eliminates the joint's columns from J: the articulated inertia seen by the parent. Returns false
// if the inertia along a column is zero, or negligible beside the size of J.
bool eliminate_joint(AInertia& J, const std::vector<se3>& columns, double armature) {
  const double angular = size_of(J.angular()), linear = size_of(J.linear());
  for (const se3& S : columns) {
    const dse3 F = J * S;
    const double along = S * F + armature;
    if (!(along > 1e-12 * (S.w == Vec3{} ? linear : angular))) return false;
    J = J - outer(1.0 / along, F);
  }
  return true;
}

// Of the whole tree: its mass, and the maximum distance of a link from the root, along the links.
struct Scale {
  double mass = 0.0, length = 0.0;
};
Scale scale_of(const std::vector<LinkSpec>& links) {
  Scale scale;
  std::vector<double> reaches;
  for (const LinkSpec& link : links) {
    double max_offset = 0.0;
    if (link.parent != kWorld) {
      max_offset =
          reaches[static_cast<std::size_t>(link.parent)] + norm(link.T_parent_joint.position());
    }
    reaches.push_back(max_offset);
    scale.mass += link.inertia.mass();
    scale.length = std::max(scale.length, max_offset);
  }
  if (!(scale.mass > 0.0)) scale.mass = 1.0;
  if (!(scale.length > 0.0)) scale.length = 1.0;
  return scale;
}

}  // namespace

StatedMoments judged(double mass, const Sym3& moments) {
  const double slack = 1e-9 * size_of(moments);
  const std::array<double, 3> m = principal_of(moments).moments;
  if (m[0] < -slack) return StatedMoments::negative;
  const bool too_much = m[2] > m[0] + m[1] + 2.0 * slack;
  const bool without_mass = !(mass > 0.0) && moments != Sym3{};
  return too_much || without_mass ? StatedMoments::non_physical : StatedMoments::physical;
}

Sym3 without_negative(const Sym3& moments) {
  const Principal p = principal_of(moments);
  Sym3 out{};
  for (std::size_t k = 0; k < 3; ++k) out = out + outer(std::max(p.moments[k], 0.0), p.axes[k]);
  return out;
}

std::vector<int> add_armatures(std::vector<LinkSpec>& links) {
  std::vector<int> given;
  const Scale scale = scale_of(links);
  std::vector<AInertia> child_inertias(links.size());  // of each link, by its descendants
  for (std::size_t i = links.size(); i-- > 0;) {
    LinkSpec& link = links[i];
    const AInertia J = child_inertias[i] + link.inertia;
    const std::vector<se3> columns = columns_of(link.joint);
    AInertia beyond = J;
    if (!eliminate_joint(beyond, columns, link.armature)) {
      const bool slides = std::holds_alternative<PrismaticJoint>(link.joint);
      link.armature = 1e-6 * scale.mass * (slides ? 1.0 : scale.length * scale.length);
      given.push_back(static_cast<int>(i));
      beyond = J;
      eliminate_joint(beyond, columns, link.armature);
    }
    if (link.parent == kWorld) continue;
    AInertia& below = child_inertias[static_cast<std::size_t>(link.parent)];
    below = below + beyond.Xform(Inv(link.T_parent_joint));
  }
  std::reverse(given.begin(), given.end());
  return given;
}

}  // namespace vp::detail
