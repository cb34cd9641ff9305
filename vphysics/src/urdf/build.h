// A checked document becomes a model: urdfdom makes the tree, the model's builder its links.
#pragma once

#include <string>

#include "urdf/check.h"
#include "vphysics/multibody/urdf.h"

namespace vp::detail {

// text: what check_urdf has left of the document.
Expected<UrdfModel> build_urdf(const std::string& text, const UrdfLines& lines,
                               const UrdfOptions& options);

}  // namespace vp::detail
