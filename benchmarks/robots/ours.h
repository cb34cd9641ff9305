#pragma once

#include <memory>

#include "robots.h"

namespace robots {

std::unique_ptr<Simulation> make_ours(const Robot& robot, double dt);

}  // namespace robots
