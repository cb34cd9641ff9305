// A rigid collection of convex shapes. Lengths in metres.
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
struct CompoundPart;  // a shape and its pose: shapes.h

// A handle: copies share the same constant data. Any number of colliders, worlds and threads may
// use it. A compound is one collider: it has one material and one set of events, and moves at a
// lower cost than one collider for each part.
class Compound {
 public:
  // Valid parts: spheres, boxes, capsules, cylinders, cones, convex hulls, and compounds, which are
  // replaced by their parts. Errors: no parts; more than 2^16 parts, those of compounds included;
  // half-spaces, meshes and height fields (give each its own collider); sizes and poses that are
  // invalid for a collider.
  [[nodiscard]] static Expected<Compound> of(std::span<const CompoundPart> parts);

  // Precondition of all functions below: not moved from. The parts in the order given, with
  // compounds replaced by their parts. A contact's sub-shape is an index into this list.
  std::span<const CompoundPart> parts() const;
  // The sum over all parts, each of the same density [kg/m^3], about the frame's origin. Where two
  // parts overlap, the volume counts twice.
  Inertia inertia(double density) const;

  // For the engine. Null if moved from.
  const std::shared_ptr<const collide::CompoundData>& data() const { return data_; }

 private:
  explicit Compound(std::shared_ptr<const collide::CompoundData> data) : data_(std::move(data)) {}
  std::shared_ptr<const collide::CompoundData> data_;
};

}  // namespace vp
