// parse_urdf on untrusted text. An error names a line. An accepted model has numbers that are valid
// for the algorithms; the world accepts or rejects it.
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "vphysics/multibody/dynamics.h"
#include "vphysics/multibody/urdf.h"
#include "vphysics/urdf_world.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vp;
  if (size < 1) return 0;
  const UrdfOptions options{data[0] & 1 ? UrdfBase::floating : UrdfBase::fixed, {}};
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  const auto read = parse_urdf(text, options);
  if (!read) {
    if (read.error().message.rfind("line ", 0) != 0) std::abort();
    return 0;
  }
  const Model& model = read->model;
  if (model.velocities() > 500) return 0;
  Data work(model);
  const std::vector<double> q = model.zero_coordinates();
  const std::vector<double> v(static_cast<std::size_t>(model.velocities()));
  std::vector<double> a(v.size());
  (void)forward_dynamics<double>(model, work, q, v, v, {}, a);
  for (const UrdfJoint& joint : read->joints) {
    if (joint.link < 0 || joint.link >= model.links()) std::abort();
  }
  if (read->collisions.size() > 50 || model.links() > 50) return 0;
  UrdfWorldOptions in_world;
  in_world.density = data[0] & 2 ? 100.0 : 0.0;
  in_world.triangles_where_fixed = data[0] & 4;
  in_world.read_mesh = [](const std::string&) -> Expected<std::string> {
    return "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
  };
  World world;
  const auto robot = add_urdf(world, *read, "", in_world);
  if (!robot) {
    if (robot.error().message.empty()) std::abort();
    return 0;
  }
  if (robot->colliders.size() != read->collisions.size()) std::abort();
  for (int k = 0; k < 3; ++k) {
    if (!world.step(0.001)) std::abort();
  }
  return 0;
}
