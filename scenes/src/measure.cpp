// Penetration depths of bodies and their displacements from the start.
//
// A sphere, a capsule and a box are a core (a point, a segment, a box) with a radius. While the
// cores are separated, the depth is the sum of the radii minus the distance of the cores. Once they
// overlap, it is the radii plus the smallest overlap along the separating axes of two boxes (faces
// and pairs of edges: Gottschalk, Lin, Manocha, OBBTree, 1996), which is exact for boxes. Hulls and
// meshes: measure_hull.h.
#include "scenes/measure.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>

#include "measure_hull.h"

namespace scenes {
namespace {

struct Core {
  SE3 pose;
  Vec3 half;  // 0: a point; along z only: a segment
  double radius = 0.0;

  bool round() const { return radius > 0.0; }
};

Core core_of(const Shape& shape, const SE3& pose) {
  if (const auto* s = std::get_if<Sphere>(&shape)) return {pose, {}, s->radius};
  if (const auto* b = std::get_if<Box>(&shape)) return {pose, b->half_extents, 0.0};
  const auto& c = std::get<Capsule>(shape);
  return {pose, {0.0, 0.0, c.half_length}, c.radius};
}

double extent(const Core& core, const Vec3& n) {
  const vp::Mat3& R = core.pose.rotation();
  return std::fabs(dot(R.cx, n)) * core.half.x + std::fabs(dot(R.cy, n)) * core.half.y +
         std::fabs(dot(R.cz, n)) * core.half.z;
}

const Vec3& column(const Core& core, int i) {
  const vp::Mat3& R = core.pose.rotation();
  return i == 0 ? R.cx : i == 1 ? R.cy : R.cz;
}

// The smallest overlap of two cores along the separating axes; negative if they are separated.
double core_overlap(const Core& a, const Core& b) {
  const Vec3 d = b.pose.position() - a.pose.position();
  double min = std::numeric_limits<double>::infinity();
  const auto try_axis = [&](const Vec3& n) {
    min = std::min(min, extent(a, n) + extent(b, n) - std::fabs(dot(d, n)));
  };
  for (int i = 0; i < 3; ++i) {
    try_axis(column(a, i));
    try_axis(column(b, i));
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Vec3 n = cross(column(a, i), column(b, j));
      const double length = norm(n);
      if (length > 1e-6) try_axis((1.0 / length) * n);  // else parallel: the face axes suffice
    }
  }
  return min;
}

double distance_to(const Core& core, const Vec3& point) {
  const Vec3 p = inverse_times(core.pose, point);
  const auto beyond = [](double x, double half) { return std::max(0.0, std::fabs(x) - half); };
  return norm(Vec3{beyond(p.x, core.half.x), beyond(p.y, core.half.y), beyond(p.z, core.half.z)});
}

// The distance of a segment's points from a convex set is a convex function. Ternary search finds
// its minimum: 100 iterations reduce the interval below rounding.
template <class DistanceAt>
double min_along(double half_length, const DistanceAt& at) {
  double lower = -half_length, upper = half_length;
  for (int i = 0; i < 100 && upper > lower; ++i) {
    const double third = (upper - lower) / 3.0;
    if (at(lower + third) <= at(upper - third)) {
      upper -= third;
    } else {
      lower += third;
    }
  }
  return at(0.5 * (lower + upper));
}

// Distance of a point or a segment from another core.
double core_distance(const Core& thin, const Core& other) {
  return min_along(thin.half.z, [&](double z) {
    return distance_to(other, thin.pose * Vec3{0.0, 0.0, z});
  });
}

double ground_penetration(const SE3& ground, const Core& core) {
  const Vec3& up = ground.rotation().cz;
  return core.radius + extent(core, up) - dot(up, core.pose.position() - ground.position());
}

// Distance of a point above the ground, exact up to `reach`; beyond it a larger value.
double distance_to(const Terrain& terrain, const Vec3& p, double reach) {
  const auto corner = [&](int i, int j) {
    const double height = (*terrain.heights)[static_cast<std::size_t>(j * terrain.columns + i)];
    return Vec3{i * terrain.spacing, j * terrain.spacing, height};
  };
  const auto cell = [&](double x, int samples) {
    return std::clamp(static_cast<int>(std::floor(x / terrain.spacing)), 0, samples - 2);
  };
  double nearest = std::numeric_limits<double>::infinity();
  for (int j = cell(p.y - reach, terrain.rows); j <= cell(p.y + reach, terrain.rows); ++j) {
    for (int i = cell(p.x - reach, terrain.columns); i <= cell(p.x + reach, terrain.columns); ++i) {
      const Vec3 a = corner(i, j), b = corner(i + 1, j), c = corner(i + 1, j + 1),
                 d = corner(i, j + 1);
      nearest =
          std::min({nearest, triangle_distance({a, b, c}, p), triangle_distance({a, c, d}, p)});
    }
  }
  return nearest;
}

double terrain_penetration(const Terrain& terrain, const SE3& T, const Core& core) {
  double deepest = -std::numeric_limits<double>::infinity();
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3& h = core.half;
    const Vec3 p =
        inverse_times(T, core.pose * Vec3{corner & 1 ? h.x : -h.x, corner & 2 ? h.y : -h.y,
                                          corner & 4 ? h.z : -h.z});
    const Terrain::Below below = terrain.below(p.x, p.y);
    const double above = below.normal.z * (p.z - below.height);  // above its triangle's plane
    const bool separated = core.round() && above > 0.0;
    deepest =
        std::max(deepest, core.radius - (separated ? distance_to(terrain, p, core.radius) : above));
  }
  return deepest;
}

