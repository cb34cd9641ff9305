// Converts a checked document to a model: urdfdom builds the tree, the model builder its links.
#pragma once

#include <string>

#include "urdf/check.h"
#include "vphysics/multibody/urdf.h"

namespace vp::detail {

// text: the document after check_urdf. notes: what was omitted or repaired so far.
Expected<UrdfModel> build_urdf(const std::string& text, const UrdfLines& lines,
                               const UrdfOptions& options, std::vector<std::string> notes);

}  // namespace vp::detail
