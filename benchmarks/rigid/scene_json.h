// A scene as JSON, for engines that are driven from JavaScript.
#pragma once

#include <string>

#include "scenes/scene.h"

namespace rigid {

// Returns false if the file cannot be written.
bool write_json(const scenes::Scene& scene, const std::string& file);

}  // namespace rigid
