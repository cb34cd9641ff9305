// What the engine tells of a world, and where a hand holds a body, as marks over the picture.
#pragma once

#include "core/simulation.h"
#include "view/marks.h"

namespace sandbox {

// Of options the switches count; sizes follow from the scene's own. origin: of the picture, in the
// world.
void add_marks(const Simulation& simulation, const vp::DebugDrawOptions& options,
               const vp::Vec3& origin, Marks& marks);

}  // namespace sandbox
