#include "scenes/catalogue.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstdio>
#include <map>
#include <set>
#include <string>

#include "scenes/measure.h"
#include "vphysics/shapes.h"
#include "vphysics/triangle_mesh.h"

namespace scenes {
namespace {

Scene scene_of(std::string_view name) {
  auto scene = make_scene(name);
  if (!scene) ADD_FAILURE() << scene.error().message;
  return scene.value_or(Scene{});
}

int dynamic_bodies(const Scene& scene) {
  int count = 0;
  for (const Body& body : scene.bodies) count += body.motion == Motion::dynamic;
  return count;
}

double total_mass(const Scene& scene) {
  double sum = 0.0;
  for (const Body& body : scene.bodies) {
    if (body.motion == Motion::dynamic) sum += mass_of(body).mass;
  }
  return sum;
}

// FNV-1a over the bits of all numbers of a scene's initial state.
std::uint64_t hash_of(const Scene& scene) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto add = [&](double x) {
    const auto bits = std::bit_cast<std::uint64_t>(x);
    for (int i = 0; i < 64; i += 8) hash = (hash ^ ((bits >> i) & 0xff)) * 0x100000001b3u;
  };
  const auto add_vector = [&](const Vec3& a) {
    for (int i = 0; i < 3; ++i) add(a[i]);
  };
  const auto add_pose = [&](const SE3& T) {
    for (int i = 0; i < 9; ++i) add(T.rotation()(i / 3, i % 3));
    add_vector(T.position());
  };
  for (const Body& body : scene.bodies) {
    add_pose(body.T_world_body);
    add_vector(body.velocity);
    add_vector(body.spin);
    for (const Part& part : body.parts) {
      add_pose(part.T_body_shape);
      if (const auto* hull = std::get_if<Hull>(&part.shape)) {
        for (const Vec3& p : hull->data->points) add_vector(p);
      }
      if (const auto* mesh = std::get_if<Mesh>(&part.shape)) {
        for (const Vec3& p : mesh->data->vertices) add_vector(p);
      }
    }
    if (body.motion == Motion::dynamic) {
      const Mass mass = mass_of(body);
      add(mass.mass);
      add_vector(mass.moments);
    }
  }
  for (const Joint& joint : scene.joints) {
    add_pose(joint.T_a_joint);
    add_pose(joint.T_b_joint);
  }
  return hash;
}

TEST(Catalogue, HasEveryNameOnceAndMakesIt) {
  std::set<std::string_view> names;
  for (const Entry& entry : catalogue()) {
    EXPECT_TRUE(names.insert(entry.name).second) << entry.name;
    EXPECT_FALSE(entry.what.empty()) << entry.name;
    const Scene scene = scene_of(entry.name);
    EXPECT_EQ(scene.name, entry.name);
    EXPECT_GT(dynamic_bodies(scene), 0) << entry.name;
    EXPECT_GT(scene.seconds, 0.0) << entry.name;
  }
}

TEST(Catalogue, RefusesWhatItDoesNotHaveAndNamesWhatItHas) {
  for (const char* name : {"", "tower", "towers1121", "Towers1120", "heap", "heap0", "heap-5",
                           "heap1000001", "heap12x", "heap99999999999999999999"}) {
    const auto scene = make_scene(name);
    ASSERT_FALSE(scene.has_value()) << name;
    EXPECT_EQ(scene.error().code, vp::Errc::invalid_argument);
    EXPECT_NE(scene.error().message.find("heapN"), std::string::npos) << scene.error().message;
  }
  EXPECT_NE(make_scene("nonsense").error().message.find("towers1120"), std::string::npos);
}

TEST(Catalogue, HasTheBodiesThatTheNamesSay) {
  const std::map<std::string, std::pair<int, int>> kBodiesAndJoints = {
      {"towers1120", {1120, 0}},
      {"pyramid1128", {1128, 0}},
      {"pile1120", {1120, 0}},
      {"wall1128", {1129, 0}},
      {"pile10k", {10000, 0}},
      {"ragdolls", {1200, 1100}},
      {"chain200", {201, 201}},
      {"bridge", {120, 101}},
      {"joint_grid", {9900, 19701}},
      {"tower10", {10, 0}},
      {"pyramid10", {55, 0}},
      {"cards", {6 + 4 + 2 + 2 + 1, 0}},
      {"dominoes", {60, 0}},
      {"cradle", {5, 5}},
      {"hills", {60, 0}},
      {"furniture", {75, 0}},
      {"rain", {15 * 30 * 12, 15 * 30 * 11}},
      {"trees100", {50, 0}},
      {"trees25", {50, 0}},
      {"washer", {8000, 0}},
      {"convex_pile", {5120, 0}},
      {"junkyard", {10584, 0}},
      {"large_pyramid", {5050, 0}},
      {"shaken_pyramid", {1128, 0}},
      {"stirred_pile", {1120, 0}},
      {"heap1000", {1000, 0}},
      {"heap1", {1, 0}}};
  for (const auto& [name, expected] : kBodiesAndJoints) {
    const Scene scene = scene_of(name);
    EXPECT_EQ(dynamic_bodies(scene), expected.first) << name;
    EXPECT_EQ(static_cast<int>(scene.joints.size()), expected.second) << name;
  }
}

TEST(Catalogue, HasTheMassesThatTheScenesSay) {
  EXPECT_DOUBLE_EQ(total_mass(scene_of("towers1120")), 1120e3);
  EXPECT_NEAR(total_mass(scene_of("wall1128")), 1128e3 + 10e3, 1e-6);
  // 374 boxes, 373 spheres of radius 0.5, 373 capsules of radius 0.3 and length 1.2.
  const double sphere = 1000.0 * vp::kPi / 6.0;
  const double capsule = 1000.0 * vp::kPi * 0.09 * (0.6 + 0.4);
  EXPECT_NEAR(total_mass(scene_of("pile1120")), 374e3 + 373 * (sphere + capsule), 1e-3);
  const Scene heavy = scene_of("heavy");
  EXPECT_NEAR(mass_of(heavy.bodies[2]).mass / mass_of(heavy.bodies[1]).mass, 1000.0, 1e-9);
  const Scene chain = scene_of("chain200");
  EXPECT_NEAR(mass_of(chain.bodies.back()).mass / mass_of(chain.bodies[2]).mass, 1013.0, 1.0);
}

TEST(Catalogue, BeginsWithNothingInAnythingElse) {
  double worst = 0.0;
  std::vector<std::string> names = {"heap1", "heap7", "heap1000", "heap2500"};
  for (const Entry& entry : catalogue()) names.emplace_back(entry.name);
  for (const std::string& name : names) {
    const Scene scene = scene_of(name);
    const Standing standing = measure(scene, start_poses(scene));
    EXPECT_LE(standing.penetration, 1e-9) << name;
    EXPECT_LE(standing.gap, 1e-12) << name;
    EXPECT_EQ(standing.in_place, standing.of) << name;
    worst = std::max(worst, standing.penetration);
  }
  std::printf("deepest %.1e m\n", worst);  // measured 3e-17 m: the feet of the first cards
}

// Bodies of a stack start in contact with their support, so they do not fall.
TEST(Catalogue, BeginsWithEachBodyOfAStackOnItsSupport) {
  for (const char* name :
       {"towers1120", "pyramid1128", "tower10", "pyramid10", "heavy", "cards", "large_pyramid"}) {
    const Scene scene = scene_of(name);
    for (const Body& body : scene.bodies) {
      if (body.motion != Motion::dynamic) continue;
      const Vec3 at = body.T_world_body.position();
      double touch = -1.0;
      for (const Body& other : scene.bodies) {
        const Vec3 apart = at - other.T_world_body.position();
        const bool below = apart.z > 1e-9 && norm(apart) < 2.0;
        if (other.motion != Motion::fixed && !below) continue;
        touch = std::max(touch, penetration(body.parts[0].shape, body.T_world_body,
                                            other.parts[0].shape, other.T_world_body));
      }
      EXPECT_NEAR(touch, 0.0, 1e-9) << name;
    }
  }
}

// Mass properties by the engine's solids. Shared hulls are built once.
class EngineSolids {
 public:
  vp::Inertia of(const Part& part) {
    const auto* hull = std::get_if<Hull>(&part.shape);
    if (!hull) {
      vp::Shape shape = vp::HalfSpace{};
      if (const auto* s = std::get_if<Sphere>(&part.shape)) shape = vp::Sphere{s->radius};
      if (const auto* b = std::get_if<Box>(&part.shape)) shape = vp::Box{b->half_extents};
      if (const auto* c = std::get_if<Capsule>(&part.shape)) {
        shape = vp::Capsule{c->radius, c->half_length};
      }
      return vp::solid_inertia(shape, part.density).InvXform(part.T_body_shape);
    }
    auto found = hulls_.find(hull->data.get());
    if (found == hulls_.end()) {
      vp::HullOptions exact;
      exact.tolerance = 0.0;
      const auto made = vp::ConvexHull::of(hull->data->points, exact);
      if (!made) ADD_FAILURE() << made.error().message;
      found = hulls_.emplace(hull->data.get(), made.value()).first;
    }
    return found->second.inertia(part.density).InvXform(part.T_body_shape);
  }

