// Restarts of the displacements of states. A state's displacement is in single precision, so that
// it starts again at zero now and then (body_states.cpp). What is relative to it follows.
#pragma once

#include <cstdint>
#include <vector>

namespace vp {

struct Stores;

// The displacement of the state of the body becomes zero. Contacts with points become dirty; the
// others keep what is left of their clearance, or nothing unless keeps_clearances.
void restart_displacement(const Stores& stores, std::uint32_t body, bool keeps_clearances = true);

// The same for several bodies at the start of a step, by several workers. What must be tested again
// is not dirty yet: the passes that look for what has moved find it. Precondition of run(): the
// bodies' states and start displacements were loaded for this step.
class Restarts {
 public:
  void reserve(std::size_t bodies);
  void add(std::uint32_t body, bool keeps_clearances);
  // Restarts what was added.
  void run(const Stores& stores);

 private:
  enum class Kind : std::uint8_t { none, keeps_clearances, forgets_them };

  void restart_contacts_of(const Stores& stores, std::uint32_t body) const;

  std::vector<std::uint32_t> bodies_;
  std::vector<Kind> kinds_;  // of each body of the world
};

}  // namespace vp
