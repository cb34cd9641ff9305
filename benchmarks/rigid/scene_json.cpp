#include "scene_json.h"

#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

namespace rigid {
namespace {

using nlohmann::json;

json vector(const vp::Vec3& a) {
  return {a.x, a.y, a.z};
}
json pose(const vp::SE3& T) {
  const auto q = vp::to_quaternion(T.rotation());
  return {{"position", vector(T.position())}, {"rotation", {q.x, q.y, q.z, q.w}}};
}
json limit(double angle) {
  return std::isfinite(angle) ? json(angle) : json(nullptr);
}

// The data of hulls and meshes, each once; shapes refer to them by index.
class Data {
 public:
  int index_of(const scenes::Hull& hull) {
    return index_of(hull.data.get(), [&] { return json{{"points", numbers(hull.data->points)}}; });
  }
  int index_of(const scenes::Mesh& mesh) {
    return index_of(mesh.data.get(), [&] {
      json indices = json::array();
      for (const auto& corners : mesh.data->corners) {
        for (const std::uint32_t corner : corners) indices.push_back(corner);
      }
      return json{{"vertices", numbers(mesh.data->vertices)}, {"indices", std::move(indices)}};
    });
  }
  json all() && { return std::move(all_); }

 private:
  static json numbers(const std::vector<vp::Vec3>& points) {
    json out = json::array();
    for (const vp::Vec3& p : points) {
      for (int i = 0; i < 3; ++i) out.push_back(p[i]);
    }
    return out;
  }
  template <class Make>
  int index_of(const void* data, const Make& make) {
    const auto [found, added] = indices_.try_emplace(data, static_cast<int>(all_.size()));
    if (added) all_.push_back(make());
    return found->second;
  }

  json all_ = json::array();
  std::map<const void*, int> indices_;
};

json shape(const scenes::Shape& shape, Data& data) {
  if (const auto* h = std::get_if<scenes::Hull>(&shape)) {
    return {{"kind", "hull"}, {"data", data.index_of(*h)}};
  }
  if (const auto* m = std::get_if<scenes::Mesh>(&shape)) {
    return {{"kind", "mesh"}, {"data", data.index_of(*m)}};
  }
  if (const auto* s = std::get_if<scenes::Sphere>(&shape)) {
    return {{"kind", "sphere"}, {"radius", s->radius}};
  }
  if (const auto* b = std::get_if<scenes::Box>(&shape)) {
    return {{"kind", "box"}, {"half", vector(b->half_extents)}};
  }
  if (const auto* c = std::get_if<scenes::Capsule>(&shape)) {
    return {{"kind", "capsule"}, {"radius", c->radius}, {"half_length", c->half_length}};
  }
  if (std::holds_alternative<scenes::Terrain>(shape)) return {{"kind", "terrain"}};
  return {{"kind", "ground"}};
}

json body(const scenes::Body& body, Data& data) {
  json out = {{"pose", pose(body.T_world_body)},
              {"velocity", vector(body.velocity)},
              {"spin", vector(body.spin)},
              {"parts", json::array()}};
  out["from_start"] = exists(body, 0.0);
  out["motion"] = body.motion == scenes::Motion::dynamic ? "dynamic"
                  : body.motion == scenes::Motion::fixed ? "fixed"
                                                         : "kinematic";
  if (body.motion == scenes::Motion::dynamic) {
    const scenes::Mass mass = scenes::mass_of(body);
    out["mass"] = mass.mass;
    out["moments"] = vector(mass.moments);
  }
  for (const scenes::Part& part : body.parts) {
    out["parts"].push_back({{"shape", shape(part.shape, data)},
                            {"pose", pose(part.T_body_shape)},
                            {"friction", part.material.friction},
                            {"restitution", part.material.restitution}});
  }
  return out;
}

const char* name_of(scenes::Event::Kind kind) {
  using Kind = scenes::Event::Kind;
  switch (kind) {
    case Kind::remove_joint:
      return "removeJoint";
    case Kind::remove_body:
      return "removeBody";
    case Kind::add_body:
      return "addBody";
    case Kind::add_joint:
      return "addJoint";
    case Kind::launch:
      return "launch";
  }
  return "";
}

json joint(const scenes::Scene& scene, const scenes::Joint& joint) {
  return {{"kind", joint.kind == scenes::Joint::Kind::ball ? "ball" : "hinge"},
          {"a", joint.a},
          {"b", joint.b},
          {"in_a", pose(joint.T_a_joint)},
          {"in_b", pose(joint.T_b_joint)},
          // The joint's x and z axes in both bodies, for engines that take no quaternion.
          {"x_a", vector(joint.T_a_joint.rotation().cx)},
          {"z_a", vector(joint.T_a_joint.rotation().cz)},
          {"x_b", vector(joint.T_b_joint.rotation().cx)},
          {"z_b", vector(joint.T_b_joint.rotation().cz)},
          {"from_start", exists(scene, joint, 0.0)},
          {"lower", limit(joint.lower)},
          {"upper", limit(joint.upper)}};
}

}  // namespace

bool write_json(const scenes::Scene& scene, const std::string& file) {
  json out = {
      {"name", scene.name},      {"seconds", scene.seconds}, {"gravity", vector(scene.gravity)},
      {"bodies", json::array()}, {"joints", json::array()},  {"launches", json::array()},
      {"events", json::array()}};
  Data data;
  for (const scenes::Body& b : scene.bodies) out["bodies"].push_back(body(b, data));
  out["data"] = std::move(data).all();
  for (const scenes::Joint& j : scene.joints) out["joints"].push_back(joint(scene, j));
  for (const scenes::Event& e : scenes::events_of(scene)) {
    out["events"].push_back({{"time", e.time}, {"kind", name_of(e.kind)}, {"index", e.index}});
  }
  for (const scenes::Launch& l : scene.launches) {
    out["launches"].push_back({{"time", l.time},
                               {"body", l.body},
                               {"velocity", vector(l.velocity)},
                               {"spin", vector(l.spin)}});
  }
  std::ofstream stream(file);
  stream << out;
  stream.close();
  return static_cast<bool>(stream);
}

}  // namespace rigid
