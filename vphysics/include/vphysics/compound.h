// Several convex shapes that move as one. Lengths in metres.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "vphysics/error.h"
#include "vphysics/lie.h"

namespace vp {

namespace collide {
struct CompoundData;
}
struct CompoundPart;  // a shape and where it is: shapes.h

// A handle: copies share the same constant data, which may be used by any number of colliders,
// worlds and threads. As one collider it has one material and one set of events, and costs less to
// move than a collider for each part.
class Compound {
 public:
  // Parts are spheres, boxes, capsules, cylinders, cones, convex hulls, or compounds, whose parts
  // are taken instead. Refused: no parts or, with those of compounds, more than 2^16; half-spaces,
  // meshes and height fields, which move nowhere: give each a collider; sizes and poses that a
  // collider would be refused for.
  [[nodiscard]] static Expected<Compound> of(std::span<const CompoundPart> parts);

  // Precondition of all below: not moved from.
  // In the order given, compounds replaced by their parts. A contact's sub-shape is an index of
  // these.
  std::span<const CompoundPart> parts() const;
  // Of all parts, each of the same density [kg/m^3], about the frame's origin. What two parts both
  // fill counts twice.
  Inertia inertia(double density) const;

  // For the engine; null if moved from.
  const std::shared_ptr<const collide::CompoundData>& data() const { return data_; }

 private:
  explicit Compound(std::shared_ptr<const collide::CompoundData> data) : data_(std::move(data)) {}
  std::shared_ptr<const collide::CompoundData> data_;
};

}  // namespace vp