 private:
  std::map<const Polyhedron*, vp::ConvexHull> hulls_;
};

TEST(Catalogue, GivesDynamicBodiesTheirCentreOfMassAndPrincipalAxes) {
  for (const Entry& entry : catalogue()) {
    const Scene scene = scene_of(entry.name);
    EngineSolids solids;
    for (const Body& body : scene.bodies) {
      if (body.motion != Motion::dynamic) continue;
      vp::Inertia sum;
      double extent = 1.0;  // [m], of the summed values
      for (const Part& part : body.parts) {
        sum = sum + solids.of(part);
        extent = std::max(extent, norm(part.T_body_shape.position()));
        if (const auto* hull = std::get_if<Hull>(&part.shape)) {
          for (const Vec3& p : hull->data->points) extent = std::max(extent, norm(p));
        }
      }
      const Mass mass = mass_of(body);
      const double scale = mass.mass;
      ASSERT_NEAR(sum.mass(), mass.mass, 1e-12 * scale) << entry.name;
      ASSERT_LT(norm(sum.first_moment()), 1e-12 * scale * extent) << entry.name;
      const vp::Sym3& I = sum.rotational();
      const double bound = 1e-12 * scale * extent * extent;
      ASSERT_LT(norm(Vec3{I.xx, I.yy, I.zz} - mass.moments), bound) << entry.name;
      ASSERT_LT(norm(Vec3{I.xy, I.yz, I.zx}), bound) << entry.name;
    }
  }
}

// Each edge has two triangles, and the mesh encloses a torus of 16 x 16 pieces.
TEST(Catalogue, RainsOnRingsThatAreClosedAndFaceOutwards) {
  const Scene scene = scene_of("rain");
  const auto& ring = *std::get<Mesh>(scene.bodies[0].parts[1].shape).data;
  const auto made = vp::TriangleMesh::of(ring.vertices, ring.corners);
  ASSERT_TRUE(made.has_value());
  EXPECT_TRUE(made->closed());
  const double round = 2.0 * vp::kPi * vp::kPi * 3.75;
  EXPECT_GT(made->volume(), 0.9 * round);
  EXPECT_LT(made->volume(), round);
}

TEST(Catalogue, LetsTreesBeginAsTheyTip) {
  const Scene scene = scene_of("trees100");
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    const Body& tree = scene.bodies[i];
    ASSERT_EQ(tree.parts.size(), 22u);
    // The tree's foot is at rest.
    const Vec3 at{0.0, tree.T_world_body.position().y, 1.0};
    const Vec3 velocity = tree.velocity + cross(tree.spin, at - tree.T_world_body.position());
    EXPECT_LT(norm(velocity), 1e-12);
    EXPECT_NEAR(norm(tree.spin), 0.25 + 0.005 * static_cast<double>(i - 1), 1e-12);
  }
}