double ground_penetration(const SE3& ground, const Polyhedron& hull, const SE3& T_world_hull) {
  const Vec3& up = ground.rotation().cz;
  double lowest = std::numeric_limits<double>::infinity();
  for (const Vec3& p : hull.points) {
    lowest = std::min(lowest, dot(up, T_world_hull * p - ground.position()));
  }
  return -lowest;
}

double terrain_penetration(const Terrain& terrain, const SE3& T, const Polyhedron& hull,
                           const SE3& T_world_hull) {
  double deepest = -std::numeric_limits<double>::infinity();
  for (const Vec3& corner : hull.points) {
    const Vec3 p = inverse_times(T, T_world_hull * corner);
    const Terrain::Below below = terrain.below(p.x, p.y);
    deepest = std::max(deepest, below.normal.z * (below.height - p.z));
  }
  return deepest;
}

// A hull and a core with a radius, or a box.
double hull_penetration(const Polyhedron& hull, const SE3& T, const Core& core) {
  if (!core.round()) return hulls_penetration(hull, T, box_polyhedron(core.half), core.pose);
  const auto in_hull = [&](double z) { return inverse_times(T, core.pose * Vec3{0.0, 0.0, z}); };
  const double distance =
      min_along(core.half.z, [&](double z) { return hull_distance(hull, in_hull(z)); });
  if (distance > 0.0) return core.radius - distance;
  return core.radius +
         std::max(depth_in(hull, in_hull(core.half.z)), depth_in(hull, in_hull(-core.half.z)));
}

double mesh_penetration(const MeshGrid& grid, const SE3& T_mesh_shape, const Shape& shape) {
  if (const auto* hull = std::get_if<Hull>(&shape)) {
    Probe probe{hull->data->points, 0.0, {}, 0.0};
    for (const Vec3& p : probe.points) probe.centre += p;
    probe.centre = (1.0 / static_cast<double>(probe.points.size())) * probe.centre;
    for (const Vec3& p : probe.points) probe.reach = std::max(probe.reach, norm(p - probe.centre));
    return grid.penetration(probe, T_mesh_shape,
                            [&](const Vec3& v) { return depth_in(*hull->data, v); });
  }
  const Core core = core_of(shape, SE3{});
  Probe probe{{}, core.radius, {}, norm(core.half) + core.radius};
  if (!core.round()) {
    probe.points = box_polyhedron(core.half).points;
  } else {
    probe.points = {Vec3{0.0, 0.0, -core.half.z}, Vec3{0.0, 0.0, core.half.z}};
  }
  return grid.penetration(probe, T_mesh_shape, [&](const Vec3& v) {
    if (core.round()) return core.radius - distance_to(core, v);
    return std::min(
        {core.half.x - std::fabs(v.x), core.half.y - std::fabs(v.y), core.half.z - std::fabs(v.z)});
  });
}

