// Robots from URDF in a world: placement of shapes, masses, meshes, and notes.
#include "vphysics/urdf_world.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "urdf_text.h"

namespace vp::test {
namespace {

std::string collision(const std::string& geometry, const std::string& origin = "") {
  return "<collision>" + origin + "<geometry>" + geometry + "</geometry></collision>";
}
// A link element on one line, of 2 kg or massless.
std::string link(const std::string& name, const std::string& inside, bool mass = true) {
  const std::string inertial =
      "<inertial><mass value=\"2\"/><inertia ixx=\"0.3\" ixy=\"0\" ixz=\"0\" iyy=\"0.4\" "
      "iyz=\"0\" izz=\"0.5\"/></inertial>";
  return "<link name=\"" + name + "\">" + (mass ? inertial : "") + inside + "</link>\n";
}
std::string mesh(const std::string& file, const std::string& scale = "1 1 1") {
  return collision("<mesh filename=\"" + file + "\" scale=\"" + scale + "\"/>");
}
std::string origin(const std::string& xyz, const std::string& rpy = "0 0 0") {
  return "<origin xyz=\"" + xyz + "\" rpy=\"" + rpy + "\"/>";
}

// A cube of edge 2 as two boxes side by side, cut at x = 0.
std::string two_boxes() {
  std::string text;
  for (const double x : {-1.0, 0.0}) {
    text += "o box\n";
    for (int k = 0; k < 8; ++k) {
      text += "v " + std::to_string(x + (k & 1)) + (k & 2 ? " 1" : " -1") + (k & 4 ? " 1" : " -1") +
              "\n";
    }
    for (const char* face : {"1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"}) {
      text += "f";
      for (const char* c = face; *c; ++c) {
        if (*c != ' ') text += " " + std::to_string(*c - '1' - 8);
      }
      text += "\n";
    }
  }
  return text;
}
Expected<std::string> meshes(const std::string& name) {
  if (name == "cube.obj") return two_boxes();
  if (name == "plate.obj")
    return std::string("v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n");
  if (name == "point.obj") return std::string("v 1 2 3\n");
  if (name == "broken.stl") return std::string("broken");
  return tl::make_unexpected(Error{Errc::bad_data, "not in the archive"});
}

struct Placed {
  World world;
  UrdfRobot robot;
};
Placed place(const std::string& text, UrdfWorldOptions options = {}) {
  if (!options.read_mesh) options.read_mesh = meshes;
  Placed out{World(), {must_parse(text, {options.base, options.T_world_root})}};
  out.robot = must_build(add_urdf(out.world, std::move(out.robot.urdf), "", options));
  return out;
}
// A ray down from 10 m at (x, y): the height of its hit and the collider's number, or -1.
struct Seen {
  double z;
  int collider;
};
Seen seen_from_above(const Placed& placed, double x, double y) {
  const auto hit = must_build(placed.world.ray_cast({x, y, 10}, {0, 0, -1}, 100));
  if (!hit) return {-1e9, -1};
  for (std::size_t i = 0; i < placed.robot.colliders.size(); ++i) {
    if (placed.robot.colliders[i] == hit->collider) return {hit->point.z, static_cast<int>(i)};
  }
  return {hit->point.z, -1};
}
UrdfWorldOptions floating() {
  UrdfWorldOptions options;
  options.base = UrdfBase::floating;
  return options;
}

TEST(UrdfWorld, EachShapeIsWhereTheFileHasIt) {
  const std::string quarter = "1.5707963267948966";
  Placed placed = place(
      robot(link("a", "") +
            link("b", collision("<box size=\"1 2 3\"/>", origin("5 0 0", quarter + " 0 0")) +
                          collision("<sphere radius=\"0.5\"/>", origin("10 0 0")) +
                          collision("<cylinder radius=\"0.25\" length=\"2\"/>", origin("15 0 0")) +
                          collision("<capsule radius=\"0.25\" length=\"2\"/>", origin("20 0 0")) +
                          mesh("cube.obj", "2 2 0.5")) +
            joint("j", "continuous", "a", "b", origin("0 0 1") + "<axis xyz=\"0 0 1\"/>")),
      floating());
  EXPECT_TRUE(placed.robot.notes.empty());
  ASSERT_EQ(placed.robot.colliders.size(), 5u);
  // The box lies on its side: 2 m high, 3 m along y.
  EXPECT_NEAR(seen_from_above(placed, 5, 1.4).z, 1 + 1, 1e-12);
  EXPECT_EQ(seen_from_above(placed, 5, 1.6).collider, -1);
  EXPECT_NEAR(seen_from_above(placed, 10, 0).z, 1 + 0.5, 1e-12);
  EXPECT_NEAR(seen_from_above(placed, 15, 0).z, 1 + 1, 1e-12);
  EXPECT_NEAR(seen_from_above(placed, 20, 0).z, 1 + 1.25, 1e-12);
  const Seen cube = seen_from_above(placed, 1.9, -1.9);
  EXPECT_NEAR(cube.z, 1 + 0.5, 1e-12);
  EXPECT_EQ(cube.collider, 4);
  // All belong to the link, and move with its joint.
  const ArticulationId art = placed.robot.articulation;
  ASSERT_TRUE(
      placed.world.set_joint_state(art, placed.robot.urdf.model.find_link("b"), 0, kPi / 2, 0.0));
  EXPECT_NEAR(seen_from_above(placed, 0, 10).z, 1 + 0.5, 1e-12);
}

// Links that a fixed joint welds keep their own bodies, and their geometry keeps its place.
TEST(UrdfWorld, GeometryOfWeldedLinksIsInItsPlace) {
  UrdfWorldOptions options = floating();
  options.T_world_root = SE3(Vec3{0, 0, 2});
  Placed placed = place(robot(link("a", "") + link("b", "") +
                              link("foot", collision("<sphere radius=\"0.1\"/>"), false) +
                              joint("j", "continuous", "a", "b", "<axis xyz=\"0 0 1\"/>") +
                              joint("weld", "fixed", "b", "foot", origin("1 0 0.5"))),
                        options);
  EXPECT_NEAR(seen_from_above(placed, 1, 0).z, 2.6, 1e-12);
  EXPECT_EQ(placed.robot.link_body(placed.world, "foot"),
            placed.world.body_of(placed.robot.colliders[0]));
  EXPECT_EQ(placed.robot.link_body(placed.world, "none"), BodyId{});
}

// A frame that a file names, without mass and geometry: for a camera or a tool.
TEST(UrdfWorld, ALinkWithoutMassHasTheVelocityOfItsOrigin) {
  Placed placed = place(robot(link("a", "") + link("b", "") + link("camera", "", false) +
                              joint("j", "continuous", "a", "b", "<axis xyz=\"0 0 1\"/>") +
                              joint("weld", "fixed", "b", "camera", origin("3 0 0"))));
  World& world = placed.world;
  const int b = placed.robot.urdf.model.find_link("b");
  ASSERT_TRUE(world.set_joint_state(placed.robot.articulation, b, 0, 0.0, 2.0));
  const BodyId camera = placed.robot.link_body(world, "camera");
  const VelocityWorld v = world.velocity_world(camera);
  EXPECT_LT(norm(v.linear - Vec3{0, 6, 0}), 1e-12);
  EXPECT_LT(norm(v.angular - Vec3{0, 0, 2}), 1e-12);
  // A force there rotates the joint: 1 N at 3 m against 0.5 kg m^2, over 1 ms.
  ASSERT_TRUE(world.apply_force(camera, {0, 1, 0}));
  ASSERT_TRUE(world.step(0.001));
  EXPECT_NEAR(world.joint_velocity(placed.robot.articulation, b, 0), 2.0 + 0.006, 1e-9);
}

// A cube of edge 2 from two hulls: bodies that rest on it, or fall onto its centre, touch both.
TEST(UrdfWorld, EachObjectOfAMeshIsAHull) {
  for (const std::size_t max_hulls : {std::size_t{16}, std::size_t{1}}) {
    UrdfWorldOptions options = floating();
    options.max_hulls = max_hulls;
    options.density = 10.0;
    options.T_world_root = SE3(Vec3{0, 0, 1});
    Placed placed = place(robot(link("cube", mesh("cube.obj"), false)), options);
    ASSERT_TRUE(placed.robot.body);
    EXPECT_NEAR(placed.world.inertia(placed.robot.body).mass(), 80.0, 1e-9);
    const auto hit = must_build(placed.world.ray_cast({0.5, 0, 10}, {0, 0, -1}, 100));
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->part, max_hulls > 1 ? 1u : 0u);
    EXPECT_NEAR(hit->point.z, 2.0, 1e-12);
  }
}

TEST(UrdfWorld, ARobotOfWhichNoJointMovesIsOneBody) {
  const std::string table =
      robot(link("top", collision("<box size=\"1 1 0.1\"/>", origin("0 0 0.7"))) +
            link("leg", collision("<cylinder radius=\"0.05\" length=\"0.6\"/>")) +
            joint("weld", "fixed", "top", "leg", origin("0.4 0 0.3")));
  Placed placed = place(table, floating());
  EXPECT_FALSE(placed.robot.articulation);
  const Inertia J = placed.world.inertia(placed.robot.body);
  EXPECT_NEAR(J.mass(), 4.0, 1e-12);
  EXPECT_NEAR(J.first_moment().x, 2 * 0.4, 1e-12);
  EXPECT_NEAR(J.first_moment().z, 2 * 0.3, 1e-12);
  EXPECT_EQ(seen_from_above(placed, 0.4, 0).collider, 0);
  ASSERT_TRUE(placed.world.remove_collider(placed.robot.colliders[0]));
  EXPECT_NEAR(seen_from_above(placed, 0.4, 0).z, 0.6, 1e-12);
  EXPECT_EQ(placed.robot.link_body(placed.world, "leg"), placed.robot.body);

  const std::string path = testing::TempDir() + "vphysics_urdf_world_table.urdf";
  std::ofstream(path) << table;
  World world;
  const UrdfRobot fixed = must_build(add_urdf(world, path));
  std::remove(path.c_str());
  for (int k = 0; k < 100; ++k) ASSERT_TRUE(world.step(0.01));
  EXPECT_EQ(world.pose(fixed.body).position(), Vec3{});
}

TEST(UrdfWorld, LinksWithoutMassGetThatOfTheirGeometry) {
  UrdfWorldOptions options = floating();
  options.density = 500.0;
  Placed placed =
      place(robot(link("a", collision("<box size=\"0.1 0.2 0.3\"/>", origin("1 0 0")), false) +
                  link("b", collision("<sphere radius=\"1\"/>")) +
                  joint("j", "continuous", "a", "b", "<axis xyz=\"0 0 1\"/>")),
            options);
  const Model& model = *placed.world.model(placed.robot.articulation);
  EXPECT_NEAR(model.link(0).inertia.mass(), 3.0, 1e-12);
  EXPECT_NEAR(model.link(0).inertia.first_moment().x, 3.0, 1e-12);
  EXPECT_NEAR(model.link(1).inertia.mass(), 2.0, 1e-12);  // from the file
  ASSERT_EQ(placed.robot.notes.size(), 2u);  // the first: an armature, while it had no mass
  EXPECT_EQ(placed.robot.notes[1], "link \"a\" has no mass, and gets 3.000000 kg by its geometry");
}

TEST(UrdfWorld, PointMassesGetTheMomentsOfTheirGeometry) {
  UrdfWorldOptions options = floating();
  options.density = 500.0;
  Placed placed =
      place(robot("<link name=\"a\"><inertial><origin xyz=\"0 0 3\"/><mass value=\"6\"/><inertia "
                  "ixx=\"0\" ixy=\"0\" ixz=\"0\" iyy=\"0\" iyz=\"0\" izz=\"0\"/></inertial>" +
                  collision("<box size=\"1 2 3\"/>") + "</link>\n"),
            options);
  const Inertia J = placed.world.inertia(placed.robot.body);
  EXPECT_NEAR(J.mass(), 6.0, 1e-12);
  EXPECT_EQ(J.first_moment(), Vec3{});
  EXPECT_NEAR(J.rotational().xx, 6.0 / 12 * (4 + 9), 1e-12);
}

// For instance a file with a mass of 0 but with moments of inertia.
TEST(UrdfWorld, ABodyWithoutMassHasThatOfItsColliders) {
  Placed placed = place(
      robot("<link name=\"a\"><inertial><mass value=\"0\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" "
            "iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial>" +
            collision("<box size=\"0.1 0.1 0.2\"/>") + "</link>\n"),
      floating());
  EXPECT_NEAR(placed.world.inertia(placed.robot.body).mass(), 2.0, 1e-12);
}

TEST(UrdfWorld, MeshesOfLinksThatDoNotMoveMayBeTriangles) {
  UrdfWorldOptions options;
  options.triangles_where_fixed = true;
  const std::string text =
      robot(link("base", mesh("plate.obj", "1 1 -1")) + link("arm", mesh("cube.obj")) +
            joint("j", "continuous", "base", "arm", origin("0 0 5") + "<axis xyz=\"0 0 1\"/>"));
  Placed placed = place(text, options);
  EXPECT_TRUE(placed.robot.notes.empty());
  // The mirrored plate has its triangles reversed: one-sided, it is solid from its lower side.
  BodyDesc ball;
  ball.T_world_body = SE3(Vec3{0, 0, -0.5});
  ball.gravity_scale = -1.0;
  ColliderDesc sphere;
  sphere.shape = Sphere{0.1};
  const BodyId body = must_build(placed.world.create_body(ball));
  (void)must_build(placed.world.add_collider(body, sphere));
  for (int k = 0; k < 1000; ++k) ASSERT_TRUE(placed.world.step(0.001));
  EXPECT_NEAR(placed.world.pose(body).position().z, -0.1, 1e-3);
}

TEST(UrdfWorld, WhatIsFlatIsGivenAThickness) {
  UrdfWorldOptions options = floating();
  Placed placed = place(
      robot(link("a", collision("<box size=\"2 2 0\"/>") +
                          collision("<cylinder radius=\"1\" length=\"0\"/>", origin("5 0 0"))) +
            "\n" + link("b", mesh("plate.obj")) + link("c", mesh("point.obj")) +
            joint("j", "continuous", "a", "b", origin("10 0 0")) +
            joint("k", "continuous", "a", "c", origin("0 20 0"))),
      options);
  const auto& notes = placed.robot.notes;
  ASSERT_EQ(notes.size(), 4u);
  EXPECT_EQ(notes[0], "line 2: <collision> of link \"a\": an extent of zero is taken as 0.1 mm");
  EXPECT_NE(notes[2].find("line 4: <collision> of link \"b\": mesh \"plate.obj\": it is flat"),
            std::string::npos)
      << notes[2];
  EXPECT_NEAR(seen_from_above(placed, 0, 0).z, 5e-5, 1e-12);
  EXPECT_NEAR(seen_from_above(placed, 5, 0).z, 5e-5, 1e-12);
  EXPECT_NEAR(seen_from_above(placed, 10, 0).z, 2e-3, 1e-9);
  EXPECT_EQ(seen_from_above(placed, 1, 22).collider, 3);
}

TEST(UrdfWorld, WhatCannotBeMadeIsNotedOrRefused) {
  struct Bad {
    std::string geometry;
    const char* note;
  };
  for (const Bad& bad : std::vector<Bad>{
           {collision("<mesh filename=\"none.stl\"/>"), "not in the archive"},
           {collision("<mesh filename=\"broken.stl\"/>"), "not an STL file"},
           {collision("<mesh filename=\"shape.ply\"/>"), "make it .stl, .obj or .dae"},
           {mesh("cube.obj", "1 0 1"), "a scale of zero"},
           {collision("<sphere radius=\"0\"/>"), "radius"},
           {collision("<sphere radius=\"-1\"/>"), "radius"},
           {collision("<box size=\"0 0 0\"/>"), "no extent"},
           {collision("<box size=\"1 -1 1\"/>"), "half"},
           {collision("<capsule radius=\"1\" length=\"-1\"/>"), "half length"},
           {collision("<sphere radius=\"1\"/>", origin("1e300 0 0")), "T_body_shape"},
           {collision("<sphere radius=\"1\"/>", origin("0 0 0", "1e300 1e300 0")), ""},
       }) {
    const std::string text =
        robot(link("a", "") + link("b", bad.geometry) + joint("j", "continuous", "a", "b"));
    Placed placed = place(text);
    if (*bad.note == '\0') continue;  // it only must not crash
    ASSERT_EQ(placed.robot.colliders.size(), 1u) << bad.geometry;
    EXPECT_FALSE(placed.robot.colliders[0]) << bad.geometry;
    ASSERT_EQ(placed.robot.notes.size(), 1u) << bad.geometry;
    EXPECT_EQ(placed.robot.notes[0].rfind("line 3: <collision> of link \"b\": left out: ", 0), 0u)
        << placed.robot.notes[0];
    EXPECT_NE(placed.robot.notes[0].find(bad.note), std::string::npos) << placed.robot.notes[0];

    UrdfWorldOptions strict;
    strict.require_all = true;
    strict.read_mesh = meshes;
    World world, untouched;
    const auto refused = add_urdf(world, must_parse(text), "robot.urdf", strict);
    ASSERT_FALSE(refused) << bad.geometry;
    EXPECT_EQ(refused.error().message.rfind("robot.urdf: line 3: ", 0), 0u);
    EXPECT_FALSE(world.contains(ArticulationId{1, 1}));
  }
}

TEST(UrdfWorld, FaultsOfCollisionsAreNotedByLineWhenRead) {
  const UrdfModel read = must_parse(
      robot(
          "<link name=\"a\">\n<collision/>\n<collision><geometry/></collision>\n"
          "<collision><geometry><cone/></geometry></collision>\n"
          "<collision><geometry><box size=\"1 2\"/></geometry></collision>\n"
          "<collision><geometry><sphere/></geometry></collision>\n"
          "<collision><origin xyz=\"x\"/><geometry><sphere radius=\"1\"/></geometry></collision>\n"
          "<collision name=\"good\"><geometry><sphere radius=\"1\"/></geometry></collision>\n"
          "<inertial><mass value=\"1\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" "
          "iyz=\"0\" izz=\"1\"/></inertial></link>\n"),
      {UrdfBase::floating, {}});
  ASSERT_EQ(read.collisions.size(), 1u);
  EXPECT_EQ(read.collisions[0].name, "good");
  EXPECT_EQ(read.collisions[0].line, 9);
  ASSERT_EQ(read.notes.size(), 6u);
  for (int k = 0; k < 6; ++k) {
    const std::string line = "line " + std::to_string(3 + k) + ": ";
    EXPECT_EQ(read.notes[static_cast<std::size_t>(k)].rfind(line, 0), 0u)
        << read.notes[static_cast<std::size_t>(k)];
  }
}

// An inertia that no rigid body has is valid for a link, but not for a body.
TEST(UrdfWorld, ABodyWithAnInertiaOfNoBodyHasThatOfItsColliders) {
  Placed placed = place(
      robot("<link name=\"a\"><inertial><mass value=\"1\"/><inertia ixx=\"9\" ixy=\"0\" ixz=\"0\" "
            "iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial>" +
            collision("<box size=\"0.1 0.1 0.1\"/>") + "</link>\n"),
      floating());
  EXPECT_NEAR(placed.world.inertia(placed.robot.body).mass(), 1.0, 1e-12);
  ASSERT_EQ(placed.robot.notes.size(), 2u);
  EXPECT_NE(placed.robot.notes[1].find("1.000000 kg by its colliders"), std::string::npos);
}

TEST(UrdfWorld, MeshesAreFoundAsRobotsToolsFindThem) {
  namespace fs = std::filesystem;
  const fs::path root = fs::path(testing::TempDir()) / "vphysics_urdf_world_test";
  fs::remove_all(root);
  fs::create_directories(root / "dog" / "urdf");
  fs::create_directories(root / "dog" / "meshes");
  fs::create_directories(root / "elsewhere" / "parts");
  std::ofstream(root / "dog" / "meshes" / "leg.obj") << two_boxes();
  std::ofstream(root / "elsewhere" / "parts" / "head.OBJ") << two_boxes();
  const std::string path = (root / "dog" / "urdf" / "dog.urdf").string();
  const auto colliders = [&](const std::string& name, std::vector<std::string> folders) {
    std::ofstream(path) << robot(link("a", mesh(name)));
    World world;
    UrdfWorldOptions options;
    options.folders = std::move(folders);
    const UrdfRobot robot = must_build(add_urdf(world, path, options));
    EXPECT_EQ(robot.notes.empty(), static_cast<bool>(robot.colliders[0])) << name;
    return static_cast<bool>(robot.colliders[0]);
  };
  EXPECT_TRUE(colliders("package://dog/meshes/leg.obj", {}));
  EXPECT_TRUE(colliders("model://dog/meshes/leg.obj", {}));
  EXPECT_TRUE(colliders("package://other_name/meshes/leg.obj", {}));
  EXPECT_TRUE(colliders("../meshes/leg.obj", {}));
  EXPECT_TRUE(colliders("file://" + (root / "dog" / "meshes" / "leg.obj").string(), {}));
  EXPECT_FALSE(colliders("package://parts/head.OBJ", {}));
  EXPECT_TRUE(colliders("package://parts/head.OBJ", {(root / "elsewhere").string()}));
  EXPECT_TRUE(colliders("package://parts/head.OBJ", {(root / "elsewhere" / "parts").string()}));
  EXPECT_TRUE(colliders("head.OBJ", {(root / "elsewhere" / "parts").string()}));
  EXPECT_FALSE(colliders("", {}));
  EXPECT_FALSE(colliders("package://", {}));
  EXPECT_FALSE(colliders("package://dog", {}));
  fs::remove_all(root);
}

// The first and the last link overlap; the one in between is a neighbour of both.
TEST(UrdfWorld, LinksMeetEachOtherIfAskedTo) {
  const std::string ball = collision("<sphere radius=\"0.5\"/>");
  const std::string text =
      robot(link("base", ball) + link("upper", ball) + link("lower", ball) + link("hand", ball) +
            joint("shoulder", "continuous", "base", "upper", origin("0 0 -0.2")) +
            joint("elbow", "continuous", "upper", "lower", origin("0 0 -0.2")) +
            joint("wrist", "fixed", "lower", "hand", origin("0 0 -0.2")));
  for (const bool collide : {false, true}) {
    UrdfWorldOptions options = floating();
    options.links_collide = collide;
    Placed placed = place(text, options);
    (void)must_build(placed.world.step(0.001));
    std::vector<std::pair<ColliderId, ColliderId>> met, expected;
    for (const ContactEvent& e : placed.world.contact_events()) met.emplace_back(e.a, e.b);
    const auto& all = placed.robot.colliders;
    if (collide) expected = {{all[0], all[2]}, {all[0], all[3]}};
    EXPECT_TRUE(met == expected) << met.size();
  }
}

// It falls onto its feet and stays there; no part of it passes through the ground.
TEST(UrdfWorld, ARobotStandsOnTheGroundByItsGeometry) {
  const auto foot = [](const std::string& name, const std::string& at) {
    return link(name, collision("<sphere radius=\"0.05\"/>"), false) +
           joint(name + "_weld", "fixed", "base", name, origin(at));
  };
  UrdfWorldOptions options = floating();
  options.T_world_root = SE3(Vec3{0, 0, 1});
  Placed placed = place(robot(link("base", "") + link("arm", mesh("cube.obj", "0.1 0.1 0.1")) +
                              foot("f1", "0.5 0.4 -0.3") + foot("f2", "0.5 -0.4 -0.3") +
                              foot("f3", "-0.5 0.4 -0.3") + foot("f4", "-0.5 -0.4 -0.3") +
                              joint("j", "continuous", "base", "arm", "<axis xyz=\"0 0 1\"/>")),
                        options);
  BodyDesc ground;
  ground.motion = Motion::fixed;
  ColliderDesc plane;
  plane.shape = HalfSpace{};
  (void)must_build(placed.world.add_collider(must_build(placed.world.create_body(ground)), plane));
  StepStatus status;
  for (int k = 0; k < 2000; ++k) status |= must_build(placed.world.step(0.001));
  EXPECT_FALSE(status.non_finite);
  const SE3 base = placed.world.pose(placed.robot.link_body(placed.world, "base"));
  EXPECT_NEAR(base.position().z, 0.35, 1e-3);
  EXPECT_NEAR(base.rotation().cz.z, 1.0, 1e-5);
}

}  // namespace
}  // namespace vp::test
