// The engine's debug drawing of a world, and the grip on a body, as marks over the picture.
#pragma once

#include "core/simulation.h"
#include "view/marks.h"

namespace sandbox {

// Uses only the switches of the options; sizes follow from the scene's size. origin: of the
// picture, in the world.
void add_marks(const Simulation& simulation, const vp::DebugDrawOptions& options,
               const vp::Vec3& origin, Marks& marks);

}  // namespace sandbox
