// The passes of ImpulseFactor (impulse_factor.h) over a tree, compiled for several instruction
// sets. All give the same bits: they use no fused multiply-add and the same order (kernels.h).
//
// SIMD lanes are slots where nodes are independent (lanes.h). Where they depend on each other, the
// lanes are the components of one node's twist or wrench. In rows(), they are the wrenches.
#pragma once

#include <cstddef>
#include <cstdint>

namespace vphysics_factor {

// Of each node: the offset of its inertia in `inertias`, and the degrees of freedom that carry its
// body and its parent's body, or kNone. Of each degree of freedom: the twist V, acceleration A and
// force F of the body that it carries.
struct Bodies {
  std::size_t nodes;
  const double* inertias;
  const std::uint32_t *inertia_at, *body, *parent;
  const void* V;
  void *A, *F;
};
inline constexpr std::uint32_t kNone = 0xffffffffu;

// `void*` stands for types that each instruction set has in a namespace of its own, with the same
// layout.
struct Passes {
  // Computes the inertia of each slot's body in the tree's frame, by groups of slots: mass, first
  // moment, rotational inertia. bodies: the same in the nodes' own frames.
  void (*inertias)(const void* tree, const void* work, const double* bodies, double* inertias);
  // Updates the twists of the kinematics and the trees' origins. Precondition: the poses in the
  // trees' frames have not changed.
  void (*velocities)(const void* tree, void* work, const double* q, const double* v);
  // ImpulseFactor::factor(). gains: one for each degree of freedom, or null. columns: a
  // FactorColumn for each degree of freedom. J: scratch, kArticulated numbers for each node.
  // Returns false if a joint moves no inertia.
  bool (*factor)(const void* tree, const void* work, double damping_time, const double* gains,
                 const double* inertias, void* columns, double* J);
  // Computes y for three wrenches on the body that `dof` carries: three times `depth` numbers, one
  // wrench after the other.
  void (*rows)(const void* columns, const std::uint32_t* next, std::uint32_t dof,
               const void* wrenches, std::size_t depth, double* y);
  // ImpulseFactor::bias() without its tip-to-base sums.
  void (*body_forces)(const Bodies& bodies, const double* gravity);
  void (*twists)(const void* columns, const std::uint32_t* tip_to_base, const std::uint32_t* next,
                 std::size_t dofs, const double* v, void* V);
  // Adds the inertias and momenta of some nodes, ascending, to *inertia and *momentum. Uses the
  // twists V or, if V is null, those of the kinematics.
  void (*momenta)(const Bodies& bodies, const int* nodes, std::size_t count, const void* work,
                  void* inertia, void* momentum);
};
inline constexpr int kInertia = 10;      // numbers of a body's inertia
inline constexpr int kArticulated = 48;  // six columns, each padded to eight numbers

extern const Passes kBaseline;
// Only in libraries built with VP_INSTRUCTION_SETS.
extern const Passes kAvx2, kAvx512;

}  // namespace vphysics_factor
