// parse_urdf on a stranger's text. What is refused has a line; what is accepted has numbers that
// the algorithms can work with.
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "vphysics/multibody/dynamics.h"
#include "vphysics/multibody/urdf.h"

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
  return 0;
}
