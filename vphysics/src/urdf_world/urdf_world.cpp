// Adds a robot to a world in four steps: makes the shapes of its geometry, completes the masses,
// creates the articulation or the body, adds the colliders.
#include "vphysics/urdf_world.h"

#include <array>
#include <cmath>
#include <exception>
#include <map>
#include <optional>
#include <utility>
#include <variant>

#include "files/read_file.h"
#include "urdf_world/mesh_path.h"
#include "urdf_world/mesh_shape.h"

namespace vp {
namespace {

constexpr double kMinExtent = 1e-4;  // [m], for a box or cylinder with an extent of zero

// Whether only the root moves: then the robot is a single body.
bool is_one_body(const Model& model) {
  const bool free = std::holds_alternative<FreeJoint>(model.link(0).joint);
  return free && model.velocities() == velocities_of(model.link(0).joint);
}

// Whether J has moments about the centre of mass, beyond rounding.
bool has_moments(const Inertia& J) {
  if (!(J.mass() > 0.0)) return false;
  const auto trace = [](const Sym3& I) { return I.xx + I.yy + I.zz; };
  return trace(J.central()) > 1e-9 * trace(J.rotational());
}

class Importer {
 public:
  Importer(World& world, UrdfModel robot, const UrdfWorldOptions& options, std::string path)
      : world_(world), options_(options), path_(std::move(path)), robot_{std::move(robot)} {
    for (const std::string& each : robot_.urdf.notes) note(each);
  }

  // motion: for a robot that is a single body.
  Expected<UrdfRobot> add(Motion motion) {
    for (const UrdfCollision& collision : collisions()) {
      made_.push_back(shape_of(collision));
      if (!made_.back() && options_.require_all) return fault();
    }
    place_links();
    const bool one_body = is_one_body(model());
    if (options_.density > 0.0) {
      if (auto good = complete_masses(); !good) return tl::make_unexpected(fault(good.error()));
    }
    if (auto good = one_body ? create_body(motion) : create_articulation(); !good) {
      return tl::make_unexpected(fault(good.error()));
    }
    if (!add_colliders(one_body)) {
      take_back();
      return fault();
    }
    if (one_body && motion == Motion::dynamic && !has_mass_) note_mass_of_colliders();
    note_mimics();
    return std::move(robot_);
  }

 private:
  const Model& model() const { return robot_.urdf.model; }
  const std::vector<UrdfCollision>& collisions() const { return robot_.urdf.collisions; }
  const std::string& name_of(int link) const { return model().link(link).name; }

  std::string placed(const std::string& what) const {
    return path_.empty() ? what : path_ + ": " + what;
  }
  void note(const std::string& what) { robot_.notes.push_back(placed(what)); }
  Error fault(const Error& error) const { return {error.code, placed(error.message)}; }
  // The error of the last note.
  tl::unexpected<Error> fault() const {
    return tl::make_unexpected(Error{Errc::bad_data, robot_.notes.back()});
  }
  void note_collision(const UrdfCollision& collision, const std::string& what) {
    note("line " + std::to_string(collision.line) + ": <collision> of link \"" +
         name_of(collision.link) + "\": " + what);
  }
  void leave_out(const UrdfCollision& collision, const std::string& why) {
    note_collision(collision, "left out: " + why);
  }

  // --- shapes -----------------------------------------------------------------------------------

  std::optional<Shape> shape_of(const UrdfCollision& collision) {
    const auto thick = [&](double length) {
      if (length != 0.0) return length;
      note_collision(collision, "an extent of zero is taken as 0.1 mm");
      return kMinExtent;
    };
    const Vec3& size = collision.size;
    switch (collision.kind) {
      case UrdfCollision::Kind::box:
        if (size == Vec3{}) break;
        return Box{{0.5 * thick(size.x), 0.5 * thick(size.y), 0.5 * thick(size.z)}};
      case UrdfCollision::Kind::sphere:
        return Sphere{collision.radius};
      case UrdfCollision::Kind::cylinder:
        return Cylinder{collision.radius, 0.5 * thick(collision.length)};
      case UrdfCollision::Kind::capsule:
        return Capsule{collision.radius, 0.5 * collision.length};
      case UrdfCollision::Kind::mesh:
        return mesh_of(collision);
    }
    leave_out(collision, "it has no extent");
    return std::nullopt;
  }

