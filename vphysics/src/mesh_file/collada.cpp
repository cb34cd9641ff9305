// COLLADA 1.4 and 1.5, as far as collision shapes need it: the geometries (triangles, polylist,
// polygons) and their placement by the scene's nodes. The unit of length is applied. The up axis is
// ignored, as in RViz. Without a scene, every geometry is used without a transform.
//
//   <mesh> <source id="p"><float_array>x y z ...</float_array></source>
//          <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
//          <triangles> <input semantic="VERTEX" source="#v" offset="0"/> <p>0 1 2 ...</p>
#include <cstring>
#include <map>
#include <utility>
#include <vector>

#include "files/xml.h"
#include "mesh_file/reader.h"

namespace vp::detail {
namespace {

using tinyxml2::XMLElement;

// x' = A x + t, with any A.
struct Affine {
  Mat3 A = Mat3::identity();
  Vec3 t;

  Vec3 operator()(const Vec3& x) const { return A * x + t; }
  Affine operator*(const Affine& b) const { return {A * b.A, A * b.t + t}; }
};

std::string_view text_of(const XMLElement* e) {
  const char* text = e ? e->GetText() : nullptr;
  return text ? text : "";
}
bool is(const XMLElement& e, const char* name) {
  return std::strcmp(e.Name(), name) == 0;
}
// The id in an attribute "#id".
std::string_view reference(const XMLElement* e, const char* attribute) {
  const char* value = e ? e->Attribute(attribute) : nullptr;
  return value && *value == '#' ? value + 1 : "";
}
// The child input with this semantic, or null.
const XMLElement* input(const XMLElement& parent, const char* semantic) {
  for (const XMLElement* e = parent.FirstChildElement("input"); e;
       e = e->NextSiblingElement("input")) {
    if (const char* s = e->Attribute("semantic"); s && std::strcmp(s, semantic) == 0) return e;
  }
  return nullptr;
}

class Collada {
 public:
  Collada(const XMLElement& root, MeshBuilder& builder) : builder_(builder) {
    unit(root);
    for (const XMLElement* library = root.FirstChildElement("library_geometries"); library;
         library = library->NextSiblingElement("library_geometries")) {
      for (const XMLElement* g = library->FirstChildElement("geometry"); g;
           g = g->NextSiblingElement("geometry")) {
        if (const char* id = g->Attribute("id")) geometries_.emplace(id, g);
        anonymous_.push_back(g);
      }
    }
    for (const XMLElement* library = root.FirstChildElement("library_nodes"); library;
         library = library->NextSiblingElement("library_nodes")) {
      for (const XMLElement* n = library->FirstChildElement("node"); n;
           n = n->NextSiblingElement("node")) {
        if (const char* id = n->Attribute("id")) nodes_.emplace(id, n);
      }
    }
  }

  void read(const XMLElement& root) {
    for (const XMLElement* library = root.FirstChildElement("library_visual_scenes"); library;
         library = library->NextSiblingElement("library_visual_scenes")) {
      for (const XMLElement* scene = library->FirstChildElement("visual_scene"); scene;
           scene = scene->NextSiblingElement("visual_scene")) {
        for (const XMLElement* n = scene->FirstChildElement("node"); n;
             n = n->NextSiblingElement("node")) {
          node(*n, unit_, 0);
        }
      }
    }
    if (placed_) return;
    for (const XMLElement* g : anonymous_) geometry(*g, unit_);
  }

 private:
  void unit(const XMLElement& root) {
    const XMLElement* asset = root.FirstChildElement("asset");
    const XMLElement* unit = asset ? asset->FirstChildElement("unit") : nullptr;
    const char* meter = unit ? unit->Attribute("meter") : nullptr;
    const double m = meter ? to_number(meter) : 1.0;
    if (m > 0.0 && std::isfinite(m)) unit_.A = {{m, 0, 0}, {0, m, 0}, {0, 0, m}};
  }

  // Nodes may instance nodes of a library, so a few lines could request an unbounded number.
  void node(const XMLElement& n, const Affine& parent, int depth) {
    constexpr int kDeepest = 50, kMaxNodes = 10000;
    if (depth > kDeepest || ++visited_ > kMaxNodes || builder_.full()) return;
    Affine T = parent;
    for (const XMLElement* e = n.FirstChildElement(); e; e = e->NextSiblingElement()) {
      if (is(*e, "instance_geometry")) {
        if (const auto g = geometries_.find(reference(e, "url")); g != geometries_.end()) {
          placed_ = true;
          geometry(*g->second, T);
        }
      } else if (is(*e, "instance_node")) {
        const auto named = nodes_.find(reference(e, "url"));
        if (named != nodes_.end()) node(*named->second, T, depth + 1);
      } else if (is(*e, "node")) {
        node(*e, T, depth + 1);
      } else {
        T = T * transform(*e);
      }
    }
  }

  static Affine transform(const XMLElement& e) {
    std::string_view text = text_of(&e);
    Affine T;
    if (is(e, "matrix")) {
      for (int row = 0; row < 3; ++row) {
        const Vec3 a = take_vec3(text);
        T.A.cx[row] = a.x;
        T.A.cy[row] = a.y;
        T.A.cz[row] = a.z;
        T.t[row] = to_number(take_token(text));
      }
    } else if (is(e, "translate")) {
      T.t = take_vec3(text);
    } else if (is(e, "scale")) {
      const Vec3 s = take_vec3(text);
      T.A = {{s.x, 0, 0}, {0, s.y, 0}, {0, 0, s.z}};
    } else if (is(e, "rotate")) {
      const Vec3 axis = take_vec3(text);
      const double degrees = to_number(take_token(text));
      const double length = norm(axis);
      // Excludes non-finite and huge numbers, which Exp does not accept.
      if (length > 0.0 && length < 1e9 && std::fabs(degrees) < 1e9) {
        T.A = Exp((degrees * kPi / 180.0 / length) * axis).matrix();
      }
    }
    return T;
  }

