#include "scene_json.h"

#include <cmath>
#include <fstream>
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

json shape(const scenes::Shape& shape) {
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

json body(const scenes::Body& body) {
  json out = {{"pose", pose(body.T_world_body)},
              {"velocity", vector(body.velocity)},
              {"spin", vector(body.spin)},
              {"parts", json::array()}};
  out["motion"] = body.motion == scenes::Motion::dynamic ? "dynamic"
                  : body.motion == scenes::Motion::fixed ? "fixed"
                                                         : "kinematic";
  if (body.motion == scenes::Motion::dynamic) {
    const scenes::Mass mass = scenes::mass_of(body);
    out["mass"] = mass.mass;
    out["moments"] = vector(mass.moments);
  }
  for (const scenes::Part& part : body.parts) {
    out["parts"].push_back({{"shape", shape(part.shape)},
                            {"pose", pose(part.T_body_shape)},
                            {"friction", part.material.friction},
                            {"restitution", part.material.restitution}});
  }
  return out;
}

json joint(const scenes::Joint& joint) {
  return {{"kind", joint.kind == scenes::Joint::Kind::ball ? "ball" : "hinge"},
          {"a", joint.a},
          {"b", joint.b},
          {"in_a", pose(joint.T_a_joint)},
          {"in_b", pose(joint.T_b_joint)},
          // The joint's x and z axes in both bodies, for those who want no quaternion.
          {"x_a", vector(joint.T_a_joint.rotation().cx)},
          {"z_a", vector(joint.T_a_joint.rotation().cz)},
          {"x_b", vector(joint.T_b_joint.rotation().cx)},
          {"z_b", vector(joint.T_b_joint.rotation().cz)},
          {"lower", limit(joint.lower)},
          {"upper", limit(joint.upper)}};
}

}  // namespace

bool write_json(const scenes::Scene& scene, const std::string& file) {
  json out = {
      {"name", scene.name},      {"seconds", scene.seconds}, {"gravity", vector(scene.gravity)},
      {"bodies", json::array()}, {"joints", json::array()},  {"launches", json::array()}};
  for (const scenes::Body& b : scene.bodies) out["bodies"].push_back(body(b));
  for (const scenes::Joint& j : scene.joints) out["joints"].push_back(joint(j));
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