TEST(Catalogue, TakesThePusherAlongItsCircleByChords) {
  const Scene scene = scene_of("junkyard");
  const int pusher = scene.launches[0].body;
  Vec3 at = scene.bodies[static_cast<std::size_t>(pusher)].T_world_body.position();
  for (const Launch& launch : scene.launches) {
    EXPECT_NEAR(norm(at), 35.0, 1e-9);
    EXPECT_NEAR(norm(launch.velocity), 35.0 * vp::kPi / 30.0, 1e-4);
    at += (1.0 / 60.0) * launch.velocity;
  }
  EXPECT_EQ(scene.launches.size(), 500u);
}

TEST(Catalogue, PoursTenThousandAsTheFamilyDoes) {
  Scene heap = scene_of("heap10000"), pile = scene_of("pile10k");
  EXPECT_EQ(hash_of(heap), hash_of(pile));
  EXPECT_DOUBLE_EQ(pit_side(1120), 10.0);
  EXPECT_DOUBLE_EQ(pit_side(10000), 30.0);
  // Equally deep: the number of layers differs by less than a tenth.
  for (const int count : {1000, 2000, 5000, 20000, 50000, 100000}) {
    const double cells = pit_side(count) * pit_side(count) / (1.25 * 1.25);
    EXPECT_NEAR(count / cells, 10000.0 / 576.0, 1.9) << count;
  }
}