bool is_ground(const Shape& shape) {
  return std::holds_alternative<Ground>(shape) || std::holds_alternative<Terrain>(shape);
}

// A part of a body in the world, with its AABB.
struct Placed {
  const Shape* shape;
  SE3 pose;
  int body;
  bool moves;
  Vec3 lower, upper;
};

Placed place(const Scene& scene, std::span<const SE3> poses, int body, const Part& part) {
  Placed out{&part.shape, poses[body] * part.T_body_shape,
             body,        scene.bodies[body].motion == Motion::dynamic,
             {},          {}};
  if (is_ground(part.shape)) return out;
  const auto* hull = std::get_if<Hull>(&part.shape);
  const auto* mesh = std::get_if<Mesh>(&part.shape);
  if (hull || mesh) {
    const std::vector<Vec3>& points = hull ? hull->data->points : mesh->data->vertices;
    out.lower = out.upper = out.pose * points[0];
    for (const Vec3& point : points) {
      const Vec3 p = out.pose * point;
      for (int i = 0; i < 3; ++i) {
        out.lower[i] = std::min(out.lower[i], p[i]);
        out.upper[i] = std::max(out.upper[i], p[i]);
      }
    }
    return out;
  }
  const Core core = core_of(part.shape, out.pose);
  const Vec3 half_extents = {core.radius + extent(core, {1, 0, 0}),
                             core.radius + extent(core, {0, 1, 0}),
                             core.radius + extent(core, {0, 0, 1})};
  out.lower = out.pose.position() - half_extents;
  out.upper = out.pose.position() + half_extents;
  return out;
}

bool bounds_overlap(const Placed& a, const Placed& b) {
  if (is_ground(*a.shape) || is_ground(*b.shape)) return true;
  return a.lower.x <= b.upper.x && b.lower.x <= a.upper.x && a.lower.y <= b.upper.y &&
         b.lower.y <= a.upper.y && a.lower.z <= b.upper.z && b.lower.z <= a.upper.z;
}

// The grids of the meshes; each is built once.
class Grids {
 public:
  const MeshGrid& of(const Mesh& mesh) {
    return grids_.try_emplace(mesh.data.get(), *mesh.data).first->second;
  }

 private:
  std::map<const Triangles*, MeshGrid> grids_;
};

// A shape of a moving body and any other shape.
double penetration(const Shape& a, const SE3& T_world_a, const Shape& b, const SE3& T_world_b,
                   Grids& grids) {
  if (is_ground(a) || std::holds_alternative<Mesh>(a))
    return penetration(b, T_world_b, a, T_world_a, grids);
  const auto* hull = std::get_if<Hull>(&a);
  if (const auto* mesh = std::get_if<Mesh>(&b))
    return mesh_penetration(grids.of(*mesh), Inv(T_world_b) * T_world_a, a);
  if (std::holds_alternative<Ground>(b)) {
    return hull ? ground_penetration(T_world_b, *hull->data, T_world_a)
                : ground_penetration(T_world_b, core_of(a, T_world_a));
  }
  if (const auto* terrain = std::get_if<Terrain>(&b)) {
    return hull ? terrain_penetration(*terrain, T_world_b, *hull->data, T_world_a)
                : terrain_penetration(*terrain, T_world_b, core_of(a, T_world_a));
  }
  const auto* other = std::get_if<Hull>(&b);
  if (hull && other) return hulls_penetration(*hull->data, T_world_a, *other->data, T_world_b);
  if (hull) return hull_penetration(*hull->data, T_world_a, core_of(b, T_world_b));
  if (other) return hull_penetration(*other->data, T_world_b, core_of(a, T_world_a));
  const Core ca = core_of(a, T_world_a), cb = core_of(b, T_world_b);
  const double radii = ca.radius + cb.radius;
  if (ca.round() || cb.round()) {
    const double distance = ca.round() ? core_distance(ca, cb) : core_distance(cb, ca);
    if (distance > 0.0) return radii - distance;
  }
  return radii + core_overlap(ca, cb);
}

