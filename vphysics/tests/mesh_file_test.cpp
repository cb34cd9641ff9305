// Triangles from files: the same tetrahedron in every format, variants that other programs write,
// and rejected files.
#include "vphysics/mesh_file.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstdio>
#include <cstring>
#include <fstream>

#include "trees.h"
#include "vphysics/convex_hull.h"

namespace vp::test {
namespace {

// Corners (0,0,0), (3,0,0), (0,2,0), (0,0,1): a volume of 1, and a face that crosses all three
// axes.
const Vec3 kCorners[] = {{0, 0, 0}, {3, 0, 0}, {0, 2, 0}, {0, 0, 1}};
const int kFaces[][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};

void add_u32(std::string& bytes, std::uint32_t value) {
  for (int k = 0; k < 4; ++k) bytes += static_cast<char>(value >> (8 * k) & 0xff);
}
std::string binary_stl(const char* header) {
  std::string bytes = header;
  bytes.resize(80, ' ');
  add_u32(bytes, 4);
  for (const auto& face : kFaces) {
    for (int k = 0; k < 3; ++k) add_u32(bytes, 0);
    for (const int corner : face) {
      for (int k = 0; k < 3; ++k) {
        add_u32(bytes, std::bit_cast<std::uint32_t>(static_cast<float>(kCorners[corner][k])));
      }
    }
    bytes += std::string(2, '\x7f');
  }
  return bytes;
}
std::string text_stl() {
  std::string text = "solid a name of words\n";
  for (const auto& face : kFaces) {
    text += "facet normal 0 0 0\r\n outer loop\n";
    for (const int corner : face) {
      const Vec3& v = kCorners[corner];
      text += "  vertex " + std::to_string(v.x) + "\t" + std::to_string(v.y) + " +" +
              std::to_string(v.z) + "\n";
    }
    text += " endloop\nendfacet\n";
  }
  return text + "endsolid\n";
}
const std::string kObj =
    "# a tetrahedron\nmtllib none.mtl\no t\nv 0 0 0\nv 3e0 0 0 1.0\r\nv 0 2 \\\n0\nv 0 0 1\n"
    "vt 0 0\nvn 0 0 1\nusemtl m\ns off\nf 1/1/1 3/1 2//1\nf -4 -3 -1\nf 2 3 4 # last\nf 3 1 4\n";
std::string collada(const std::string& faces, const std::string& node = "",
                    const std::string& asset = "") {
  return "<?xml version=\"1.0\"?>\n<COLLADA version=\"1.4.1\">" + asset +
         "<library_geometries><geometry id=\"g\"><mesh>"
         "<source id=\"n\"><float_array count=\"3\">9 9 9</float_array></source>"
         "<source id=\"p\"><float_array count=\"12\">0 0 0 3 0 0 0 2 0\n0 0 1</float_array>"
         "<technique_common><accessor stride=\"3\"/></technique_common></source>"
         "<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>" +
         faces + "</mesh></geometry></library_geometries>" + node + "</COLLADA>\n";
}
const std::string kTriangles =
    "<triangles count=\"4\"><input semantic=\"NORMAL\" source=\"#n\" offset=\"0\"/>"
    "<input semantic=\"VERTEX\" source=\"#v\" offset=\"1\"/>"
    "<p>0 0 0 2 0 1  0 0 0 1 0 3  0 1 0 2 0 3  0 2 0 0 0 3</p></triangles>";

void expect_tetrahedron(const Expected<MeshFile>& mesh, const char* what) {
  ASSERT_TRUE(mesh) << what << ": " << mesh.error().message;
  EXPECT_EQ(mesh->triangles.size(), 4u) << what;
  EXPECT_EQ(mesh->left_out, 0u) << what;
  EXPECT_EQ(mesh->objects, std::vector<std::size_t>{0}) << what;
  const TriangleMesh triangles = must_build(TriangleMesh::of(mesh->vertices, mesh->triangles));
  EXPECT_TRUE(triangles.closed()) << what;
  EXPECT_NEAR(triangles.volume(), 1.0, 1e-6) << what;
}

TEST(MeshFile, EveryFormatGivesTheSameTetrahedron) {
  expect_tetrahedron(parse_mesh(binary_stl("made by hand"), MeshFormat::stl), "binary STL");
  expect_tetrahedron(parse_mesh(binary_stl("solid as if it were text"), MeshFormat::stl),
                     "binary STL that begins as text does");
  expect_tetrahedron(parse_mesh(text_stl(), MeshFormat::stl), "text STL");
  expect_tetrahedron(parse_mesh(kObj, MeshFormat::obj), "OBJ");
  expect_tetrahedron(parse_mesh(collada(kTriangles), MeshFormat::collada), "COLLADA");
  expect_tetrahedron(
      parse_mesh(collada("<polylist><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>"
                         "<vcount>3 3 3 3</vcount><p>0 2 1 0 1 3 1 2 3 2 0 3</p></polylist>"),
                 MeshFormat::collada),
      "COLLADA, polylist");
  expect_tetrahedron(
      parse_mesh(collada("<polygons><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>"
                         "<p>0 2 1</p><p>0 1 3</p><p>1 2 3</p><p>2 0 3</p></polygons>"),
                 MeshFormat::collada),
      "COLLADA, polygons");
}

// The nodes of a scene transform a geometry: here from centimetres, scaled by two in x, rotated by
// a quarter revolution about z, and translated. The first corner away from the origin is then at
// (1, 0.06, 0).
TEST(MeshFile, ColladaIsWhereItsScenePlacesIt) {
  const std::string scene =
      "<library_visual_scenes><visual_scene><node><translate>100 0 0</translate>"
      "<rotate>0 0 2 90</rotate><node><matrix>2 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</matrix>"
      "<instance_geometry url=\"#g\"/></node></node></visual_scene></library_visual_scenes>";
  const MeshFile mesh = must_build(parse_mesh(
      collada(kTriangles, scene, "<asset><unit meter=\"0.01\"/></asset>"), MeshFormat::collada));
  ASSERT_EQ(mesh.vertices.size(), 4u);
  EXPECT_LT(norm(mesh.vertices[0] - Vec3{1, 0, 0}), 1e-15);
  EXPECT_LT(norm(mesh.vertices[1] - Vec3{1, 0.06, 0}), 1e-15);
  EXPECT_LT(norm(mesh.vertices[2] - Vec3{0.98, 0, 0}), 1e-15);
  EXPECT_LT(norm(mesh.vertices[3] - Vec3{1, 0, 0.01}), 1e-15);
}

TEST(MeshFile, ObjectsBeginWhereTheFileNamesThem) {
  const std::string triangle = "f 1 2 3\n";
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const MeshFile mesh = must_build(
      parse_mesh(corners + "g a\n" + triangle + triangle + "o empty\no b\n" + triangle + "g last\n",
                 MeshFormat::obj));
  EXPECT_EQ(mesh.objects, (std::vector<std::size_t>{0, 2}));
  const MeshFile unnamed =
      must_build(parse_mesh(corners + triangle + "o b\n" + triangle, MeshFormat::obj));
  EXPECT_EQ(unnamed.objects, (std::vector<std::size_t>{0, 1}));
}

TEST(MeshFile, APolygonIsCutFromItsFirstCorner) {
  const MeshFile mesh =
      must_build(parse_mesh("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n", MeshFormat::obj));
  EXPECT_EQ(mesh.triangles, (std::vector<TriangleMesh::Triangle>{{0, 1, 2}, {0, 2, 3}}));
}

TEST(MeshFile, FacesOfWhatIsNoVertexAreLeftOutAndCounted) {
  const MeshFile mesh = must_build(
      parse_mesh("v nan 0 0\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 2 3 4\nf 2 3 5\nf 2 3\n"
                 "f 0 2 3\nf 2 x 3\nf -5 2 3\nf 2 3 99999999999999999999\n",
                 MeshFormat::obj));
  EXPECT_EQ(mesh.triangles, (std::vector<TriangleMesh::Triangle>{{0, 1, 2}}));
  EXPECT_EQ(mesh.vertices.size(), 3u);
  EXPECT_EQ(mesh.left_out, 7u);
}

TEST(MeshFile, AFileThatEndsEarlyIsRefusedOrHasFewerTriangles) {
  const std::string whole = binary_stl("made by hand");
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(parse_mesh(whole.substr(0, size), MeshFormat::stl)) << size;
  }
  // Some programs write extra bytes after the last triangle.
  expect_tetrahedron(parse_mesh(whole + "end", MeshFormat::stl), "bytes at the end");
  for (const std::string& text : {text_stl(), kObj, collada(kTriangles)}) {
    const MeshFormat format = text[0] == 's'   ? MeshFormat::stl
                              : text[0] == '#' ? MeshFormat::obj
                                               : MeshFormat::collada;
    for (std::size_t size = 0; size < text.size(); ++size) {
      const auto mesh = parse_mesh(text.substr(0, size), format);
      if (mesh) {
        EXPECT_LE(mesh->triangles.size(), 4u);
      }
    }
  }
}

TEST(MeshFile, WhatIsNoMeshIsRefused) {
  const auto refusal = [](const std::string& bytes, MeshFormat format) {
    const auto mesh = parse_mesh(bytes, format);
    EXPECT_FALSE(mesh) << bytes;
    if (mesh) return std::string();
    EXPECT_EQ(mesh.error().code, Errc::bad_data);
    return mesh.error().message;
  };
  const std::string pointer =
      "version https://git-lfs.github.com/spec/v1\noid sha256:" + std::string(64, 'a') +
      "\nsize 12345\n";
  EXPECT_EQ(refusal(pointer, MeshFormat::stl), "not an STL file, or cut short");
  EXPECT_EQ(refusal("solid\nendsolid\n", MeshFormat::stl), "not an STL file, or cut short");
  EXPECT_EQ(refusal(pointer, MeshFormat::obj), "no vertex that OBJ has; is it such a file?");
  EXPECT_EQ(refusal("<robot/>", MeshFormat::collada), "the root element is <robot>, not <COLLADA>");
  EXPECT_EQ(refusal("<COLLADA>\n<asset>", MeshFormat::collada).substr(0, 7), "line 2:");
  EXPECT_EQ(refusal("<COLLADA/>", MeshFormat::collada),
            "no vertex that COLLADA has; is it such a file?");
}

TEST(MeshFile, LimitsAreKept) {
  const std::string whole = binary_stl("");
  EXPECT_TRUE(parse_mesh(whole, MeshFormat::stl, {.max_triangles = 4}));
  const auto many = parse_mesh(whole, MeshFormat::stl, {.max_triangles = 3});
  ASSERT_FALSE(many);
  EXPECT_EQ(many.error().code, Errc::unsupported);
  const auto large = parse_mesh(whole, MeshFormat::stl, {.max_bytes = whole.size() - 1});
  ASSERT_FALSE(large);
  EXPECT_EQ(large.error().code, Errc::unsupported);
  std::string vertices;
  for (int k = 0; k < 100; ++k) vertices += "v\n";
  EXPECT_EQ(parse_mesh(vertices, MeshFormat::obj, {.max_triangles = 10}).error().code,
            Errc::unsupported);
}

// Each node instances the next twice: 2^40 geometries. The parser rejects it at once.
TEST(MeshFile, AColladaThatMultipliesItselfEnds) {
  std::string nodes = "<library_nodes>";
  for (int k = 0; k < 40; ++k) {
    const std::string next = "<instance_node url=\"#n" + std::to_string(k + 1) + "\"/>";
    nodes += "<node id=\"n" + std::to_string(k) + "\">" + next + next + "</node>";
  }
  nodes +=
      "<node id=\"n40\"><instance_geometry url=\"#g\"/></node></library_nodes>"
      "<library_visual_scenes><visual_scene><node><instance_node url=\"#n0\"/></node>"
      "</visual_scene></library_visual_scenes>";
  const auto mesh = parse_mesh(collada(kTriangles, nodes), MeshFormat::collada);
  if (mesh) {
    EXPECT_LE(mesh->triangles.size(), 40000u);
  }
}

TEST(MeshFile, AFileIsReadByTheEndOfItsName) {
  EXPECT_EQ(mesh_format("a/B.STL"), MeshFormat::stl);
  EXPECT_EQ(mesh_format("x.Obj"), MeshFormat::obj);
  EXPECT_EQ(mesh_format("x.dae"), MeshFormat::collada);
  EXPECT_EQ(mesh_format("stl"), std::nullopt);
  const std::string path = testing::TempDir() + "vphysics_mesh_file_test.obj";
  std::ofstream(path) << kObj;
  expect_tetrahedron(load_mesh(path), "file");
  std::remove(path.c_str());
  EXPECT_EQ(load_mesh(path).error().message,
            path + ": it cannot be read; is it there, and a file?");
  EXPECT_EQ(load_mesh("x.ply").error().code, Errc::unsupported);
}

}  // namespace
}  // namespace vp::test