  std::optional<Shape> mesh_of(const UrdfCollision& collision) {
    const bool triangles = options_.triangles_where_fixed && !moves(collision.link);
    const Vec3& s = collision.size;
    const auto key = std::pair(collision.mesh, std::array{s.x, s.y, s.z, triangles ? 1.0 : 0.0});
    const auto [at, fresh] = meshes_.try_emplace(key);
    if (fresh) at->second = read_mesh(collision, triangles);
    const Expected<detail::MadeShape>& made = *at->second;
    if (!made) {
      leave_out(collision, made.error().message);
      return std::nullopt;
    }
    if (fresh && !made->note.empty()) {
      note_collision(collision, "mesh \"" + collision.mesh +
                                    "\": " + made->note.substr(0, made->note.size() - 2));
    }
    return made->shape;
  }

  Expected<detail::MadeShape> read_mesh(const UrdfCollision& collision, bool triangles) const {
    const auto bad = [&](const std::string& what) {
      return tl::make_unexpected(
          Error{Errc::bad_data, "the mesh \"" + collision.mesh + "\": " + what});
    };
    constexpr double kMinScale = 1e-9;
    for (int k = 0; k < 3; ++k) {
      if (!(std::fabs(collision.size[k]) >= kMinScale)) return bad("a scale of zero");
    }
    const auto format = mesh_format(collision.mesh);
    if (!format) return bad("not a kind that is read; make it .stl, .obj or .dae");
    Expected<std::string> bytes;
    if (options_.read_mesh) {
      bytes = options_.read_mesh(collision.mesh);
    } else {
      const auto file = detail::find_mesh(collision.mesh, path_, options_.folders);
      if (!file) {
        return bad(
            "it is not there; name the folder that it, or its package, lies in by "
            "UrdfWorldOptions::folders");
      }
      bytes = detail::read_file(*file, options_.limits.max_bytes);
    }
    if (!bytes) return bad(bytes.error().message);
    auto mesh = parse_mesh(*bytes, *format, options_.limits);
    if (!mesh) return bad(mesh.error().message);
    auto made = detail::shape_of_mesh(*mesh, collision.size, triangles, options_);
    if (!made) return bad(made.error().message);
    return made;
  }

  void place_links() {
    for (int l = 0; l < model().links(); ++l) {
      const LinkSpec& link = model().link(l);
      const bool root = link.parent == kWorld;
      T_root_link_.push_back(
          root ? SE3() : T_root_link_[static_cast<std::size_t>(link.parent)] * link.T_parent_joint);
    }
  }

  // Whether the link can move.
  bool moves(int link) const {
    for (; link != kWorld; link = model().link(link).parent) {
      if (velocities_of(model().link(link).joint) != 0) return true;
    }
    return false;
  }

  // --- masses -----------------------------------------------------------------------------------

  // Gives links without mass the mass of their geometry, and point masses its moments.
  Expected<void> complete_masses() {
    std::map<int, Inertia> added;
    for (std::size_t i = 0; i < made_.size(); ++i) {
      const UrdfCollision& collision = collisions()[i];
      const Inertia& stated = model().link(collision.link).inertia;
      if (!made_[i] || has_moments(stated)) continue;
      const Inertia J = solid_inertia(*made_[i], options_.density).InvXform(collision.T_link_shape);
      if (!(J.mass() > 0.0)) continue;
      Inertia& sum = added.try_emplace(collision.link).first->second;
      sum = sum + J;
    }
    if (added.empty()) return {};
    ModelBuilder builder;
    for (int l = 0; l < model().links(); ++l) {
      LinkSpec link = model().link(l);
      if (const auto given = added.find(l); given != added.end()) {
        const Inertia& J = given->second;
        const double stated = link.inertia.mass();
        if (stated > 0.0) {
          const double f = stated / J.mass();
          link.inertia = Inertia(stated, f * J.first_moment(), f * J.rotational());
          note("link \"" + link.name +
               "\" has no moments of inertia, and gets those of its geometry");
        } else {
          link.inertia = J;
          note("link \"" + link.name + "\" has no mass, and gets " + std::to_string(J.mass()) +
               " kg by its geometry");
        }
      }
      if (auto good = builder.add(std::move(link)); !good) {
        return tl::make_unexpected(std::move(good.error()));
      }
    }
    auto model = builder.build();
    if (!model) return tl::make_unexpected(std::move(model.error()));
    robot_.urdf.model = *std::move(model);
    return {};
  }

  // --- into the world ---------------------------------------------------------------------------

  Expected<void> create_articulation() {
    const auto made = world_.create_articulation({model(), options_.links_collide});
    if (!made) return tl::make_unexpected(made.error());
    robot_.articulation = *made;
    return {};
  }