// The same bits with every compiler, every optimisation level, and on every machine.
TEST(Catalogue, MakesTheSameBitsEverywhere) {
  const std::map<std::string, std::uint64_t> kGolden = {
      {"towers1120", 0x89f08141f108495u},
      {"pyramid1128", 0xc04e87a9d80695d0u},
      {"pile1120", 0x14bba0107fecdee0u},
      {"wall1128", 0x3a1d2b1d1f68a97du},
      {"pile10k", 0x495a3f0c3590da9cu},
      {"ragdolls", 0xe7ab2618553f447du},
      {"chain200", 0x9a1f1f3e699eeb4cu},
      {"bridge", 0x24fb95b8f9466ae8u},
      {"tower10", 0x268d6eff63ea16dbu},
      {"pyramid10", 0xb6450c408cc6adcau},
      {"cards", 0x9720fd565b8a6eu},
      {"dominoes", 0xc7565fd9d665213u},
      {"cradle", 0xcef621620ee05db6u},
      {"heavy", 0x937e0d2e76fec842u},
      {"handle", 0xb190c4c0925d8feau},
      {"ramp", 0x1b38a12f75694d25u},
      {"bounce", 0x68dd743a955178c3u},
      {"conveyor", 0xea51b6f5319dacb6u},
      {"plumb", 0x72539b38b9b4fc49u},
      {"catenary", 0x8a074c04254ca5d3u},
      {"touchstone", 0xa6aded3e74344f4cu},
      {"touchstone-joined", 0x8590d694d0d643b9u},
      {"joint_grid", 0xb7971b2dbe6cd379u},
      {"hills", 0x870a7bae0fc3217du},
      {"furniture", 0xb0abe4e879d882b8u},
      {"rain", 0xd2eecfc92209f389u},
      {"trees100", 0x52e53d0dbd364e6fu},
      {"trees25", 0xb2c4bd7d528f1432u},
      {"washer", 0x1e959c76b1446f81u},
      {"convex_pile", 0xf2819720fb8d5865u},
      {"junkyard", 0xa9e5e79c11d11780u},
      {"large_pyramid", 0xe56683a798c7e5d4u},
      {"shaken_pyramid", 0x3837cdf227db2b9cu},
      {"stirred_pile", 0x28b7875a705663b5u},
  };
  for (const Entry& entry : catalogue()) {
    const auto golden = kGolden.find(std::string(entry.name));
    const std::uint64_t hash = hash_of(scene_of(entry.name));
    if (golden == kGolden.end()) {
      ADD_FAILURE() << "{\"" << entry.name << "\", 0x" << std::hex << hash << "u},";
      continue;
    }
    EXPECT_EQ(hash, golden->second) << entry.name << " 0x" << std::hex << hash;
  }
}

}  // namespace
}  // namespace scenes
