// Robots from URDF in a World: links with the joints of the format (multibody/urdf.h), and one
// collider for each <collision> element.
//
//   vp::UrdfWorldOptions options;
//   options.base = vp::UrdfBase::floating;
//   options.T_world_root = vp::SE3(vp::Vec3{0, 0, 0.5});
//   options.folders = {"robots"};  // package://dog/meshes/leg.stl is robots/dog/meshes/leg.stl
//   const auto dog = vp::add_urdf(world, "robots/dog/dog.urdf", options);
//   if (!dog) std::puts(dog.error().message.c_str());
//   for (const std::string& note : dog->notes) std::puts(note.c_str());
//
// Boxes, spheres, cylinders and capsules become shapes of the same kind. Meshes (mesh_file.h)
// become convex hulls, one for each object of the file, or triangle meshes where a link does not
// move. Links of one robot collide with each other if UrdfWorldOptions::links_collide is true.
// UrdfWorldOptions::filter excludes further collisions.
//
// A robot in which no joint moves, such as a table or a cup, becomes one body of the world.
//
// Part of the library VirtualPhysics::urdf. Nothing is printed, nothing is thrown. The calling
// thread reads the files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "vphysics/mesh_file.h"
#include "vphysics/multibody/urdf.h"
#include "vphysics/world.h"

namespace vp {

struct UrdfWorldOptions {
  UrdfBase base = UrdfBase::fixed;
  SE3 T_world_root{};  // the root link's pose, with every joint at zero
  // For every collider:
  Material material{};
  CollisionFilter filter{};
  std::uint64_t user_data = 0;
  bool links_collide = false;  // each link with all but its neighbours (ArticulationDesc)
  // If above zero [kg/m^3]: links without mass that have collision geometry get its mass and
  // inertia, and links with a mass but no moments of inertia get its moments. Triangle meshes
  // contribute none.
  double density = 0.0;

  // Search path of meshes. package://NAME/REST and model://NAME/REST: in each folder as NAME/REST,
  // and as REST in a folder called NAME; then in the parent folders of the URDF file, from its own
  // upwards. A relative path: in the file's folder, then in each of these folders.
  std::vector<std::string> folders{};
  // If set, it returns the bytes of a mesh, given its name in the file, and no file is opened. For
  // archives and tests.
  std::function<Expected<std::string>(const std::string& name)> read_mesh{};
  MeshLimits limits{};
  // True: meshes of links that do not move become triangle meshes, so that concave shapes stay
  // concave.
  bool triangles_where_fixed = false;
  MeshOptions triangles{};
  HullOptions hull{};
  std::size_t max_hulls = 16;  // per mesh; a mesh of more objects becomes one hull
  // True: a collider that cannot be made is an error. False: it is omitted, with a note.
  bool require_all = false;
};

struct UrdfRobot {
  UrdfModel urdf;
  ArticulationId articulation{};  // null if no joint moves
  BodyId body{};                  // the robot, if no joint moves; else null
  // One for each of urdf.collisions; null if omitted.
  std::vector<ColliderId> colliders{};
  // What was omitted or corrected, from urdf.notes and for colliders: "dog.urdf: line 12: ...".
  std::vector<std::string> notes{};

  // The body of a link; of a robot that is one body, that body. Null if there is no such link.
  BodyId link_body(const World& world, std::string_view link) const;
};

// Adds the robot of a file. An error changes nothing. Its message begins with the path and, for an
// error in the file, the line. The errors are those of load_urdf() (except that a fixed robot
// without moving joints is valid), of World::create_articulation() and, with require_all, of
// colliders.
//
// Omitted, with a note: meshes that are missing, cannot be read or have no extent; sizes that are
// invalid for shapes. Corrected, with a note: flat meshes and boxes, which get a thickness; a
// mimic, which a world does not support; for a robot that is one body, an invalid inertia, which
// the colliders' inertia replaces.
[[nodiscard]] Expected<UrdfRobot> add_urdf(World& world, const std::string& path,
                                           const UrdfWorldOptions& options = {});
// Adds a robot that has been read. The model defines base and T_world_root. The robot starts at
// zero coordinates. The path is that of its file, for meshes and notes; it may be empty.
[[nodiscard]] Expected<UrdfRobot> add_urdf(World& world, UrdfModel robot, const std::string& path,
                                           const UrdfWorldOptions& options = {});

}  // namespace vp
