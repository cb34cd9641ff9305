// One number per slot, for sixteen slots: the storage of contact blocks and joint blocks.
#pragma once

#include <cstdint>

namespace vphysics_solver {

inline constexpr int kLanes = 16;

struct alignas(64) Field {
  float lane[kLanes];
};
struct alignas(64) IndexField {
  std::uint32_t lane[kLanes];
};
struct Field3 {
  Field x, y, z;
};
struct FieldSym3 {
  Field xx, yy, zz, xy, yz, zx;
};

}  // namespace vphysics_solver

namespace vp::solve {
using namespace vphysics_solver;  // NOLINT(google-build-using-namespace): see passes.h
}  // namespace vp::solve
