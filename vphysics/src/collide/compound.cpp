#include "vphysics/compound.h"

#include <cmath>
#include <string>
#include <utility>

#include "collide/compound_data.h"
#include "vphysics/shapes.h"

namespace vp {
namespace {

constexpr std::size_t kMaxParts = std::size_t{1} << 16;
constexpr double kMinPart = 1e-6, kLargestPart = 1e9;  // [m], the engine's limits

tl::unexpected<Error> invalid_compound(std::string message) {
  return tl::make_unexpected(Error{Errc::invalid_argument, "compound: " + std::move(message)});
}

bool is_size(double x) {
  return x >= kMinPart && x <= kLargestPart;
}
bool has_size(const Vec3& a) {
  return is_size(a.x) && is_size(a.y) && is_size(a.z);
}
bool is_near(const Vec3& a) {
  return std::fabs(a.x) <= kLargestPart && std::fabs(a.y) <= kLargestPart &&
         std::fabs(a.z) <= kLargestPart;
}

bool is_proper_pose(const SE3& T) {
  constexpr double kTolerance = 1e-6;
  const Mat3& R = T.rotation();
  return is_near(T.position()) && std::fabs(dot(R.cx, R.cx) - 1.0) < kTolerance &&
         std::fabs(dot(R.cy, R.cy) - 1.0) < kTolerance && std::fabs(dot(R.cx, R.cy)) < kTolerance &&
         norm(cross(R.cx, R.cy) - R.cz) < kTolerance;
}

// The problem with a part, or nullptr.
const char* problem_with_part(const Shape& shape) {
  if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    return is_size(sphere->radius) ? nullptr : "its radius must be from 1e-6 to 1e9 m";
  }
  if (const auto* box = std::get_if<Box>(&shape)) {
    return has_size(box->half_extents) ? nullptr : "its half extents must be from 1e-6 to 1e9 m";
  }
  if (const auto* capsule = std::get_if<Capsule>(&shape)) {
    const bool good = is_size(capsule->radius) && capsule->half_length >= 0.0 &&
                      capsule->half_length <= kLargestPart;
    return good ? nullptr : "its radius must be from 1e-6 to 1e9 m, its half length from 0";
  }
  if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
    return is_size(cylinder->radius) && is_size(cylinder->half_length)
               ? nullptr
               : "its radius and half length must be from 1e-6 to 1e9 m";
  }
  if (const auto* cone = std::get_if<Cone>(&shape)) {
    return is_size(cone->radius) && is_size(cone->half_height)
               ? nullptr
               : "its radius and half height must be from 1e-6 to 1e9 m";
  }
  if (const auto* hull = std::get_if<ConvexHull>(&shape)) {
    return hull->data() ? nullptr : "its convex hull was moved from; give a copy";
  }
  if (const auto* compound = std::get_if<Compound>(&shape)) {
    return compound->data() ? nullptr : "its compound was moved from; give a copy";
  }
  return "half-spaces, meshes and height fields are no parts; give each a collider of its own";
}

Expected<void> append(std::span<const CompoundPart> parts, std::vector<CompoundPart>& all) {
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const auto refused = [&](const char* problem) {
      return invalid_compound("part " + std::to_string(i) + ": " + problem);
    };
    if (const char* problem = problem_with_part(parts[i].shape)) return refused(problem);
    if (!is_proper_pose(parts[i].T_compound_part)) {
      return refused("its pose must be a rotation and a position within 1e9 m");
    }
    if (const auto* inner = std::get_if<Compound>(&parts[i].shape)) {
      for (const CompoundPart& part : inner->parts()) {
        all.push_back({part.shape, parts[i].T_compound_part * part.T_compound_part});
      }
    } else {
      all.push_back(parts[i]);
    }
    if (all.size() > kMaxParts) {
      return invalid_compound("more than 2^16 parts; split it into several compounds");
    }
  }
  return {};
}

}  // namespace

Expected<Compound> Compound::of(std::span<const CompoundPart> parts) {
  if (parts.empty()) return invalid_compound("there are no parts; give at least one");
  auto data = std::make_shared<collide::CompoundData>();
  if (const Expected<void> appended = append(parts, data->parts); !appended) {
    return tl::make_unexpected(appended.error());
  }
  std::vector<collide::TreeItem> items;
  collide::Bounds total_bounds;
  for (std::uint32_t i = 0; i < data->parts.size(); ++i) {
    const CompoundPart& part = data->parts[i];
    data->geometries.push_back(collide::make_geometry(part.shape));
    const collide::Bounds b = bounds_of(data->geometries.back(), part.T_compound_part);
    items.push_back({collide::rounded_outward(b), i});
    total_bounds = merged(total_bounds, b);
    data->unit = data->unit + solid_inertia(part.shape, 1.0).InvXform(part.T_compound_part);
  }
  data->lower = total_bounds.lower;
  data->upper = total_bounds.upper;
  data->tree.build(items, collide::BoundingTree::Effort::careful);
  return Compound(std::move(data));
}

std::span<const CompoundPart> Compound::parts() const {
  return data_->parts;
}
Inertia Compound::inertia(double density) const {
  const Inertia& unit = data_->unit;
  return {density * unit.mass(), density * unit.first_moment(), density * unit.rotational()};
}

}  // namespace vp
