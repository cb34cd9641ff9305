// Stops fast rotating bodies before they pass through another body within a step.
//
// Contacts are found at the poses at the start of a step, with the points and normals that the two
// bodies have there. For a body that rotates far within the step these are not where it will touch,
// and it may pass. So, after the sub-steps, such a body is swept from its start to its end pose
// against each body that its contacts name and that does not move far itself. If it has passed
// through one or overlaps it deeply at the end, its motion ends at the first impact. Its velocity
// remains: the next step solves the contact. Bodies with joints are not stopped. These and bodies
// that meet others that also move far need BodyDesc::continuous.
#pragma once

#include <cstdint>
#include <vector>

namespace vp {

struct Stores;

struct ShortenedMotion {
  std::uint32_t body;
  float fraction;  // of its displacement in the step
};

struct FastRotationScratch {
  std::vector<std::uint8_t> rotates_fast;  // of each awake body
  std::vector<ShortenedMotion> shortened;
};

// Precondition: the bodies have their poses at the start of the step, the states their
// displacements at its end. Shortens displacements, and sets Body::shortened.
void stop_fast_rotating_bodies(const Stores& stores, FastRotationScratch& scratch);

}  // namespace vp