class Depth {
 public:
  Depth(const Scene& scene, double time) {
    for (const Joint& j : scene.joints) {
      if (exists(scene, j, time)) joined_.push_back(key(j.a, j.b));
    }
    std::sort(joined_.begin(), joined_.end());
  }
  void look_at(const Placed& a, const Placed& b) {
    if (a.body == b.body || !bounds_overlap(a, b)) return;
    if (std::binary_search(joined_.begin(), joined_.end(), key(a.body, b.body))) return;
    deepest = std::max(deepest, penetration(*a.shape, a.pose, *b.shape, b.pose, grids_));
  }
  double deepest = 0.0;

 private:
  static std::uint64_t key(int a, int b) {
    return static_cast<std::uint64_t>(std::min(a, b)) << 32 |
           static_cast<std::uint64_t>(std::max(a, b));
  }
  std::vector<std::uint64_t> joined_;
  Grids grids_;
};

bool is_finite_pose(const SE3& T) {
  const vp::Mat3& R = T.rotation();
  return is_finite(T.position()) && is_finite(R.cx) && is_finite(R.cy) && is_finite(R.cz);
}

// Pairs of moving parts by sweep and prune along x. Fixed parts are few but large, so each is
// tested against all moving ones.
double deepest_penetration(const Scene& scene, std::span<const SE3> poses, double time) {
  std::vector<Placed> moving, standing;
  for (int i = 0; i < static_cast<int>(scene.bodies.size()); ++i) {
    if (!exists(scene.bodies[i], time) || !is_finite_pose(poses[i])) continue;
    for (const Part& part : scene.bodies[i].parts) {
      Placed placed = place(scene, poses, i, part);
      (placed.moves ? moving : standing).push_back(placed);
    }
  }
  std::stable_sort(moving.begin(), moving.end(),
                   [](const Placed& a, const Placed& b) { return a.lower.x < b.lower.x; });
  Depth depth(scene, time);
  for (std::size_t i = 0; i < moving.size(); ++i) {
    for (const Placed& s : standing) depth.look_at(moving[i], s);
    for (std::size_t j = i + 1; j < moving.size() && moving[j].lower.x <= moving[i].upper.x; ++j) {
      depth.look_at(moving[i], moving[j]);
    }
  }
  return depth.deepest;
}

bool is_in_place(const InPlace& rule, const Vec3& start, const Vec3& now) {
  if (rule.rule == InPlace::Rule::near_start) return norm(now - start) <= rule.distance;
  return now.x >= rule.lower.x && now.y >= rule.lower.y && now.z >= rule.lower.z &&
         now.x <= rule.upper.x && now.y <= rule.upper.y && now.z <= rule.upper.z;
}

double max_joint_gap(const Scene& scene, std::span<const SE3> poses, double time) {
  double max = 0.0;
  for (const Joint& j : scene.joints) {
    if (!exists(scene, j, time) || !is_finite_pose(poses[j.a]) || !is_finite_pose(poses[j.b]))
      continue;
    const Vec3 a = poses[j.a] * j.T_a_joint.position(), b = poses[j.b] * j.T_b_joint.position();
    max = std::max(max, norm(b - a));
  }
  return max;
}

}  // namespace

double penetration(const Shape& a, const SE3& T_world_a, const Shape& b, const SE3& T_world_b) {
  Grids grids;
  return penetration(a, T_world_a, b, T_world_b, grids);
}

std::vector<SE3> start_poses(const Scene& scene) {
  std::vector<SE3> poses;
  for (const Body& body : scene.bodies) poses.push_back(body.T_world_body);
  return poses;
}

Standing measure(const Scene& scene, std::span<const SE3> poses, double time) {
  Standing out;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (scene.bodies[i].motion != Motion::dynamic || !exists(scene.bodies[i], time)) continue;
    ++out.of;
    if (!is_finite_pose(poses[i])) {
      ++out.lost;
      continue;
    }
    const Vec3 start = scene.bodies[i].T_world_body.position(), now = poses[i].position();
    const Vec3 moved = now - start;
    out.in_place += is_in_place(scene.in_place, start, now);
    out.drift = std::max(out.drift, norm(Vec3{moved.x, moved.y, 0.0}));
    out.sink = std::max(out.sink, std::fabs(moved.z));
  }
  out.penetration = deepest_penetration(scene, poses, time);
  out.gap = max_joint_gap(scene, poses, time);
  return out;
}

}  // namespace scenes