  // Returns the text, or nothing once the total exceeds what any real file needs: nodes may
  // instance a geometry any number of times.
  std::string_view asked(std::string_view text) {
    constexpr std::size_t kMax = std::size_t{256} << 20;
    asked_ += text.size();
    return asked_ <= kMax ? text : std::string_view();
  }

  void geometry(const XMLElement& g, const Affine& T) {
    const XMLElement* mesh = g.FirstChildElement("mesh");
    if (!mesh) return;
    const XMLElement* vertices = mesh->FirstChildElement("vertices");
    const XMLElement* position = vertices ? input(*vertices, "POSITION") : nullptr;
    if (!position) return;
    builder_.begin_object();
    const std::size_t first = builder_.mesh.vertices.size();
    add_vertices(*mesh, reference(position, "source"), T);
    for (const XMLElement* e = mesh->FirstChildElement(); e; e = e->NextSiblingElement()) {
      if (is(*e, "triangles") || is(*e, "polylist") || is(*e, "polygons")) {
        faces(*e, static_cast<std::int64_t>(first));
      }
    }
  }

  void add_vertices(const XMLElement& mesh, std::string_view id, const Affine& T) {
    const XMLElement* source = mesh.FirstChildElement("source");
    while (source && (!source->Attribute("id") || id != source->Attribute("id"))) {
      source = source->NextSiblingElement("source");
    }
    if (!source) return;
    std::string_view text = asked(text_of(source->FirstChildElement("float_array")));
    const XMLElement* technique = source->FirstChildElement("technique_common");
    const XMLElement* accessor = technique ? technique->FirstChildElement("accessor") : nullptr;
    const int stride = accessor ? accessor->IntAttribute("stride", 3) : 3;
    for (;;) {
      const std::string_view x = take_token(text);
      if (x.empty() || builder_.full()) return;
      const double y = to_number(take_token(text)), z = to_number(take_token(text));
      builder_.vertex(T(Vec3{to_number(x), y, z}));
      for (int k = 3; k < stride && !text.empty(); ++k) take_token(text);
    }
  }

  // Each corner has one index for each offset; one of them is the vertex index.
  void faces(const XMLElement& e, std::int64_t first) {
    const XMLElement* vertex = input(e, "VERTEX");
    if (!vertex) return;
    int indices = 1;
    for (const XMLElement* i = e.FirstChildElement("input"); i; i = i->NextSiblingElement("input"))
      indices = std::max(indices, std::clamp(i->IntAttribute("offset", 0), 0, 100) + 1);
    const int offset = std::clamp(vertex->IntAttribute("offset", 0), 0, indices - 1);
    const auto polygon = [&](std::string_view& text, std::size_t corners) {
      corners_.clear();
      while (corners_.size() < corners && !text.empty()) {
        for (int k = 0; k < indices; ++k) {
          const std::string_view token = take_token(text);
          if (token.empty()) break;
          std::int64_t index = -1;
          const auto [end, failed] =
              std::from_chars(token.data(), token.data() + token.size(), index);
          const bool fine = failed == std::errc() && index >= 0 && index < kMaxIndices;
          if (k == offset) corners_.push_back(fine ? first + index : -1);
        }
      }
      if (!corners_.empty()) builder_.polygon(corners_);
    };
    constexpr std::size_t kAll = ~std::size_t{0};
    const XMLElement* p = e.FirstChildElement("p");
    std::string_view text = asked(text_of(p));
    if (is(e, "polygons")) {
      for (; p && !builder_.full(); p = p->NextSiblingElement("p")) {
        text = asked(text_of(p));
        polygon(text, kAll);
      }
    } else if (is(e, "polylist")) {
      std::string_view counts = text_of(e.FirstChildElement("vcount"));
      while (!text.empty() && !builder_.full()) {
        const double count = to_number(take_token(counts));
        if (!(count >= 1.0 && count < 1e6)) return;
        polygon(text, static_cast<std::size_t>(count));
      }
    } else {
      while (!text.empty() && !builder_.full()) polygon(text, 3);
    }
  }

  static constexpr std::int64_t kMaxIndices = std::int64_t{1} << 31;

  MeshBuilder& builder_;
  Affine unit_;
  std::map<std::string, const XMLElement*, std::less<>> geometries_, nodes_;
  std::vector<const XMLElement*> anonymous_;
  std::vector<std::int64_t> corners_;
  std::size_t asked_ = 0;
  int visited_ = 0;
  bool placed_ = false;
};

}  // namespace

void read_collada(std::string_view text, MeshBuilder& builder, std::string& fault) {
  tinyxml2::XMLDocument document;
  if (const auto read = parse_xml(text, document); !read) {
    fault = read.error().message;
    return;
  }
  const XMLElement& root = *document.RootElement();
  if (!is(root, "COLLADA")) {
    fault = "the root element is <" + std::string(root.Name()) + ">, not <COLLADA>";
    return;
  }
  Collada(root, builder).read(root);
}

}  // namespace vp::detail
