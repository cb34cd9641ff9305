// Robots from URDF in a World: links as the format's joints move them (multibody/urdf.h), and a
// collider for each of their <collision> elements.
//
//   vp::UrdfWorldOptions options;
//   options.base = vp::UrdfBase::floating;
//   options.T_world_root = vp::SE3(vp::Vec3{0, 0, 0.5});
//   options.folders = {"robots"};  // package://dog/meshes/leg.stl is robots/dog/meshes/leg.stl
//   const auto dog = vp::add_urdf(world, "robots/dog/dog.urdf", options);
//   if (!dog) std::puts(dog.error().message.c_str());
//   for (const std::string& note : dog->notes) std::puts(note.c_str());
//
// Boxes, spheres, cylinders and capsules are shapes of the same kind. Meshes (mesh_file.h) are
// convex hulls, one for each object of the file, or triangles where a link does not move. Links of
// one robot meet each other if UrdfWorldOptions::links_collide says so; UrdfWorldOptions::filter
// says what else does not meet.
//
// A robot of which no joint moves, such as a table or a cup, is one body of the world.
//
// Of the library VirtualPhysics::urdf. Nothing is printed, nothing is thrown. Files are read by the
// calling thread.
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
  // Of every collider.
  Material material{};
  CollisionFilter filter{};
  std::uint64_t user_data = 0;
  bool links_collide = false;  // ArticulationDesc has it: each with all but its neighbours
  // If above zero [kg/m^3], links without mass that have collision geometry get the mass and
  // inertia of its volume, and those with a mass but no moments its moments; triangles have none.
  double density = 0.0;

  // Where meshes are looked for. package://NAME/REST and model://NAME/REST: in each folder as
  // NAME/REST, and as REST where the folder is called NAME; then in the folders that the URDF file
  // lies in, from its own upwards. A relative path: from the file's folder, then from each of
  // these.
  std::vector<std::string> folders{};
  // If set, meshes are asked for here, by their name in the file, and no file is opened: for
  // archives and tests. It returns the file's bytes.
  std::function<Expected<std::string>(const std::string& name)> read_mesh{};
  MeshLimits limits{};
  // Of links that do not move, meshes are triangles: what is hollow stays hollow.
  bool triangles_where_fixed = false;
  MeshOptions triangles{};
  HullOptions hull{};
  std::size_t max_hulls = 16;  // of a mesh; one of more objects is one hull
  // A collider that cannot be made is an error. Else it is left out, with a note.
  bool require_all = false;
};

struct UrdfRobot {
  UrdfModel urdf;
  ArticulationId articulation{};  // null if no joint moves
  BodyId body{};                  // then the robot; else null
  // One for each of urdf.collisions; null if it was left out.
  std::vector<ColliderId> colliders{};
  // What was left out or mended, of urdf.notes and of colliders: "dog.urdf: line 12: ...".
  std::vector<std::string> notes{};

  // The body of a link: of a robot that is one body, that body. Null if there is no such link.
  BodyId link_body(const World& world, std::string_view link) const;
};

// Adds the robot of a file. An error changes nothing, and its message begins with the path and, of
// what is wrong in the file, the line. Errors are those of load_urdf() (a fixed robot of which no
// joint moves is none), of World::create_articulation(), and with require_all of colliders.
//
// Noted, and left out: meshes that are not there, cannot be read or have no extent; sizes that
// shapes do not have. Noted, and mended: flat meshes and boxes, which are given a thickness; a
// mimic, which a world does not hold; for bodies, an inertia that no body has, in place of which
// that of the colliders is taken.
[[nodiscard]] Expected<UrdfRobot> add_urdf(World& world, const std::string& path,
                                           const UrdfWorldOptions& options = {});
// The same of a robot that has been read: base and T_world_root are the model's, which stands at
// zero coordinates. The path is that of its file, for meshes and notes; it may be empty.
[[nodiscard]] Expected<UrdfRobot> add_urdf(World& world, UrdfModel robot, const std::string& path,
                                           const UrdfWorldOptions& options = {});

}  // namespace vp
