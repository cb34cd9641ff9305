// A scene by name: one of the catalogue, or "tableN", the foosball table with N balls.
#pragma once

#include <string_view>

#include "scenes/scene.h"
#include "vphysics/error.h"

namespace rigid {

vp::Expected<scenes::Scene> load(std::string_view name);
inline bool is_table(std::string_view name) {
  return name.starts_with("table");
}

}  // namespace rigid
