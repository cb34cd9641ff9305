// A URDF document checked and cleaned, before urdfdom sees it.
//
// urdfdom tells no lines, recurses as deep as its input, prints, and leaves circles of links aside.
// So every fault that a file can have is found here, by line; what is kept is only what it needs,
// with every number written anew.
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
    int line, order;  // order: its place among the joints
    std::string parent, child, mimics;
    int parent_line, child_line, mimic_line;  // mimic_line: 0 if it mimics none
  };
  std::map<std::string, int> links;      // line of each
  std::map<std::string, int> inertials;  // by the link's name
  std::map<std::string, Joint> joints;
  std::map<std::string, std::vector<UrdfCollision>> collisions;  // by the link's name
};

// Written into a document for what has no bound: URDF has no word for it.
inline constexpr double kUrdfUnbounded = 1e300;

std::string urdf_note(int line, const std::string& what);
Error urdf_error(int line, const std::string& what);

// Leaves of the document what builds a model; tells where it stood, and in notes what was left out
// or mended. What has no meaning is an error.
Expected<UrdfLines> check_urdf(tinyxml2::XMLElement& robot, std::vector<std::string>& notes);

// The links are one tree: every name is known, one root, one parent each, no circle. Mimics that
// cannot be are taken out of lines, with a note.
Expected<void> check_tree(UrdfLines& lines, std::vector<std::string>& notes);
// Of a joint that mimics another.
void ignore_mimic(const std::string& name, UrdfLines::Joint& joint, const std::string& why,
                  std::vector<std::string>& notes);

}  // namespace vp::detail
