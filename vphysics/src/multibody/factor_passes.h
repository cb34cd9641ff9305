// The passes of ImpulseFactor (impulse_factor.h) over a tree, compiled for several instruction
// sets, all to the same bits: without fused multiply-add and in one order (kernels.h).
//
// Where nodes are alike, lanes are slots (lanes.h); of one node they are the numbers of a twist or
// a wrench; of rows, those of one point.
#pragma once

#include <cstddef>
#include <cstdint>

namespace vphysics_factor {

// Of each node: where its inertia is among those of the slots, and the degrees of freedom that
// carry its body and its parent's, or kNone. Of each degree of freedom: twist, acceleration, force.
struct Bodies {
  std::size_t nodes;
  const double* inertias;
  const std::uint32_t *inertia_at, *body, *parent;
  const void* V;
  void *A, *F;
};
inline constexpr std::uint32_t kNone = 0xffffffffu;

// What is `const void*` is of the namespace of a set: layouts are one.
struct Passes {
  // Of all slots the inertia of its body in the tree's frame, by groups as kernels have them: mass,
  // first moment, rotational inertia. bodies: the same in the nodes' own frames.
  void (*inertias)(const void* tree, const void* work, const double* bodies, double* inertias);
  // The twists of the kinematics and the trees' origins, of poses that stay in the trees' frames.
  void (*velocities)(const void* tree, void* work, const double* q, const double* v);
  // columns: of each degree of freedom; J: kArticulated numbers of each node, scratch. False if a
  // joint moves no inertia.
  bool (*factor)(const void* tree, const void* work, double damping_time, const double* inertias,
                 void* columns, double* J);
  // y of three wrenches on what carries `dof`, one behind the other, each `depth` numbers long.
  void (*rows)(const void* columns, const std::uint32_t* next, std::uint32_t dof,
               const void* wrenches, std::size_t depth, double* y);
  // ImpulseFactor::bias() without its sums inwards, and twists().
  void (*body_forces)(const Bodies& bodies, const double* gravity);
  void (*twists)(const void* columns, const std::uint32_t* inwards, const std::uint32_t* next,
                 std::size_t dofs, const double* v, void* V);
  // Of some nodes, ascending: adds their inertias to *inertia and their momenta to *momentum, at
  // the twists V of what carries them, or without V at those of the kinematics.
  void (*momenta)(const Bodies& bodies, const int* nodes, std::size_t count, const void* work,
                  void* inertia, void* momentum);
};
inline constexpr int kInertia = 10;      // numbers of a body's inertia
inline constexpr int kArticulated = 48;  // six columns of six and two

extern const Passes kBaseline;
// Only in libraries built with VP_INSTRUCTION_SETS.
extern const Passes kAvx2, kAvx512;

}  // namespace vphysics_factor
