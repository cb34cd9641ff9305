// A checked document becomes a model: urdfdom makes the tree, the model's builder its links.
#pragma once

#include <string>

#include "urdf/check.h"
#include "vphysics/multibody/urdf.h"

namespace vp::detail {

// text: what check_urdf has left of the document. notes: of what was left out or mended until here.
Expected<UrdfModel> build_urdf(const std::string& text, const UrdfLines& lines,
                               const UrdfOptions& options, std::vector<std::string> notes);

}  // namespace vp::detail
