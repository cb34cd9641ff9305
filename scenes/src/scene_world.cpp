#include "scenes/scene_world.h"

#include <utility>

namespace scenes {
namespace {

// The data that shapes may share; null if the kind has none.
const void* data_of(const Shape& shape) {
  if (const auto* h = std::get_if<Hull>(&shape)) return h->data.get();
  if (const auto* m = std::get_if<Mesh>(&shape)) return m->data.get();
  return nullptr;
}

vp::Expected<vp::Shape> built(const Shape& shape) {
  const auto as_shape = [](auto made) { return vp::Shape(std::move(made)); };
  if (const auto* t = std::get_if<Terrain>(&shape)) {
    const vp::HeightGrid grid{static_cast<std::uint32_t>(t->columns),
                              static_cast<std::uint32_t>(t->rows),
                              t->spacing,
                              t->spacing,
                              *t->heights,
                              {}};
    return vp::HeightField::of(grid).map(as_shape);
  }
  if (const auto* h = std::get_if<Hull>(&shape)) {
    return vp::ConvexHull::of(h->data->points).map(as_shape);
  }
  const Triangles& mesh = *std::get<Mesh>(shape).data;
  return vp::TriangleMesh::of(mesh.vertices, mesh.corners).map(as_shape);
}

vp::Material engine_material(const Material& material) {
  vp::Material out;
  out.friction = material.friction;
  out.restitution = material.restitution;
  out.rolling_friction = material.rolling_friction;
  return out;
}

vp::Motion engine_motion(Motion motion) {
  if (motion == Motion::fixed) return vp::Motion::fixed;
  return motion == Motion::kinematic ? vp::Motion::kinematic : vp::Motion::dynamic;
}

vp::se3 engine_velocity(const SE3& T_world_body, const Vec3& velocity, const Vec3& spin) {
  return {T_world_body.unrotate(spin), T_world_body.unrotate(velocity)};
}

}  // namespace

vp::Expected<vp::Shape> EngineShapes::of(const Shape& shape) {
  if (const auto* s = std::get_if<Sphere>(&shape)) return vp::Sphere{s->radius};
  if (const auto* b = std::get_if<Box>(&shape)) return vp::Box{b->half_extents};
  if (const auto* c = std::get_if<Capsule>(&shape)) return vp::Capsule{c->radius, c->half_length};
  if (std::holds_alternative<Ground>(shape)) return vp::HalfSpace{};
  const void* data = data_of(shape);
  if (data == nullptr) return built(shape);
  const auto found = made_.find(data);
  if (found != made_.end()) return found->second;
  auto made = built(shape);
  if (made) made_.emplace(data, *made);
  return made;
}

SceneWorld::SceneWorld(Scene scene, vp::World world)
    : scene_(std::move(scene)),
      world_(std::move(world)),
      bodies_(scene_.bodies.size()),
      events_(events_of(scene_)) {}

vp::Expected<SceneWorld> SceneWorld::create(Scene scene, vp::WorldDesc settings) {
  settings.gravity = scene.gravity;
  auto world = vp::World::create(settings);
  if (!world) return tl::make_unexpected(world.error());
  SceneWorld out(std::move(scene), *std::move(world));
  for (std::size_t i = 0; i < out.scene_.bodies.size(); ++i) {
    if (!exists(out.scene_.bodies[i], 0.0)) continue;
    if (const auto added = out.add_body(i); !added) return tl::make_unexpected(added.error());
  }
  for (std::size_t i = 0; i < out.scene_.joints.size(); ++i) {
    if (!exists(out.scene_, out.scene_.joints[i], 0.0)) continue;
    if (const auto added = out.add_joint(i); !added) return tl::make_unexpected(added.error());
  }
  return out;
}

vp::Expected<void> SceneWorld::add_body(std::size_t index) {
  const Body& body = scene_.bodies[index];
  vp::BodyDesc desc;
  desc.motion = engine_motion(body.motion);
  desc.T_world_body = body.T_world_body;
  desc.velocity = engine_velocity(body.T_world_body, body.velocity, body.spin);
  desc.continuous = body.fast;
  desc.user_data = index;
  if (body.motion == Motion::dynamic) {
    const Mass mass = mass_of(body);
    desc.inertia = vp::Inertia(mass.mass, mass.moments);
  }
  const auto id = world_.create_body(desc);
  if (!id) return tl::make_unexpected(id.error());
  bodies_[index] = *id;
  if (body.as_one) return add_compound(index);
  for (const Part& part : body.parts) {
    const auto shape = shapes_.of(part.shape);
    if (!shape) return tl::make_unexpected(shape.error());
    const auto added = add_collider(index, *shape, part.T_body_shape, part.material);
    if (!added) return added;
  }
  return {};
}

vp::Expected<void> SceneWorld::add_compound(std::size_t index) {
  const Body& body = scene_.bodies[index];
  std::vector<vp::CompoundPart> parts;
  for (const Part& part : body.parts) {
    auto shape = shapes_.of(part.shape);
    if (!shape) return tl::make_unexpected(shape.error());
    parts.push_back({*std::move(shape), part.T_body_shape});
  }
  auto compound = vp::Compound::of(parts);
  if (!compound) return tl::make_unexpected(compound.error());
  return add_collider(index, *std::move(compound), SE3{}, body.parts[0].material);
}

vp::Expected<void> SceneWorld::add_collider(std::size_t index, const vp::Shape& shape,
                                            const SE3& T_body_shape, const Material& material) {
  vp::ColliderDesc collider;
  collider.shape = shape;
  collider.T_body_shape = T_body_shape;
  collider.material = engine_material(material);
  collider.user_data = index;
  const auto added = world_.add_collider(bodies_[index], collider);
  if (!added) return tl::make_unexpected(added.error());
  return {};
}

vp::Expected<void> SceneWorld::add_joint(std::size_t index) {
  const Joint& joint = scene_.joints[index];
  vp::JointDesc desc;
  desc.T_a_joint = joint.T_a_joint;
  desc.T_b_joint = joint.T_b_joint;
  if (joint.kind == Joint::Kind::hinge) {
    desc.kind = vp::Hinge{joint.lower, joint.upper, {}};
  } else {
    desc.kind = vp::BallSocket{};
  }
  const auto body = [this](int i) { return bodies_[static_cast<std::size_t>(i)]; };
  const auto id = world_.create_joint(body(joint.a), body(joint.b), desc);
  if (!id) return tl::make_unexpected(id.error());
  return {};
}

vp::Expected<void> SceneWorld::launch(const Launch& launch) {
  const vp::BodyId body = bodies_[static_cast<std::size_t>(launch.body)];
  if (!body) return {};
  return world_.set_velocity(body,
                             engine_velocity(world_.pose(body), launch.velocity, launch.spin));
}

vp::Expected<void> SceneWorld::handle(const Event& event) {
  const auto index = static_cast<std::size_t>(event.index);
  switch (event.kind) {
    case Event::Kind::add_body:
      return add_body(index);
    case Event::Kind::add_joint:
      return add_joint(index);
    case Event::Kind::remove_body:
      return world_.destroy_body(std::exchange(bodies_[index], vp::BodyId{}));
    case Event::Kind::remove_joint:  // destroyed with its body
      return {};
    case Event::Kind::launch:
      return launch(scene_.launches[index]);
  }
  return {};
}

vp::Expected<vp::StepStatus> SceneWorld::step(double dt) {
  while (happened_ < events_.size() && events_[happened_].time <= time_ + 0.5 * dt) {
    if (const auto done = handle(events_[happened_++]); !done) {
      return tl::make_unexpected(done.error());
    }
  }
  const auto status = world_.step(dt);
  if (status) time_ += dt;
  return status;
}

std::vector<SE3> SceneWorld::poses() const {
  std::vector<SE3> out;
  out.reserve(bodies_.size());
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    out.push_back(bodies_[i] ? world_.pose(bodies_[i]) : scene_.bodies[i].T_world_body);
  }
  return out;
}

}  // namespace scenes
