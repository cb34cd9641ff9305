// Checks and cleans a URDF document before urdfdom parses it.
//
// urdfdom reports no lines, recurses as deep as its input, prints, and ignores cycles of links. The
// checks here therefore find every possible fault of a file, with its line. The cleaned document
// contains only what urdfdom needs, with all numbers rewritten.
#pragma once

#include <tinyxml2.h>

#include <map>
#include <string>
#include <vector>

#include "vphysics/error.h"
#include "vphysics/multibody/urdf.h"

namespace vp::detail {

struct UrdfLines {
  struct Joint {
    int line, order;  // order: index among the joints
    std::string parent, child, mimics;
    int parent_line, child_line, mimic_line;  // mimic_line: 0 if it mimics no joint
  };
  std::map<std::string, int> links;      // line of each link
  std::map<std::string, int> inertials;  // by link name
  std::map<std::string, Joint> joints;
  std::map<std::string, std::vector<UrdfCollision>> collisions;  // by link name
};

// Written to the document for a missing bound, which URDF cannot express.
inline constexpr double kUrdfUnbounded = 1e300;

std::string urdf_note(int line, const std::string& what);
Error urdf_error(int line, const std::string& what);

// Reduces the document to what the model needs. Returns the lines of its elements, and lists in
// notes what was omitted or repaired. Invalid content is an error.
Expected<UrdfLines> check_urdf(tinyxml2::XMLElement& robot, std::vector<std::string>& notes);

// Checks that the links form one tree: all names known, one root, one parent each, no cycle.
// Removes invalid mimics from lines, with a note.
Expected<void> check_tree(UrdfLines& lines, std::vector<std::string>& notes);
// Removes the mimic of a joint, with a note.
void ignore_mimic(const std::string& name, UrdfLines::Joint& joint, const std::string& why,
                  std::vector<std::string>& notes);

}  // namespace vp::detail
