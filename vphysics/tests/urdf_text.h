// Pieces of URDF for tests.
#pragma once

#include <string>

#include "trees.h"
#include "vphysics/multibody/urdf.h"

namespace vp::test {

inline std::string robot(const std::string& inside) {
  return "<robot name=\"r\">\n" + inside + "</robot>\n";
}
// A link element with an inertia, on one line.
inline std::string body(const std::string& name) {
  return "<link name=\"" + name +
         "\"><inertial><mass value=\"2\"/><inertia ixx=\"0.3\" ixy=\"0\" ixz=\"0\" iyy=\"0.4\" "
         "iyz=\"0\" izz=\"0.5\"/></inertial></link>\n";
}
inline std::string joint(const std::string& name, const std::string& type,
                         const std::string& parent, const std::string& child,
                         const std::string& more = "") {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent +
         "\"/><child link=\"" + child + "\"/>" + more + "</joint>\n";
}
inline std::string one_joint(const std::string& type, const std::string& more) {
  return robot("<link name=\"base\"/>\n" + body("b") + joint("j", type, "base", "b", more));
}
inline const std::string kLimit = "<limit effort=\"1\" velocity=\"1\"/>";

inline UrdfModel must_parse(const std::string& text, const UrdfOptions& options = {}) {
  return must_build(parse_urdf(text, options));
}

}  // namespace vp::test