  Expected<void> create_body(Motion motion) {
    BodyDesc desc;
    desc.motion = motion;
    desc.T_world_body = model().link(0).T_parent_joint;
    for (std::size_t l = 0; l < T_root_link_.size(); ++l) {
      const Inertia& J = model().link(static_cast<int>(l)).inertia;
      desc.inertia = desc.inertia + J.InvXform(T_root_link_[l]);
    }
    has_mass_ = desc.inertia.mass() > 0.0;
    auto made = world_.create_body(desc);
    if (!made) {  // mostly because of its inertia; any other error fails again
      has_mass_ = false;
      desc.inertia = {};
      made = world_.create_body(desc);
    }
    if (!made) return tl::make_unexpected(made.error());
    robot_.body = *made;
    return {};
  }

  // Returns false if a collider fails and options.require_all is set.
  bool add_colliders(bool one_body) {
    for (std::size_t i = 0; i < made_.size(); ++i) {
      ColliderId& id = robot_.colliders.emplace_back();
      if (!made_[i]) continue;
      const UrdfCollision& collision = collisions()[i];
      ColliderDesc desc;
      desc.shape = *made_[i];
      desc.T_body_shape = collision.T_link_shape;
      if (one_body) {
        desc.T_body_shape =
            T_root_link_[static_cast<std::size_t>(collision.link)] * desc.T_body_shape;
      }
      desc.material = options_.material;
      desc.filter = options_.filter;
      desc.user_data = options_.user_data;
      if (options_.density > 0.0) desc.density = options_.density;
      const BodyId body =
          one_body ? robot_.body : world_.link_body(robot_.articulation, collision.link);
      const auto added = world_.add_collider(body, desc);
      if (added) {
        id = *added;
        continue;
      }
      leave_out(collision, added.error().message);
      if (options_.require_all) return false;
    }
    return true;
  }

  void take_back() {
    if (robot_.articulation) (void)world_.destroy_articulation(robot_.articulation);
    if (robot_.body) (void)world_.destroy_body(robot_.body);
  }

  void note_mass_of_colliders() {
    note("the robot has no mass, or an inertia that no body has: " +
         std::to_string(world_.inertia(robot_.body).mass()) + " kg by its colliders are taken");
  }
  void note_mimics() {
    for (const UrdfJoint& joint : robot_.urdf.joints) {
      if (joint.mimics.empty()) continue;
      note("joint \"" + joint.name + "\" mimics \"" + joint.mimics +
           "\", which a world does not hold: drive it to its multiplier and offset");
    }
  }

  World& world_;
  const UrdfWorldOptions& options_;
  std::string path_;
  UrdfRobot robot_;
  std::vector<std::optional<Shape>> made_;  // of each collision
  std::map<std::pair<std::string, std::array<double, 4>>,
           std::optional<Expected<detail::MadeShape>>>
      meshes_;                    // by name, scale and kind
  std::vector<SE3> T_root_link_;  // at zero coordinates
  bool has_mass_ = false;
};

Expected<UrdfRobot> add(World& world, UrdfModel robot, const UrdfWorldOptions& options,
                        const std::string& path, Motion motion) {
  try {  // the standard library throws
    return Importer(world, std::move(robot), options, path).add(motion);
  } catch (const std::exception& thrown) {
    return tl::make_unexpected(
        Error{Errc::bad_data, path + ": it cannot be added: " + thrown.what()});
  }
}

}  // namespace

BodyId UrdfRobot::link_body(const World& world, std::string_view link) const {
  const int number = urdf.model.find_link(link);
  if (number < 0) return {};
  return body ? body : world.link_body(articulation, number);
}

Expected<UrdfRobot> add_urdf(World& world, const std::string& path,
                             const UrdfWorldOptions& options) {
  // With a free root, a file without moving joints can be loaded too.
  auto robot = load_urdf(path, {UrdfBase::floating, options.T_world_root});
  if (!robot) return tl::make_unexpected(std::move(robot.error()));
  const bool fixed = options.base == UrdfBase::fixed;
  if (fixed && !is_one_body(robot->model)) {
    robot = load_urdf(path, {UrdfBase::fixed, options.T_world_root});
    if (!robot) return tl::make_unexpected(std::move(robot.error()));
  }
  return add(world, *std::move(robot), options, path, fixed ? Motion::fixed : Motion::dynamic);
}

Expected<UrdfRobot> add_urdf(World& world, UrdfModel robot, const std::string& path,
                             const UrdfWorldOptions& options) {
  return add(world, std::move(robot), options, path, Motion::dynamic);
}

}  // namespace vp
